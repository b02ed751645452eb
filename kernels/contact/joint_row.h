#pragma once
// One joint in the problem of a step: which rows of force and moment it has, and coordinates in
// which these rows do not act on each other.
//
// Six rows in the axes of the joint: three forces at the anchor, three moments divided by a length.
// Each is held (its impulse takes any value, its velocity goes to zero) or absent; the last one
// acts along the axis of the joint or about it, and may be driven instead: by a motor or a spring,
// with friction, between limits. With the block D = J M^-1 J^T of the rows that are there and
//
//   D = d L L^T,   L lower triangular,   d = trace(D) / number of held rows
//
// solvers see gamma' = L^T gamma [N s] and u' = L^-1 u [m/s], whose block is d times the identity:
// one step with the scalar d solves a joint exactly, however far apart the inertias along its rows
// are. gamma . u is gamma' . u', and what drives the last row scales with it, as that is the last
// of L.

#include "kernels/math/sym3.h"

namespace scree {

inline constexpr int kJointRows = 6;
/// The row that may be driven: the moment about the axis, or the force along it. The other one of the
/// two is row 2.
inline constexpr int kJointAxisRow = 5;
/// The three moments, where no force is the last row.
inline constexpr unsigned kJointMoments = 0b111000;

/// In place of an infinite impulse or velocity.
template <class Real>
SCREE_HD constexpr Real largest_number() {
  return sizeof(Real) == 8 ? static_cast<Real>(1e300) : static_cast<Real>(1e38);
}

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

/// What decides about the impulse of a drive.
enum class DrivePart {
  bound,    ///< the impulse is the same at any velocity nearby
  main,     ///< the main part, which takes the velocity to zero, but for its compliance
  rest,     ///< friction, which holds
  fastest,  ///< limits
  slowest
};

template <class Real>
struct DrivenImpulse {
  Real impulse = 0;  ///< [N s]
  DrivePart by = DrivePart::bound;
};

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
  bool force_is_last =
      false;  ///< the last row is the force along the axis, row 2 the moment about it
  /// The only rows are the three moments, none of which acts on another, and all that they give is friction in any direction.
  bool rubs = false;

  // What drives the last row, in the coordinates of solvers. It gives the sum of a main part, which
  // takes the velocity to zero, and of friction; whatever is missing the limits give.
  Real least = 0;       ///< bounds of the main part [N s]; the largest number: none
  Real most = 0;        ///< a row that is held has none
  Real compliance = 0;  ///< E of the main part, -E gamma = u between its bounds [1/kg]
  Real friction = 0;    ///< most that friction gives [N s]; of `rubs` in the rows themselves
  Real rest = 0;        ///< velocity at which it holds [m/s]
  Real slowest = -largest_number<Real>();  ///< bounds of the velocity [m/s]
  Real fastest = largest_number<Real>();
  /// Compliance of all rows, driven or not: they give way by this times their impulse [1/kg]. Zero but in steps whose joints
  /// contradict each other.
  Real give = 0;

  /// World vectors to rows. @param moment  over the length
  SCREE_HD JointValues<Real> rows(const Vec3<Real>& force, const Vec3<Real>& moment) const {
    JointValues<Real> x;
    for (int k = 0; k < 3; ++k) {
      x[k] = dot(axes[k], force);
      x[3 + k] = dot(axes[k], moment);
    }
    return ordered(x);
  }
  SCREE_HD Vec3<Real> world_force(const JointValues<Real>& given) const {
    const JointValues<Real> x = ordered(given);
    return x[0] * axes[0] + x[1] * axes[1] + x[2] * axes[2];
  }
  /// Over the length.
  SCREE_HD Vec3<Real> world_moment(const JointValues<Real>& given) const {
    const JointValues<Real> x = ordered(given);
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

  /// The impulse that the joint gives after a step, in the coordinates of solvers: of the rows that
  /// are held any; of the last one the only z + step w that its drive gives at the velocity w. So with
  /// a row's own block, step = 1 / d, it is that of the row solved by itself.
  /// @param z     impulse less the step times the velocity [N s]
  /// @param step  [kg]; zero: the nearest impulse that the drive may give
  SCREE_HD JointValues<Real> project(JointValues<Real> z, Real step) const {
    if (!(give > Real(0))) return project_firm(z, step);
    const Real share = Real(1) / (Real(1) + step * give);
    for (int k = 0; k < kJointRows; ++k) z[k] *= share;
    return project_firm(z, share * step);
  }
  /// The same of rows that do not give way.
  SCREE_HD JointValues<Real> project_firm(JointValues<Real> z, Real step) const {
    for (int k = 0; k < kJointRows; ++k)
      if (!(inverse_pivot(k) > Real(0))) z[k] = 0;
    if (rubs) return rubbed(z);
    if (inverse_pivot(kJointAxisRow) > Real(0))
      z[kJointAxisRow] = driven(z[kJointAxisRow], step).impulse;
    return z;
  }

  /// What drives the last row gives after a step: impulses fall as the velocity rises, while z + step w rises with it, and the two
  /// meet in one point.
  /// @param z  impulse less the step times the velocity of that row [N s]
  SCREE_HD DrivenImpulse<Real> driven(Real z, Real step) const {
    constexpr Real kNone = largest_number<Real>();
    if (!(step > Real(0))) {
      const Real low = fastest < kNone ? -kNone : least - friction;
      const Real high = slowest > -kNone ? kNone : most + friction;
      return {z < low ? low : (z > high ? high : z), DrivePart::bound};
    }
    DrivenImpulse<Real> sum = main_part(z, step);
    if (friction > Real(0)) {
      const DrivenImpulse<Real> rising = main_part_and(-friction, z, step);  // against w > rest
      const DrivenImpulse<Real> falling = main_part_and(friction, z, step);
      sum = {z + step * rest, DrivePart::rest};
      if (rising.impulse > sum.impulse) sum = rising;
      if (falling.impulse < sum.impulse) sum = falling;
    }
    const Real at_fastest = z + step * fastest, at_slowest = z + step * slowest;
    if (sum.impulse > at_fastest) sum = {at_fastest, DrivePart::fastest};
    if (sum.impulse < at_slowest) sum = {at_slowest, DrivePart::slowest};
    return sum;
  }

  /// Whether the last row gives impulses at other velocities than zero, but for bounds of the main
  /// part: then the objective has terms beside 1/2 gamma N gamma + r gamma.
  SCREE_HD bool has_own_terms() const { return give > Real(0) || has_law(); }

  /// Whether it gives anything else than what takes the velocity of the last row to zero.
  SCREE_HD bool is_last_driven() const {
    constexpr Real kNone = largest_number<Real>();
    return least > -kNone || most < kNone || has_law();
  }

  /// The same of row k: whether it is not held.
  SCREE_HD bool is_driven(int k) const {
    return k == kJointAxisRow ? is_last_driven() : rubs && (kJointMoments >> k & 1u) != 0;
  }

  SCREE_HD Real inverse_pivot(int k) const { return factor[triangle_place(k, k)]; }

 private:
  /// Whether impulses of the last row depend on its velocity, but for bounds of the main part.
  SCREE_HD bool has_law() const {
    constexpr Real kNone = largest_number<Real>();
    return compliance > Real(0) || friction > Real(0) || slowest > -kNone || fastest < kNone;
  }

  SCREE_HD Real pivot(int k) const {
    const Real inverse = inverse_pivot(k);
    return inverse > Real(0) ? Real(1) / inverse : Real(0);
  }

  /// Forces first to the order of rows, and back.
  SCREE_HD JointValues<Real> ordered(JointValues<Real> x) const {
    if (!force_is_last) return x;
    const Real along = x[2];
    x[2] = x[kJointAxisRow];
    x[kJointAxisRow] = along;
    return x;
  }

  /// What the main part gives after the step alone.
  SCREE_HD DrivenImpulse<Real> main_part(Real z, Real step) const {
    if (compliance > Real(0)) z /= Real(1) + step * compliance;
    if (z <= least) return {least, DrivePart::bound};
    if (z >= most) return {most, DrivePart::bound};
    return {z, DrivePart::main};
  }
  SCREE_HD DrivenImpulse<Real> main_part_and(Real given, Real z, Real step) const {
    DrivenImpulse<Real> sum = main_part(z - given, step);
    sum.impulse += given;
    return sum;
  }

  /// The nearest impulse whose moments are no more than friction gives, in the rows themselves: there the bound is a ball, here an
  /// ellipsoid with its axes along the rows. The point is z_k / (1 + x p_k^2) with the inverse pivots p and x > 0, found by Newton's
  /// method on the inverse of its size, which comes from below and ends in the first step where all p are equal.
  /// Source: More and Sorensen, SIAM J. Sci. Stat. Comput. 4, 1983.
  SCREE_HD JointValues<Real> rubbed(JointValues<Real> z) const {
    constexpr int kMostSteps = 30, kFirst = 3;
    constexpr Real kRounding = sizeof(Real) == 8 ? Real(1e-15) : Real(5e-7);
    Real g[3], largest = 0;
    for (int k = 0; k < 3; ++k) {
      g[k] = inverse_pivot(kFirst + k) * z[kFirst + k];
      const Real size = std::abs(g[k]);
      if (size > largest) largest = size;
    }
    if (!(largest > Real(0))) return z;
    const Real most = friction / largest;  // in these units squares are numbers
    Real x = 0, share = 1;
    for (int step = 0; step < kMostSteps; ++step) {
      Real square = 0, slope = 0;
      for (int k = 0; k < 3; ++k) {
        const Real p = inverse_pivot(kFirst + k);
        const Real own = g[k] / largest / (Real(1) + x * p * p);
        square += own * own;
        slope += p * p * own * own / (Real(1) + x * p * p);
      }
      const Real size = std::sqrt(square);
      if (step == 0 && !(size > most)) return z;
      if (!(most > Real(0))) break;
      share = most / size;
      if (size - most <= kRounding * most) break;
      x += (size - most) * square / (most * slope);
    }
    for (int k = 0; k < 3; ++k) {
      const Real p = inverse_pivot(kFirst + k);
      z[kFirst + k] = most > Real(0) ? share * z[kFirst + k] / (Real(1) + x * p * p) : Real(0);
    }
    return z;
  }
};

/// Sets `factor` and `scale`. Rows that the others hold already, and those along which no body can
/// move, are left out.
/// @param block  J M^-1 J^T of the six rows, lower triangle [1/kg]; overwritten
/// @param held   bit k: row k is there
template <class Real>
SCREE_HD void factorize(JointRow<Real>& joint, double (&block)[kJointTriangle], unsigned held) {
  // What rounding leaves of a pivot that is zero. A true one is as small where a body is 1e6 times
  // smaller than its distance from the anchor. A row that locked axes hold has nothing else: its own
  // entry is the square of what rounding turns its axis by.
  constexpr double kRounding = 1e-13, kTurned = 1e-26;
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
        entry = entry > kRounding * whole && whole > kTurned ? std::sqrt(entry) : 0;
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
