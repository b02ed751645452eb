#pragma once
// One joint in the problem of a step: which rows of force and moment it has, and coordinates in
// which these rows do not act on each other.
//
// Six rows in the axes of the joint: three forces at the anchor, three moments divided by a length.
// Each is held (its impulse takes any value, its velocity goes to zero) or absent; the last one,
// the moment about the axis, may have bounds. With the block D = J M^-1 J^T of the held rows and
//
//   D = d L L^T,   L lower triangular,   d = trace(D) / number of held rows
//
// solvers see gamma' = L^T gamma [N s] and u' = L^-1 u [m/s], whose block is d times the identity:
// one step with the scalar d solves a joint exactly, however far apart the inertias along its rows
// are. gamma . u is gamma' . u', and bounds on the last row stay bounds, as that is the last of L.

#include "kernels/math/sym3.h"

namespace scree {

inline constexpr int kJointRows = 6;
/// The row that may have bounds: the moment about the axis.
inline constexpr int kJointAxisRow = 5;

/// Values of the rows of a joint: impulses [N s] or velocities [m/s].
template <class Real>
struct JointValues {
  Real row[kJointRows] = {};

  SCREE_HD Real& operator[](int k) { return row[k]; }
  SCREE_HD Real operator[](int k) const { return row[k]; }
};

/// Place of entry (i, j), j <= i, of a lower triangle kept row by row.
SCREE_HD constexpr int triangle_place(int i, int j) { return i * (i + 1) / 2 + j; }
inline constexpr int kJointTriangle = triangle_place(kJointRows, 0);

template <class Real>
struct JointRow {
  Vec3<Real> arm_a;    ///< center of A to the anchor, world [m]
  Vec3<Real> arm_b;    ///< center of B to the anchor, world [m]
  Vec3<Real> axes[3];  ///< of the joint, unit, world; the last is its axis
  Real length = 1;     ///< scale of the moment rows [m]
  /// What is added to the velocity of the rows [m/s]: position errors over the step, and what the
  /// turning bodies gain by its middle.
  JointValues<Real> bias;
  /// L row by row; on its diagonal the inverse, zero for rows that are absent or that the bodies
  /// cannot follow.
  Real factor[kJointTriangle] = {};
  Real scale = 0;  ///< d [1/kg]
  /// Bounds of the last row in the coordinates of solvers [N s]; the largest number: none.
  Real least = 0;
  Real most = 0;

  /// World vectors to rows. @param moment  over the length
  SCREE_HD JointValues<Real> rows(const Vec3<Real>& force, const Vec3<Real>& moment) const {
    JointValues<Real> x;
    for (int k = 0; k < 3; ++k) {
      x[k] = dot(axes[k], force);
      x[3 + k] = dot(axes[k], moment);
    }
    return x;
  }
  SCREE_HD Vec3<Real> world_force(const JointValues<Real>& x) const {
    return x[0] * axes[0] + x[1] * axes[1] + x[2] * axes[2];
  }
  /// Over the length.
  SCREE_HD Vec3<Real> world_moment(const JointValues<Real>& x) const {
    return x[3] * axes[0] + x[4] * axes[1] + x[5] * axes[2];
  }

  /// u' = L^-1 u.
  SCREE_HD JointValues<Real> scaled_velocity(const JointValues<Real>& u) const {
    JointValues<Real> w;
    for (int i = 0; i < kJointRows; ++i) {
      Real rest = u[i];
      for (int j = 0; j < i; ++j) rest -= factor[triangle_place(i, j)] * w[j];
      w[i] = inverse_pivot(i) * rest;
    }
    return w;
  }
  /// u = L u' of the held rows.
  SCREE_HD JointValues<Real> velocity(const JointValues<Real>& w) const {
    JointValues<Real> u;
    for (int i = 0; i < kJointRows; ++i) {
      Real sum = pivot(i) * w[i];
      for (int j = 0; j < i; ++j) sum += factor[triangle_place(i, j)] * w[j];
      u[i] = sum;
    }
    return u;
  }
  /// gamma' = L^T gamma; absent rows become zero.
  SCREE_HD JointValues<Real> scaled_impulse(const JointValues<Real>& g) const {
    JointValues<Real> z;
    for (int j = 0; j < kJointRows; ++j) {
      Real sum = pivot(j) * g[j];
      for (int i = j + 1; i < kJointRows; ++i)
        if (inverse_pivot(i) > Real(0)) sum += factor[triangle_place(i, j)] * g[i];
      z[j] = sum;
    }
    return z;
  }
  /// gamma = L^-T gamma'.
  SCREE_HD JointValues<Real> impulse(const JointValues<Real>& z) const {
    JointValues<Real> g;
    for (int j = kJointRows - 1; j >= 0; --j) {
      Real rest = z[j];
      for (int i = j + 1; i < kJointRows; ++i) rest -= factor[triangle_place(i, j)] * g[i];
      g[j] = inverse_pivot(j) * rest;
    }
    return g;
  }

  /// Nearest impulse that is allowed, in the coordinates of solvers.
  SCREE_HD JointValues<Real> project(JointValues<Real> z) const {
    for (int k = 0; k < kJointRows; ++k)
      if (!(inverse_pivot(k) > Real(0))) z[k] = 0;
    Real& last = z[kJointAxisRow];
    if (last < least) last = least;
    if (last > most) last = most;
    return z;
  }

 private:
  SCREE_HD Real inverse_pivot(int k) const { return factor[triangle_place(k, k)]; }
  SCREE_HD Real pivot(int k) const {
    const Real inverse = inverse_pivot(k);
    return inverse > Real(0) ? Real(1) / inverse : Real(0);
  }
};

/// Sets `factor` and `scale`. Rows that the others hold already, and those along which no body can
/// move, are left out.
/// @param block  J M^-1 J^T of the six rows, lower triangle [1/kg]; overwritten
/// @param held   bit k: row k is there
template <class Real>
SCREE_HD void factorize(JointRow<Real>& joint, double (&block)[kJointTriangle], unsigned held) {
  // What rounding leaves of a pivot that is zero. A true one is as small where a body is 1e6 times
  // smaller than its distance from the anchor.
  constexpr double kRounding = 1e-13;
  double trace = 0;
  int count = 0;
  for (int k = 0; k < kJointRows; ++k) {
    const double entry = block[triangle_place(k, k)];
    if ((held >> k & 1u) == 0 || !(entry > 0)) continue;
    trace += entry;
    ++count;
  }
  const double scale = count > 0 ? trace / count : 0;
  joint.scale = static_cast<Real>(scale);
  for (int i = 0; i < kJointRows; ++i) {
    for (int j = 0; j <= i; ++j) {
      double& entry = block[triangle_place(i, j)];
      const bool is_held = (held >> i & 1u) != 0 && (held >> j & 1u) != 0 && scale > 0;
      entry = is_held ? entry / scale : 0;
      const double whole = entry;
      for (int k = 0; k < j; ++k)
        entry -= block[triangle_place(i, k)] * block[triangle_place(j, k)];
      if (i == j) {
        entry = entry > kRounding * whole ? std::sqrt(entry) : 0;
        joint.factor[triangle_place(i, i)] = static_cast<Real>(entry > 0 ? 1 / entry : 0);
      } else {
        const double pivot = block[triangle_place(j, j)];
        entry = pivot > 0 ? entry / pivot : 0;
        joint.factor[triangle_place(i, j)] = static_cast<Real>(entry);
      }
    }
  }
}

}  // namespace scree
