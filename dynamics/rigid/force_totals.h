#pragma once
// Sums of impulses on walls, groups and joints, on the host.

#include <cstdint>
#include <vector>

#include "host/world.h"

namespace scree {

class ForceTotals {
 public:
  explicit ForceTotals(const Scene& scene);

  void add_to_body(int id, const Vec3d& impulse, const Vec3d& torque);
  void add_to_group(int group, const Vec3d& impulse, const Vec3d& torque);
  void add_joints(const std::vector<JointRecord>& joints);
  /// Ends a step: what was added since the one before is that of the step.
  void count_step();

  /// Of the last step [N], [N m]; zero before there is one. @throws InputError for free bodies
  ForceRecord on_body(int id, double time_step) const;
  ForceRecord on_group(int group, double time_step) const;

  /// Means over the steps so far; what comes later starts afresh. @param time_step  [s]
  MeanForces take(double time_step);

  /// For checkpoints: impulse and its moment by turns.
  void save(WorldState& s) const;
  /// Takes sums over that fit the scene; starts afresh without any. @throws InputError when they do not
  void restore(const WorldState& s);
  /// Those of the last step, for a run of other bodies.
  void leave(WorldState& s) const;
  void enter(const WorldState& s);

 private:
  struct Sum {
    Vec3d impulse, torque;  ///< [N s], [N m s]
  };
  void add(std::size_t target, const Vec3d& impulse, const Vec3d& torque);

  std::int64_t steps_ = 0;
  std::vector<int> fixed_;  ///< ids, rising
  std::size_t group_count_ = 0;
  ForceRecord of_last(std::size_t target, double time_step) const;

  // Of fixed bodies, groups, joints:
  std::vector<Sum> sums_;  ///< over steps
  std::vector<Sum> now_;   ///< of the step that is being added
  std::vector<Sum> last_;  ///< of the one before
};

}  // namespace scree
