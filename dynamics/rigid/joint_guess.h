#pragma once
// Impulses of joints that are a better guess than those of the step before, for a solver to begin with.

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>
#include <vector>

#include "dynamics/rigid/deep_joints.h"
#include "dynamics/rigid/held_joints.h"
#include "kernels/step/driven_joints.h"
#include "solvers/contact_passes.h"

namespace scree {

/// Driven joints of the free body that has the most of them.
inline int most_drives(const Scene& scene, const std::vector<JointFrames>& frames) {
  std::vector<int> count(scene.bodies.size());
  int most = 0;
  for (const JointFrames& joint : frames) {
    if (!joint.drive.is_used()) continue;
    for (const Index id : joint.body) {
      if (id == kWorldId) continue;
      const auto body = static_cast<std::size_t>(id);
      if (scene.bodies[body].kind == BodyKind::free) most = std::max(most, ++count[body]);
    }
  }
  return most;
}

template <class B, class Real>
class JointGuess {
 public:
  JointGuess(B& b, const Scene& scene, const std::vector<JointFrames>& frames)
      : JointGuess(b, scene, frames, solved_on_host(scene, frames)) {}

  /// Better impulses of the joints of a problem: where it starts from impulses of the step before, see HeldJoints. Drives that are
  /// left out there, or all, by a few steps among them, since a solver stops at once where a weak motor or spring is all that is
  /// missing, in each step anew.
  /// @param order  joint of each joint row of the problem
  /// @param gamma  impulses of contacts and joints, in and out
  void improve(B& b, const ContactProblem<Real>& problem, const JointPlaces& places,
               Span<const Index> order, Span<Vec3<Real>> gamma, bool is_warm) {
    const bool has_held = held_.count() > 0 && is_warm;
    shares_ = false;
    if (most_drives_ == 0 && !has_held) return;
    Buffer<B, Twist<Real>> velocity(b, problem.bodies.owned_count);
    const auto gather = [&] {
      ContactPasses<JointedRows<Real>, B, Real>::gather_velocities(b, problem, gamma,
                                                                   velocity.view());
    };
    const auto solve_drives = [&] {
      const int passes = most_drives_ > 1 ? kDrivePasses : most_drives_;
      for (int pass = 0; pass < passes; ++pass) {
        gather();
        for_each(b, order.size, SolveDrivenJoints<Real>{problem, velocity.view(), gamma});
      }
    };
    const auto solve_held = [&] {
      gather();
      bool is_solved = false;
      on_host(b, problem, places, order, gamma, velocity.view(),
              [&](std::vector<JointEnds<Real>>& ends) { is_solved = held_.improve(ends); });
      shares_ = held_.are_redundant();
      return is_solved;
    };
    if (!has_held) return solve_drives();
    if (takes_all_drives_ || most_drives_ == 0) {
      const bool is_solved = solve_held();
      if (is_solved || most_drives_ == 0) return;
    }
    for (int round = 0; round < 2; ++round) {
      solve_drives();
      solve_held();
    }
  }

  /// Redundant joints share the impulses that a solver found from the last guess, see HeldJoints::share(). Nothing where that took no
  /// impulses of the step before.
  /// @param velocity  that the solver found
  void share(B& b, const ContactProblem<Real>& problem, const JointPlaces& places,
             Span<const Index> order, Span<Vec3<Real>> gamma, Span<const Twist<Real>> velocity) {
    if (!shares_) return;
    on_host(b, problem, places, order, gamma, velocity,
            [&](std::vector<JointEnds<Real>>& ends) { held_.share(ends); });
  }

 private:
  /// Steps of driven joints that share bodies.
  static constexpr int kDrivePasses = 8;

  JointGuess(B& b, const Scene& scene, const std::vector<JointFrames>& frames,
             const std::vector<Index>& held)
      : most_drives_(most_drives(scene, frames)),
        held_(known_of(scene, held, frames), static_cast<Index>(scene.bodies.size())),
        takes_all_drives_(held.size() == frames.size() && held_.takes_all_drives()),
        slot_(b),
        ends_(b, held_.count()),
        impulse_(b, held_.count()) {
    std::vector<Index> slot(frames.size(), -1);
    for (std::size_t s = 0; s < held.size(); ++s)
      slot[static_cast<std::size_t>(held[s])] = static_cast<Index>(s);
    if (!held.empty()) upload(b, slot, slot_);
  }

  /// Changes the impulses of the joints that are solved on the host.
  template <class Change>
  void on_host(B& b, const ContactProblem<Real>& problem, const JointPlaces& places,
               Span<const Index> order, Span<Vec3<Real>> gamma, Span<const Twist<Real>> velocity,
               Change change) {
    const Offset joint_vectors = 2 * static_cast<Offset>(order.size);
    const Span<Vec3<Real>> own = {gamma.data + gamma.size - joint_vectors, joint_vectors};
    fill(b, ends_.view(), JointEnds<Real>{});
    for_each(
        b, order.size,
        ListJointEnds<Real>{problem, velocity, own, places, order, slot_.view(), ends_.view()});
    std::vector<JointEnds<Real>> ends = download(b, ends_.view());
    change(ends);
    std::vector<JointValues<Real>> impulse;
    impulse.reserve(ends.size());
    for (const JointEnds<Real>& e : ends) impulse.push_back(e.impulse);
    upload(b, impulse, impulse_);
    for_each(b, order.size, TakeJointImpulses<Real>{order, slot_.view(), impulse_.view(), own});
  }

  /// Joints that are solved on the host: all where that is where their problem is, else those that are worth the way.
  static std::vector<Index> solved_on_host(const Scene& scene,
                                           const std::vector<JointFrames>& frames) {
    if (B::kIsDevice) return deep_joints(scene, frames);
    std::vector<Index> all(frames.size());
    std::iota(all.begin(), all.end(), Index(0));
    return all;
  }

  static std::vector<HeldJoints::Known> known_of(const Scene& scene,
                                                 const std::vector<Index>& joints,
                                                 const std::vector<JointFrames>& frames) {
    std::vector<HeldJoints::Known> out;
    out.reserve(joints.size());
    for (const Index j : joints) {
      const JointFrames& joint = frames[static_cast<std::size_t>(j)];
      const bool is_driven = (joint.held >> kJointAxisRow & 1u) == 0 && joint.drive.is_used();
      HeldJoints::Known known;
      for (std::size_t side = 0; side < 2; ++side) {
        const Index id = joint.body[side];
        const bool moves =
            id != kWorldId && scene.bodies[static_cast<std::size_t>(id)].kind == BodyKind::free;
        if (moves) known.body[side] = id;
      }
      known.rows = std::popcount(joint.held) + (is_driven ? 1 : 0);
      known.rubs = is_driven && joint.form == JointForm::rub;
      known.is_spring = is_driven && (joint.drive.stiffness > 0 || joint.drive.damping > 0);
      out.push_back(known);
    }
    return out;
  }

  int most_drives_ = 0;  ///< of a free body
  HeldJoints held_;
  bool takes_all_drives_ = false;  ///< no drive is left out of `held_`
  bool shares_ = false;            ///< the last guess had redundant joints
  Buffer<B, Index> slot_;          ///< of each joint among those of `held_`, -1: none
  Buffer<B, JointEnds<Real>> ends_;
  Buffer<B, JointValues<Real>> impulse_;
};

}  // namespace scree
