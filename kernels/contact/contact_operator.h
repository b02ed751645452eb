#pragma once
// Element programs every solver shares: body velocities from impulses, contact
// velocities, residual.

#include "kernels/backend/over_ranks.h"
#include "kernels/contact/contact_rows.h"

namespace scree {

/// J^T gamma of body i, summed in the fixed order "contacts as A, then contacts as B", group by
/// group.
template <class R, class Real>
SCREE_HD Twist<Real> gather_wrench(const ContactProblem<Real>& p, Span<const Vec3<Real>> gamma,
                                   Index i) {
  Twist<Real> sum;
  for (Index c = p.a_start[i]; c < p.a_start[i + 1]; ++c) {
    sum = sum + R::wrench(p, c, false, R::load(gamma, c));
  }
  for (Index k = p.b_start[i]; k < p.b_start[i + 1]; ++k) {
    const Index c = p.b_contact[k];
    sum = sum + R::wrench(p, c, true, R::load(gamma, c));
  }
  if constexpr (R::kHasLaterGroups) {
    for (const ContactLists& group : p.later) {
      if (group.a_start.empty()) continue;
      for (Index k = group.a_start[i]; k < group.a_start[i + 1]; ++k) {
        const Index c = group.first + k;
        sum = sum + R::wrench(p, c, false, R::load(gamma, c));
      }
      for (Index k = group.b_start[i]; k < group.b_start[i + 1]; ++k) {
        const Index c = group.first + group.b_contact[k];
        sum = sum + R::wrench(p, c, true, R::load(gamma, c));
      }
    }
  }
  return sum;
}

/// velocity[i] = v*_i + (M^-1 J^T gamma)_i, for owned bodies.
/// Bytes per body (radial, float): 24 read + 24 written + 8; per contact 2 x (12 + 12)
/// gathered + 4.
template <class R, class Real>
struct BodyVelocity {
  static constexpr const char* name = "body_velocity";
  ContactProblem<Real> p;
  Span<const Vec3<Real>> gamma;
  Span<Twist<Real>> velocity;
  SCREE_HD void operator()(Index i) const {
    velocity[i] = p.free_velocity[i] + R::apply_inverse_mass(p, i, gather_wrench<R>(p, gamma, i));
  }
};

/// velocity[i] = v*_i, for all bodies.
template <class Real>
struct StartVelocity {
  static constexpr const char* name = "start_velocity";
  ContactProblem<Real> p;
  Span<Twist<Real>> velocity;
  SCREE_HD void operator()(Index i) const { velocity[i] = p.free_velocity[i]; }
};

/// u_c = (J V + bias)_c in the world frame [m/s]: with V of BodyVelocity the whole product
/// N gamma + r. Bytes per contact (radial, float): 24 read + 12 written; twists 2 x 24 gathered.
template <class R, class Real>
struct ContactVelocity {
  static constexpr const char* name = "contact_velocity";
  ContactProblem<Real> p;
  Span<const Twist<Real>> velocity;
  Span<Vec3<Real>> out;  ///< [contact_count], of the rolling layout two vectors a contact
  SCREE_HD void operator()(Index c) const {
    R::store(out, c, R::velocity(p, c, velocity[p.body_a[c]], velocity[p.body_b[c]]));
  }
};

/// Projects every impulse onto its contact's cone, in the Euclidean metric.
template <class R, class Real>
struct ProjectImpulses {
  static constexpr const char* name = "project_impulses";
  ContactProblem<Real> p;
  Span<Vec3<Real>> gamma;
  SCREE_HD void operator()(Index c) const {
    R::store(gamma, c, R::project(p, c, R::load(gamma, c), euclidean_metric<Real>()));
  }
};

/// What the residual pass adds up. docs/theory.md eq. (12).
struct ResidualSums {
  double sum_squares = 0;     ///< sum of |e_c|^2 [m^2/s^2]
  double exact_squares = 0;   ///< the same with the De Saxce velocity
  double work = 0;            ///< sum of gamma . (N gamma + r) [J]
  double cone_violation = 0;  ///< max(|gamma_t| - mu gamma_n) [N s]
  double max_square = -1;     ///< largest |e_c|^2
  Index max_contact = -1;
  Index bad_contact = -1;  ///< lowest contact whose residual is not finite

  SCREE_HD void combine(const ResidualSums& o) {
    sum_squares += o.sum_squares;
    exact_squares += o.exact_squares;
    work += o.work;
    if (o.cone_violation > cone_violation) cone_violation = o.cone_violation;
    if (o.max_square > max_square) {  // ties keep the earlier contact
      max_square = o.max_square;
      max_contact = o.max_contact;
    }
    if (o.bad_contact >= 0 && (bad_contact < 0 || o.bad_contact < bad_contact))
      bad_contact = o.bad_contact;
  }
};

/// Lets contacts count once that two ranks list: the program runs for all, the records of the others are left out.
template <class F>
struct CountedOnce {
  static constexpr const char* name = F::name;
  F f;
  Span<const Index> body_a, body_b;
  BodyRanges bodies;
  SCREE_HD auto operator()(Index c) const {
    const auto record = f(c);
    if (!bodies.has_uncounted() || bodies.counts(body_a[c], body_b[c])) return record;
    return std::remove_const_t<decltype(record)>{};
  }
};

/// To count contacts.
struct EachContact {
  static constexpr const char* name = "each_contact";
  SCREE_HD Sums<1> operator()(Index) const { return {{1}}; }
};

/// How many contacts each body has.
template <class Real>
struct ContactsOfBodies {
  static constexpr const char* name = "contacts_of_bodies";
  ContactProblem<Real> p;
  Span<Index> count;  ///< [owned_count] out
  SCREE_HD void operator()(Index i) const { count[i] = p.count_contacts(i); }
};

/// reduce() over the contacts of all ranks, each counted once.
template <class R, class B, class Real, class F, class G>
void reduce_contacts(B& b, const ContactProblem<Real>& p, F f, G finish) {
  reduce_over_ranks<R>(b, p.contact_count, CountedOnce<F>{f, p.body_a, p.body_b, p.bodies}, finish);
}

/// Natural-map residual of one contact: e = (gamma - P_K(gamma - rho u)) / rho,
/// rho = 3 / trace(N_cc).
/// @param u  contact velocity J V + bias [m/s]
template <class R, class Real>
SCREE_HD typename R::Rows natural_map(const ContactProblem<Real>& p, Index c,
                                      const typename R::Rows& gamma, const typename R::Rows& u) {
  const Real trace = R::block_trace(p, c);
  if (!(trace > Real(0)))
    return {};  // no body of this contact can move: no impulse changes anything
  const Real rho = Real(3) / trace, weight = trace / Real(3);
  // With equal weights a projection is the Euclidean one.
  return weight * (gamma - R::project(p, c, gamma - rho * u, {weight, weight, weight}));
}

/// De Saxce's correction: the speed by which the convex cone lifts a sliding contact, mu |u_t|.
/// Added to the normal velocity it turns the convex condition into Coulomb's law. Source: De Saxce
/// & Feng, Math. Comput. Modelling 28, 1998; docs/theory.md, section "Residual".
/// @param u  contact velocity [m/s]
template <class Real>
SCREE_HD Real de_saxce_shift(const ContactProblem<Real>& p, Index c, const ForceRows<Real>& u) {
  const Vec3<Real> n = p.normal[c];
  return p.friction[c] * norm(u.force - dot(u.force, n) * n);
}

/// With rolling and spinning friction: mu |u_t| + rolling |u_roll| + spinning |u_spin|, the support
/// function of the three bounded parts per unit of normal impulse.
template <class Real>
SCREE_HD Real de_saxce_shift(const ContactProblem<Real>& p, Index c,
                             const ForceMomentRows<Real>& u) {
  const Vec3<Real> n = p.normal[c];
  const Real spin = dot(u.moment, n);
  return de_saxce_shift(p, c, ForceRows<Real>{u.force}) +
         p.rolling[c].rolling * norm(u.moment - spin * n) + p.rolling[c].spinning * std::abs(spin);
}

/// Whether the contact keeps still: its impulse, in the cone, is off the bound that friction sets
/// by more than rounding.
template <class Real>
SCREE_HD bool is_sticking(const ContactProblem<Real>& p, Index c, const ForceRows<Real>& g) {
  constexpr Real kInside = Real(0.999);
  const Vec3<Real> n = p.normal[c];
  const Real g_n = dot(g.force, n);
  return norm(g.force - g_n * n) < kInside * p.friction[c] * (g_n + p.adhesion[c]);
}
template <class Real>
SCREE_HD bool is_sticking(const ContactProblem<Real>& p, Index c, const ForceMomentRows<Real>& g) {
  constexpr Real kInside = Real(0.999);
  const Vec3<Real> n = p.normal[c];
  const Real bound = kInside * (dot(g.force, n) + p.adhesion[c]);
  const Real spin = dot(g.moment, n);
  return is_sticking(p, c, ForceRows<Real>{g.force}) &&
         std::abs(spin) < bound * p.rolling[c].spinning &&
         norm(g.moment - spin * n) < bound * p.rolling[c].rolling;
}

template <class R, class Real>
struct ContactResidual {
  static constexpr const char* name = "contact_residual";
  ContactProblem<Real> p;
  Span<const Vec3<Real>> gamma;
  Span<const Twist<Real>> velocity;

  SCREE_HD ResidualSums operator()(Index c) const {
    const auto u = R::velocity(p, c, velocity[p.body_a[c]], velocity[p.body_b[c]]);
    const auto g = R::load(gamma, c);
    if constexpr (R::kHasJoints) {
      if (R::is_joint(p, c)) {
        const auto left = R::Joints::residual(p, c, g, u);
        return sums_of(c, dot(left, left), dot(left, left), dot(g, u));
      }
    }
    const auto e = natural_map<R>(p, c, g, u);
    const Vec3<Real> n = p.normal[c];
    auto u_exact = u;
    u_exact.force += de_saxce_shift(p, c, u) * n;
    const auto e_exact = natural_map<R>(p, c, g, u_exact);
    const Real g_n = dot(g.force, n);

    ResidualSums s = sums_of(c, dot(e, e), dot(e_exact, e_exact), dot(g, u));
    const double violation = norm(g.force - g_n * n) - p.friction[c] * (g_n + p.adhesion[c]);
    if (violation > 0) s.cone_violation = violation;
    return s;
  }

 private:
  static SCREE_HD ResidualSums sums_of(Index c, Real square, Real exact_square, Real work) {
    ResidualSums s;
    s.sum_squares = s.max_square = static_cast<double>(square);
    s.exact_squares = static_cast<double>(exact_square);
    s.work = static_cast<double>(work);
    s.max_contact = c;
    if (!(s.sum_squares < 1e300)) s.bad_contact = c;
    return s;
  }
};

/// 1/2 |V - v*|_M^2 of body i: the quadratic part of the objective.
template <class R, class Real>
struct ImpulseEnergy {
  static constexpr const char* name = "impulse_energy";
  ContactProblem<Real> p;
  Span<const Twist<Real>> velocity;
  SCREE_HD Sums<1> operator()(Index i) const {
    return {{R::mass_norm2(p, i, velocity[i] - p.free_velocity[i]) / 2}};
  }
};

/// What a ghost adds to the bound of mass_split_metric(): it is body B.
template <class R, class Real>
SCREE_HD void add_ghost_metric(const ContactProblem<Real>& p, Index c, ContactMetric<Real>& sum) {
  const Index i = p.body_b[c];
  if (p.bodies.is_owned(i) || !p.bodies.moves(i)) return;
  const Real k = static_cast<Real>(p.ghost_contacts[i - p.bodies.owned_count]);
  const ContactMetric<Real> m = R::body_metric(p, c, true, i);
  sum.normal += k * m.normal;
  sum.tangential += k * m.tangential;
  sum.moment += k * m.moment;
}

/// Upper bound of the largest eigenvalue of N over contact c's rows: with k_i contacts on body i,
/// N <= blockdiag_c(k_a N_c,a + k_b N_c,b) (mass splitting).
template <class R, class Real>
SCREE_HD ContactMetric<Real> mass_split_metric(const ContactProblem<Real>& p, Index c) {
  if constexpr (R::kHasJoints) {
    if (R::is_joint(p, c)) return R::Joints::split_metric(p, c);
  }
  ContactMetric<Real> sum{0, 0, 0};
  for (int side = 0; side < 2; ++side) {
    const Index i = side == 0 ? p.body_a[c] : p.body_b[c];
    if (!p.bodies.is_owned(i)) continue;
    const Real k =
        static_cast<Real>(R::kHasLaterGroups ? p.count_contacts(i) : p.lists(0).count(i));
    const ContactMetric<Real> m = R::body_metric(p, c, side == 1, i);
    sum.normal += k * m.normal;
    sum.tangential += k * m.tangential;
    sum.moment += k * m.moment;
  }
  if (!p.ghost_contacts.empty()) add_ghost_metric<R>(p, c, sum);
  return sum;
}

}  // namespace scree
