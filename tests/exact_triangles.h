#pragma once
// Whether two triangles touch, without rounding.

#include "tests/exact_number.h"

namespace scree::exact {

using Point = Vec3<double>;
using Triangle = std::array<Point, 3>;

/// Sign of (b - a) x (c - a) . (d - a): in floating point where its error cannot change it, else
/// with exact numbers.
inline int orientation(const Point& a, const Point& b, const Point& c, const Point& d) {
  const Point p = b - a, q = c - a, r = d - a;
  const double volume = dot(scree::cross(p, q), r);
  const auto size = [](const Point& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  };
  if (std::abs(volume) > 1e-14 * size(p) * size(q) * size(r) && std::abs(volume) > 1e-200)
    return volume > 0 ? 1 : -1;
  const auto x = vector(a);
  return dot(cross(vector(b) - x, vector(c) - x), vector(d) - x).sign();
}

/// Sign of the area of (a, b, c) in the plane of two axes.
inline int turn(const Point& a, const Point& b, const Point& c, int i, int j) {
  const auto apart = [](double s, double t) { return Number(s) - Number(t); };
  return (apart(b[i], a[i]) * apart(c[j], a[j]) - apart(b[j], a[j]) * apart(c[i], a[i])).sign();
}

/// Two axes in which the triangle has an area; the same one twice where it has none.
inline std::array<int, 2> plane_axes(const Triangle& t) {
  for (int k = 0; k < 3; ++k)
    if (turn(t[0], t[1], t[2], k, (k + 1) % 3) != 0) return {k, (k + 1) % 3};
  return {0, 0};
}

/// Whether a segment and a triangle of some area in one plane have a point in common.
inline bool segment_touches_in_plane(const Point& p, const Point& q, const Triangle& t) {
  const auto [i, j] = plane_axes(t);
  const int way = turn(t[0], t[1], t[2], i, j);
  const auto within = [&, i = i, j = j](const Point& x) {
    for (std::size_t k = 0; k < 3; ++k)
      if (turn(t[k], t[(k + 1) % 3], x, i, j) == -way) return false;
    return true;
  };
  if (within(p) || within(q)) return true;
  for (std::size_t k = 0; k < 3; ++k) {
    const Point &a = t[k], &b = t[(k + 1) % 3];
    const int ap = turn(p, q, a, i, j), bp = turn(p, q, b, i, j);
    const int pa = turn(a, b, p, i, j), qa = turn(a, b, q, i, j);
    if (ap * bp < 0 && pa * qa < 0) return true;
    const auto on = [&, i = i, j = j](const Point& u, const Point& v, const Point& x) {
      return std::min(u[i], v[i]) <= x[i] && x[i] <= std::max(u[i], v[i]) &&
             std::min(u[j], v[j]) <= x[j] && x[j] <= std::max(u[j], v[j]);
    };
    if ((ap == 0 && on(p, q, a)) || (bp == 0 && on(p, q, b)) || (pa == 0 && on(a, b, p)) ||
        (qa == 0 && on(a, b, q)))
      return true;
  }
  return false;
}

/// Whether a segment and a triangle of some area have a point in common.
inline bool segment_touches(const Point& p, const Point& q, const Triangle& t) {
  const int at_p = orientation(t[0], t[1], t[2], p), at_q = orientation(t[0], t[1], t[2], q);
  if (at_p * at_q > 0) return false;
  if (at_p == 0 && at_q == 0) return segment_touches_in_plane(p, q, t);
  int least = 0, most = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const int side = orientation(p, q, t[k], t[(k + 1) % 3]);
    least = std::min(least, side);
    most = std::max(most, side);
  }
  return least * most == 0;
}

/// Whether two triangles of some area have a point in common.
inline bool triangles_touch(const Triangle& a, const Triangle& b) {
  for (std::size_t k = 0; k < 3; ++k)
    if (segment_touches(a[k], a[(k + 1) % 3], b) || segment_touches(b[k], b[(k + 1) % 3], a))
      return true;
  return false;
}

}  // namespace scree::exact
