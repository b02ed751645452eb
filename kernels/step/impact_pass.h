#pragma once
// Element programs of the impacts of a step: which contacts take part, the problem they make, and
// what follows from its solution. docs/theory.md, section "Impacts".

#include "kernels/backend/atomic.h"
#include "kernels/backend/backend.h"
#include "kernels/contact/contact_operator.h"
#include "kernels/contact/contact_velocity.h"
#include "kernels/step/step_setup.h"

namespace scree {

/// Which contacts bounce, and which others touch.
template <class Real>
struct ImpactTest {
  BodyView<Real> bodies;
  ContactView<Real> contacts;
  LawTable<Real> law;
  Real time_step = 0;                ///< h [s]
  Real threshold = 0;                ///< approach speed below which contacts do not bounce [m/s]
  Real touching_gap = 0;             ///< largest gap of bodies that count as touching [m]
  bool lifts = false;                ///< whether sliding contacts are lifted: the convex law
  Vec3<Real> gravity_step;           ///< h g [m/s]
  Span<const Vec3<Real>> load_gain;  ///< [owned_count] what other loads add [m/s]; empty: none

  SCREE_HD const PairLaw<Real>& pair(Index c) const {
    return law(bodies.material[contacts.body_a[c]], bodies.material[contacts.body_b[c]]);
  }
  /// A contact that is not closed in the step bounces, too, where the law would lift it as it slides: it would be stopped before
  /// it could bounce.
  /// @param u_n  normal velocity of contact c [m/s]
  SCREE_HD bool bounces(Index c, Real u_n) const {
    const PairLaw<Real>& own = pair(c);
    if (!(own.restitution > 0 && u_n < -threshold)) return false;
    Real nearest = contacts.gap[c] + time_step * (u_n + 2 * half_load(c));
    if (lifts) {
      const Vec3<Real> u = contact_velocity(bodies, contacts, c);
      nearest -= time_step * own.friction * norm(across(u, contacts.normal[c]));
    }
    return nearest <= 0;
  }
  SCREE_HD bool touches(Index c) const { return contacts.gap[c] <= touching_gap; }

  /// Normal velocity that the loads of half a step add at contact c [m/s].
  SCREE_HD Real half_load(Index c) const {
    const Vec3<Real> gained = load(contacts.body_b[c]) - load(contacts.body_a[c]);
    return dot(gained, contacts.normal[c]) / 2;
  }

 private:
  SCREE_HD Vec3<Real> load(Index i) const {
    if (!bodies.moves(i)) return {};
    const Vec3<Real> gained = on_axes(gravity_step, free_linear_axes(bodies.locks[i]));
    return i < load_gain.size ? gained + load_gain[i] : gained;
  }
};

/// What the search for impacts adds up.
struct ImpactSums {
  double approach_squares = 0;  ///< sum over bouncing contacts of u_n^2 [m^2/s^2]
  double bouncing = 0;          ///< their number
  double touching_squares = 0;  ///< as SetupSums::approach_squares
  double touching = 0;          ///< as SetupSums::touching
  SCREE_HD void combine(const ImpactSums& o) {
    approach_squares += o.approach_squares;
    bouncing += o.bouncing;
    touching_squares += o.touching_squares;
    touching += o.touching;
  }
};

/// Finds the contacts that bounce, and marks their bodies.
template <class Real>
struct FindImpacts {
  static constexpr const char* name = "find_impacts";
  ImpactTest<Real> test;
  float mark;              ///< of bodies of bouncing contacts
  Span<Index> takes_part;  ///< [contacts.count] out: 0 or 1
  Span<float> reached;     ///< [moving_count] in: zero; out: mark

  SCREE_HD ImpactSums operator()(Index c) const {
    const Real u_n = normal_velocity(test.bodies, test.contacts, c);
    ImpactSums s;
    if (test.contacts.gap[c] <= 0) {
      s.touching = 1;
      if (u_n < 0) s.touching_squares = static_cast<double>(u_n) * u_n;
    }
    takes_part[c] = test.bounces(c, u_n) ? 1 : 0;
    if (takes_part[c] == 0) return s;
    s.bouncing = 1;
    s.approach_squares = static_cast<double>(u_n) * u_n;
    const Index b = test.contacts.body_b[c];
    atomic_max(&reached[test.contacts.body_a[c]], mark);
    if (test.bodies.moves(b)) atomic_max(&reached[b], mark);
    return s;
  }
};

/// One round over the contacts: those that touch a body reached before take part, and reach their
/// own bodies. Marks fall by one a round, so what one contact writes no other reads in that round.
template <class Real>
struct SpreadImpacts {
  static constexpr const char* name = "spread_impacts";
  ImpactTest<Real> test;
  float least;  ///< mark of bodies reached before
  Span<Index> takes_part;
  Span<float> reached;

  SCREE_HD void operator()(Index c) const {
    if (takes_part[c] != 0 || !test.touches(c)) return;
    const Index a = test.contacts.body_a[c], b = test.contacts.body_b[c];
    const bool has_b = test.bodies.moves(b);
    if (!(reached[a] >= least) && !(has_b && reached[b] >= least)) return;
    takes_part[c] = 1;
    atomic_max(&reached[a], least - 1);
    if (has_b) atomic_max(&reached[b], least - 1);
  }
};

/// The contacts that take part, one after the other: what their problem needs.
template <class Real>
struct GatherImpacts {
  static constexpr const char* name = "gather_impacts";
  ImpactTest<Real> test;
  Span<const Index> takes_part;
  Span<const Offset> place;  ///< where a contact goes
  Span<Index> contact;       ///< out: where it comes from
  ContactLayout layout;
  Offset radial_count;              ///< of those that take part
  ProblemFields<InSpans<Real>> to;  ///< bodies, normal, arms, bias, friction, rolling
  Span<Real> restitution;           ///< [-], 0 where the contact does not bounce

  SCREE_HD void operator()(Index c) const {
    if (takes_part[c] == 0) return;
    const Offset k = place[c];
    const ContactView<Real>& from = test.contacts;
    contact[k] = c;
    to.body_a[k] = from.body_a[c];
    to.body_b[k] = from.body_b[c];
    to.normal[k] = from.normal[c];
    if (!from.is_radial(c)) {
      to.arm_a[k - radial_count] = scaled(from.lever_a(c), from.body_a[c]);
      to.arm_b[k - radial_count] = scaled(from.lever_b(c), from.body_b[c]);
    }
    const PairLaw<Real>& pair = test.pair(c);
    to.friction[k] = pair.friction;
    if (!to.rolling.empty()) to.rolling[k] = rolling_row(test.bodies, from, c, pair);
    // Bodies meet in the middle of the step, on average: with half of its loads.
    const Real u_n = normal_velocity(test.bodies, from, c);
    const Real load = test.half_load(c);
    const bool bounces = test.bounces(c, u_n);
    to.bias[k] = bounces && u_n + load < 0 ? load : Real(0);
    restitution[k] = bounces ? pair.restitution : Real(0);
  }

 private:
  SCREE_HD Vec3<Real> scaled(const Vec3<Real>& arm, Index i) const {
    return (Real(1) / rate_length(layout, test.bodies, i)) * arm;
  }
};

/// The least normal impulse of each contact after its compression, Poisson's hypothesis: 1 + e
/// times that of the compression, as far as this went into stopping the approach and not into the
/// lift of a sliding contact. Impulses are raised to it.
template <class R, class Real>
struct ReleaseImpacts {
  static constexpr const char* name = "release_impacts";
  ContactProblem<Real> p;
  Span<const Real> restitution;        ///< [-]
  Span<const Twist<Real>> compressed;  ///< body velocities at the end of the compression
  Span<Vec3<Real>> gamma;              ///< impulses of the compression; out: a guess of the total
  Span<Real> least;                    ///< out [N s]

  SCREE_HD void operator()(Index c) const {
    least[c] = 0;
    const Real e = restitution[c];
    auto g = R::load(gamma, c);
    const Vec3<Real> n = p.normal[c];
    const Real g_n = dot(n, g.force);
    if (!(e > Real(0)) || !(g_n > Real(0))) return;
    const Index a = p.body_a[c], b = p.body_b[c];
    const Real before = dot(n, R::velocity(p, c, p.free_velocity[a], p.free_velocity[b]).force);
    const Real after = dot(n, R::velocity(p, c, compressed[a], compressed[b]).force);
    if (!(before < Real(0))) return;
    const Real share = after > Real(0) ? before / (before - after) : Real(1);
    least[c] = (1 + e) * share * g_n;
    if (least[c] > g_n) g.force += (least[c] - g_n) * n;
    R::store(gamma, c, g);
  }
};

/// Exact Coulomb friction: adds mu |u_t| to the bias. Returns the squared changes.
template <class R, class Real>
struct LiftBias {
  static constexpr const char* name = "lift_bias";
  ContactProblem<Real> p;  ///< with the unchanged bias
  Span<const Twist<Real>> velocity;
  Span<Real> bias;  ///< in, out [m/s]

  SCREE_HD Sums<1> operator()(Index c) const {
    if constexpr (R::kHasJoints) {
      if (R::is_joint(p, c)) return {};
    }
    const auto u = R::velocity(p, c, velocity[p.body_a[c]], velocity[p.body_b[c]]);
    const Real lifted = p.bias[c] + de_saxce_shift(p, c, u);
    const double change = static_cast<double>(lifted) - bias[c];
    bias[c] = lifted;
    return {{change * change}};
  }
};

/// Takes the velocities after the impacts over, where a body took part in one.
template <class Real>
struct TakeVelocities {
  static constexpr const char* name = "take_velocities";
  ContactProblem<Real> p;
  Span<const Twist<Real>> velocity;
  BodyView<Real> bodies;

  SCREE_HD void operator()(Index i) const {
    if (p.count_contacts(i) == 0) return;
    bodies.velocity[i] = velocity[i].linear;
    bodies.angular_velocity[i] = (Real(1) / rate_length(p.layout, bodies, i)) * velocity[i].angular;
  }
};

}  // namespace scree
