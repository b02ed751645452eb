#pragma once
// A guess of what motors, springs, friction and limits of joints give, before a solver begins.

#include "kernels/contact/contact_rows.h"

namespace scree {

/// One step for all joints whose last row is driven, each by its own block and at once: a projected Jacobi step among them, in
/// the mass-split metric, with all other impulses as they are. Joints with a ghost are left out: its owner would guess another.
/// Bytes a joint: 430 and two twists read, 24 written.
template <class Real>
struct SolveDrivenJoints {
  static constexpr const char* name = "solve_driven_joints";
  ContactProblem<Real> p;
  Span<const Twist<Real>> velocity;  ///< of owned bodies, under gamma
  Span<Vec3<Real>> gamma;            ///< in and out

  SCREE_HD void operator()(Index k) const {
    using R = JointedRows<Real>;
    const JointRow<Real>& joint = p.joints[k];
    const Index c = p.joint_begin + k;
    const Index a = p.body_a[c], b = p.body_b[c];
    if (!(joint.scale > Real(0)) || !joint.is_last_driven()) return;
    if (p.bodies.is_ghost(a) || p.bodies.is_ghost(b)) return;
    const Index share = most(driven_at(a), driven_at(b));
    const Real step = Real(1) / (static_cast<Real>(share) * joint.scale);
    const auto u = R::velocity(p, c, velocity_of(a), velocity_of(b));
    R::store(gamma, c, JointRows<Real>::project(p, c, R::load(gamma, c) - step * u, step));
  }

 private:
  static SCREE_HD Index most(Index x, Index y) { return x > y ? x : y; }
  SCREE_HD Twist<Real> velocity_of(Index i) const {
    return p.bodies.is_owned(i) ? velocity[i] : p.free_velocity[i];
  }
  /// Driven joints of a body that moves; at least 1.
  SCREE_HD Index driven_at(Index i) const {
    if (!p.bodies.is_owned(i)) return 1;
    const ContactLists& list = p.later[0];
    Index count = 0;
    for (Index m = list.a_start[i]; m < list.a_start[i + 1]; ++m)
      count += p.joints[m].is_last_driven() ? 1 : 0;
    for (Index m = list.b_start[i]; m < list.b_start[i + 1]; ++m)
      count += p.joints[list.b_contact[m]].is_last_driven() ? 1 : 0;
    return most(count, 1);
  }
};

}  // namespace scree
