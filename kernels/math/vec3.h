#pragma once
// Three-component vectors, world frame unless a name says otherwise, and the contact-frame triple.

#include <cmath>

#include "kernels/types.h"

namespace scree {

/// A vector in world (or stated) axes. Twelve bytes in float: compact records move
/// the fewest bytes.
template <class Real>
struct Vec3 {
  Real x = 0;
  Real y = 0;
  Real z = 0;

  Vec3() = default;
  SCREE_HD constexpr Vec3(Real x_, Real y_, Real z_) : x(x_), y(y_), z(z_) {}
  template <class Other>
  SCREE_HD explicit constexpr Vec3(const Vec3<Other>& v)
      : x(static_cast<Real>(v.x)), y(static_cast<Real>(v.y)), z(static_cast<Real>(v.z)) {}

  SCREE_HD Real& operator[](int axis) { return axis == 0 ? x : (axis == 1 ? y : z); }
  SCREE_HD Real operator[](int axis) const { return axis == 0 ? x : (axis == 1 ? y : z); }

  SCREE_HD Vec3& operator+=(const Vec3& b) {
    x += b.x;
    y += b.y;
    z += b.z;
    return *this;
  }
  SCREE_HD Vec3& operator-=(const Vec3& b) {
    x -= b.x;
    y -= b.y;
    z -= b.z;
    return *this;
  }
  SCREE_HD Vec3& operator*=(Real s) {
    x *= s;
    y *= s;
    z *= s;
    return *this;
  }

  friend SCREE_HD Vec3 operator+(Vec3 a, const Vec3& b) { return a += b; }
  friend SCREE_HD Vec3 operator-(Vec3 a, const Vec3& b) { return a -= b; }
  friend SCREE_HD Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  friend SCREE_HD Vec3 operator*(Real s, Vec3 a) { return a *= s; }
  friend SCREE_HD Vec3 operator*(Vec3 a, Real s) { return a *= s; }
  friend SCREE_HD bool operator==(const Vec3& a, const Vec3& b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
  }
};

template <class Real>
SCREE_HD Real dot(const Vec3<Real>& a, const Vec3<Real>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class Real>
SCREE_HD Vec3<Real> cross(const Vec3<Real>& a, const Vec3<Real>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Componentwise product.
template <class Real>
SCREE_HD Vec3<Real> hadamard(const Vec3<Real>& a, const Vec3<Real>& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}

template <class Real>
SCREE_HD Real norm2(const Vec3<Real>& a) {
  return dot(a, a);
}

template <class Real>
SCREE_HD Real norm(const Vec3<Real>& a) {
  return std::sqrt(dot(a, a));
}

/// a / |a|; the fallback when |a| is zero.
template <class Real>
SCREE_HD Vec3<Real> normalized(const Vec3<Real>& a, const Vec3<Real>& fallback = {0, 0, 1}) {
  const Real length = norm(a);
  return length > Real(0) ? a * (Real(1) / length) : fallback;
}

template <class Real>
SCREE_HD bool is_finite(const Vec3<Real>& a) {
  // A sum of products with zero is NaN exactly when a component is infinite or NaN.
  return a.x * Real(0) + a.y * Real(0) + a.z * Real(0) == Real(0);
}

/// A unit vector orthogonal to the unit vector n.
template <class Real>
SCREE_HD Vec3<Real> any_orthogonal(const Vec3<Real>& n) {
  const Vec3<Real> axis = std::abs(n.x) < Real(0.6) ? Vec3<Real>{1, 0, 0} : Vec3<Real>{0, 1, 0};
  return normalized(cross(axis, n));
}

/// A vector in contact axes: normal first, then the two tangents.
/// A different type than Vec3 on purpose: world and contact components do not mix by accident.
template <class Real>
struct ContactVec {
  Real n = 0;
  Real t1 = 0;
  Real t2 = 0;
};

}  // namespace scree
