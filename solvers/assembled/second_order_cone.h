#pragma once
// The algebra of the cone Q = {(x0, x1, x2) : |(x1, x2)| <= x0} that interior-point methods need.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "solvers/assembled/assembled_problem.h"

namespace scree {

using Cone3 = std::array<double, 3>;

/// x0^2 - |(x1, x2)|^2, as a product that keeps its digits near the surface.
inline double cone_determinant(const Cone3& x) {
  const double t = std::sqrt(x[1] * x[1] + x[2] * x[2]);
  return (x[0] - t) * (x[0] + t);
}

/// Jordan product (x.y, x0 y_t + y0 x_t).
inline Cone3 jordan(const Cone3& x, const Cone3& y) {
  return {x[0] * y[0] + x[1] * y[1] + x[2] * y[2], x[0] * y[1] + y[0] * x[1],
          x[0] * y[2] + y[0] * x[2]};
}

/// y with jordan(x, y) = b, for x inside Q.
inline Cone3 jordan_divide(const Cone3& x, const Cone3& b) {
  const double cross = x[1] * b[1] + x[2] * b[2];
  const double y0 = (x[0] * b[0] - cross) / cone_determinant(x);
  return {y0, (b[1] - y0 * x[1]) / x[0], (b[2] - y0 * x[2]) / x[0]};
}

/// Largest a such that x + a d is in Q, for x inside it; infinity when there is none.
inline double step_to_surface(const Cone3& x, const Cone3& d) {
  const double a = d[0] * d[0] - d[1] * d[1] - d[2] * d[2];
  const double b = x[0] * d[0] - x[1] * d[1] - x[2] * d[2];
  const double c = std::max(cone_determinant(x), 0.0);
  const double none = std::numeric_limits<double>::infinity();
  // First positive root of a s^2 + 2 b s + c. There is one unless d points into the cone; a
  // negative discriminant is rounding, of a d that points at the apex.
  if (b >= 0 && a >= 0) return none;
  const double root = std::sqrt(std::max(b * b - a * c, 0.0));
  return b < 0 ? c / (root - b) : (b + root) / -a;
}

/// The symmetric P with P s = P^-1 x = l, for x and s inside Q: P = b (2 v v^T - J),
/// J = diag(1, -1, -1).
/// Source: Nesterov and Todd, Math. Oper. Res. 22, 1997; written as a hyperbolic reflection as in
/// Andersen, Roos and Terlaky, Math. Program. 95, 2003.
class NesterovTodd {
 public:
  NesterovTodd(const Cone3& x, const Cone3& s) {
    const double dx = std::sqrt(cone_determinant(x)), ds = std::sqrt(cone_determinant(s));
    size_ = std::sqrt(dx / ds);
    const double cosine = (x[0] * s[0] + x[1] * s[1] + x[2] * s[2]) / (dx * ds);
    const double g = std::sqrt(0.5 * (1 + cosine));
    w_ = {(x[0] / dx + s[0] / ds) / (2 * g), (x[1] / dx - s[1] / ds) / (2 * g),
          (x[2] / dx - s[2] / ds) / (2 * g)};
    const double h = std::sqrt(2 * (w_[0] + 1));
    v_ = {(w_[0] + 1) / h, w_[1] / h, w_[2] / h};
  }

  /// P y
  Cone3 apply(const Cone3& y) const {
    const double a = 2 * (v_[0] * y[0] + v_[1] * y[1] + v_[2] * y[2]);
    return {size_ * (a * v_[0] - y[0]), size_ * (a * v_[1] + y[1]), size_ * (a * v_[2] + y[2])};
  }
  /// P^-1 y
  Cone3 apply_inverse(const Cone3& y) const {
    const double a = 2 * (v_[0] * y[0] - v_[1] * y[1] - v_[2] * y[2]);
    return {(a * v_[0] - y[0]) / size_, (y[1] - a * v_[1]) / size_, (y[2] - a * v_[2]) / size_};
  }
  /// P^-2, as a matrix
  Block3 inverse_square() const {
    const Cone3 j{w_[0], -w_[1], -w_[2]};
    Block3 m;
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k)
        m[3 * i + k] = (2 * j[i] * j[k] - (i != k ? 0 : i == 0 ? 1 : -1)) / (size_ * size_);
    return m;
  }

 private:
  double size_;
  Cone3 w_, v_;
};

}  // namespace scree
