#include "solvers/assembled/pyramid_projection.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scree {
namespace {

constexpr double on_face = 1e-10;

/// One face, with the axes (n, m, s) in which it is symmetric: m from the axis of the pyramid to
/// the middle of the face, s along it. By that symmetry the nearest point of the pyramid lies in
/// the same sector as the point.
struct Face {
  double cosine, sine;  ///< of the angle of m
  double apothem;       ///< m on the face for n = 1
  double half_side;     ///< largest |s| on the face for n = 1

  /// The face in whose sector a tangential vector lies.
  Face(int sides, double mu, const double* x) {
    const double half = std::numbers::pi / sides;
    const double angle = half * (2 * std::floor(std::atan2(x[2], x[1]) / (2 * half)) + 1);
    set(half, mu, angle);
  }
  /// The same for the sector beside it, on the side of s.
  Face(int sides, double mu, const Face& beside, double s) {
    const double half = std::numbers::pi / sides;
    set(half, mu, std::atan2(beside.sine, beside.cosine) + (s < 0 ? -2 * half : 2 * half));
  }

  double middle(const double* x) const { return cosine * x[1] + sine * x[2]; }
  double along(const double* x) const { return cosine * x[2] - sine * x[1]; }
  /// How far a point is outside of the face's plane, in units of m.
  double beyond(const double* x) const { return middle(x) - apothem * x[0]; }
  /// Projects on the plane.
  void onto(double* x) const {
    const double back = beyond(x) / (1 + apothem * apothem);
    x[0] += apothem * back;
    x[1] -= cosine * back;
    x[2] -= sine * back;
  }
  /// Projects on the line through the apex and the corner on the side of s.
  /// @return the factor of (1, corner)
  double onto_edge(double s, double* x) const {
    const double side = std::copysign(half_side, s);
    const double t1 = cosine * apothem - sine * side, t2 = sine * apothem + cosine * side;
    const double l = (x[0] + t1 * x[1] + t2 * x[2]) / (1 + t1 * t1 + t2 * t2);
    x[0] = l;
    x[1] = l * t1;
    x[2] = l * t2;
    return l;
  }

 private:
  void set(double half, double mu, double angle) {
    cosine = std::cos(angle);
    sine = std::sin(angle);
    apothem = mu * std::cos(half);
    half_side = mu * std::sin(half);
  }
};

}  // namespace

void project_on_pyramid(int sides, double mu, double* x) {
  const Face face(sides, mu, x);
  if (face.beyond(x) <= 0 && x[0] >= 0) return;
  double plane[3] = {x[0], x[1], x[2]};
  face.onto(plane);
  const double s = face.along(x);
  if (plane[0] > 0 && std::abs(s) <= face.half_side * plane[0]) {
    std::copy(plane, plane + 3, x);
  } else if (!(face.onto_edge(s, x) > 0)) {
    x[0] = x[1] = x[2] = 0;
  }
}

void project_on_pyramid_tangent(int sides, double mu, const double* x, double* v) {
  if (!(x[0] > 0)) return project_on_pyramid(sides, mu, v);  // the apex
  if (!(mu > 0)) {                                           // without friction it is a ray
    v[1] = v[2] = 0;
    return;
  }
  const double close = on_face * mu * x[0];
  const Face face(sides, mu, x);
  if (face.beyond(x) < -close) return;
  const double s = face.along(x);
  const bool on_edge = std::abs(s) >= face.half_side * x[0] - close;
  const Face other(sides, mu, face, s);
  const bool out = face.beyond(v) > 0, out_of_other = on_edge && other.beyond(v) > 0;
  if (!out && !out_of_other) return;
  double plane[3] = {v[0], v[1], v[2]};
  if (out) {
    face.onto(plane);
    if (!on_edge || other.beyond(plane) <= 0) return void(std::copy(plane, plane + 3, v));
    std::copy(v, v + 3, plane);
  }
  if (out_of_other) {
    other.onto(plane);
    if (face.beyond(plane) <= 0) return void(std::copy(plane, plane + 3, v));
  }
  face.onto_edge(s, v);
}

}  // namespace scree
