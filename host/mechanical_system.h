#pragma once
// A mechanical system of n coordinates that moves between walls, as CollisionIntegrator takes it: functions, no bodies.

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace scree {

/// A function of the coordinates q, and what is known of how it bends.
struct WallFunction {
  std::function<double(std::span<const double> q)> value;
  /// Writes all n derivatives by the coordinates. Must not vanish where the function is zero.
  std::function<void(std::span<const double> q, std::span<double> gradient)> gradient;
  /// b with |w.H w| <= sum_i b_i w_i^2 for all w, H the second derivatives, at all q between two points of the motion: n
  /// numbers >= 0, all zero for a linear function. With it no impact is missed. Empty: not known; then the way of a step is
  /// looked at in ImpactSettings::samples places, and in between where the value has a minimum.
  std::vector<double> curvature;
};

/// One condition on the coordinates: at least one part is >= 0. A system has to meet those of all its walls.
struct Wall {
  std::string name;  ///< in messages
  /// One part: a smooth wall, which other walls meet at corners that the system is in. Several: an obstacle with sharp edges
  /// that the system is around, as the outside of a convex polygon, whose parts are its sides.
  std::vector<WallFunction> parts;
  double restitution = 1;  ///< normal speed after over before an impact [-], in [0, 1]
  double friction = 0;     ///< Coulomb's coefficient [-], >= 0; see CollisionIntegrator
};

/// A momentum that the symmetries of a system keep: a function of coordinates and momenta.
struct MomentumMap {
  std::string name;
  std::function<double(std::span<const double> q, std::span<const double> p)> value;
};

/// Lagrangian 1/2 q'.M q' - V(q) of n coordinates, and walls. Units are those of its user: with q in m and M in kg all others
/// are SI, and where a coordinate is an angle, its row of M is a moment of inertia.
struct MechanicalSystem {
  std::vector<double> mass;  ///< M, n x n row by row, symmetric and positive definite
  std::function<double(std::span<const double> q)> potential;  ///< V; empty: no forces
  /// Writes all n derivatives of V; given where `potential` is.
  std::function<void(std::span<const double> q, std::span<double> gradient)> potential_gradient;
  std::vector<Wall> walls;
  std::vector<MomentumMap> momenta;  ///< reported by CollisionIntegrator::momenta()
};

/// p.xi: momentum along a direction of the coordinates, kept where neither V nor a wall changes along it.
MomentumMap linear_momentum(std::string name, std::vector<double> direction);

/// p.(A q): momentum of the linear motion exp(s A), for instance a rotation.
/// @param generator  A, n x n row by row
MomentumMap angular_momentum(std::string name, std::vector<double> generator);

}  // namespace scree
