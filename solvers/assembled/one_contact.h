#pragma once
// Exact solutions of problems with one contact: what Gauss-Seidel methods do at every contact, on
// the host and on a device.

#include <cmath>

#include "solvers/assembled/assembled_measures.h"
#include "solvers/assembled/bracketed_root.h"

namespace scree {
namespace one_contact_parts {

struct Vec2 {
  double x = 0, y = 0;
};

SCREE_HD inline double length(const Vec2& v) { return std::sqrt(v.x * v.x + v.y * v.y); }

/// (A + l I)^-1 v for A = {a, b; c, d}.
struct Shifted {
  double a, b, c, d;
  SCREE_HD Vec2 solve(double l, const Vec2& v) const {
    const double p = a + l, s = d + l, det = p * s - b * c;
    return {(s * v.x - b * v.y) / det, (p * v.y - c * v.x) / det};
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

SCREE_HD inline void solve_exact(const Block3& W, const double* b, double mu, double* r) {
  if (b[0] >= 0) return set(r, 0, {});
  if (!(mu > 0)) return set(r, -b[0] / W[0], {});
  // u_n = 0 eliminates r_n.
  const Vec2 n_row{W[1], W[2]}, n_column{W[3], W[6]};
  const Shifted schur{W[4] - n_column.x * n_row.x / W[0], W[5] - n_column.x * n_row.y / W[0],
                      W[7] - n_column.y * n_row.x / W[0], W[8] - n_column.y * n_row.y / W[0]};
  const Vec2 c{n_column.x * b[0] / W[0] - b[1], n_column.y * b[0] / W[0] - b[2]};
  const auto normal = [&](const Vec2& t) { return -(b[0] + n_row.x * t.x + n_row.y * t.y) / W[0]; };
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
  const double last = miss(last_t);
  if (!(last < 0)) return set(r, -b[0] / W[0], {});
  const Vec2 tangent =
      schur.solve(stretched(scale, bracketed_root(miss, least, first, last_t, last)), c);
  set_on_surface(mu, r, std::fmax(0.0, normal(tangent)), tangent);
}

SCREE_HD inline void solve_convex(const Block3& W, const double* b, double mu, double* r) {
  const Vec2 bt{b[1], b[2]};
  if (b[0] >= mu * length(bt)) return set(r, 0, {});
  if (!(mu > 0)) return set(r, -b[0] / W[0], {});
  const Vec2 cross{0.5 * (W[1] + W[3]), 0.5 * (W[2] + W[6])};
  const double off = 0.5 * (W[5] + W[7]);
  const Shifted tangential{W[4], off, off, W[8]};
  const double scale = (W[0] + W[4] + W[8]) / (mu * mu);
  const double floor = tangential.definite() ? 0 : 1e-12;
  // (W_nn - mu^2 l - cross.(W_tt + l)^-1 cross) r_n = -(b_n - cross.(W_tt + l)^-1 b_t)
  const auto pivot = [&](double t) {
    const double l = stretched(scale, t);
    const Vec2 s = tangential.solve(l, cross);
    return W[0] - mu * mu * l - (cross.x * s.x + cross.y * s.y);
  };
  const auto load = [&](double t) {
    const Vec2 s = tangential.solve(stretched(scale, t), bt);
    return b[0] - (cross.x * s.x + cross.y * s.y);
  };
  const double at_floor = pivot(floor);
  if (at_floor > 0) {
    const double n = -load(floor) / at_floor;
    const Vec2 tangent =
        tangential.solve(stretched(scale, floor), {-cross.x * n - bt.x, -cross.y * n - bt.y});
    if (length(tangent) <= mu * n) return set(r, n, tangent);
  }
  // The pole of r_n; r_n is positive on the side where load and pivot have different signs.
  const double at_last = pivot(last_t);
  double pole = floor;
  if (at_floor > 0) pole = bracketed_root(pivot, floor, at_floor, last_t, at_last);
  // Multiplied by |pivot|, the miss |r_t| - mu r_n stays finite at the pole, where it is negative.
  const double sign = load(pole) < 0 ? 1 : -1;
  const auto miss = [&](double t) {
    const double a = sign * pivot(t), n_times_a = -sign * load(t);
    const double l = stretched(scale, t);
    const Vec2 times_a =
        tangential.solve(l, {-cross.x * n_times_a - a * bt.x, -cross.y * n_times_a - a * bt.y});
    return length(times_a) - mu * n_times_a;
  };
  // r_n = -load / pivot, but near the pole, where contacts that only slide sit, that is 0 / 0.
  // There |A n + B| = mu n has one positive root, as the cone holds the null vector (1, A) of the
  // pole.
  const auto set_slip = [&](double t) {
    const Vec2 A = tangential.solve(stretched(scale, t), {-cross.x, -cross.y});
    const Vec2 B = tangential.solve(stretched(scale, t), {-bt.x, -bt.y});
    const double square = mu * mu - A.x * A.x - A.y * A.y, half = A.x * B.x + A.y * B.y;
    const double size = B.x * B.x + B.y * B.y, a = pivot(t);
    double n = -load(t) / a;
    if (square > 0 && std::abs(a) < 1e-3 * W[0]) {
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
/// its sign over a known interval of l, so that a bracketing method always finds a root of it. With
///   exact    u_n = 0:           l in (0, inf), where W_nn > 0 and the Schur complement of W_tt is
///                               positive definite; W may be unsymmetric
///   convex   u_n = mu^2 l r_n:  l on one side of the pole of r_n(l); W symmetric positive definite
/// A block whose W_nn is not positive cannot be solved: r is then left as it is.
/// @param W   block of the contact [1/kg]
/// @param b   velocity without this contact [3] [m/s]
/// @param r   in: any; out: impulse [3] [N s]
/// Source: own; the slip condition as in Bonnefon and Daviet, "Quartic formulation of Coulomb 3D
/// frictional contact", INRIA 2011, but bracketed instead of expanded.
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
