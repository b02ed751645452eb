#pragma once
// A guess of the impulses of joints: those that take the velocities of all rows that joints hold to zero, all at once.

#include <array>
#include <vector>

#include "dynamics/rigid/shared_loads.h"
#include "dynamics/rigid/sparse_factor.h"
#include "kernels/step/joint_ends.h"

namespace scree {

/// Iterations carry an impulse from joint to joint, so those of a chain of n links take n of them and more. Where nothing but held
/// rows are there, this solves the step, and the solver sees that its guess is the answer; contacts, motors and limits keep the
/// impulse that they have, and are left to the solver. On the host, in double precision, with equal bits on any number of threads.
class HeldJoints {
 public:
  /// @param bodies      ids of the bodies of each joint, negative: the world
  /// @param body_count  ids are below
  HeldJoints(const std::vector<std::array<Index, 2>>& bodies, Index body_count);

  Index count() const { return static_cast<Index>(place_.size()); }

  /// @param joints  [count()]; their impulses in and out
  template <class Real>
  void improve(std::vector<JointEnds<Real>>& joints) {
    std::vector<JointEnds<double>> wide(joints.size());
    for (std::size_t k = 0; k < joints.size(); ++k) wide[k] = widened(joints[k]);
    improve(wide);
    for (std::size_t k = 0; k < joints.size(); ++k)
      for (int r = 0; r < kJointRows; ++r)
        joints[k].impulse[r] = static_cast<Real>(wide[k].impulse[r]);
  }
  void improve(std::vector<JointEnds<double>>& joints);

 private:
  /// One of the two bodies of a joint, in the order of the scene.
  struct End {
    int joint = 0;
    int side = 0;
  };

  template <class Real>
  static JointEnds<double> widened(const JointEnds<Real>& x);

  void list_rows(const std::vector<JointEnds<double>>& joints);
  bool list_entries(const std::vector<JointEnds<double>>& joints);
  void add_entries(const std::vector<JointEnds<double>>& joints, const End& from, int r,
                   const End& to, const Twist<double>& change);
  void add(std::vector<JointEnds<double>>& joints) const;
  void share_loads(std::vector<JointEnds<double>>& joints);

  int row(std::size_t joint, int r) const { return place_[joint][static_cast<std::size_t>(r)]; }

  std::vector<int> start_;  ///< of the ends at each body
  std::vector<End> ends_;   ///< by body
  int rows_ = 0;
  std::vector<std::array<int, kJointRows>> place_;  ///< unknown of each row, -1: none
  std::vector<FactorEntry> entries_;
  std::vector<double> right_;
  SparseFactor factor_;
};

template <class Real>
JointEnds<double> HeldJoints::widened(const JointEnds<Real>& x) {
  JointEnds<double> w;
  w.is_here = x.is_here;
  w.is_turned = x.is_turned;
  for (int side = 0; side < 2; ++side) {
    const auto& from = x.end[side];
    auto& to = w.end[side];
    to.moves = from.moves;
    to.inv_mass = Vec3<double>(from.inv_mass);
    const Sym3<Real>& m = from.inv_inertia;
    to.inv_inertia = {m.xx, m.yy, m.zz, m.xy, m.xz, m.yz};
    to.velocity = {Vec3<double>(from.velocity.linear), Vec3<double>(from.velocity.angular)};
  }
  w.row.arm_a = Vec3<double>(x.row.arm_a);
  w.row.arm_b = Vec3<double>(x.row.arm_b);
  for (int k = 0; k < 3; ++k) w.row.axes[k] = Vec3<double>(x.row.axes[k]);
  w.row.length = x.row.length;
  for (int k = 0; k < kJointTriangle; ++k) w.row.factor[k] = x.row.factor[k];
  w.row.scale = x.row.scale;
  w.row.force_is_last = x.row.force_is_last;
  w.row.rubs = x.row.rubs;
  for (int r = 0; r < kJointRows; ++r) {
    w.row.bias[r] = x.row.bias[r];
    w.impulse[r] = x.impulse[r];
  }
  // Whether rows are driven is all that is asked of a drive here.
  if (x.row.is_last_driven()) w.row.most = 0;
  return w;
}

}  // namespace scree
