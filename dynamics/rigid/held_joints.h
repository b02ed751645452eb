#pragma once
// A guess of the impulses of joints: those that take the velocities of all rows that joints hold to zero, all at once, and with
// them what drives give: taut cables, limits that are reached, motors that are strong enough, springs.

#include <array>
#include <vector>

#include "dynamics/rigid/shared_loads.h"
#include "dynamics/rigid/sparse_factor.h"
#include "kernels/step/joint_ends.h"

namespace scree {

/// Iterations carry an impulse from joint to joint, so those of a chain of n links take n of them and more. Where nothing but joints
/// is there, this solves the step, and the solver sees that its guess is the answer; contacts, friction of ball joints and springs
/// of lattices in space keep the impulse that they have, and are left to the solver. On the host, in double precision, with equal
/// bits on any number of threads.
///
/// Which of the driven rows hold is found by a few steps of Newton's method on their laws, an active set: those hold that would by
/// their impulse and velocity; where it then turns out that one would have to push as no cable does, it is let go, and one that is
/// passed is taken in, and all is worked out again. docs/theory.md, "Joints".
class HeldJoints {
 public:
  /// A joint of the scene.
  struct Known {
    std::array<Index, 2> body = {-1, -1};  ///< ids; negative: does not move
    int rows = 0;
    bool is_spring = false, rubs = false;  ///< what drives it
  };

  /// @param body_count  ids are below
  HeldJoints(const std::vector<Known>& joints, Index body_count);

  Index count() const { return static_cast<Index>(place_.size()); }
  /// Whether no drive is left to the solver.
  bool takes_all_drives() const { return takes_all_drives_; }

  /// @param joints  [count()]; their impulses in and out
  /// @return  whether the impulses are right for all of them, with what else acts on their bodies as it is
  template <class Real>
  bool improve(std::vector<JointEnds<Real>>& joints) {
    bool is_solved = false;
    in_double(joints, [&](auto& wide) { is_solved = improve(wide); });
    return is_solved;
  }
  bool improve(std::vector<JointEnds<double>>& joints);

  /// Whether the joints of the last improve() are redundant.
  bool are_redundant() const { return !free_.empty(); }
  /// Shares what redundant joints bear, as improve() does, without a change of what impulses do: a solver that goes on from a guess
  /// shares what it adds in its own way.
  /// @param joints  those of the last improve(), with other impulses and velocities; impulses in and out
  template <class Real>
  void share(std::vector<JointEnds<Real>>& joints) {
    in_double(joints, [&](auto& wide) { share(wide); });
  }
  void share(std::vector<JointEnds<double>>& joints);

 private:
  /// One of the two bodies of a joint, in the order of the scene.
  struct End {
    int joint = 0;
    int side = 0;
  };

  /// A driven row that may hold.
  struct Drive {
    std::size_t joint = 0;
    DrivePart by = DrivePart::bound;  ///< what decides about its impulse
    double off = 0;                   ///< impulse that is not as its law would have it [N s]
    double target = 0;                ///< velocity where it holds [m/s]

    bool holds() const { return by != DrivePart::bound; }
  };

  template <class Real>
  static JointEnds<double> widened(const JointEnds<Real>& x);
  template <class Real, class Change>
  static void in_double(std::vector<JointEnds<Real>>& joints, Change change) {
    std::vector<JointEnds<double>> wide(joints.size());
    for (std::size_t k = 0; k < joints.size(); ++k) wide[k] = widened(joints[k]);
    change(wide);
    for (std::size_t k = 0; k < joints.size(); ++k)
      for (int r = 0; r < kJointRows; ++r)
        joints[k].impulse[r] = static_cast<Real>(wide[k].impulse[r]);
  }

  bool are_springs_worth_it(const std::vector<Known>& joints) const;
  void list_rows(const std::vector<JointEnds<double>>& joints);

  bool solve(std::vector<JointEnds<double>>& joints);
  bool find_set(std::vector<JointEnds<double>>& joints);
  bool look_at_drives(const std::vector<JointEnds<double>>& joints, bool is_first);
  void let_go(std::vector<JointEnds<double>>& joints);
  double left_over(const std::vector<JointEnds<double>>& joints) const;
  bool list_entries(const std::vector<JointEnds<double>>& joints);
  void add_entries(const std::vector<JointEnds<double>>& joints, const End& from, int r,
                   const End& to, const Twist<double>& change);
  void list_entries_of_set(const std::vector<JointEnds<double>>& joints);
  void add(std::vector<JointEnds<double>>& joints) const;
  void move_bodies(std::vector<JointEnds<double>>& joints) const;
  void share_loads(std::vector<JointEnds<double>>& joints, const std::vector<FactorEntry>& free);
  std::vector<FactorEntry> free_without_drives() const;
  bool drives_hold(const std::vector<JointEnds<double>>& joints) const;

  int row(std::size_t joint, int r) const { return place_[joint][static_cast<std::size_t>(r)]; }
  double& right(std::size_t joint, int r) {
    return right_[static_cast<std::size_t>(row(joint, r))];
  }

  std::vector<int> start_;  ///< of the ends at each body
  std::vector<End> ends_;   ///< by body
  bool takes_springs_ = false, takes_all_drives_ = false;
  bool is_whole_ = false;  ///< all joints are here
  int rows_ = 0;
  std::vector<std::array<int, kJointRows>> place_;  ///< unknown of each row, -1: none
  std::vector<Drive> drives_;
  std::vector<FactorEntry> entries_, of_set_;
  std::vector<double> right_;
  SparseFactor factor_;
  std::vector<FactorEntry> free_;  ///< see SparseFactor::free_directions()
};

/// A bound of a drive in another precision; none stays none.
template <class Real>
double widened_bound(Real bound) {
  constexpr Real kNone = largest_number<Real>();
  if (bound >= kNone) return largest_number<double>();
  return bound <= -kNone ? -largest_number<double>() : static_cast<double>(bound);
}

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
  w.row.least = widened_bound(x.row.least);
  w.row.most = widened_bound(x.row.most);
  w.row.compliance = x.row.compliance;
  w.row.friction = widened_bound(x.row.friction);
  w.row.rest = x.row.rest;
  w.row.slowest = widened_bound(x.row.slowest);
  w.row.fastest = widened_bound(x.row.fastest);
  return w;
}

}  // namespace scree
