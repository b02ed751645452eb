#pragma once
// The parts of the bodies of a running simulation in backend memory. Runs without compounds have none: their bodies are
// what is detected and drawn.

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

#include "collision/obstacles.h"
#include "dynamics/part_names.h"
#include "dynamics/rigid/storage_room.h"
#include "kernels/backend/backend.h"
#include "kernels/step/place_parts.h"

namespace scree {

template <class B, class Real>
class PartStore {
 public:
  /// @param shapes       records that BodyView::shape points to; they outlive this object
  /// @param fixed_count  of bodies
  /// @param fixed_begin  place of the first part of a fixed body, as shape records have it; parts of other bodies have
  ///                     room before it, which grows when they need more
  PartStore(B& b, const ObstacleData<Real>& data, Span<const ShapeRecord<Real>> shapes,
            Index fixed_count, Index fixed_begin, const PeriodicBox& box)
      : b_(&b),
        shapes_(shapes),
        box_(box),
        records_(b),
        first_(b),
        reach_(b),
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
    Index fixed_parts = fixed_count;
    for (const ShapeRecord<Real>& shape : data.shapes) {
      if (shape.kind != shapes::Compound::kind || shape.body < 0) continue;
      const auto k = static_cast<std::size_t>(shape.mesh);
      fixed_parts += data.first_part[k + 1] - data.first_part[k] - 1;
    }
    ranges_.fixed_begin = fixed_begin;
    ranges_.count = fixed_begin + fixed_parts;
    take_room();
  }

  bool is_used() const { return records_.capacity() > 0; }
  PartSet<Real> set() const { return {whole(records_), whole(first_)}; }
  /// How far bodies reach that other ranks have to know. @param data  that of the constructor
  PartReach<Real> reach(const ObstacleData<Real>& data) {
    if (!is_used()) return {};
    if (reach_.capacity() == 0) upload(*b_, radii_about_parts(data), reach_);
    return {shapes_, whole(reach_)};
  }

  /// Places for parts of free bodies and of ghosts.
  Index capacity() const { return ranges_.fixed_begin; }
  /// The list of parts is void after it. @param places  no fewer than there are parts of free bodies and ghosts
  void set_capacity(Index places) {
    const Index shift = places - capacity();
    if (shift == 0) return;
    if (before_fixed_move_) before_fixed_move_(shift);
    ranges_.fixed_begin += shift;
    ranges_.count += shift;
    take_room();
    forget();
  }
  /// Called with a number of places, before parts of fixed bodies move back by so many (forward where it is negative).
  void before_fixed_move(std::function<void(Index)> act) { before_fixed_move_ = std::move(act); }

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

  /// New places of the parts of ghosts that came, went or changed places, -1: gone. Without parts, those of bodies.
  /// @param bodies     as they are now, with the owned ones where they were
  /// @param new_place  of the ghosts before; -1: gone
  std::vector<Index> follow_ghosts(const BodyView<Real>& bodies,
                                   const std::vector<Index>& new_place) {
    if (!is_used()) return new_place;
    const auto before = static_cast<Index>(new_place.size());
    const std::vector<Offset> old_begin = begins_of(bodies.owned_count, before);
    list(bodies);
    const std::vector<Offset> begin =
        begins_of(bodies.owned_count, bodies.moving_count - bodies.owned_count);
    std::vector<Index> places;
    for (std::size_t k = 0; k < new_place.size(); ++k) {
      const Index ghost = new_place[k] - bodies.owned_count;
      for (Offset p = 0; p < old_begin[k + 1] - old_begin[k]; ++p)
        places.push_back(
            new_place[k] < 0 ? -1 : static_cast<Index>(begin[static_cast<std::size_t>(ghost)] + p));
    }
    return places;
  }

  /// Names of the parts listed last, see PartNames; -1 where none is. Without parts, those of bodies.
  /// @param id        of bodies, in storage order
  /// @param id_count  of all bodies that there can ever be
  std::vector<Index> names(std::vector<Index> id, Index id_count) const {
    if (!is_used()) return id;
    const PartNames names{id_count, {}};
    const std::vector<Index> record = download(*b_, record_.view(ranges_.count));
    const std::vector<Index> first = download(*b_, whole(first_));
    id = download(*b_, id_.view(ranges_.count));
    std::vector<bool> is_first(static_cast<std::size_t>(records_.capacity()), false);
    for (std::size_t k = 0; k + 1 < first.size(); ++k)
      is_first[static_cast<std::size_t>(first[k])] = true;
    for (std::size_t p = 0; p < id.size(); ++p) {
      const Index r = record[p];
      if (!ranges_.exists(static_cast<Index>(p))) id[p] = -1;
      if (id[p] >= 0 && r >= 0 && !is_first[static_cast<std::size_t>(r)]) id[p] = names.of(r);
    }
    return id;
  }

 private:
  static constexpr Index kSphere = -1;  ///< see BodyView::shape

  template <class T>
  static Span<const T> whole(const Buffer<B, T>& buffer) {
    return buffer.view(buffer.capacity());
  }

  /// For each compound the radius about its center that holds the spheres about its parts [m].
  static std::vector<double> radii_about_parts(const ObstacleData<Real>& data) {
    std::vector<double> radii;
    for (std::size_t k = 0; k + 1 < data.first_part.size(); ++k) {
      double radius = 0;
      for (Index p = data.first_part[k]; p < data.first_part[k + 1]; ++p) {
        const PartRecord<Real>& part = data.parts[static_cast<std::size_t>(p)];
        radius = std::max(radius, norm(part.position) + static_cast<double>(part.radius));
      }
      radii.push_back(radius);
    }
    return radii;
  }

  /// Room holds defined values.
  void take_room() {
    B& b = *b_;
    const auto take = [&](auto& buffer, const auto& value) {
      fill(b, buffer.resize_discard(ranges_.count), value);
    };
    take(owner_, Index(0));
    take(record_, Index(-1));
    take(shape_, kSphere);
    take(id_, Index(-1));
    take(group_, Index(0));
    take(radius_, Real(0));
    take(inv_mass_, Real(0));
    take(locks_, std::uint8_t(0));
    take(material_, std::uint8_t(0));
    take(position_, Vec3<double>{});
    take(orientation_, Quat<Real>{});
    take(velocity_, Vec3<Real>{});
    take(angular_velocity_, Vec3<Real>{});
    take(from_body_, Vec3<Real>{});
  }

  /// First parts of so many present bodies from the m-th on, and the end, as they were listed.
  std::vector<Offset> begins_of(Index m, Index count) {
    if (count == 0) return {};
    return download(*b_, Span<const Offset>{begin_.data() + m, static_cast<Offset>(count) + 1});
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

  /// One host read; where there are ghosts, three.
  void list(const BodyView<Real>& bodies) {
    const Index n = bodies.present_count();
    Buffer<B, Index> count(*b_, n);
    for_each(*b_, n, CountParts<Real>{bodies, shapes_, set(), count.view()});
    begin_.resize_discard(static_cast<Offset>(n) + 1);
    exclusive_scan(*b_, Span<const Index>(count.view()), begin_.view());
    const Offset owned = fetch(*b_, begin_.data() + bodies.owned_count);
    const auto begin_of = [&](Index m) {
      return m == bodies.owned_count ? owned : fetch(*b_, begin_.data() + m);
    };
    const Offset moving = begin_of(bodies.moving_count);
    if (moving > capacity()) set_capacity(grown_room(moving, ranges_.fixed_count()));
    ranges_.owned_count = static_cast<Index>(owned);
    ranges_.moving_count = static_cast<Index>(moving);
    ranges_.higher_begin = static_cast<Index>(begin_of(bodies.higher_begin));
    const PartConstants<Real> out{owner_.view(),    record_.view(), shape_.view(),
                                  id_.view(),       group_.view(),  radius_.view(),
                                  inv_mass_.view(), locks_.view(),  material_.view()};
    for_each(*b_, n,
             ListParts<Real>{bodies, shapes_, set(), begin_.view(), ranges_.fixed_begin, out});
    is_listed_ = true;
  }

  B* b_;
  Span<const ShapeRecord<Real>> shapes_;
  PeriodicBox box_;
  BodyRanges ranges_;
  bool is_listed_ = false;
  std::function<void(Index)> before_fixed_move_;
  Buffer<B, PartRecord<Real>> records_;
  Buffer<B, Index> first_;
  Buffer<B, double> reach_;  ///< see PartReach; of several ranks
  Buffer<B, Offset> begin_;  ///< [present bodies + 1] first part of each
  Buffer<B, Index> owner_, record_, shape_, id_, group_;
  Buffer<B, Real> radius_, inv_mass_;
  Buffer<B, std::uint8_t> locks_, material_;
  Buffer<B, Vec3<double>> position_;
  Buffer<B, Quat<Real>> orientation_;
  Buffer<B, Vec3<Real>> velocity_, angular_velocity_, from_body_;
};

}  // namespace scree
