#pragma once
// What an impact does: the direction from the normal cone, the size from the discrete energy.
// docs/theory.md, section "Variational collisions".

#include "kernels/math/vec3.h"

namespace scree {

/// Speed along the direction of an impact after it.
struct Rebound {
  double speed = 0;         ///< [m/s]
  bool is_grazing = false;  ///< the energy equation was not used
};

/// The discrete energy E_d(a, b, t) = m |v|^2 / 2 + (V(a) + V(b)) / 2 of a part of a step is what the
/// energy at its nodes is, less m g^2 t^2 / 8. It is the same before and after an impact, so the square
/// of the speed changes by what the lengths of the two parts differ in:
///
///     after^2 = before^2 + g^2 (T^2 - S^2) / 4      one body of any mass and a wall
///
/// where S is the time from the node before the impact and T that to the node after it. Near-grazing
/// impacts have no such speed, or one that has little to do with that before: speeds that would change
/// by more than a factor of two stay as they are. The bounds are those of the same impact run backward,
/// so neither gains nor losses are preferred.
/// @param before   approach speed [m/s], >= 0
/// @param carried  after^2 - before^2 [m^2/s^2]
SCREE_HD inline Rebound rebound(double before, double carried) {
  const double square = before * before;
  if (!(carried > -0.75 * square && carried < 3 * square) && carried != 0) return {before, true};
  return {std::sqrt(square + carried), false};
}

/// What the lengths of two parts of a step make of the square of a speed [m^2/s^2].
/// @param s, t  lengths before and after the impact [s]
SCREE_HD inline double carried_square(double gravity, double s, double t) {
  return 0.25 * gravity * gravity * (t - s) * (t + s);
}

/// The normal cone of the admissible set at a point where a body touches several walls, or one:
/// spanned by the directions into them.
struct NormalCone {
  static constexpr int kMost = 6;
  Vec3<double> n[kMost];  ///< unit, out of the walls
  int count = 0;

  /// Adds a wall; the same direction only once. Beyond kMost they have an impact of their own.
  SCREE_HD void add(const Vec3<double>& normal) {
    for (int k = 0; k < count; ++k)
      if (norm2(n[k] - normal) < 1e-20) return;
    if (count < kMost) n[count++] = normal;
  }

  /// Projection of a velocity on the cone. With one mass for all directions the metric of the mass
  /// matrix is the plain one. The projection is spanned by at most three of the directions: each set
  /// of up to three is tried, smaller ones first.
  SCREE_HD Vec3<double> project(const Vec3<double>& v) const {
    Vec3<double> part;
    for (int a = 0; a < count; ++a)
      if (is_projection(v, -dot(n[a], v), a, 0, a, 0, a, part)) return part;
    for (int a = 0; a < count; ++a) {
      for (int b = a + 1; b < count; ++b) {
        const double c = dot(n[a], n[b]), p = -dot(n[a], v), q = -dot(n[b], v);
        const double rest = 1 - c * c;
        if (is_projection(v, (p - c * q) / rest, a, (q - c * p) / rest, b, 0, a, part)) return part;
      }
    }
    for (int a = 0; a < count; ++a) {
      for (int b = a + 1; b < count; ++b) {
        for (int c = b + 1; c < count; ++c) {
          const Vec3<double> bc = cross(n[b], n[c]), ca = cross(n[c], n[a]), ab = cross(n[a], n[b]);
          const double volume = -dot(n[a], bc);
          if (is_projection(v, dot(v, bc) / volume, a, dot(v, ca) / volume, b, dot(v, ab) / volume,
                            c, part))
            return part;
        }
      }
    }
    return nearest_alone(v);
  }

 private:
  /// Whether v less part is out of all walls, and part is in the cone.
  SCREE_HD bool is_projection(const Vec3<double>& v, double x, int a, double y, int b, double z,
                              int c, Vec3<double>& part) const {
    if (!(x >= 0 && y >= 0 && z >= 0)) return false;  // not a number: directions that depend
    part = -x * n[a] - y * n[b] - z * n[c];
    const Vec3<double> rest = v - part;
    const double slack = 1e-12 * norm(v);
    for (int k = 0; k < count; ++k)
      if (!(dot(n[k], rest) >= -slack)) return false;
    return true;
  }
  /// The wall that is approached fastest: where rounding leaves no set of several.
  SCREE_HD Vec3<double> nearest_alone(const Vec3<double>& v) const {
    double most = 0;
    Vec3<double> part;
    for (int k = 0; k < count; ++k) {
      const double approach = -dot(n[k], v);
      if (approach > most) most = approach, part = -approach * n[k];
    }
    return part;
  }
};

}  // namespace scree
