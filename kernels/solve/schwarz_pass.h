#pragma once
// One pass of accelerated Schwarz: from a point extrapolated beyond the iterate, every tile in
// turn, color after color, improves the impulses of its contacts by Gauss-Seidel sweeps. Source:
// docs/theory.md, section "Accelerated Schwarz".

#include "kernels/solve/body_tiles.h"
#include "kernels/solve/gauss_seidel_pass.h"
#include "kernels/solve/momentum.h"

namespace scree {

/// Scalars of a running solve, in backend memory. The momentum of a pass is decided two passes
/// before, so that on a device a pass may begin before the one ahead of it has ended everywhere.
struct SchwarzState {
  double theta = next_theta(kFirstTheta);        ///< momentum parameter of the last pass decided
  double beta[2] = {0, next_beta(kFirstTheta)};  ///< extrapolation factor of pass k in k % 2
  Index restarts = 0;
  bool has_momentum = true;
  bool is_restarting = false;  ///< the last decision was a restart, unknown to the next pass

  SCREE_HD double beta_of(int k) const { return k % 2 == 0 ? beta[0] : beta[1]; }
};

/// The iterate x, and the one before, whose place the next one takes.
template <class T>
struct Iterates {
  Span<const T> current;
  Span<T> next;

  /// y = x + beta (x - x_before) of element i; before next[i] is written.
  template <class Real>
  SCREE_HD T extrapolated(Index i, Real beta) const {
    return current[i] + beta * (current[i] - next[i]);
  }
};

/// next[i] = y_i, and a copy of it.
template <class T, class Real>
struct Extrapolate {
  static constexpr const char* name = "extrapolate";
  Iterates<T> x;
  const SchwarzState* state;
  int k;          ///< number of the pass
  Span<T> start;  ///< out, or empty
  SCREE_HD void operator()(Index i) const {
    const T y = x.extrapolated(i, static_cast<Real>(state->beta_of(k)));
    x.next[i] = y;
    if (!start.empty()) start[i] = y;
  }
};

/// Sweeps over a tile; tiles of one color run concurrently. Bytes per contact and sweep as in
/// GaussSeidelPass, from the caches after the first one.
template <class R, class Real>
struct SweepTile {
  static constexpr const char* name = "sweep_tile";
  static constexpr Index kSerialBelow = 16;
  BodyTiles tiles;
  Span<const Index> sequence;  ///< tiles by color
  Span<const Index> order;     ///< contacts by (tile, color)
  GaussSeidelPass<R, Real> step;
  int sweeps;
  Index first = 0;  ///< position in the sequence
  SCREE_HD void operator()(Index k) const {
    const Index t = sequence[first + k];
    const Index begin = tiles.first_contact(t), end = tiles.first_contact(t + 1);
    for (int s = 0; s < sweeps; ++s) {
      for (Index at = begin; at < end; ++at) step(order[at]);
    }
  }
};

/// (y - x+) . D (x+ - x) of contact c, D its own metric: positive when the pass went
/// against the momentum.
/// @param x, y, moved  the iterate, the extrapolated point and the next iterate
template <class R, class Real, class Rows>
SCREE_HD Sums<1> against_momentum(const ContactProblem<Real>& p, Index c,
                                  const ContactMetric<Real>& d, const Rows& x, const Rows& y,
                                  const Rows& moved) {
  return {{static_cast<double>(metric_dot(d, p.normal[c], y - moved, moved - x))}};
}

template <class R, class Real>
struct AgainstMomentum {
  static constexpr const char* name = "against_momentum";
  ContactProblem<Real> p;
  Span<const ContactMetric<Real>> metric;
  Iterates<Vec3<Real>> gamma;
  Span<const Vec3<Real>> start;
  SCREE_HD Sums<1> operator()(Index c) const {
    return against_momentum<R>(p, c, metric[c], R::load(gamma.current, c), R::load(start, c),
                               R::load(Span<const Vec3<Real>>(gamma.next), c));
  }
};

/// Ends pass k and decides on the momentum of pass k + 2: restarts it where it led uphill,
/// else lets it grow.
struct SchwarzFinish {
  SchwarzState* state;
  int k;
  SCREE_HD void operator()(const Sums<1>& against) const {
    SchwarzState& s = *state;
    const bool restart = against.value[0] > 0 && !s.is_restarting;
    s.is_restarting = restart;
    if (restart) ++s.restarts;
    s.beta[k % 2] = restart || !s.has_momentum ? 0 : next_beta(s.theta);
    s.theta = restart ? 1 : next_theta(s.theta);
  }
};

/// Restarts the momentum of the next two passes, or ends it for good.
struct SchwarzRestart {
  static constexpr const char* name = "schwarz_restart";
  SchwarzState* state;
  bool for_good;
  SCREE_HD void operator()(Index) const {
    state->theta = 1;
    state->beta[0] = state->beta[1] = 0;
    state->has_momentum = !for_good;
  }
};

/// All that the passes of a solve work on.
template <class R, class Real>
struct SchwarzPasses {
  ContactProblem<Real> p;
  Span<Vec3<Real>> gamma[2];      ///< iterate k in the one of index k % 2
  Span<Twist<Real>> velocity[2];  ///< likewise; fixed bodies have theirs in both
  SchwarzState* state;
  Real relaxation;
  int sweeps;  ///< over a tile in one pass

  // Comparisons pick the buffer: an array that a device program indexes would leave registers.
  SCREE_HD Iterates<Vec3<Real>> impulses(int k) const {
    return k % 2 == 0 ? Iterates<Vec3<Real>>{gamma[0], gamma[1]}
                      : Iterates<Vec3<Real>>{gamma[1], gamma[0]};
  }
  SCREE_HD Iterates<Twist<Real>> velocities(int k) const {
    return k % 2 == 0 ? Iterates<Twist<Real>>{velocity[0], velocity[1]}
                      : Iterates<Twist<Real>>{velocity[1], velocity[0]};
  }
};

}  // namespace scree
