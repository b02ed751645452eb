#pragma once
// Unit quaternions (w, x, y, z), body frame to world frame.

#include "kernels/math/vec3.h"

namespace scree {

template <class Real>
struct Quat {
  Real w = 1;
  Real x = 0;
  Real y = 0;
  Real z = 0;

  Quat() = default;
  SCREE_HD constexpr Quat(Real w_, Real x_, Real y_, Real z_) : w(w_), x(x_), y(y_), z(z_) {}
  template <class Other>
  SCREE_HD explicit constexpr Quat(const Quat<Other>& q)
      : w(static_cast<Real>(q.w)),
        x(static_cast<Real>(q.x)),
        y(static_cast<Real>(q.y)),
        z(static_cast<Real>(q.z)) {}

  SCREE_HD Vec3<Real> vec() const { return {x, y, z}; }
};

template <class Real>
SCREE_HD Quat<Real> operator*(const Quat<Real>& a, const Quat<Real>& b) {
  return {
      a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
      a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

template <class Real>
SCREE_HD Quat<Real> conjugate(const Quat<Real>& q) {
  return {q.w, -q.x, -q.y, -q.z};
}

template <class Real>
SCREE_HD Quat<Real> normalized(const Quat<Real>& q) {
  const Real s = Real(1) / std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return {q.w * s, q.x * s, q.y * s, q.z * s};
}

/// Body components to world components: R(q) v.
template <class Real>
SCREE_HD Vec3<Real> rotate(const Quat<Real>& q, const Vec3<Real>& v) {
  const Vec3<Real> t = Real(2) * cross(q.vec(), v);
  return v + q.w * t + cross(q.vec(), t);
}

/// World components to body components: R(q)^T v.
template <class Real>
SCREE_HD Vec3<Real> rotate_back(const Quat<Real>& q, const Vec3<Real>& v) {
  return rotate(conjugate(q), v);
}

/// Exponential map: the rotation by |w| radians about w, exactly a unit quaternion up to rounding.
/// @param w  rotation vector [rad], world frame
template <class Real>
SCREE_HD Quat<Real> exp_map(const Vec3<Real>& w) {
  const Real angle2 = norm2(w);
  // sin(a/2)/a by its series below the angle where the closed form loses digits.
  const Real angle = std::sqrt(angle2);
  const Real s = angle < Real(1e-3) ? Real(0.5) - angle2 / Real(48) : std::sin(angle / 2) / angle;
  return normalized(Quat<Real>{std::cos(angle / 2), s * w.x, s * w.y, s * w.z});
}

/// Rotation vector of a unit quaternion [rad], of an angle in [0, pi].
template <class Real>
SCREE_HD Vec3<Real> log_map(Quat<Real> q) {
  if (q.w < Real(0)) q = {-q.w, -q.x, -q.y, -q.z};
  const Real s = norm(q.vec());
  const Real angle = Real(2) * std::atan2(s, q.w);
  return s > Real(0) ? (angle / s) * q.vec() : Vec3<Real>{};
}

/// q after a turn by a rotation vector, exp_map(w) q. What the turn changes is added to q at once: products with a cosine just
/// below one are rounded to the same side for thousands of steps, and a steady spin would drift by 1e-8 of itself a step in float.
/// @param w  [rad], world frame
template <class Real>
SCREE_HD Quat<Real> turned_by(const Vec3<Real>& w, const Quat<Real>& q) {
  Quat<Real> turn = exp_map(w);
  const Real sine2 = norm2(turn.vec());
  turn.w = turn.w > Real(0) ? -sine2 / (Real(1) + turn.w) : turn.w - Real(1);
  const Quat<Real> change = turn * q;
  return normalized(Quat<Real>{q.w + change.w, q.x + change.x, q.y + change.y, q.z + change.z});
}

}  // namespace scree
