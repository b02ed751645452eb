#pragma once
// The parts of the bodies of a running simulation in backend memory. Runs without compounds have none: their bodies are
// what is detected and drawn.

#include <vector>

#include "collision/obstacles.h"
#include "kernels/backend/backend.h"
#include "kernels/step/place_parts.h"

namespace scree {

template <class B, class Real>
class PartStore {
 public:
  /// @param shapes    records that BodyView::shape points to; they outlive this object
  /// @param capacity  places of the storage of bodies
  PartStore(B& b, const ObstacleData<Real>& data, Span<const ShapeRecord<Real>> shapes,
            const BodyRanges& capacity, const PeriodicBox& box)
      : b_(&b),
        shapes_(shapes),
        body_count_(capacity.count),
        box_(box),
        records_(b),
        first_(b),
        begin_(b),
        owner_(b),
        record_(b),
        shape_(b),
        id_(b),
        group_(b),
        radius_(b),
        inv_mass_(b),
        locks_(b),
        material_(b),
        position_(b),
        orientation_(b),
        velocity_(b),
        angular_velocity_(b),
        from_body_(b) {
    if (data.parts.empty()) return;
    upload(b, data.parts, records_);
    upload(b, data.first_part, first_);
    Index fixed_parts = 0, all_parts = 0;
    for (const ShapeRecord<Real>& shape : data.shapes) {
      if (shape.kind != shapes::Compound::kind) continue;
      const auto k = static_cast<std::size_t>(shape.mesh);
      const Index more = data.first_part[k + 1] - data.first_part[k] - 1;
      all_parts += more;
      if (shape.body >= 0) fixed_parts += more;
    }
    ranges_.count = capacity.count + all_parts;
    ranges_.fixed_begin = ranges_.count - capacity.fixed_count() - fixed_parts;
    const auto size = [&](auto&... buffers) { (buffers.resize_discard(ranges_.count), ...); };
    size(owner_, record_, shape_, id_, group_, radius_, inv_mass_, locks_, material_, position_,
         orientation_, velocity_, angular_velocity_, from_body_);
    // Room holds defined values.
    fill(b, owner_.view(), Index(0));
    fill(b, record_.view(), Index(-1));
    fill(b, shape_.view(), kSphere);
    fill(b, id_.view(), Index(-1));
    fill(b, group_.view(), Index(0));
    fill(b, radius_.view(), Real(0));
    fill(b, inv_mass_.view(), Real(0));
    fill(b, locks_.view(), std::uint8_t(0));
    fill(b, material_.view(), std::uint8_t(0));
    fill(b, position_.view(), Vec3<double>{});
    fill(b, orientation_.view(), Quat<Real>{});
    fill(b, velocity_.view(), Vec3<Real>{});
    fill(b, angular_velocity_.view(), Vec3<Real>{});
    fill(b, from_body_.view(), Vec3<Real>{});
  }

  bool is_used() const { return ranges_.count > 0; }
  PartSet<Real> set() const { return {whole(records_), whole(first_)}; }

  /// Places of bodies changed, or there are more of them.
  void forget() { is_listed_ = false; }

  /// Parts where their bodies are, or else the bodies themselves.
  BodyView<Real> place(const BodyView<Real>& bodies) {
    if (!is_used()) return bodies;
    if (!is_listed_) list(bodies);
    const BodyView<Real> parts = view();
    for_each(*b_, parts.present_count(),
             PlaceParts<Real>{bodies, set(), record_.view(), box_, parts, owner_.view(),
                              from_body_.view()});
    return parts;
  }
  /// Whose they are, as place() left them. @param bodies  as given to it
  BodyParts<Real> of(const BodyView<Real>& bodies) {
    if (!is_used()) return {};
    return {bodies, owner_.view(), from_body_.view()};
  }

  /// Follows a reordering of the bodies. @return  new places of the owned parts by old ones
  Span<const Index> follow(const BodyView<Real>& bodies, Span<const Index> new_of_old,
                           Buffer<B, Index>& place) {
    if (!is_used()) return new_of_old;
    Buffer<B, Offset> old_begin(*b_);
    swap(old_begin, begin_);
    list(bodies);
    const Index n = ranges_.owned_count;
    for_each(*b_, bodies.owned_count,
             FollowBodies{old_begin.view(), begin_.view(), new_of_old, place.resize_discard(n)});
    return std::as_const(place).view(n);
  }

  /// Names of parts that outlive their places: that of the first part of a body is its id; others follow those
  /// of all bodies. Without parts, those of bodies. @param id  of bodies, in storage order
  std::vector<Index> names(const BodyView<Real>& bodies, std::vector<Index> id) {
    if (!is_used()) return id;
    if (!is_listed_) list(bodies);
    const std::vector<Index> record = download(*b_, record_.view());
    const std::vector<Index> first = download(*b_, first_.view());
    id = download(*b_, id_.view());
    std::vector<bool> is_first(static_cast<std::size_t>(records_.capacity()), false);
    for (std::size_t k = 0; k + 1 < first.size(); ++k)
      is_first[static_cast<std::size_t>(first[k])] = true;
    for (std::size_t p = 0; p < id.size(); ++p) {
      const Index r = record[p];
      if (r >= 0 && !is_first[static_cast<std::size_t>(r)]) id[p] = body_count_ + r;
    }
    return id;
  }

 private:
  static constexpr Index kSphere = -1;  ///< see BodyView::shape

  template <class T>
  static Span<const T> whole(const Buffer<B, T>& buffer) {
    return buffer.view(buffer.capacity());
  }

  BodyView<Real> view() {
    BodyView<Real> v;
    static_cast<BodyRanges&>(v) = ranges_;
    v.position = position_.view();
    v.orientation = orientation_.view();
    v.velocity = velocity_.view();
    v.angular_velocity = angular_velocity_.view();
    v.id = id_.view();
    v.inv_mass = inv_mass_.view();
    v.radius = radius_.view();
    v.shape = shape_.view();
    v.locks = locks_.view();
    v.material = material_.view();
    v.group = group_.view();
    return v;
  }

  /// One host read.
  void list(const BodyView<Real>& bodies) {
    const Index n = bodies.present_count();
    Buffer<B, Index> count(*b_, n);
    for_each(*b_, n, CountParts<Real>{bodies, shapes_, set(), count.view()});
    begin_.resize_discard(static_cast<Offset>(n) + 1);
    exclusive_scan(*b_, Span<const Index>(count.view()), begin_.view());
    ranges_.owned_count = static_cast<Index>(fetch(*b_, begin_.data() + bodies.owned_count));
    ranges_.moving_count =
        bodies.moving_count == bodies.owned_count
            ? ranges_.owned_count
            : static_cast<Index>(fetch(*b_, begin_.data() + bodies.moving_count));
    const PartConstants<Real> out{owner_.view(),    record_.view(), shape_.view(),
                                  id_.view(),       group_.view(),  radius_.view(),
                                  inv_mass_.view(), locks_.view(),  material_.view()};
    for_each(*b_, n,
             ListParts<Real>{bodies, shapes_, set(), begin_.view(), ranges_.fixed_begin, out});
    is_listed_ = true;
  }

  B* b_;
  Span<const ShapeRecord<Real>> shapes_;
  Index body_count_;
  PeriodicBox box_;
  BodyRanges ranges_;
  bool is_listed_ = false;
  Buffer<B, PartRecord<Real>> records_;
  Buffer<B, Index> first_;
  Buffer<B, Offset> begin_;  ///< [present bodies + 1] first part of each
  Buffer<B, Index> owner_, record_, shape_, id_, group_;
  Buffer<B, Real> radius_, inv_mass_;
  Buffer<B, std::uint8_t> locks_, material_;
  Buffer<B, Vec3<double>> position_;
  Buffer<B, Quat<Real>> orientation_;
  Buffer<B, Vec3<Real>> velocity_, angular_velocity_, from_body_;
};

}  // namespace scree
