#pragma once
// Exact solutions of problems with one contact: what Gauss-Seidel methods do at every contact, on
// the host and on a device.

#include <cmath>

#include "solvers/assembled/assembled_measures.h"
#include "solvers/assembled/bracketed_root.h"
#include "solvers/assembled/newton_root.h"

namespace scree {
namespace one_contact_parts {

struct Vec2 {
  double x = 0, y = 0;
};

SCREE_HD inline double inner(const Vec2& v, const Vec2& w) { return v.x * w.x + v.y * w.y; }
SCREE_HD inline double length(const Vec2& v) { return std::sqrt(inner(v, v)); }

/// (A + l I)^-1 v for A = {a, b; c, d}.
struct Shifted {
  double a, b, c, d;
  SCREE_HD Vec2 solve(double l, const Vec2& v) const {
    const double p = a + l, s = d + l, over_det = 1 / (p * s - b * c);
    return {over_det * (s * v.x - b * v.y), over_det * (p * v.y - c * v.x)};
  }
  SCREE_HD double trace() const { return a + d; }
  /// Whether A is positive definite by more than rounding.
  SCREE_HD bool definite() const {
    const double det = a * d - b * c;
    return a > 0 && d > 0 && det > 1e-15 * trace() * trace();
  }
};

/// [0, 1) to [0, inf): where brackets of l live.
SCREE_HD inline double stretched(double scale, double t) { return scale * t / (1 - t); }

inline constexpr double last_t = 1 - 1e-12;

/// Pivots of the convex model below this times W_nn are near the pole of r_n, and not divided by.
inline constexpr double near_pole = 1e-3;

SCREE_HD inline void set(double* r, double n, const Vec2& t) {
  r[0] = n;
  r[1] = t.x;
  r[2] = t.y;
}

/// Puts r on the cone's surface, off which the root leaves it by rounding.
SCREE_HD inline void set_on_surface(double mu, double* r, double n, Vec2 t) {
  const double size = length(t);
  const double factor = size > 0 ? mu * n / size : 0;
  set(r, n, {factor * t.x, factor * t.y});
}

/// The l with u_t = -l r_t of impulses that slip, from which Newton's method starts: when contacts
/// are visited again and again, those of the last visit are nearly right. @return 0 without slip
SCREE_HD inline double slip_of(const Block3& W, const double* b, const double* r) {
  const Vec2 t{r[1], r[2]};
  const Vec2 u{b[1] + W[3] * r[0] + W[4] * t.x + W[5] * t.y,
               b[2] + W[6] * r[0] + W[7] * t.x + W[8] * t.y};
  const double square = inner(t, t), l = -inner(u, t) / square;
  return square > 0 && l > 0 && std::isfinite(l) ? l : 0;
}

SCREE_HD inline void solve_exact(const Block3& W, const double* b, double mu, double* r) {
  if (b[0] >= 0) return set(r, 0, {});
  if (!(mu > 0)) return set(r, -b[0] / W[0], {});
  // u_n = 0 eliminates r_n.
  const Vec2 n_row{W[1], W[2]}, n_column{W[3], W[6]};
  const Shifted schur{W[4] - n_column.x * n_row.x / W[0], W[5] - n_column.x * n_row.y / W[0],
                      W[7] - n_column.y * n_row.x / W[0], W[8] - n_column.y * n_row.y / W[0]};
  const Vec2 c{n_column.x * b[0] / W[0] - b[1], n_column.y * b[0] / W[0] - b[2]};
  const auto normal = [&](const Vec2& t) { return -(b[0] + inner(n_row, t)) / W[0]; };
  double least = 0;
  if (!schur.definite()) least = 1e-12;  // a tangent that nothing resists: the least stiff slip
  const double scale = std::fmax(schur.trace(), 1e-12 * W[0]);
  const auto miss = [&](double t) {
    const Vec2 tangent = schur.solve(stretched(scale, t), c);
    return length(tangent) - mu * normal(tangent);
  };
  const double first = miss(least);
  if (!(first > 0)) {
    const Vec2 tangent = schur.solve(stretched(scale, least), c);
    if (std::isfinite(first)) set(r, normal(tangent), tangent);
    return;
  }
  // mu r_n / |r_t| - 1 is nearly linear in l.
  const auto relative = [&](double at) -> ValueAndSlope {
    const Vec2 tangent = schur.solve(at, c), fall = schur.solve(at, tangent);
    const double ratio = mu / length(tangent), n = normal(tangent);
    const double n_slope = inner(n_row, fall) / W[0];
    return {ratio * n - 1, ratio * (n_slope + n * inner(tangent, fall) / inner(tangent, tangent))};
  };
  double l = slip_of(W, b, r);
  if (l > 0 && schur.definite() && newton_root(relative, l)) {
    const Vec2 tangent = schur.solve(l, c);
    const double n = normal(tangent);
    if (n > 0) return set_on_surface(mu, r, n, tangent);
  }
  const double last = miss(last_t);
  if (!(last < 0)) return set(r, -b[0] / W[0], {});
  const Vec2 tangent =
      schur.solve(stretched(scale, bracketed_root(miss, least, first, last_t, last)), c);
  set_on_surface(mu, r, std::fmax(0.0, normal(tangent)), tangent);
}

/// A slipping contact of the convex model by its l, with u = (mu^2 l r_n, -l r_t):
/// r_n = -load / pivot and r_t = tangent(l, r_n).
struct ConvexSlip {
  double mu;
  double w_n, b_n;     ///< W_nn and b_n
  Vec2 cross, b_t;     ///< W_nt and b_t
  Shifted tangential;  ///< W_tt

  SCREE_HD double pivot(double l) const {
    return w_n - mu * mu * l - inner(cross, tangential.solve(l, cross));
  }
  SCREE_HD double load(double l) const { return b_n - inner(cross, tangential.solve(l, b_t)); }
  /// a times r_t, from a times r_n.
  SCREE_HD Vec2 tangent(double l, double n, double a = 1) const {
    return tangential.solve(l, {-cross.x * n - a * b_t.x, -cross.y * n - a * b_t.y});
  }
  /// mu r_n / |r_t| - 1, up to the sign of r_n, and its derivative: nearly linear in l, and finite
  /// at the pole of r_n.
  SCREE_HD ValueAndSlope relative(double l) const {
    const Vec2 p = tangential.solve(l, cross), q = tangential.solve(l, b_t);
    const double f = b_n - inner(cross, q), f_slope = inner(p, q);
    const double a = w_n - mu * mu * l - inner(cross, p), a_slope = inner(p, p) - mu * mu;
    const Vec2 t{f * p.x - a * q.x, f * p.y - a * q.y};  // -a r_t
    const Vec2 fall = tangential.solve(l, t);
    const Vec2 t_slope{f_slope * p.x - a_slope * q.x - fall.x,
                       f_slope * p.y - a_slope * q.y - fall.y};
    const double size = std::abs(f), ratio = mu / length(t);
    return {ratio * size - 1,
            ratio * ((f < 0 ? -f_slope : f_slope) - size * inner(t, t_slope) / inner(t, t))};
  }
};

SCREE_HD inline void solve_convex(const Block3& W, const double* b, double mu, double* r) {
  const Vec2 bt{b[1], b[2]};
  if (b[0] >= mu * length(bt)) return set(r, 0, {});
  if (!(mu > 0)) return set(r, -b[0] / W[0], {});
  const double off = 0.5 * (W[5] + W[7]);
  const ConvexSlip slip{
      mu, W[0], b[0], {0.5 * (W[1] + W[3]), 0.5 * (W[2] + W[6])}, bt, {W[4], off, off, W[8]}};
  const double scale = (W[0] + W[4] + W[8]) / (mu * mu);
  const double floor = slip.tangential.definite() ? 0 : 1e-12;
  const auto pivot = [&](double t) { return slip.pivot(stretched(scale, t)); };
  const auto load = [&](double t) { return slip.load(stretched(scale, t)); };
  const double at_floor = pivot(floor);
  if (at_floor > 0) {
    const double n = -load(floor) / at_floor;
    const Vec2 tangent = slip.tangent(stretched(scale, floor), n);
    if (length(tangent) <= mu * n) return set(r, n, tangent);
  }
  // Any l with positive r_n and |r_t| = mu r_n is the solution, as the problem is convex.
  double l = slip_of(W, b, r);
  if (l > 0 && newton_root([&](double at) { return slip.relative(at); }, l)) {
    const double a = slip.pivot(l), n = -slip.load(l) / a;
    if (n > 0 && std::abs(a) > near_pole * W[0])
      return set_on_surface(mu, r, n, slip.tangent(l, n));
  }
  // The pole of r_n; r_n is positive on the side where load and pivot have different signs.
  const double at_last = pivot(last_t);
  double pole = floor;
  if (at_floor > 0) pole = bracketed_root(pivot, floor, at_floor, last_t, at_last);
  // Multiplied by |pivot|, the miss |r_t| - mu r_n stays finite at the pole, where it is negative.
  const double sign = load(pole) < 0 ? 1 : -1;
  const auto miss = [&](double t) {
    const double n_times_a = -sign * load(t);
    return length(slip.tangent(stretched(scale, t), n_times_a, sign * pivot(t))) - mu * n_times_a;
  };
  // r_n = -load / pivot, but near the pole, where contacts that only slide sit,
  // that is 0 / 0. There |A n + B| = mu n has one positive root, as the cone holds the null
  // vector (1, A) of the pole.
  const auto set_slip = [&](double t) {
    const Vec2 A = slip.tangent(stretched(scale, t), 1, 0);
    const Vec2 B = slip.tangent(stretched(scale, t), 0);
    const double square = mu * mu - inner(A, A), half = inner(A, B);
    const double size = inner(B, B), a = pivot(t);
    double n = -load(t) / a;
    if (square > 0 && std::abs(a) < near_pole * W[0]) {
      const double root = std::sqrt(half * half + square * size);
      n = half > 0 ? (half + root) / square : size / (root - half);
    }
    set_on_surface(mu, r, std::fmax(0.0, n), {A.x * n + B.x, A.y * n + B.y});
  };
  const double other = sign > 0 ? floor : last_t;
  const double at_pole = miss(pole), at_other = miss(other);
  if (!(at_other > 0)) {  // the end itself, up to rounding: a contact that just begins to slip
    set_slip(other);
  } else if (at_pole < 0) {
    set_slip(bracketed_root(miss, other, at_other, pole, at_pole));
  } else {
    set_slip(pole);
  }
}

}  // namespace one_contact_parts

/// r with u = W r + b under the law of the model, for one contact.
///
/// Open and sticking contacts are told by their conditions. For a slipping one u_t = -l r_t with
/// one unknown l > 0, and r follows from l by a 3x3 system; the condition |r_t| = mu r_n changes
/// its sign over a known interval of l, so that a bracketing method always finds a root of it; when
/// the impulses that come in slip, Newton's method from their l is tried first. With
///   exact    u_n = 0:           l in (0, inf), where W_nn > 0 and the Schur complement of W_tt is
///                               positive definite; W may be unsymmetric
///   convex   u_n = mu^2 l r_n:  l on one side of the pole of r_n(l); W symmetric positive definite
/// A block whose W_nn is not positive cannot be solved: r is then left as it is.
/// @param W   block of the contact [1/kg]
/// @param b   velocity without this contact [3] [m/s]
/// @param r   in: any, best near the solution; out: impulse [3] [N s]. Where Coulomb's law has
///            several solutions, which one depends on what came in
///
/// Preclik, Iglberger and Ruede (Iterative rigid multibody dynamics, 2009) relax r_n first, project
/// the tangential impulse that prevents slip, and may then maximize dissipation over the disk of
/// radius mu r_n by Newton iterations. The least of r_t . u_t there has u_t = -l r_t too, with l
/// the multiplier of the disk and the same condition |r_t| = mu r_n; what differs is that r_n
/// follows l here, so that one visit ends at the solution of the contact and not at that for a
/// given r_n. And the bracket makes it safe: where a step of Newton leaves it, or is not quick,
/// bisection and inverse quadratic interpolation take over, which cannot fail. Source: own; the
/// slip condition as in Bonnefon and Daviet, "Quartic formulation of Coulomb 3D frictional
/// contact", INRIA 2011, but bracketed instead of expanded.
SCREE_HD inline void solve_one_contact(AssembledModel model, const Block3& W, const double* b,
                                       double mu, double* r) {
  if (!(W[0] > 0)) return;
  if (model == AssembledModel::exact) {
    one_contact_parts::solve_exact(W, b, mu, r);
  } else {
    one_contact_parts::solve_convex(W, b, mu, r);
  }
}

}  // namespace scree
