#pragma once
// The bodies of a running simulation in backend memory, and the maps between storage order and ids.

#include <algorithm>
#include <span>
#include <unordered_map>

#include "host/engine_errors.h"
#include "host/scene.h"
#include "host/world.h"
#include "kernels/backend/backend.h"
#include "kernels/body_view.h"
#include "kernels/permute.h"

namespace scree {

/// Storage index of the shape record of a body, see BodyView::shape.
inline constexpr Index kSphereShape = -1;

template <class B, class Real>
class BodyStore {
 public:
  /// @param capacity  free bodies ever in the simulation, insertions included
  BodyStore(B& backend, Index capacity, Index fixed_count)
      : b_(&backend),
        position_(backend, capacity + fixed_count),
        orientation_(backend, capacity + fixed_count),
        velocity_(backend, capacity + fixed_count),
        angular_velocity_(backend, capacity + fixed_count),
        inv_mass_(backend, capacity + fixed_count),
        inertia_(backend, capacity + fixed_count),
        radius_(backend, capacity + fixed_count),
        shape_(backend, capacity + fixed_count),
        locks_(backend, capacity + fixed_count),
        material_(backend, capacity + fixed_count),
        group_(backend, capacity + fixed_count),
        id_(backend, capacity + fixed_count),
        fixed_begin_(capacity),
        count_(capacity + fixed_count) {
    // Room for bodies that come later holds defined values: pictures and copies may pass over it.
    fill(backend, position_.view(), Vec3<double>{});
    fill(backend, orientation_.view(), Quat<Real>{});
    fill(backend, velocity_.view(), Vec3<Real>{});
    fill(backend, angular_velocity_.view(), Vec3<Real>{});
    fill(backend, inv_mass_.view(), Real(0));
    fill(backend, inertia_.view(), Vec3<Real>{});
    fill(backend, radius_.view(), Real(0));
    fill(backend, shape_.view(), kSphereShape);
    fill(backend, locks_.view(), std::uint8_t(0));
    fill(backend, material_.view(), std::uint8_t(0));
    fill(backend, group_.view(), Index(0));
    fill(backend, id_.view(), Index(-1));
  }

  Index free_count() const { return free_count_; }
  Index fixed_begin() const { return fixed_begin_; }
  Index count() const { return count_; }

  BodyView<Real> view() {
    BodyView<Real> v;
    v.free_count = free_count_;
    v.fixed_begin = fixed_begin_;
    v.count = count_;
    v.position = position_.view();
    v.orientation = orientation_.view();
    v.velocity = velocity_.view();
    v.angular_velocity = angular_velocity_.view();
    v.inv_mass = inv_mass_.view();
    v.inertia = inertia_.view();
    v.radius = radius_.view();
    v.shape = shape_.view();
    v.locks = locks_.view();
    v.material = material_.view();
    v.group = group_.view();
    v.id = id_.view();
    return v;
  }

  /// One body as it is uploaded.
  struct Entry {
    const BodyDescription* body;
    Index id;
    Index shape;    ///< shape record, or kSphereShape
    double radius;  ///< sphere or bounding radius
  };

  void append_free(std::span<const Entry> entries) {
    write(free_count_, entries);
    free_count_ += static_cast<Index>(entries.size());
  }
  void set_fixed(std::span<const Entry> entries) { write(fixed_begin_, entries); }

  /// Rewrites pose and velocity of body `fixed_begin + k` for each k.
  void set_fixed_motion(const std::vector<Vec3<double>>& position,
                        const std::vector<Quat<Real>>& orientation,
                        const std::vector<Vec3<Real>>& velocity,
                        const std::vector<Vec3<Real>>& angular_velocity) {
    put(position_, fixed_begin_, position);
    put(orientation_, fixed_begin_, orientation);
    put(velocity_, fixed_begin_, velocity);
    put(angular_velocity_, fixed_begin_, angular_velocity);
  }

  std::vector<Index> ids() { return take(id_, 0, count_); }

  /// Free bodies in storage order, as doubles (exact).
  void save_free(WorldState& s) {
    s.id = take(id_, 0, free_count_);
    s.position = take(position_, 0, free_count_);
    s.orientation = as_double<Quatd>(take(orientation_, 0, free_count_));
    s.velocity = as_double<Vec3d>(take(velocity_, 0, free_count_));
    s.angular_velocity = as_double<Vec3d>(take(angular_velocity_, 0, free_count_));
  }
  /// Overwrites the state of the free bodies; their constants must be in place already, in order of
  /// s.id.
  void restore_free(const WorldState& s) {
    put(position_, 0, s.position);
    put(orientation_, 0, as_real<Quat<Real>>(s.orientation));
    put(velocity_, 0, as_real<Vec3<Real>>(s.velocity));
    put(angular_velocity_, 0, as_real<Vec3<Real>>(s.angular_velocity));
  }
  /// Brings the free bodies into the storage order of a saved state.
  /// @param id  [free_count] ids in that order @throws InputError when they are not those of the
  /// free bodies
  void arrange(const std::vector<int>& id) {
    const std::vector<Index> now = take(id_, 0, free_count_);
    std::unordered_map<Index, Index> place;
    for (Index i = 0; i < free_count_; ++i) place[now[static_cast<std::size_t>(i)]] = i;
    std::vector<Index> order;
    for (const int wanted : id) {
      const auto found = place.find(wanted);
      if (found == place.end()) throw_unknown_body(wanted);
      order.push_back(found->second);
      place.erase(found);
    }
    Buffer<B, Index> on_backend(*b_);
    upload(*b_, order, on_backend);
    for_each_array([&](auto& array) {
      std::remove_reference_t<decltype(array)> moved(*b_, free_count_);
      for_each(*b_, free_count_,
               Gather{Span<const Index>(on_backend.view(free_count_)),
                      std::as_const(array).view(free_count_), moved.view(free_count_)});
      copy(*b_, std::as_const(moved).view(free_count_), array.view(free_count_));
    });
  }

  /// States of the bodies inserted so far, by id.
  BodyStates states() {
    const std::vector<Index> id = ids();
    BodyStates out;
    const std::size_t n = static_cast<std::size_t>(free_count_ + count_ - fixed_begin_);
    scatter(take(position_, 0, count_), id, n, out.position);
    scatter(take(orientation_, 0, count_), id, n, out.orientation);
    scatter(take(velocity_, 0, count_), id, n, out.velocity);
    scatter(take(angular_velocity_, 0, count_), id, n, out.angular_velocity);
    return out;
  }

  /// Applies f(buffer) to every array, for reordering.
  template <class F>
  void for_each_array(F&& f) {
    f(position_), f(orientation_), f(velocity_), f(angular_velocity_), f(inv_mass_), f(inertia_),
        f(radius_);
    f(shape_), f(locks_), f(material_), f(group_), f(id_);
  }

 private:
  template <class T>
  void put(Buffer<B, T>& buffer, Index begin, const std::vector<T>& values) {
    upload(*b_, values.data(), Span<T>{buffer.data() + begin, static_cast<Offset>(values.size())});
  }
  template <class T>
  std::vector<T> take(Buffer<B, T>& buffer, Index begin, Index count) {
    return download(*b_, Span<T>{buffer.data() + begin, count});
  }
  template <class To, class From>
  static std::vector<To> as_double(const std::vector<From>& v) {
    return std::vector<To>(v.begin(), v.end());
  }
  template <class To, class From>
  static std::vector<To> as_real(const std::vector<From>& v) {
    return std::vector<To>(v.begin(), v.end());
  }
  template <class T, class D>
  void scatter(const std::vector<T>& from, const std::vector<Index>& id, std::size_t n,
               std::vector<D>& to) {
    to.resize(n);
    for (Index i = 0; i < count_; ++i) {
      if (i >= free_count_ && i < fixed_begin_) continue;
      to[static_cast<std::size_t>(id[i])] = D(from[i]);
    }
  }

  void write(Index begin, std::span<const Entry> entries) {
    std::vector<Vec3<double>> position;
    std::vector<Quat<Real>> orientation;
    std::vector<Vec3<Real>> velocity, angular_velocity, inertia;
    std::vector<Real> inv_mass, radius;
    std::vector<Index> shape, group, id;
    std::vector<std::uint8_t> locks, material;
    for (const Entry& e : entries) {
      const BodyDescription& d = *e.body;
      const bool moves = d.kind == BodyKind::free;
      position.push_back(d.position);
      orientation.emplace_back(d.orientation);
      velocity.emplace_back(moves ? Vec3<Real>(d.velocity) : Vec3<Real>{});
      angular_velocity.emplace_back(moves ? Vec3<Real>(d.angular_velocity) : Vec3<Real>{});
      inertia.emplace_back(moves ? Vec3<Real>(d.inertia) : Vec3<Real>{});
      inv_mass.push_back(moves ? static_cast<Real>(1 / d.mass) : Real(0));
      radius.push_back(static_cast<Real>(e.radius));
      shape.push_back(e.shape);
      group.push_back(d.group);
      id.push_back(e.id);
      locks.push_back(d.locks);
      material.push_back(static_cast<std::uint8_t>(d.material));
    }
    put(position_, begin, position);
    put(orientation_, begin, orientation);
    put(velocity_, begin, velocity);
    put(angular_velocity_, begin, angular_velocity);
    put(inv_mass_, begin, inv_mass);
    put(inertia_, begin, inertia);
    put(radius_, begin, radius);
    put(shape_, begin, shape);
    put(locks_, begin, locks);
    put(material_, begin, material);
    put(group_, begin, group);
    put(id_, begin, id);
  }

  B* b_;
  Buffer<B, Vec3<double>> position_;
  Buffer<B, Quat<Real>> orientation_;
  Buffer<B, Vec3<Real>> velocity_;
  Buffer<B, Vec3<Real>> angular_velocity_;
  Buffer<B, Real> inv_mass_;
  Buffer<B, Vec3<Real>> inertia_;
  Buffer<B, Real> radius_;
  Buffer<B, Index> shape_;
  Buffer<B, std::uint8_t> locks_;
  Buffer<B, std::uint8_t> material_;
  Buffer<B, Index> group_;
  Buffer<B, Index> id_;
  Index free_count_ = 0;
  Index fixed_begin_ = 0;
  Index count_ = 0;
};

}  // namespace scree
