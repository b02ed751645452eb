#pragma once
// The bodies of a running simulation in backend memory, and the maps between storage order and ids.

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "dynamics/model_errors.h"
#include "dynamics/rigid/constant_array.h"
#include "dynamics/rigid/move_rows.h"
#include "dynamics/rigid/shared_constants.h"
#include "dynamics/rigid/storage_room.h"
#include "host/own_bodies.h"
#include "host/world.h"
#include "kernels/backend/backend.h"
#include "kernels/backend/ranks.h"
#include "kernels/bodies/body_view.h"
#include "kernels/bodies/locks.h"
#include "kernels/bodies/permute.h"

namespace scree {

/// Storage index of the shape record of a body, see BodyView::shape.
inline constexpr Index kSphereShape = -1;

/// Bodies that pass through host memory at once on their way to and from the backend.
inline constexpr Index kTransferChunk = 65536;

template <class B, class Real>
class BodyStore {
 public:
  /// @param capacity       places for free bodies and ghosts, see make_room()
  /// @param solid_spheres  see SceneSummary: their moments are not stored
  BodyStore(B& backend, Index capacity, Index fixed_count, const SharedConstants& shared,
            bool solid_spheres)
      : b_(&backend),
        position_(backend, capacity + fixed_count),
        orientation_(backend, capacity + fixed_count),
        velocity_(backend, capacity + fixed_count),
        angular_velocity_(backend, capacity + fixed_count),
        inertia_(backend, solid_spheres ? 0 : capacity + fixed_count),
        id_(backend, capacity + fixed_count),
        inv_mass_(backend, capacity, capacity + fixed_count, inverse_of(shared.mass), Real(0)),
        radius_(backend, capacity, capacity + fixed_count, converted<Real>(shared.radius), Real(0)),
        shape_(backend, capacity, capacity + fixed_count,
               shared.spheres ? std::optional<Index>(kSphereShape) : std::nullopt, kSphereShape),
        locks_(backend, capacity, capacity + fixed_count, shared.locks, std::uint8_t(0)),
        material_(backend, capacity, capacity + fixed_count,
                  converted<std::uint8_t>(shared.material), std::uint8_t(0)),
        group_(backend, capacity, capacity + fixed_count, shared.group, Index(0)),
        ranges_{0, 0, capacity, capacity + fixed_count} {
    // Room for bodies that come later holds defined values: pictures and copies may pass over it.
    fill(backend, position_.view(), Vec3<double>{});
    fill(backend, orientation_.view(), Quat<Real>{});
    fill(backend, velocity_.view(), Vec3<Real>{});
    fill(backend, angular_velocity_.view(), Vec3<Real>{});
    fill(backend, inertia_.view(), Vec3<Real>{});
    fill(backend, id_.view(), Index(-1));
  }

  const BodyRanges& ranges() const { return ranges_; }
  Index owned_count() const { return ranges_.owned_count; }
  Index fixed_begin() const { return ranges_.fixed_begin; }
  Index count() const { return ranges_.count; }

  BodyView<Real> view() {
    BodyView<Real> v;
    static_cast<BodyRanges&>(v) = ranges_;
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

  /// Collects bodies in the host's memory and uploads them chunk by chunk.
  class Loader {
   public:
    /// @param begin  storage index of the first body
    Loader(BodyStore& store, Index begin) : store_(&store), begin_(begin) {}

    /// @param shape   shape record, or kSphereShape
    /// @param radius  sphere or bounding radius [m]
    void add(const BodyDescription& d, Index id, Index shape, double radius) {
      const bool moves = d.kind == BodyKind::free;
      position_.push_back(d.position);
      orientation_.emplace_back(d.orientation);
      const unsigned linear = moves ? free_linear_axes(d.locks) : 0;
      const unsigned angular = moves ? free_angular_axes(d.locks) : 0;
      velocity_.push_back(Vec3<Real>(on_axes(d.velocity, linear)));
      angular_velocity_.push_back(Vec3<Real>(on_axes(d.angular_velocity, angular)));
      inertia_.emplace_back(moves ? Vec3<Real>(d.inertia) : Vec3<Real>{});
      inv_mass_.push_back(moves ? static_cast<Real>(1 / d.mass) : Real(0));
      radius_.push_back(static_cast<Real>(radius));
      shape_.push_back(shape);
      group_.push_back(d.group);
      id_.push_back(id);
      locks_.push_back(d.locks);
      material_.push_back(static_cast<std::uint8_t>(d.material));
      if (id_.size() == static_cast<std::size_t>(kTransferChunk)) flush();
    }

    /// Uploads what is left. @return storage index behind the last body
    Index flush() {
      const auto count = static_cast<Index>(id_.size());
      move_to(store_->position_, position_);
      move_to(store_->orientation_, orientation_);
      move_to(store_->velocity_, velocity_);
      move_to(store_->angular_velocity_, angular_velocity_);
      if (store_->inertia_.capacity() > 0) move_to(store_->inertia_, inertia_);
      inertia_.clear();
      move_to(store_->inv_mass_, inv_mass_);
      move_to(store_->radius_, radius_);
      move_to(store_->shape_, shape_);
      move_to(store_->locks_, locks_);
      move_to(store_->material_, material_);
      move_to(store_->group_, group_);
      move_to(store_->id_, id_);
      begin_ += count;
      return begin_;
    }

   private:
    template <class T>
    void move_to(Buffer<B, T>& buffer, std::vector<T>& values) {
      store_->put(buffer, begin_, values);
      values.clear();
    }
    template <class T>
    void move_to(ConstantArray<B, T>& array, std::vector<T>& values) {
      array.put(*store_->b_, begin_, values);
      values.clear();
    }

    BodyStore* store_;
    Index begin_;
    std::vector<Vec3<double>> position_;
    std::vector<Quat<Real>> orientation_;
    std::vector<Vec3<Real>> velocity_, angular_velocity_, inertia_;
    std::vector<Real> inv_mass_, radius_;
    std::vector<Index> shape_, group_, id_;
    std::vector<std::uint8_t> locks_, material_;
  };

  /// Takes the free bodies into the simulation that were loaded up to a storage index. No body is a
  /// ghost after it.
  void set_owned_count(Index count) {
    ranges_.owned_count = ranges_.moving_count = ranges_.higher_begin = count;
  }

  /// The bodies behind the owned ones are ghosts from now on. @param lower  of them that lower ranks own; they come first
  void set_ghost_count(Index count, Index lower) {
    ranges_.moving_count = ranges_.owned_count + count;
    ranges_.higher_begin = ranges_.owned_count + lower;
  }
  /// Places for free bodies, ghosts included.
  Index capacity() const { return ranges_.fixed_begin; }

  /// Called with a number of places, before fixed bodies move back in storage by so many (forward where it is negative).
  void before_fixed_move(std::function<void(Index)> act) { before_fixed_move_ = std::move(act); }
  /// Makes room for so many free bodies and ghosts. It may move fixed bodies in storage.
  /// @throws RunError when storage cannot be numbered
  void make_room(Offset places) {
    if (places > capacity()) set_capacity(grown_room(places, ranges_.fixed_count()));
  }
  /// @param places  no fewer than free bodies and ghosts there are
  void set_capacity(Index places) {
    const Index shift = places - capacity();
    if (shift == 0) return;
    if (before_fixed_move_) before_fixed_move_(shift);
    const Index from = ranges_.fixed_begin;
    move_rows(*b_, position_, from, shift, Vec3<double>{});
    move_rows(*b_, orientation_, from, shift, Quat<Real>{});
    move_rows(*b_, velocity_, from, shift, Vec3<Real>{});
    move_rows(*b_, angular_velocity_, from, shift, Vec3<Real>{});
    move_rows(*b_, id_, from, shift, Index(-1));
    if (inertia_.capacity() > 0) move_rows(*b_, inertia_, from, shift, Vec3<Real>{});
    const auto move_fixed = [&](auto&... array) { (array.move_fixed(*b_, from, shift), ...); };
    move_fixed(inv_mass_, radius_, shape_, locks_, material_, group_);
    ranges_.fixed_begin += shift;
    ranges_.count += shift;
  }

  /// Sends rows of owned bodies to other ranks and stores those that come behind the owned bodies, by rank.
  /// @param to  places, for each rank  @return how many came from each rank
  std::vector<Index> send_bodies(Ranks& ranks, const std::vector<std::vector<Index>>& to) {
    std::vector<Index> places;
    for (const std::vector<Index>& of_rank : to)
      places.insert(places.end(), of_rank.begin(), of_rank.end());
    const auto n = static_cast<Index>(places.size());
    Buffer<B, Index> on_backend(*b_);
    upload(*b_, places, on_backend);
    std::vector<Bytes> out(to.size());
    for_each_array([&](auto& array) {
      using Value = std::remove_pointer_t<decltype(array.data())>;
      Buffer<B, Value> rows(*b_, n);
      for_each(*b_, n, Gather<Value>{on_backend.view(n), array.view(), rows.view(n)});
      const std::vector<Value> values = download(*b_, rows.view(n));
      const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
      for (std::size_t r = 0; r < to.size(); ++r) {
        const std::size_t size = to[r].size() * sizeof(Value);
        out[r].insert(out[r].end(), bytes, bytes + size);
        bytes += size;
      }
    });
    const std::vector<Bytes> in = all_to_all(ranks, std::move(out));
    std::size_t row = 0;
    for_each_array([&](auto& array) { row += sizeof(*array.data()); });
    std::vector<Index> came;
    Offset total = 0;
    for (const Bytes& of_rank : in) {
      came.push_back(static_cast<Index>(of_rank.size() / row));
      total += came.back();
    }
    make_room(ranges_.owned_count + total);
    std::vector<std::size_t> read(in.size(), 0);
    for_each_array([&](auto& array) {
      using Value = std::remove_pointer_t<decltype(array.data())>;
      std::vector<Value> values(static_cast<std::size_t>(total));
      auto* bytes = reinterpret_cast<unsigned char*>(values.data());
      for (std::size_t r = 0; r < in.size(); ++r) {
        const std::size_t size = static_cast<std::size_t>(came[r]) * sizeof(Value);
        std::copy_n(in[r].data() + read[r], size, bytes);
        read[r] += size;
        bytes += size;
      }
      put(array, ranges_.owned_count, values);
    });
    return came;
  }

  /// Owned bodies stay that are named, in this order; the others are gone. @param places  in storage
  void keep(const std::vector<Index>& places) {
    gather_owned(places);
    set_owned_count(static_cast<Index>(places.size()));
  }

  std::vector<Vec3d> owned_positions() { return take_owned<Vec3d>(position_); }
  std::vector<Index> owned_ids() { return take(id_, 0, ranges_.owned_count); }
  std::vector<Index> ghost_ids() {
    return take(id_, ranges_.owned_count, ranges_.moving_count - ranges_.owned_count);
  }
  /// Places that hold no body name none.
  void clear_room() {
    fill(*b_,
         Span<Index>{id_.data() + ranges_.moving_count, ranges_.fixed_begin - ranges_.moving_count},
         Index(-1));
  }

  /// Calls f with all arrays of what changes from step to step.
  template <class F>
  void with_states(F&& f) {
    f(position_, orientation_, velocity_, angular_velocity_);
  }

  /// Rewrites pose and velocity of body `fixed_begin + k` for each k.
  void set_fixed_motion(const std::vector<Vec3<double>>& position,
                        const std::vector<Quat<Real>>& orientation,
                        const std::vector<Vec3<Real>>& velocity,
                        const std::vector<Vec3<Real>>& angular_velocity) {
    put(position_, ranges_.fixed_begin, position);
    put(orientation_, ranges_.fixed_begin, orientation);
    put(velocity_, ranges_.fixed_begin, velocity);
    put(angular_velocity_, ranges_.fixed_begin, angular_velocity);
  }

  std::vector<Index> ids() { return take(id_, 0, ranges_.count); }
  int id_of(Index storage) { return fetch(*b_, id_.data() + storage); }

  /// Owned bodies in storage order, as doubles (exact).
  void save_owned(WorldState& s) {
    s.add("body/id", take(id_, 0, ranges_.owned_count));
    s.add("body/position", take_owned<Vec3d>(position_));
    s.add("body/orientation", take_owned<Quatd>(orientation_));
    s.add("body/velocity", take_owned<Vec3d>(velocity_));
    s.add("body/angular_velocity", take_owned<Vec3d>(angular_velocity_));
  }
  /// Overwrites the state of the owned bodies; their constants must be in place already,
  /// in the order of its ids. @throws InputError when an array has not a row for each body
  void restore_owned(const WorldState& s) {
    put_owned(s.at<Vec3d>("body/position"), position_);
    put_owned(s.at<Quatd>("body/orientation"), orientation_);
    put_owned(s.at<Vec3d>("body/velocity"), velocity_);
    put_owned(s.at<Vec3d>("body/angular_velocity"), angular_velocity_);
  }
  /// Takes bodies out that are owned; the others keep their order. @param removed  ids, rising
  void drop(const std::vector<int>& removed) {
    const Index before = ranges_.owned_count;
    std::vector<Index> stay = take(id_, 0, before);
    std::erase_if(stay, [&](Index id) {
      return std::binary_search(removed.begin(), removed.end(), static_cast<int>(id));
    });
    const auto left = static_cast<Index>(stay.size());
    if (left == before) return;
    arrange(stay);
    fill(*b_, Span<Index>{id_.data() + left, before - left}, Index(-1));
    set_owned_count(left);
  }
  /// Brings the owned bodies into the storage order of a saved state.
  /// @param id  ids in that order; bodies that are not named are left behind them
  /// @throws InputError when they are not those of the owned bodies
  void arrange(const std::vector<int>& id) {
    const std::vector<Index> now = take(id_, 0, ranges_.owned_count);
    const Index id_end = now.empty() ? 0 : *std::max_element(now.begin(), now.end()) + 1;
    std::vector<Index> place(static_cast<std::size_t>(id_end), -1);  // in storage, by id
    for (std::size_t i = 0; i < now.size(); ++i)
      place[static_cast<std::size_t>(now[i])] = static_cast<Index>(i);
    std::vector<Index> order;
    order.reserve(id.size());
    for (const int wanted : id) {
      if (wanted < 0 || wanted >= id_end || place[static_cast<std::size_t>(wanted)] < 0)
        throw_unknown_body(wanted);
      order.push_back(std::exchange(place[static_cast<std::size_t>(wanted)], -1));
    }
    gather_owned(order);
  }

  /// States of the bodies by id; not a number where there is none. @param id_end  behind those inserted so far
  BodyStates states(Index id_end) {
    const auto n = static_cast<std::size_t>(id_end);
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    BodyStates out;
    out.position.resize(n, Vec3d{kNone, kNone, kNone});
    out.orientation.resize(n, Quatd{kNone, kNone, kNone, kNone});
    out.velocity.resize(n, Vec3d{kNone, kNone, kNone});
    out.angular_velocity.resize(n, Vec3d{kNone, kNone, kNone});
    const auto scatter_chunk = [&](Index begin, Index count) {
      const std::vector<Index> id = take(id_, begin, count);
      scatter(take(position_, begin, count), id, out.position);
      scatter(take(orientation_, begin, count), id, out.orientation);
      scatter(take(velocity_, begin, count), id, out.velocity);
      scatter(take(angular_velocity_, begin, count), id, out.angular_velocity);
    };
    for_each_chunk(0, ranges_.owned_count, scatter_chunk);
    for_each_chunk(ranges_.fixed_begin, ranges_.count, scatter_chunk);
    return out;
  }

  /// Owned bodies by rising ids, in chunks: all arrays of the backend stay as they are. @param with_fixed  those that are
  /// not free, too
  OwnBodies own_bodies(bool with_fixed) {
    std::vector<Index> place(static_cast<std::size_t>(ranges_.owned_count));
    std::iota(place.begin(), place.end(), Index(0));
    for (Index i = ranges_.fixed_begin; with_fixed && i < ranges_.count; ++i) place.push_back(i);
    OwnBodies out;
    {
      const std::vector<Index> id = ids();
      const auto id_at = [&](Index i) { return id[static_cast<std::size_t>(i)]; };
      std::sort(place.begin(), place.end(), [&](Index a, Index b) { return id_at(a) < id_at(b); });
      out.id.reserve(place.size());
      for (const Index i : place) out.id.push_back(id_at(i));
    }
    Buffer<B, Index> on_backend(*b_);
    const auto append = [&](Index n, auto& array, auto& to) {
      using Value = std::remove_pointer_t<decltype(array.data())>;
      Buffer<B, Value> rows(*b_, n);
      for_each(*b_, n, Gather<Value>{on_backend.view(n), array.view(), rows.view(n)});
      for (const Value& value : download(*b_, rows.view(n))) to.emplace_back(value);
    };
    BodyStates& s = out.states;
    s.position.reserve(place.size()), s.orientation.reserve(place.size());
    s.velocity.reserve(place.size()), s.angular_velocity.reserve(place.size());
    for_each_chunk(0, static_cast<Index>(place.size()), [&](Index begin, Index count) {
      const auto first = place.begin() + begin;
      upload(*b_, std::vector<Index>(first, first + count), on_backend);
      append(count, position_, s.position), append(count, orientation_, s.orientation);
      append(count, velocity_, s.velocity), append(count, angular_velocity_, s.angular_velocity);
    });
    return out;
  }

  /// Applies f(buffer) to every array of owned bodies, for reordering.
  template <class F>
  void for_each_array(F&& f) {
    f(position_), f(orientation_), f(velocity_), f(angular_velocity_), f(id_);
    if (inertia_.capacity() > 0) f(inertia_);
    inv_mass_.if_stored(f), radius_.if_stored(f), shape_.if_stored(f);
    locks_.if_stored(f), material_.if_stored(f), group_.if_stored(f);
  }

  /// Calls f(name, unit, meaning, array) for the constants that programs may read.
  template <class F>
  void for_each_constant(F&& f) {
    f("inverse_mass", "1/kg", "one over the mass", inv_mass_);
    f("radius", "m", "of the sphere, else of the bounding sphere", radius_);
    f("locks", "1", "locked degrees of freedom, bits x y z rx ry rz", locks_);
    f("material", "1", "index of the material in the scene", material_);
    f("group", "1", "index of the group in the scene", group_);
  }

 private:
  /// Row k becomes that of place order[k].
  void gather_owned(const std::vector<Index>& order) {
    Buffer<B, Index> on_backend(*b_);
    upload(*b_, order, on_backend);
    const auto n = static_cast<Index>(order.size());
    for_each_array([&](auto& array) {
      std::remove_reference_t<decltype(array)> moved(*b_, n);
      using Value = std::remove_pointer_t<decltype(array.data())>;
      for_each(*b_, n, Gather<Value>{on_backend.view(n), array.view(), moved.view(n)});
      copy(*b_, std::as_const(moved).view(n), array.view(n));
    });
  }
  template <class To, class From>
  static std::optional<To> converted(const std::optional<From>& value) {
    return value ? std::optional<To>(static_cast<To>(*value)) : std::nullopt;
  }
  static std::optional<Real> inverse_of(const std::optional<double>& mass) {
    return mass ? std::optional<Real>(static_cast<Real>(1 / *mass)) : std::nullopt;
  }

  template <class T>
  void put(Buffer<B, T>& buffer, Index begin, const std::vector<T>& values) {
    upload(*b_, values.data(), Span<T>{buffer.data() + begin, static_cast<Offset>(values.size())});
  }
  template <class T>
  std::vector<T> take(Buffer<B, T>& buffer, Index begin, Index count) {
    return download(*b_, Span<T>{buffer.data() + begin, count});
  }
  /// Calls f(begin, count) for the chunks of a range of storage.
  template <class F>
  static void for_each_chunk(Index begin, Index end, F&& f) {
    for (Index i = begin; i < end; i += std::min(kTransferChunk, end - i))
      f(i, std::min(kTransferChunk, end - i));
  }
  template <class D, class T>
  std::vector<D> take_owned(Buffer<B, T>& buffer) {
    std::vector<D> to;
    to.reserve(static_cast<std::size_t>(ranges_.owned_count));
    for_each_chunk(0, ranges_.owned_count, [&](Index begin, Index count) {
      for (const T& value : take(buffer, begin, count)) to.emplace_back(value);
    });
    return to;
  }
  template <class T, class D>
  void put_owned(const std::vector<D>& from, Buffer<B, T>& buffer) {
    if (from.size() != static_cast<std::size_t>(ranges_.owned_count))
      throw_wrong_body_count(from.size(), static_cast<std::size_t>(ranges_.owned_count));
    for_each_chunk(0, ranges_.owned_count, [&](Index begin, Index count) {
      const auto first = from.begin() + begin;
      put(buffer, begin, std::vector<T>(first, first + count));
    });
  }
  template <class T, class D>
  static void scatter(const std::vector<T>& from, const std::vector<Index>& id,
                      std::vector<D>& to) {
    for (std::size_t i = 0; i < from.size(); ++i) to[static_cast<std::size_t>(id[i])] = D(from[i]);
  }

  B* b_;
  Buffer<B, Vec3<double>> position_;
  Buffer<B, Quat<Real>> orientation_;
  Buffer<B, Vec3<Real>> velocity_;
  Buffer<B, Vec3<Real>> angular_velocity_;
  Buffer<B, Vec3<Real>> inertia_;  ///< empty for solid spheres
  Buffer<B, Index> id_;
  ConstantArray<B, Real> inv_mass_;
  ConstantArray<B, Real> radius_;
  ConstantArray<B, Index> shape_;
  ConstantArray<B, std::uint8_t> locks_;
  ConstantArray<B, std::uint8_t> material_;
  ConstantArray<B, Index> group_;
  BodyRanges ranges_;
  std::function<void(Index)> before_fixed_move_;
};

}  // namespace scree
