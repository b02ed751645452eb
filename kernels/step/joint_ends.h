#pragma once
// Element programs that take joints out of a problem, to be solved by themselves, and put them back.

#include "kernels/contact/contact_operator.h"
#include "kernels/contact/joint_rows.h"
#include "kernels/step/joint_setup.h"

namespace scree {

/// A joint with what its bodies are and do.
template <class Real>
struct JointEnds {
  /// Of a body in the problem, A first.
  struct End {
    bool moves = false;
    Vec3<Real> inv_mass;     ///< per world axis [1/kg]
    Sym3<Real> inv_inertia;  ///< [1/(kg m^2)]
    Twist<Real> velocity;
  };

  bool is_here = false;    ///< in the problem, with both bodies owned, or at rest
  bool is_turned = false;  ///< A is the second body of the joint
  JointRow<Real> row;
  End end[2];
  JointValues<Real> impulse;  ///< in the coordinates of solvers [N s]
};

/// Lists joint k of the problem where `slot` has a place for it.
/// Bytes a joint of float: 230, two twists and two inertias read, 420 written.
template <class Real>
struct ListJointEnds {
  static constexpr const char* name = "list_joint_ends";
  ContactProblem<Real> p;
  Span<const Twist<Real>> velocity;  ///< of owned bodies, under gamma
  Span<const Vec3<Real>> gamma;      ///< of the joints [N s]
  JointPlaces places;
  Span<const Index> order;     ///< joint of each row
  Span<const Index> slot;      ///< of each joint; negative: not listed
  Span<JointEnds<Real>> ends;  ///< out

  SCREE_HD void operator()(Index k) const {
    const Index j = order[k];
    if (slot[j] < 0) return;
    const Index c = p.joint_begin + k;
    const Index body[2] = {p.body_a[c], p.body_b[c]};
    JointEnds<Real> out;
    // The owner of a ghost would find other impulses.
    out.is_here = !p.bodies.is_ghost(body[0]) && !p.bodies.is_ghost(body[1]);
    out.is_turned = places.is_turned(j);
    out.row = p.joints[k];
    for (int side = 0; side < 2; ++side) {
      const Index i = body[side];
      out.end[side].moves = p.bodies.is_owned(i);
      out.end[side].velocity = out.end[side].moves ? velocity[i] : p.free_velocity[i];
      if (!out.end[side].moves) continue;
      out.end[side].inv_mass = p.general_inertia[i].inv_mass;
      out.end[side].inv_inertia = p.general_inertia[i].inv_inertia;
    }
    for (int r = 0; r < kJointRows; ++r)
      out.impulse[r] = gamma[2 * static_cast<Offset>(k) + r / 3][r % 3];
    ends[slot[j]] = out;
  }
};

/// Puts the impulses of listed joints back.
template <class Real>
struct TakeJointImpulses {
  static constexpr const char* name = "take_joint_impulses";
  Span<const Index> order;                ///< joint of each row
  Span<const Index> slot;                 ///< of each joint; negative: not listed
  Span<const JointValues<Real>> impulse;  ///< by slot
  Span<Vec3<Real>> gamma;                 ///< of the joints, out

  SCREE_HD void operator()(Index k) const {
    const Index s = slot[order[k]];
    if (s < 0) return;
    for (int r = 0; r < kJointRows; ++r)
      gamma[2 * static_cast<Offset>(k) + r / 3][r % 3] = impulse[s][r];
  }
};

}  // namespace scree
