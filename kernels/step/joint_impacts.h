#pragma once
// Element programs of the joints in the impacts of a step. docs/theory.md, section "Impacts".

#include "kernels/backend/atomic.h"
#include "kernels/contact/joint_rows.h"
#include "kernels/step/joint_setup.h"

namespace scree {

/// Makes joint k of a step that of an impact, which takes no time: its rows keep the velocities that they have, which are those
/// of bodies that turn, and the impulses that hold them begin at zero. What has a bound or grows with the way gives nothing:
/// springs, friction, motors with a largest force. Limits and cables that are reached within the step hold their speed.
template <class Real>
struct HoldInImpact {
  static constexpr const char* name = "hold_in_impact";
  ContactProblem<Real> p;    ///< with the joints, see JointSetup
  Span<JointRow<Real>> row;  ///< in and out
  Span<Vec3<Real>> gamma;    ///< of the joints, out [N s]

  SCREE_HD void operator()(Index k) const {
    constexpr Real kNone = largest_number<Real>();
    JointRow<Real> r = row[k];
    const Index c = p.joint_begin + k;
    const JointValues<Real> u =
        JointRows<Real>::speeds(r, p.free_velocity[p.body_a[c]], p.free_velocity[p.body_b[c]]);
    // Bounds of the velocity, counted from the one that there is.
    const Real last = r.inverse_pivot(kJointAxisRow) * (u[kJointAxisRow] + r.bias[kJointAxisRow]);
    if (r.fastest < kNone) r.fastest = r.fastest > last ? r.fastest - last : Real(0);
    if (r.slowest > -kNone) r.slowest = r.slowest < last ? r.slowest - last : Real(0);
    const bool is_rigid = r.most >= kNone && !(r.compliance > Real(0));
    if (!is_rigid) r.least = r.most = r.compliance = 0;
    r.friction = r.rest = 0;
    for (int i = 0; i < kJointRows; ++i) r.bias[i] = -u[i];
    row[k] = r;
    gamma[2 * static_cast<Offset>(k)] = {};
    gamma[2 * static_cast<Offset>(k) + 1] = {};
  }
};

/// SpreadImpacts over joints: bodies that hold to one that is reached are reached.
struct SpreadThroughJoints {
  static constexpr const char* name = "spread_through_joints";
  JointPlaces places;
  Span<const Index> order;       ///< joint of each row
  Span<const JointState> state;  ///< of each joint
  float least;                   ///< mark of bodies reached before
  Span<float> reached;           ///< [moving_count] in and out

  SCREE_HD void operator()(Index k) const {
    const Index j = order[k];
    if (state[j].is_broken != 0) return;
    const Index a = places.of(places.joints[j].body[0]), b = places.of(places.joints[j].body[1]);
    if (!is_reached(a) && !is_reached(b)) return;
    if (places.moves(a)) atomic_max(&reached[a], least - 1);
    if (places.moves(b)) atomic_max(&reached[b], least - 1);
  }

 private:
  SCREE_HD bool is_reached(Index i) const { return places.moves(i) && reached[i] >= least; }
};

/// Adds the impulses of the joints in one round of impacts.
template <class Real>
struct AddJointImpulses {
  static constexpr const char* name = "add_joint_impulses";
  JointPlaces places;
  Span<const Index> order;
  Span<const JointRow<Real>> row;
  Span<const Vec3<Real>> gamma;
  Span<const JointState> state;
  Span<JointImpulse<Real>> sum;  ///< of each joint, in and out

  SCREE_HD void operator()(Index k) const {
    const Index j = order[k];
    const JointImpulse<Real> own = impulse_of_joint(places, j, state[j], row[k], gamma, k);
    sum[j].force += own.force;
    sum[j].moment += own.moment;
  }
};

}  // namespace scree
