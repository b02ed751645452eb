#pragma once
// When a falling sphere first touches something. All of it is a search from before: no root is
// passed, however fast the sphere is.

#include "kernels/variational/flight.h"

namespace scree {

/// First s >= 0 at which d + v s + a s^2 / 2 falls to zero from above; kNever.
/// @param d  >= 0; zero: it is there, and leaves or comes by its rate
SCREE_HD inline double time_to_zero(double d, double v, double a) {
  if (!(d > 0)) {
    if (v < 0) return 0;
    return a < 0 ? -2 * v / a : kNever;
  }
  const double square = v * v - 2 * a * d;
  if (!(square >= 0)) return kNever;
  const double root = std::sqrt(square);
  if (v < 0) return 2 * d / (root - v);
  return a < 0 ? (v + root) / -a : kNever;
}

/// First time at which two spheres touch that fall alike, so that they move straight past each
/// other; kNever.
/// @param d    from one center to the other [m]
/// @param u    rate of d [m/s]
/// @param sum  of the radii [m]
SCREE_HD inline double time_of_spheres(const Vec3<double>& d, const Vec3<double>& u, double sum) {
  const double b = dot(d, u);
  if (!(b < 0)) return kNever;
  const double distance = norm(d);
  const double c = (distance - sum) * (distance + sum);
  if (!(c > 0)) return 0;
  // b^2 - u^2 c, from how far the ways pass each other: nothing large cancels for spheres far apart.
  const double square = norm2(u) * sum * sum - norm2(cross(d, u));
  return square >= 0 ? c / (std::sqrt(square) - b) : kNever;
}

/// Tangent planes that a search takes at most. A head-on impact takes five, each step of one that
/// grazes halves what is left.
inline constexpr int kMostTangents = 100;

/// First s in [0, horizon] at which a falling sphere touches a convex body and approaches it; kNever.
/// A convex body lies behind the plane through its point nearest to the center, across the line
/// between them, so the sphere cannot touch the body before it touches that plane: Newton's method
/// on the distance, with the fall in it, which never passes the first touch.
/// @param touch  gap that counts as none, above what rounding leaves [m]
/// @param gap    gap(x, n): gap of the sphere at x; n: out, unit, from the body to x
template <class Gap>
SCREE_HD double time_to_touch(const Flight& f, double horizon, double touch, Gap&& gap) {
  double s = 0;
  for (int k = 0; k < kMostTangents; ++k) {
    Vec3<double> n;
    const double d = gap(f.place(s), n);
    const double rate = dot(f.velocity(s), n);
    if (d <= touch && rate < 0) return s;
    const double more = time_to_zero(d > touch ? d : 0, rate, dot(f.g, n));
    if (!(s + more <= horizon)) return kNever;
    if (s + more == s) return s;
    s += more;
  }
  return s;
}

/// Gaps below this are none, by what rounding leaves of coordinates of that size.
/// @param size  of coordinates and lengths [m]
SCREE_HD inline double touching_gap(double size) { return 1e-15 * size; }
/// Contacts with walls whose gaps are below this at an impact are at the same time.
SCREE_HD inline double simultaneous_gap(double size) { return 1e-13 * size; }

}  // namespace scree
