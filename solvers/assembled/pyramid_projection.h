#pragma once
// Projections on a friction pyramid and its tangent cones, as a set in the space of impulses.

#include <cmath>
#include <numbers>

#include "kernels/types.h"

namespace scree {

/// One face of {(n, t) : t in the polygon of radius mu n}, friction_pyramid.h, with the axes
/// (n, m, s) in which it is symmetric: m from the axis of the pyramid to the middle of
/// the face, s along it. By that symmetry the nearest point of the pyramid lies in the same
/// sector as the point.
struct PyramidFace {
  double cosine, sine;  ///< of the angle of m
  double apothem;       ///< m on the face for n = 1
  double half_side;     ///< largest |s| on the face for n = 1

  /// The face whose sector a tangential vector lies in.
  SCREE_HD static PyramidFace at(int sides, double mu, const double* x) {
    const double half = std::numbers::pi / sides;
    return at_angle(half, mu, half * (2 * std::floor(std::atan2(x[2], x[1]) / (2 * half)) + 1));
  }
  /// That of the sector beside it, on the side of s.
  SCREE_HD PyramidFace beside(int sides, double mu, double s) const {
    const double half = std::numbers::pi / sides;
    return at_angle(half, mu, std::atan2(sine, cosine) + (s < 0 ? -2 * half : 2 * half));
  }
  SCREE_HD static PyramidFace at_angle(double half, double mu, double angle) {
    return {std::cos(angle), std::sin(angle), mu * std::cos(half), mu * std::sin(half)};
  }

  SCREE_HD double middle(const double* x) const { return cosine * x[1] + sine * x[2]; }
  SCREE_HD double along(const double* x) const { return cosine * x[2] - sine * x[1]; }
  /// How far a point is outside of the face's plane, in units of m.
  SCREE_HD double beyond(const double* x) const { return middle(x) - apothem * x[0]; }
  /// The nearest point of the plane.
  SCREE_HD void onto(const double* x, double* nearest) const {
    const double back = beyond(x) / (1 + apothem * apothem);
    nearest[0] = x[0] + apothem * back;
    nearest[1] = x[1] - cosine * back;
    nearest[2] = x[2] - sine * back;
  }
  /// Projects on the line through the apex and the corner on the side of s, in place.
  /// @return the factor of (1, corner)
  SCREE_HD double onto_edge(double s, double* x) const {
    const double side = std::copysign(half_side, s);
    const double t1 = cosine * apothem - sine * side, t2 = sine * apothem + cosine * side;
    const double l = (x[0] + t1 * x[1] + t2 * x[2]) / (1 + t1 * t1 + t2 * t2);
    x[0] = l;
    x[1] = l * t1;
    x[2] = l * t2;
    return l;
  }
};

/// Euclidean projection on {(n, t) : t in the polygon of radius mu n}, friction_pyramid.h,
/// in place.
/// @param sides  even, 4 or more
/// @param x      [3]
SCREE_HD inline void project_on_pyramid(int sides, double mu, double* x) {
  const PyramidFace face = PyramidFace::at(sides, mu, x);
  if (face.beyond(x) <= 0 && x[0] >= 0) return;
  double plane[3];
  face.onto(x, plane);
  const double s = face.along(x);
  if (plane[0] > 0 && std::abs(s) <= face.half_side * plane[0]) {
    for (int i = 0; i < 3; ++i) x[i] = plane[i];
  } else if (!(face.onto_edge(s, x) > 0)) {
    x[0] = x[1] = x[2] = 0;
  }
}

/// Euclidean projection of v on the tangent cone of the pyramid at one of its points x, in place.
/// Closer to a face than 1e-10 mu n is on it.
SCREE_HD inline void project_on_pyramid_tangent(int sides, double mu, const double* x, double* v) {
  constexpr double on_face = 1e-10;
  if (!(x[0] > 0)) return project_on_pyramid(sides, mu, v);  // the apex
  if (!(mu > 0)) {                                           // without friction it is a ray
    v[1] = v[2] = 0;
    return;
  }
  const double close = on_face * mu * x[0];
  const PyramidFace face = PyramidFace::at(sides, mu, x);
  if (face.beyond(x) < -close) return;
  const double s = face.along(x);
  const bool on_edge = std::abs(s) >= face.half_side * x[0] - close;
  const PyramidFace other = on_edge ? face.beside(sides, mu, s) : face;
  const bool out = face.beyond(v) > 0, out_of_other = on_edge && other.beyond(v) > 0;
  if (!out && !out_of_other) return;
  double plane[3];
  if (out) face.onto(v, plane);
  bool nearest = out && (!on_edge || other.beyond(plane) <= 0);
  if (!nearest && out_of_other) {
    other.onto(v, plane);
    nearest = face.beyond(plane) <= 0;
  }
  if (!nearest) {
    face.onto_edge(s, v);
    return;
  }
  for (int i = 0; i < 3; ++i) v[i] = plane[i];
}

}  // namespace scree
