#pragma once
// Loads per body of a running simulation. They take no memory and no time until a program
// asks for their arrays or applies one.

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "host/error.h"
#include "host/world_state.h"
#include "kernels/step/applied_loads.h"
#include "kernels/step/loads.h"

namespace scree {

/// Memory from the first use on: 24 bytes a body in float; 48 more while a step works.
template <class B, class Real>
class BodyLoads {
 public:
  /// @param count  ids of a run
  BodyLoads(B& b, Index count)
      : count_(count),
        force_(b),
        torque_(b),
        linear_(b),
        angular_(b),
        velocity_(b),
        angular_velocity_(b),
        sums_(b, 1) {}

  /// From here on the loads count; zero until a program writes some.
  void use(B& b) {
    if (is_used_) return;
    fill(b, force_.resize_discard(count_), Vec3<Real>{});
    fill(b, torque_.resize_discard(count_), Vec3<Real>{});
    is_used_ = true;
  }
  bool is_used() const { return is_used_; }
  Span<Vec3<Real>> force() { return force_.view(); }
  Span<Vec3<Real>> torque() { return torque_.view(); }

  /// Adds the loads of the next step to a state.
  void save(WorldState& s) const {
    if (applied_.empty()) return;
    std::vector<std::int32_t> body;
    std::vector<Vec3d> load;
    for (const auto& [id, each] : applied_) {
      body.push_back(id);
      load.push_back(each.first), load.push_back(each.second);
    }
    s.add("world/applied_body", std::move(body));
    s.add("world/applied", std::move(load));
  }
  /// @throws InputError for a state that does not fit
  void check(const WorldState& s) const {
    if (!s.has("world/applied_body")) return;
    const auto& body = s.at<std::int32_t>("world/applied_body");
    const std::size_t loads = s.at<Vec3d>("world/applied").size();
    const bool are_there = std::all_of(body.begin(), body.end(),
                                       [&](std::int32_t id) { return id >= 0 && id < count_; });
    if (!are_there || loads != 2 * body.size())
      throw InputError("the loads of the next step are not those of bodies of this run");
  }
  /// @param has_body  by id: whether it is there
  template <class HasBody>
  void restore(B& b, const WorldState& s, HasBody has_body) {
    applied_.clear();
    if (!s.has("world/applied_body")) return;
    const auto& body = s.at<std::int32_t>("world/applied_body");
    const auto& load = s.at<Vec3d>("world/applied");
    for (std::size_t k = 0; k < body.size(); ++k)
      if (has_body(body[k])) apply(b, body[k], load[2 * k], load[2 * k + 1]);
  }

  /// Adds what is not zero to a state: forces and torques of all ids by turns.
  void leave(B& b, WorldState& s) {
    const auto by_turns = [](const auto& force, const auto& torque) {
      std::vector<Vec3d> rows;
      for (std::size_t k = 0; k < force.size(); ++k) {
        rows.emplace_back(force[k]);
        rows.emplace_back(torque[k]);
      }
      return rows;
    };
    if (!is_used_) return;
    s.add("run/load", by_turns(download(b, force_.view()), download(b, torque_.view())));
  }
  /// Takes them over in a run of other bodies.
  /// @param is_kept   by id: whether its row stays
  template <class IsKept>
  void enter(B& b, const WorldState& s, IsKept is_kept) {
    if (!s.has("run/load")) return;
    use(b);
    const std::vector<Vec3d>& load = s.at<Vec3d>("run/load");
    std::vector<Vec3<Real>> force(static_cast<std::size_t>(count_)), torque(force);
    const std::size_t rows = std::min(load.size() / 2, force.size());
    for (std::size_t id = 0; id < rows; ++id) {
      if (!is_kept(static_cast<Index>(id))) continue;
      force[id] = Vec3<Real>(load[2 * id]);
      torque[id] = Vec3<Real>(load[2 * id + 1]);
    }
    upload(b, force, force_);
    upload(b, torque, torque_);
  }

  /// Adds a load of the next step.
  void apply(B& b, Index id, const Vec3d& force, const Vec3d& torque) {
    use(b);
    auto& [of_force, of_torque] = applied_[id];
    of_force += force;
    of_torque += torque;
  }

  /// Works out what the loads add to velocities in a step; one host read.
  /// @param gravity_step  h g [m/s]
  LoadSums start(B& b, const BodyView<Real>& bodies, const Vec3<Real>& gravity_step, double h) {
    const Index n = bodies.owned_count;
    Buffer<B, BodyLoad<Real>> before(b);
    add_applied(b, before);
    reduce<LoadSums>(
        b, n,
        LoadGains<Real>{bodies, force_.view(), torque_.view(), gravity_step, static_cast<Real>(h),
                        linear_.resize_discard(n), angular_.resize_discard(n)},
        StoreResult<LoadSums>{sums_.data()});
    for_each(b, static_cast<Index>(applied_.size()),
             PutBodyLoads<Real>{before.view(), force_.view(), torque_.view()});
    applied_.clear();
    return fetch(b, sums_.data());
  }

  /// The bodies with the velocities that loads give them; the bodies themselves when there are
  /// none. start() comes first; valid until the next call.
  BodyView<Real> loaded(B& b, const BodyView<Real>& bodies) {
    if (!is_used_) return bodies;
    BodyView<Real> with = bodies;
    with.velocity = velocity_.resize_discard(bodies.count);
    with.angular_velocity = angular_velocity_.resize_discard(bodies.count);
    for_each(b, bodies.count,
             AddLoadGains<Real>{bodies, linear_.view(), angular_.view(), with.velocity,
                                with.angular_velocity});
    return with;
  }

  /// [owned_count] what loads add to velocities in the step [m/s]; empty when there are none.
  Span<const Vec3<Real>> gains() { return linear_.view(); }

  /// Gives back what only a step needs.
  void finish() {
    linear_.release(), angular_.release();
    velocity_.release(), angular_velocity_.release();
  }

 private:
  void add_applied(B& b, Buffer<B, BodyLoad<Real>>& before) {
    if (applied_.empty()) return;
    std::vector<BodyLoad<Real>> loads;
    for (const auto& [id, load] : applied_)
      loads.push_back({id, Vec3<Real>(load.first), Vec3<Real>(load.second)});
    Buffer<B, BodyLoad<Real>> added(b);
    upload(b, loads, added);
    const auto n = static_cast<Index>(loads.size());
    for_each(
        b, n,
        AddBodyLoads<Real>{added.view(), force_.view(), torque_.view(), before.resize_discard(n)});
  }

  Index count_;
  bool is_used_ = false;
  Buffer<B, Vec3<Real>> force_, torque_;
  Buffer<B, Vec3<Real>> linear_, angular_;
  Buffer<B, Vec3<Real>> velocity_, angular_velocity_;
  Buffer<B, LoadSums> sums_;
  std::map<Index, std::pair<Vec3d, Vec3d>> applied_;  ///< force and torque of the next step, by id
};

}  // namespace scree
