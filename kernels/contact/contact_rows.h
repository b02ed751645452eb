#pragma once
// What differs between contact layouts, as static functions on plain values: contact velocity,
// wrench, inverse mass and projection. Everything above is one template on one of these classes.

#include <stdexcept>

#include "kernels/contact/cone.h"
#include "kernels/contact/joint_rows.h"

namespace scree {

/// Part common to layouts with force rows only.
template <class Real>
struct ForceRowsBase {
  using Rows = ForceRows<Real>;
  static constexpr int kVectors = 1;
  static constexpr int kMetricValues = 2;  ///< reals a stored ContactMetric takes
  static constexpr bool kHasLaterGroups = false;
  static constexpr bool kHasJoints = false;

  /// Impulse vectors of all contacts.
  static Offset vector_count(const ContactProblem<Real>& p) { return p.contact_count; }

  static SCREE_HD Rows load(Span<const Vec3<Real>> rows, Index c) { return {rows[c]}; }
  static SCREE_HD void store(Span<Vec3<Real>> rows, Index c, const Rows& x) { rows[c] = x.force; }

  /// Nearest point of the contact's cone, with its apex moved to -adhesion along the normal.
  static SCREE_HD Rows project(const ContactProblem<Real>& p, Index c, const Rows& y,
                               const ContactMetric<Real>& m) {
    const Vec3<Real> n = p.normal[c];
    const Real adhesion = p.adhesion[c];
    if (is_zero(adhesion)) return {project_cone(p.friction[c], n, y.force, m.normal, m.tangential)};
    const Vec3<Real> apex = adhesion * n;
    return {project_cone(p.friction[c], n, y.force + apex, m.normal, m.tangential) - apex};
  }
  /// The same for Coulomb's law itself: normal part first, then the disk that it leaves.
  /// @param m  the contact's metric, on which the result does not depend
  static SCREE_HD Rows project_coulomb(const ContactProblem<Real>& p, Index c, const Rows& y,
                                       const ContactMetric<Real>& m) {
    const Vec3<Real> n = p.normal[c];
    const Vec3<Real> apex = p.adhesion[c] * n;
    return {project_disk(p.friction[c], n, y.force + apex, m.tangential) - apex};
  }
};

/// Spheres among themselves and on surfaces that do not rotate.
template <class Real>
struct RadialRows : ForceRowsBase<Real> {
  using Rows = ForceRows<Real>;

  /// J (V_a, V_b) + bias: velocity of B against A at the contact, world frame [m/s].
  /// The arms are r_a n and -r_b n, so the rotation enters as (s_a + s_b) x n with
  /// surface speeds s.
  static SCREE_HD Rows velocity(const ContactProblem<Real>& p, Index c, const Twist<Real>& a,
                                const Twist<Real>& b) {
    const Vec3<Real> n = p.normal[c];
    return {b.linear - a.linear - cross(a.angular + b.angular, n) + p.bias[c] * n};
  }
  /// J^T gamma of this contact on its body B (side_b) or A. The angular part is the torque over the
  /// radius, the same on both sides.
  static SCREE_HD Twist<Real> wrench(const ContactProblem<Real>& p, Index c, bool side_b,
                                     const Rows& g) {
    return {side_b ? g.force : -g.force, cross(g.force, p.normal[c])};
  }
  static SCREE_HD Twist<Real> apply_inverse_mass(const ContactProblem<Real>& p, Index i,
                                                 const Twist<Real>& w) {
    return apply_inverse_mass(p.radial_inertia[i], w);
  }
  static SCREE_HD Twist<Real> apply_inverse_mass(const RadialInertia<Real>& inertia,
                                                 const Twist<Real>& w) {
    return {inertia.inv_mass * w.linear, inertia.inv_spin * w.angular};
  }
  /// dV^T M dV [J]
  static SCREE_HD double mass_norm2(const ContactProblem<Real>& p, Index i, const Twist<Real>& dv) {
    const RadialInertia<Real> inertia = p.radial_inertia[i];
    double sum = 0;
    if (inertia.inv_mass > 0) sum += static_cast<double>(norm2(dv.linear)) / inertia.inv_mass;
    if (inertia.inv_spin > 0) sum += static_cast<double>(norm2(dv.angular)) / inertia.inv_spin;
    return sum;
  }
  /// The diagonal block of N is diag(n, t, t) exactly.
  static SCREE_HD ContactMetric<Real> block_metric(const ContactProblem<Real>& p, Index c) {
    const RadialInertia<Real> a = p.radial_inertia[p.body_a[c]];
    const RadialInertia<Real> b = p.radial_inertia[p.body_b[c]];
    const Real n = a.inv_mass + b.inv_mass;
    return {n, n + a.inv_spin + b.inv_spin, 1};
  }
  static SCREE_HD Real block_trace(const ContactProblem<Real>& p, Index c) {
    const ContactMetric<Real> m = block_metric(p, c);
    return m.normal + 2 * m.tangential;
  }
  /// Largest eigenvalue of what body i alone adds to the diagonal block of contact c.
  static SCREE_HD ContactMetric<Real> body_metric(const ContactProblem<Real>& p, Index, bool,
                                                  Index i) {
    const RadialInertia<Real> inertia = p.radial_inertia[i];
    return {inertia.inv_mass, inertia.inv_mass + inertia.inv_spin, 1};
  }
};

/// General inertia of a sphere whose length is its radius.
template <class Real>
SCREE_HD GeneralInertia<Real> isotropic(const RadialInertia<Real>& r) {
  GeneralInertia<Real> g;
  if (!(r.inv_mass > Real(0))) return g;
  g.mass = Real(1) / r.inv_mass;
  g.inv_mass = {r.inv_mass, r.inv_mass, r.inv_mass};
  g.inv_inertia.xx = g.inv_inertia.yy = g.inv_inertia.zz = r.inv_spin;
  if (r.inv_spin > Real(0)) g.inertia.xx = g.inertia.yy = g.inertia.zz = Real(1) / r.inv_spin;
  return g;
}

/// Shared by layouts with lever arms and full inertia.
/// @tparam kInMixed  contacts behind radial ones, and bodies that may have a radial inertia only
template <class Real, bool kInMixed = false>
struct LeverArms {
  /// Where what only such contacts have is stored.
  static SCREE_HD Index place(const ContactProblem<Real>& p, Index c) {
    return kInMixed ? c - p.radial_count : c;
  }
  static SCREE_HD const Vec3<Real>& arm(const ContactProblem<Real>& p, Index c, bool side_b) {
    return side_b ? p.arm_b[place(p, c)] : p.arm_a[place(p, c)];
  }
  static SCREE_HD decltype(auto) inertia(const ContactProblem<Real>& p, Index i) {
    if constexpr (kInMixed) {
      return p.general_inertia.empty() ? isotropic(p.radial_inertia[i]) : p.general_inertia[i];
    } else {
      return p.general_inertia[i];
    }
  }
  static SCREE_HD Twist<Real> apply_inverse_mass(const ContactProblem<Real>& p, Index i,
                                                 const Twist<Real>& w) {
    return apply_inverse_mass(inertia(p, i), w);
  }
  static SCREE_HD Twist<Real> apply_inverse_mass(const GeneralInertia<Real>& body,
                                                 const Twist<Real>& w) {
    return {hadamard(body.inv_mass, w.linear), body.inv_inertia * w.angular};
  }
  static SCREE_HD double mass_norm2(const ContactProblem<Real>& p, Index i, const Twist<Real>& dv) {
    return mass_norm2(inertia(p, i), dv);
  }
  static SCREE_HD double mass_norm2(const GeneralInertia<Real>& body, const Twist<Real>& dv) {
    return static_cast<double>(body.mass) * norm2(dv.linear) +
           dot(dv.angular, body.inertia * dv.angular);
  }
  /// Velocity of B against A at the contact, in the middle of the step, without bias.
  static SCREE_HD Vec3<Real> point_velocity(const ContactProblem<Real>& p, Index c,
                                            const Twist<Real>& a, const Twist<Real>& b) {
    const Vec3<Real> u = b.linear + cross(b.angular, arm(p, c, true)) - a.linear -
                         cross(a.angular, arm(p, c, false));
    return p.drift.empty() ? u : u + p.drift[place(p, c)];
  }
  /// Response of body i at arm r to a unit impulse along e: (M^-1)_lin e + (I^-1 (r x e)) x r.
  static SCREE_HD Vec3<Real> response(const ContactProblem<Real>& p, Index i, const Vec3<Real>& r,
                                      const Vec3<Real>& e) {
    const GeneralInertia<Real>& body = inertia(p, i);
    return hadamard(body.inv_mass, e) + cross(body.inv_inertia * cross(r, e), r);
  }
  /// Bound of a symmetric 3x3 block G by diag(a_n, a_t, a_t) >= G, given its action.
  /// a_n = G_nn + |G_nt|, a_t = lambda_max(G_tt) + |G_nt|.
  template <class Apply>
  static SCREE_HD ContactMetric<Real> bound_block(const Vec3<Real>& n, const Apply& apply) {
    const Vec3<Real> t1 = any_orthogonal(n);
    const Vec3<Real> t2 = cross(n, t1);
    const Vec3<Real> g_n = apply(n), g_1 = apply(t1), g_2 = apply(t2);
    const Real coupling = std::sqrt(dot(t1, g_n) * dot(t1, g_n) + dot(t2, g_n) * dot(t2, g_n));
    const Real half_sum = (dot(t1, g_1) + dot(t2, g_2)) / 2;
    const Real half_difference = (dot(t1, g_1) - dot(t2, g_2)) / 2;
    const Real off = dot(t1, g_2);
    const Real largest = half_sum + std::sqrt(half_difference * half_difference + off * off);
    return {dot(n, g_n) + coupling, largest + coupling, 1};
  }
  static SCREE_HD ContactMetric<Real> force_metric(const ContactProblem<Real>& p, Index c) {
    return bound_block(p.normal[c], [&](const Vec3<Real>& e) {
      return response(p, p.body_a[c], arm(p, c, false), e) +
             response(p, p.body_b[c], arm(p, c, true), e);
    });
  }
  static SCREE_HD ContactMetric<Real> body_metric(const ContactProblem<Real>& p, Index c,
                                                  bool side_b, Index i) {
    const Vec3<Real> r = arm(p, c, side_b);
    return bound_block(p.normal[c], [&](const Vec3<Real>& e) { return response(p, i, r, e); });
  }
  static SCREE_HD Real block_trace(const ContactProblem<Real>& p, Index c) {
    Real trace = 0;
    for (int axis = 0; axis < 3; ++axis) {
      Vec3<Real> e;
      e[axis] = 1;
      trace += (response(p, p.body_a[c], arm(p, c, false), e) +
                response(p, p.body_b[c], arm(p, c, true), e))[axis];
    }
    return trace;
  }
};

/// Any shapes, three rows a contact.
template <class Real, bool kInMixed = false>
struct GeneralRows : ForceRowsBase<Real>, LeverArms<Real, kInMixed> {
  using Rows = ForceRows<Real>;
  static SCREE_HD Rows velocity(const ContactProblem<Real>& p, Index c, const Twist<Real>& a,
                                const Twist<Real>& b) {
    return {GeneralRows::point_velocity(p, c, a, b) + p.bias[c] * p.normal[c]};
  }
  static SCREE_HD Twist<Real> wrench(const ContactProblem<Real>& p, Index c, bool side_b,
                                     const Rows& g) {
    return wrench_at(GeneralRows::arm(p, c, side_b), side_b, g.force);
  }
  static SCREE_HD Twist<Real> wrench_at(const Vec3<Real>& arm, bool side_b,
                                        const Vec3<Real>& impulse) {
    if (side_b) return {impulse, cross(arm, impulse)};
    return {-impulse, cross(impulse, arm)};
  }
  static SCREE_HD ContactMetric<Real> block_metric(const ContactProblem<Real>& p, Index c) {
    return GeneralRows::force_metric(p, c);
  }
};

/// Any shapes with rolling and spinning friction: six rows a contact, three cones on
/// one normal impulse.
template <class Real>
struct RollingRows : LeverArms<Real> {
  using Rows = ForceMomentRows<Real>;
  static constexpr int kVectors = 2;
  static constexpr int kMetricValues = 3;
  static constexpr bool kHasLaterGroups = false;
  static constexpr bool kHasJoints = false;

  static Offset vector_count(const ContactProblem<Real>& p) {
    return 2 * static_cast<Offset>(p.contact_count);
  }

  static SCREE_HD Rows load(Span<const Vec3<Real>> rows, Index c) {
    return {rows[2 * static_cast<Offset>(c)], rows[2 * static_cast<Offset>(c) + 1]};
  }
  static SCREE_HD void store(Span<Vec3<Real>> rows, Index c, const Rows& x) {
    rows[2 * static_cast<Offset>(c)] = x.force;
    rows[2 * static_cast<Offset>(c) + 1] = x.moment;
  }
  static SCREE_HD Rows velocity(const ContactProblem<Real>& p, Index c, const Twist<Real>& a,
                                const Twist<Real>& b) {
    return {RollingRows::point_velocity(p, c, a, b) + p.bias[c] * p.normal[c],
            p.rolling[c].length * (b.angular - a.angular)};
  }
  static SCREE_HD Twist<Real> wrench(const ContactProblem<Real>& p, Index c, bool side_b,
                                     const Rows& g) {
    const Vec3<Real> moment = p.rolling[c].length * g.moment;
    if (side_b) return {g.force, cross(p.arm_b[c], g.force) + moment};
    return {-g.force, cross(g.force, p.arm_a[c]) - moment};
  }
  static SCREE_HD Rows project(const ContactProblem<Real>& p, Index c, const Rows& y,
                               const ContactMetric<Real>& m) {
    return project_above(p, c, y, m, p.adhesion[c], Real(0));
  }
  /// The same on the part of the cones where the normal impulse is at least `least`, counted from
  /// the apex [N s].
  static SCREE_HD Rows project_above(const ContactProblem<Real>& p, Index c, const Rows& y,
                                     const ContactMetric<Real>& m, Real adhesion, Real least) {
    const Vec3<Real> n = p.normal[c];
    const RollingRow<Real> row = p.rolling[c];
    const Real y_n = dot(n, y.force) + adhesion;
    const Vec3<Real> slide = y.force - dot(n, y.force) * n;
    const Real spin = dot(n, y.moment);
    const Vec3<Real> roll = y.moment - spin * n;
    const BoundedPart<Real> part[3] = {
        {p.friction[c], m.tangential, weighed_length(m.tangential, slide)},
        {row.rolling, m.moment, weighed_length(m.moment, roll)},
        {row.spinning, m.moment, std::abs(spin)}};
    Real normal = shared_normal(m.normal, y_n, part);
    if (normal < least) normal = least;
    Real scale[3];
    for (int k = 0; k < 3; ++k) {
      const Real bound = part[k].mu * normal;
      scale[k] = part[k].length > bound ? bound / part[k].length : Real(1);
    }
    return {(normal - adhesion) * n + scale[0] * slide, scale[1] * roll + (scale[2] * spin) * n};
  }
  static SCREE_HD Rows project_coulomb(const ContactProblem<Real>& p, Index c, const Rows& y,
                                       const ContactMetric<Real>& m) {
    const Vec3<Real> n = p.normal[c];
    const RollingRow<Real> row = p.rolling[c];
    const Real spin = dot(n, y.moment);
    const Vec3<Real> roll = y.moment - spin * n;
    const Real normal = dot(n, y.force) + p.adhesion[c];
    const Real pressed = normal > Real(0) ? normal : Real(0);
    const auto within = [](Real length, Real bound) {
      return length > bound ? bound / length : Real(1);
    };
    return {ForceRowsBase<Real>::project_coulomb(p, c, {y.force}, m).force,
            within(weighed_length(m.moment, roll), row.rolling * pressed) * roll +
                (within(std::abs(spin), row.spinning * pressed) * spin) * n};
  }
  /// Bounds the coupled 6x6 block: force and moment parts of a positive semidefinite block satisfy
  /// block <= 2 diag(force part, moment part).
  static SCREE_HD ContactMetric<Real> block_metric(const ContactProblem<Real>& p, Index c) {
    ContactMetric<Real> m = RollingRows::force_metric(p, c);
    return {2 * m.normal, 2 * m.tangential,
            2 * (moment_bound(p, c, p.body_a[c]) + moment_bound(p, c, p.body_b[c]))};
  }
  static SCREE_HD ContactMetric<Real> body_metric(const ContactProblem<Real>& p, Index c,
                                                  bool side_b, Index i) {
    const ContactMetric<Real> m = LeverArms<Real>::body_metric(p, c, side_b, i);
    return {2 * m.normal, 2 * m.tangential, 2 * moment_bound(p, c, i)};
  }

 private:
  static SCREE_HD Real moment_bound(const ContactProblem<Real>& p, Index c, Index i) {
    const Real length = p.rolling[c].length;
    return length * length * p.general_inertia[i].inv_inertia.trace();
  }
};

/// Radial contacts, then general ones: what a contact is follows from its number. Bodies are radial
/// ones, whose general inertia is isotropic, or have a radial inertia of zero.
template <class Real>
struct MixedRows : ForceRowsBase<Real> {
  using Rows = ForceRows<Real>;
  using Radial = RadialRows<Real>;
  using General = GeneralRows<Real, true>;
  static constexpr bool kHasLaterGroups = true;

  static SCREE_HD bool is_radial(const ContactProblem<Real>& p, Index c) {
    return c < p.radial_count;
  }
  static SCREE_HD Rows velocity(const ContactProblem<Real>& p, Index c, const Twist<Real>& a,
                                const Twist<Real>& b) {
    return is_radial(p, c) ? Radial::velocity(p, c, a, b) : General::velocity(p, c, a, b);
  }
  static SCREE_HD Twist<Real> wrench(const ContactProblem<Real>& p, Index c, bool side_b,
                                     const Rows& g) {
    return is_radial(p, c) ? Radial::wrench(p, c, side_b, g) : General::wrench(p, c, side_b, g);
  }
  static SCREE_HD Twist<Real> apply_inverse_mass(const ContactProblem<Real>& p, Index i,
                                                 const Twist<Real>& w) {
    const RadialInertia<Real> r = p.radial_inertia[i];
    if (r.inv_mass > Real(0)) return Radial::apply_inverse_mass(r, w);
    return General::apply_inverse_mass(p, i, w);
  }
  static SCREE_HD double mass_norm2(const ContactProblem<Real>& p, Index i, const Twist<Real>& dv) {
    return p.radial_inertia[i].inv_mass > Real(0) ? Radial::mass_norm2(p, i, dv)
                                                  : General::mass_norm2(p, i, dv);
  }
  static SCREE_HD ContactMetric<Real> block_metric(const ContactProblem<Real>& p, Index c) {
    return is_radial(p, c) ? Radial::block_metric(p, c) : General::block_metric(p, c);
  }
  static SCREE_HD Real block_trace(const ContactProblem<Real>& p, Index c) {
    return is_radial(p, c) ? Radial::block_trace(p, c) : General::block_trace(p, c);
  }
  static SCREE_HD ContactMetric<Real> body_metric(const ContactProblem<Real>& p, Index c,
                                                  bool side_b, Index i) {
    return is_radial(p, c) ? Radial::body_metric(p, c, side_b, i)
                           : General::body_metric(p, c, side_b, i);
  }
};

/// Contacts with room for rolling friction, then joints.
template <class Real>
struct JointedRows : RollingRows<Real> {
  using Rows = ForceMomentRows<Real>;
  using Contacts = RollingRows<Real>;
  using Joints = JointRows<Real>;
  static constexpr bool kHasLaterGroups = true;
  static constexpr bool kHasJoints = true;

  static SCREE_HD bool is_joint(const ContactProblem<Real>& p, Index c) {
    return c >= p.joint_begin;
  }
  static SCREE_HD Rows velocity(const ContactProblem<Real>& p, Index c, const Twist<Real>& a,
                                const Twist<Real>& b) {
    return is_joint(p, c) ? Joints::velocity(p, c, a, b) : Contacts::velocity(p, c, a, b);
  }
  static SCREE_HD Twist<Real> wrench(const ContactProblem<Real>& p, Index c, bool side_b,
                                     const Rows& g) {
    return is_joint(p, c) ? Joints::wrench(p, c, side_b, g) : Contacts::wrench(p, c, side_b, g);
  }
  static SCREE_HD Rows project(const ContactProblem<Real>& p, Index c, const Rows& y,
                               const ContactMetric<Real>& m) {
    return is_joint(p, c) ? Joints::project(p, c, y) : Contacts::project(p, c, y, m);
  }
  static SCREE_HD Rows project_coulomb(const ContactProblem<Real>& p, Index c, const Rows& y,
                                       const ContactMetric<Real>& m) {
    return is_joint(p, c) ? Joints::project(p, c, y) : Contacts::project_coulomb(p, c, y, m);
  }
  static SCREE_HD ContactMetric<Real> block_metric(const ContactProblem<Real>& p, Index c) {
    if (is_joint(p, c)) return Joints::block_metric(p, c);
    return has_moments(p, c) ? Contacts::block_metric(p, c)
                             : forces_only(Contacts::force_metric(p, c));
  }
  static SCREE_HD Real block_trace(const ContactProblem<Real>& p, Index c) {
    return is_joint(p, c) ? Joints::block_trace(p, c) : Contacts::block_trace(p, c);
  }
  static SCREE_HD ContactMetric<Real> body_metric(const ContactProblem<Real>& p, Index c,
                                                  bool side_b, Index i) {
    if (is_joint(p, c)) return Joints::block_metric(p, c);
    return has_moments(p, c) ? Contacts::body_metric(p, c, side_b, i)
                             : forces_only(LeverArms<Real>::body_metric(p, c, side_b, i));
  }

 private:
  /// Without friction of that kind the moment rows stay zero, and force rows need no room for them.
  static SCREE_HD bool has_moments(const ContactProblem<Real>& p, Index c) {
    return p.rolling[c].rolling > Real(0) || p.rolling[c].spinning > Real(0);
  }
  static SCREE_HD ContactMetric<Real> forces_only(const ContactMetric<Real>& m) {
    return {m.normal, m.tangential, m.tangential};
  }
};

/// Calls f with the rows class of a layout of one group: one branch per solve, none per contact.
template <class Real, class F>
decltype(auto) with_rows_of_one_group(ContactLayout layout, F&& f) {
  switch (layout) {
    case ContactLayout::radial:
      return f(RadialRows<Real>{});
    case ContactLayout::rolling:
      return f(RollingRows<Real>{});
    case ContactLayout::general:
      return f(GeneralRows<Real>{});
    case ContactLayout::mixed:
    case ContactLayout::jointed:
      break;
  }
  throw std::logic_error("a layout of several groups where one group is expected");
}

/// The same for all layouts.
template <class Real, class F>
decltype(auto) with_rows(ContactLayout layout, F&& f) {
  if (layout == ContactLayout::mixed) return f(MixedRows<Real>{});
  if (layout == ContactLayout::jointed) return f(JointedRows<Real>{});
  return with_rows_of_one_group<Real>(layout, f);
}

}  // namespace scree
