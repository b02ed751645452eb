#pragma once
// Symmetric 3x3 matrices: world-frame inertia and its inverse.

#include <cmath>

#include "kernels/math/quat.h"

namespace scree {

template <class Real>
struct Sym3 {
  Real xx = 0, yy = 0, zz = 0;
  Real xy = 0, xz = 0, yz = 0;

  friend SCREE_HD Vec3<Real> operator*(const Sym3& m, const Vec3<Real>& v) {
    return {m.xx * v.x + m.xy * v.y + m.xz * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
            m.xz * v.x + m.yz * v.y + m.zz * v.z};
  }
  friend SCREE_HD Sym3 operator*(Real s, const Sym3& m) {
    Sym3 r;
    r.xx = s * m.xx, r.yy = s * m.yy, r.zz = s * m.zz;
    r.xy = s * m.xy, r.xz = s * m.xz, r.yz = s * m.yz;
    return r;
  }
  SCREE_HD Real trace() const { return xx + yy + zz; }
};

/// R(q) diag(d) R(q)^T.
template <class Real>
SCREE_HD Sym3<Real> rotated_diagonal(const Quat<Real>& q, const Vec3<Real>& d) {
  const Vec3<Real> a = rotate(q, Vec3<Real>{1, 0, 0});
  const Vec3<Real> b = rotate(q, Vec3<Real>{0, 1, 0});
  const Vec3<Real> c = rotate(q, Vec3<Real>{0, 0, 1});
  Sym3<Real> m;
  m.xx = d.x * a.x * a.x + d.y * b.x * b.x + d.z * c.x * c.x;
  m.yy = d.x * a.y * a.y + d.y * b.y * b.y + d.z * c.y * c.y;
  m.zz = d.x * a.z * a.z + d.y * b.z * b.z + d.z * c.z * c.z;
  m.xy = d.x * a.x * a.y + d.y * b.x * b.y + d.z * c.x * c.y;
  m.xz = d.x * a.x * a.z + d.y * b.x * b.z + d.z * c.x * c.z;
  m.yz = d.x * a.y * a.z + d.y * b.y * b.z + d.z * c.y * c.z;
  return m;
}

/// A power of two whose product with x > 0 is near one; between 2^-100 and 2^100.
template <class Real>
SCREE_HD Real scale_to_one(Real x) {
  int exponent = 0;
  std::frexp(x, &exponent);
  return std::ldexp(Real(1), exponent < -100 ? 100 : exponent > 100 ? -100 : -exponent);
}

/// Inverse of a symmetric positive definite matrix restricted to the free axes. Works at a scale
/// near one: in float the determinant of the inertia of a grain below a millimeter underflows.
/// @param free  bit k set: axis k may move; rows and columns of locked axes are zero in the result,
///              which is the inverse inertia of a body whose locked rates stay zero.
template <class Real>
SCREE_HD Sym3<Real> inverse_on_axes(const Sym3<Real>& moments, unsigned free) {
  const Real scale = scale_to_one(moments.trace());  // a power of two: no other rounding
  const Sym3<Real> m = scale * moments;
  Sym3<Real> r;
  const bool fx = (free & 1u) != 0, fy = (free & 2u) != 0, fz = (free & 4u) != 0;
  if (fx && fy && fz) {
    const Real cxx = m.yy * m.zz - m.yz * m.yz;
    const Real cxy = m.xz * m.yz - m.xy * m.zz;
    const Real cxz = m.xy * m.yz - m.xz * m.yy;
    const Real s = Real(1) / (m.xx * cxx + m.xy * cxy + m.xz * cxz);
    r.xx = cxx * s;
    r.xy = cxy * s;
    r.xz = cxz * s;
    r.yy = (m.xx * m.zz - m.xz * m.xz) * s;
    r.yz = (m.xy * m.xz - m.xx * m.yz) * s;
    r.zz = (m.xx * m.yy - m.xy * m.xy) * s;
    return scale * r;
  }
  // Two free axes: invert the 2x2 block; one: a reciprocal; none: zero.
  if (fx && fy) {
    const Real s = Real(1) / (m.xx * m.yy - m.xy * m.xy);
    r.xx = m.yy * s, r.yy = m.xx * s, r.xy = -m.xy * s;
  } else if (fx && fz) {
    const Real s = Real(1) / (m.xx * m.zz - m.xz * m.xz);
    r.xx = m.zz * s, r.zz = m.xx * s, r.xz = -m.xz * s;
  } else if (fy && fz) {
    const Real s = Real(1) / (m.yy * m.zz - m.yz * m.yz);
    r.yy = m.zz * s, r.zz = m.yy * s, r.yz = -m.yz * s;
  } else if (fx) {
    r.xx = Real(1) / m.xx;
  } else if (fy) {
    r.yy = Real(1) / m.yy;
  } else if (fz) {
    r.zz = Real(1) / m.zz;
  }
  return scale * r;
}

}  // namespace scree
