#pragma once
// Gauss-Seidel on one contact, and what brings contacts into the order of their colors and back.

#include "kernels/solve/jacobi_pass.h"

namespace scree {

/// Solves contact `first + k` against the velocities its bodies have now, and moves the two bodies
/// at once. Contacts run concurrently only when no two of them share an owned body; in sequence, in
/// any order. Bytes per contact (radial, float): read normal and bias 16, ids 8, metric 12, impulse
/// 12, two twists and inertias 64 gathered; written 12 and two twists 48.
template <class R, class Real>
struct GaussSeidelPass {
  static constexpr const char* name = "gauss_seidel_pass";
  ContactProblem<Real> p;
  Span<const ContactMetric<Real>> metric;  ///< D of each contact; empty: worked out on the way
  Span<Twist<Real>> velocity;              ///< V of the present impulses [body_count]
  Span<Vec3<Real>> gamma;
  Real relaxation;
  Index first = 0;
  Span<const Index> order = {};  ///< contacts to visit, where there are several groups

  SCREE_HD void operator()(Index k) const {
    visit(R::kHasLaterGroups && !order.empty() ? order[first + k] : first + k);
  }
  SCREE_HD void visit(Index c) const {
    const Index a = p.body_a[c], b = p.body_b[c];
    const Twist<Real> v_a = velocity[a], v_b = velocity[b];
    const auto old = R::load(gamma, c);
    const ContactMetric<Real> d = metric.empty() ? own_metric<R>(p, c) : metric[c];
    const auto next = metric_step<R>(p, c, old, R::velocity(p, c, v_a, v_b), d, relaxation);
    const auto move = next - old;
    R::store(gamma, c, next);
    velocity[a] = v_a + R::apply_inverse_mass(p, a, R::wrench(p, c, false, move));
    if (p.bodies.is_owned(b)) {
      velocity[b] = v_b + R::apply_inverse_mass(p, b, R::wrench(p, c, true, move));
    }
  }
};

/// Whether two ranks list a contact.
template <class Real>
SCREE_HD bool is_at_border(const ContactProblem<Real>& p, Index c) {
  return p.bodies.is_ghost(p.body_a[c]) || p.bodies.is_ghost(p.body_b[c]);
}

/// Gauss-Seidel with several ranks: contacts of a color that this rank alone lists.
template <class R, class Real>
struct InnerGaussSeidelPass {
  static constexpr const char* name = "inner_gauss_seidel_pass";
  GaussSeidelPass<R, Real> pass;
  Span<const Index> order;
  Index first = 0;
  SCREE_HD void operator()(Index k) const {
    const Index c = order[first + k];
    if (!is_at_border(pass.p, c)) pass.visit(c);
  }
};

/// The other contacts, all at once: the two ranks that list one give it the same impulse.
template <class R, class Real>
struct BorderPass {
  static constexpr const char* name = "border_pass";
  JacobiPass<R, Real> pass;
  SCREE_HD void operator()(Index c) const {
    if (is_at_border(pass.p, c)) pass(c);
  }
};

/// How many of those a body has. Bytes a contact: 4 as A, 12 as B.
template <class Real>
struct CountBorderContacts {
  static constexpr const char* name = "count_border_contacts";
  ContactProblem<Real> p;
  Span<Index> count;  ///< [owned_count] out
  SCREE_HD void operator()(Index i) const {
    Index n = 0;
    for (int g = 0; g <= kLaterGroups; ++g) {
      const ContactLists list = p.lists(g);
      if (list.a_start.empty()) continue;
      for (Index k = list.a_start[i]; k < list.a_start[i + 1]; ++k)
        n += is_at_border(p, list.first + k) ? 1 : 0;
      for (Index e = list.b_start[i]; e < list.b_start[i + 1]; ++e)
        n += is_at_border(p, list.first + list.b_contact[e]) ? 1 : 0;
    }
    count[i] = n;
  }
};

/// The metric of each contact: that of its block, or at borders, where all contacts step at once, the bound (11) of these alone.
template <class R, class Real>
struct StoreMetricOfRanks {
  static constexpr const char* name = "store_metric_of_ranks";
  ContactProblem<Real> p;
  Span<const Index> border;  ///< contacts at borders of each body that moves
  Span<ContactMetric<Real>> metric;

  SCREE_HD void operator()(Index c) const {
    metric[c] = is_at_border(p, c) ? split(c) : own_metric<R>(p, c);
  }

 private:
  SCREE_HD ContactMetric<Real> split(Index c) const {
    const Index body[2] = {p.body_a[c], p.body_b[c]};
    Index most = 0;
    ContactMetric<Real> sum{0, 0, 0};
    for (int side = 0; side < 2; ++side) {
      if (!p.bodies.moves(body[side])) continue;
      const Index count = border[body[side]];
      most = count > most ? count : most;
      if constexpr (R::kHasJoints) {
        if (R::is_joint(p, c)) continue;
      }
      const auto k = static_cast<Real>(count);
      const ContactMetric<Real> m = R::body_metric(p, c, side == 1, body[side]);
      sum.normal += k * m.normal;
      sum.tangential += k * m.tangential;
      sum.moment += k * m.moment;
    }
    if constexpr (R::kHasJoints) {
      if (R::is_joint(p, c)) {  // of which one number bounds all rows
        const Real d = static_cast<Real>(most) * R::Joints::block_trace(p, c) / 3;
        return {d, d, d};
      }
    }
    return sum;
  }
};

/// to[k] = data of contact order[k], and its block metric: one pass per solve, so that every sweep
/// reads the contacts of a color as one contiguous stretch.
template <class R, class Real>
struct GatherContacts {
  static constexpr const char* name = "gather_contacts";
  ContactProblem<Real> p;
  Span<const Index> order;
  ProblemFields<InSpans<Real>> to;  ///< empty: fields that the problem does not store
  Span<ContactMetric<Real>> metric;
  SCREE_HD void operator()(Index k) const {
    const Index c = order[k];
    p.visit(CopyContact{c, k}, p, to);
    metric[k] = own_metric<R>(p, c);
  }
};

/// ordered[k] = gamma[order[k]].
template <class R, class Real>
struct GatherImpulses {
  static constexpr const char* name = "gather_impulses";
  Span<const Index> order;
  Span<const Vec3<Real>> gamma;
  Span<Vec3<Real>> ordered;
  SCREE_HD void operator()(Index k) const { R::store(ordered, k, R::load(gamma, order[k])); }
};

/// gamma[order[k]] = ordered[k].
template <class R, class Real>
struct ScatterImpulses {
  static constexpr const char* name = "scatter_impulses";
  Span<const Index> order;
  Span<const Vec3<Real>> ordered;
  Span<Vec3<Real>> gamma;
  SCREE_HD void operator()(Index k) const { R::store(gamma, order[k], R::load(ordered, k)); }
};

}  // namespace scree
