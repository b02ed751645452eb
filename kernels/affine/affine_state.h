#pragma once
// Twelve coordinates of an affine body, and its mass. A point fixed in the body is at
//   x(X) = p + X_1 a_1 + X_2 a_2 + X_3 a_3
// with X its coordinates about the center of mass, p the center and a_k the columns of A. So a body
// is four nodes, p and the columns, with weights (1, X): whatever acts on points is carried to them
// by these four numbers, and matrices are Kronecker products of (1, X) (1, Y)^T and 3x3 blocks.
// docs/theory.md, "Affine bodies".

#include "kernels/math/sym3.h"
#include "kernels/math/vec3.h"
#include "shapes/polyhedron.h"

namespace scree::affine {

/// Threads of a block of programs of which there are few items that take long: on more multiprocessors they wait less for each
/// other.
inline constexpr int kWaitingThreads = 64;

/// Part of a coordinate that rounding changes where it is summed up from those of a body.
inline constexpr double kPlaceRounding = 4e-16;

/// Position, velocity, force or step of an affine body.
struct AffineVec {
  Vec3d node[4];  ///< center of mass, then the columns of A

  SCREE_HD AffineVec& operator+=(const AffineVec& o) {
    for (int k = 0; k < 4; ++k) node[k] += o.node[k];
    return *this;
  }
  friend SCREE_HD AffineVec operator+(AffineVec a, const AffineVec& b) { return a += b; }
  friend SCREE_HD AffineVec operator*(double s, AffineVec a) {
    for (Vec3d& n : a.node) n *= s;
    return a;
  }
  friend SCREE_HD AffineVec operator-(const AffineVec& a, const AffineVec& b) {
    return a + (-1.0) * b;
  }
};

/// One of the twelve numbers.
SCREE_HD inline double entry_of(const AffineVec& v, int i) { return v.node[i / 3][i % 3]; }

SCREE_HD inline double dot(const AffineVec& a, const AffineVec& b) {
  double sum = 0;
  for (int k = 0; k < 4; ++k) sum += dot(a.node[k], b.node[k]);
  return sum;
}

/// Weight of a node at a point of the body: 1, X_1, X_2, X_3.
SCREE_HD inline double node_weight(const Vec3d& rest, int node) {
  return node == 0 ? 1.0 : rest[node - 1];
}

/// Column k of the cofactors of A, which are J A^-T. @param k  1 to 3, as of nodes
SCREE_HD inline Vec3d cofactor(const AffineVec& q, int k) {
  return cross(q.node[k % 3 + 1], q.node[(k + 1) % 3 + 1]);
}
/// J, the determinant of A.
SCREE_HD inline double determinant(const AffineVec& q) { return dot(q.node[1], cofactor(q, 1)); }

/// Where a point of the body is, or how it moves. @param rest  its coordinates X [m]
SCREE_HD inline Vec3d point_of(const AffineVec& q, const Vec3d& rest) {
  return q.node[0] + rest.x * q.node[1] + rest.y * q.node[2] + rest.z * q.node[3];
}

/// Adds a force at a point of the body: f += J^T force.
SCREE_HD inline void add_force(AffineVec& f, const Vec3d& rest, const Vec3d& force) {
  for (int k = 0; k < 4; ++k) f.node[k] += node_weight(rest, k) * force;
}

/// Inverse of the mass of a body: how it gives way. Zeros of one that cannot move.
struct Mobility {
  double center = 0;     ///< [1/kg]
  Sym3<double> columns;  ///< S^-1 [1/(kg m^2)]

  friend SCREE_HD Mobility operator*(double s, const Mobility& m) {
    return {s * m.center, s * m.columns};
  }
  /// f M^-1 f of forces w_i n on points X_i, n of length one. @param sum  of w_i  @param moment  sum of w_i X_i
  SCREE_HD double squared(double sum, const Vec3d& moment) const {
    return center * sum * sum + dot(moment, columns * moment);
  }
};

/// Mass of a body about its center of mass. The kinetic energy is
/// 1/2 (mass |p'|^2 + sum of S_kl a_k'.a_l').
struct AffineMass {
  double mass = 0;      ///< [kg]
  Sym3<double> second;  ///< S, the integral of density X X^T [kg m^2], positive definite

  /// M q.
  SCREE_HD AffineVec product(const AffineVec& q) const { return applied(mass, second, q); }
  /// M^-1 f.
  SCREE_HD AffineVec solve(const AffineVec& f) const {
    const Mobility inverse = mobility();
    return applied(inverse.center, inverse.columns, f);
  }
  SCREE_HD Mobility mobility() const { return {1 / mass, inverse_on_axes(second, 7u)}; }
  /// Moments of inertia tr(S) I - S [kg m^2], of the body as a rigid one.
  SCREE_HD Sym3<double> inertia() const {
    const double trace = second.trace();
    Sym3<double> r = -1.0 * second;
    r.xx += trace, r.yy += trace, r.zz += trace;
    return r;
  }

 private:
  static SCREE_HD AffineVec applied(double m, const Sym3<double>& s, const AffineVec& q) {
    AffineVec r;
    r.node[0] = m * q.node[0];
    r.node[1] = s.xx * q.node[1] + s.xy * q.node[2] + s.xz * q.node[3];
    r.node[2] = s.xy * q.node[1] + s.yy * q.node[2] + s.yz * q.node[3];
    r.node[3] = s.xz * q.node[1] + s.yz * q.node[2] + s.zz * q.node[3];
    return r;
  }
};

/// Mass of a homogeneous solid. @param moments  its volume and moments, of a closed mesh those of
/// moments_of(); its points must then be given about `moments.center`. @param density  [kg/m^3]
inline AffineMass affine_mass(const SolidMoments& moments, double density) {
  AffineMass m;
  m.mass = density * moments.volume;
  const auto& s = moments.second;
  m.second.xx = m.mass * s[0][0], m.second.yy = m.mass * s[1][1], m.second.zz = m.mass * s[2][2];
  m.second.xy = m.mass * s[0][1], m.second.xz = m.mass * s[0][2], m.second.yz = m.mass * s[1][2];
  return m;
}

/// Mass of a body known by its principal moments of inertia, as shapes give them.
/// @param inertia  about the axes of the body [kg m^2], none larger than the sum of the others
inline AffineMass affine_mass(double mass, const Vec3d& inertia) {
  AffineMass m;
  m.mass = mass;
  const double half = 0.5 * (inertia.x + inertia.y + inertia.z);
  m.second.xx = half - inertia.x, m.second.yy = half - inertia.y, m.second.zz = half - inertia.z;
  return m;
}

/// Force of a torque about the center of mass [N m], world axes: its power on a rotation w of the
/// body is torque.w, and it does not stretch it. F_A = 1/2 [torque]x A^-T.
SCREE_HD inline AffineVec torque_force(const AffineVec& q, const Vec3d& torque) {
  const Vec3d &a = q.node[1], &b = q.node[2], &c = q.node[3];
  const double scale = 0.5 / dot(a, cross(b, c));
  AffineVec f;  // columns of A^-T are the dual vectors of those of A
  f.node[1] = scale * cross(torque, cross(b, c));
  f.node[2] = scale * cross(torque, cross(c, a));
  f.node[3] = scale * cross(torque, cross(a, b));
  return f;
}

}  // namespace scree::affine
