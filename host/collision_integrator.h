#pragma once
// Time steps of a mechanical system between walls that keep its momenta, and its energy but for what oscillates with the step.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "host/error.h"
#include "host/mechanical_system.h"

namespace scree {

struct ImpactSettings {
  double step = 0;       ///< h [s], > 0
  int max_impacts = 50;  ///< in one step, > 0
  /// Walls that are reached within this share of a step are hit at once [-], in [0, 1).
  double together = 1e-9;
  /// Rate at which a system meets or leaves a wall that forces press it to, below which it rests there [unit of the wall
  /// per s], >= 0; 0: half of what these forces change in a step, and for an elastic wall that over max_impacts.
  double handover_speed = 0;
  int samples = 64;  ///< places of a step where walls of unknown curvature are looked at, > 0
};

/// A part of a wall that takes part in an impact.
struct ActivePart {
  int wall = 0;  ///< index in MechanicalSystem::walls
  int part = 0;  ///< index in Wall::parts
  /// Multiplier of the gradient of the part, without friction: N s where the part is a distance.
  double impulse = 0;
};

struct Impact {
  double time = 0;                ///< [s]
  std::vector<double> position;   ///< q~, on the boundary
  std::vector<double> before;     ///< momentum just before
  std::vector<double> after;      ///< momentum just after
  std::vector<ActivePart> parts;  ///< those that span the normal cone there
  double energy = 0;              ///< discrete energy of the way to the impact
  double energy_after = 0;        ///< of the way from it: the same if elastic and not grazing
  bool grazing = false;           ///< reflected at once, since the energy equation had no root
  /// How far q~ is from being the closest point of the obstacle to the chord, in the norm of M [sqrt(mass) x length]: what M (q~ -
  /// q_(i-alpha)), less the part of the forces, is off the normal cone. NaN for an impact with friction.
  double closest_point_error = 0;
};

struct CollisionTotals {
  std::int64_t steps = 0;
  std::int64_t impacts = 0;
  std::int64_t grazing_impacts = 0;        ///< those that were reflected at once
  double largest_closest_point_error = 0;  ///< over all impacts without friction
  double smallest_gap = 0;  ///< least value of a wall at nodes so far; infinite without walls
};

/// The system came to rest at a wall: forces press it there and it meets or leaves it more slowly than the hand-over speed. Such
/// contact is for the time steps of a World. The integrator is as it was before the step.
class RestingContact : public RunError {
 public:
  using RunError::RunError;
};

/// More impacts in a step than `max_impacts`. The integrator is as it was before the step.
class TooManyImpacts : public RunError {
 public:
  using RunError::RunError;
};

/// Variational collision integrator: discrete Lagrangian of the Verlet scheme, where time and place of each impact are unknowns
/// of the discrete action (docs/theory.md, section "Variational impacts").
///
/// Between impacts the way of a step is the parabola q + s M^-1 (p - (s / 2) grad V(q)), 0 <= s <= h. A step is free when all of
/// it is within the walls; walls with known curvature are followed by a bound from below, which no impact escapes. An
/// impact acts along minus the projection of the momentum on the normal cone, in the metric M^-1, with the impulse that keeps
/// the discrete energy. Restitution then scales the momentum along it; friction takes the momentum across it, in the
/// tangent space in the metric M^-1, at most by `friction` times the impulse: for a point mass that is Coulomb's law.
/// Where walls of several coefficients are hit at once, the least restitution and the largest friction count.
///
/// What is kept: momenta of symmetries that walls and V have, to rounding; without V the energy, to rounding; with V the
/// energy of nodes but for a jump of order h^2 at each impact, of either sign (docs/theory.md).
/// Functions of the system are called with coordinates up to a step beyond a wall. Same input, same bits.
class CollisionIntegrator {
 public:
  /// @param position,velocity  n numbers each
  /// @throws InputError for sizes that do not match, a mass matrix that is not symmetric and positive definite, a missing function,
  ///         settings out of range, values that are not finite, and a position beyond a wall
  CollisionIntegrator(MechanicalSystem system, const ImpactSettings& settings,
                      const std::vector<double>& position, const std::vector<double>& velocity);
  ~CollisionIntegrator();
  CollisionIntegrator(CollisionIntegrator&&) noexcept;
  CollisionIntegrator& operator=(CollisionIntegrator&&) noexcept;

  /// Goes on by h.
  /// @throws RestingContact, TooManyImpacts
  /// @throws RunError when a function is not finite, or the gradient of a wall vanishes on it
  void step();

  double time() const;                          ///< [s]
  const std::vector<double>& position() const;  ///< q_k
  const std::vector<double>& momentum() const;  ///< p_k
  std::vector<double> velocity() const;         ///< M^-1 p_k
  double energy() const;                        ///< 1/2 p.M^-1 p + V(q) of the node
  double discrete_energy()
      const;  ///< -dL_d/dh of the last way to this node; that of the next one at the start
  std::vector<double> momenta() const;  ///< values of MechanicalSystem::momenta
  double gap() const;  ///< least value of a wall at the node; infinite without walls
  const std::vector<Impact>& impacts() const;  ///< those of the last step, in their order
  const CollisionTotals& totals() const;

 private:
  class State;
  std::unique_ptr<State> state_;
};

}  // namespace scree
