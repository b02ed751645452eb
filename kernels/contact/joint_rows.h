#pragma once
// Joints as rows of a contact problem, in the coordinates of JointRow.

#include "kernels/contact/contact_problem.h"
#include "kernels/contact/row_values.h"

namespace scree {

/// The joints of a problem, behind its contacts. Their block is a multiple of the identity.
template <class Real>
struct JointRows {
  using Rows = ForceMomentRows<Real>;

  static SCREE_HD const JointRow<Real>& joint(const ContactProblem<Real>& p, Index c) {
    return p.joints[c - p.joint_begin];
  }
  static SCREE_HD Rows velocity(const ContactProblem<Real>& p, Index c, const Twist<Real>& a,
                                const Twist<Real>& b) {
    return as_rows(velocity(joint(p, c), a, b));
  }
  /// Velocities of the rows in the coordinates of solvers, bias included.
  static SCREE_HD JointValues<Real> velocity(const JointRow<Real>& j, const Twist<Real>& a,
                                             const Twist<Real>& b) {
    JointValues<Real> u = speeds(j, a, b);
    for (int k = 0; k < kJointRows; ++k) u[k] += j.bias[k];
    return j.scaled_velocity(u);
  }
  /// Of B against A in the rows themselves, without bias [m/s].
  static SCREE_HD JointValues<Real> speeds(const JointRow<Real>& j, const Twist<Real>& a,
                                           const Twist<Real>& b) {
    const Vec3<Real> linear =
        b.linear + cross(b.angular, j.arm_b) - a.linear - cross(a.angular, j.arm_a);
    return j.rows(linear, j.length * (b.angular - a.angular));
  }
  static SCREE_HD Twist<Real> wrench(const ContactProblem<Real>& p, Index c, bool side_b,
                                     const Rows& z) {
    return wrench(joint(p, c), side_b, as_values(z));
  }
  static SCREE_HD Twist<Real> wrench(const JointRow<Real>& j, bool side_b,
                                     const JointValues<Real>& z) {
    const JointValues<Real> g = j.impulse(z);
    const Vec3<Real> force = j.world_force(g);
    const Vec3<Real> moment = j.length * j.world_moment(g);
    if (side_b) return {force, cross(j.arm_b, force) + moment};
    return {-force, cross(force, j.arm_a) - moment};
  }
  /// @param step  [kg], zero: the nearest impulse that the joint may give; see JointRow
  static SCREE_HD Rows project(const ContactProblem<Real>& p, Index c, const Rows& z,
                               Real step = 0) {
    return as_rows(joint(p, c).project(as_values(z), step));
  }
  static SCREE_HD ContactMetric<Real> block_metric(const ContactProblem<Real>& p, Index c) {
    const Real d = joint(p, c).scale;
    return {d, d, d};
  }
  /// Mass-split bound: k_a N_a + k_b N_b <= max(k_a, k_b) (N_a + N_b), with k contacts and joints on
  /// a body.
  static SCREE_HD ContactMetric<Real> split_metric(const ContactProblem<Real>& p, Index c) {
    Index most = 1;
    for (int side = 0; side < 2; ++side) {
      const Index i = side == 0 ? p.body_a[c] : p.body_b[c];
      const Index count = p.count_contacts_of_moving(i);
      if (count > most) most = count;
    }
    const Real d = static_cast<Real>(most) * joint(p, c).scale;
    return {d, d, d};
  }
  static SCREE_HD Real block_trace(const ContactProblem<Real>& p, Index c) {
    return 3 * joint(p, c).scale;
  }
  /// Velocity that is left in the rows themselves, not in the coordinates of solvers [m/s]. Where
  /// the last row is driven, that of its natural map.
  static SCREE_HD Rows residual(const ContactProblem<Real>& p, Index c, const Rows& z,
                                const Rows& u) {
    const JointRow<Real>& j = joint(p, c);
    if (!(j.scale > Real(0))) return {};
    // Of rows that are held u itself: beside impulses that grow where joints contradict each other the
    // map would round it away.
    JointValues<Real> left = as_values(u);
    if (j.is_last_driven()) {
      const Real step = Real(1) / j.scale;
      const JointValues<Real> own = as_values(z);
      const JointValues<Real> moved = j.project_firm(as_values(z - step * u), step);
      for (int k = 0; k < kJointRows; ++k)
        if (j.is_driven(k)) left[k] = j.scale * (own[k] - moved[k]);
    }
    return as_rows(j.velocity(left));
  }

 private:
  static SCREE_HD JointValues<Real> as_values(const Rows& x) {
    return {{x.force.x, x.force.y, x.force.z, x.moment.x, x.moment.y, x.moment.z}};
  }
  static SCREE_HD Rows as_rows(const JointValues<Real>& x) {
    return {{x[0], x[1], x[2]}, {x[3], x[4], x[5]}};
  }
};

}  // namespace scree
