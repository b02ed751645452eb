#pragma once
// What an impact does to the momentum of a system.

#include <span>
#include <vector>

#include "host/collision_integrator.h"
#include "host/variational/forces.h"

namespace scree::variational {

/// State of a system that has come to a wall.
struct Arrival {
  Vector place;          ///< q~
  Vector momentum;       ///< p-
  Vector gradient;       ///< of V at q~
  double potential = 0;  ///< V(q~)
  double energy = 0;     ///< discrete energy of the way there
};

/// Momentum after an impact.
struct Departure {
  Vector momentum;       ///< p+
  double impulse = 0;    ///< lambda, multiplier of the direction
  bool grazing = false;  ///< reflected at once
};

/// An impact: walls that are hit, normal cone, direction and coefficients there.
class Reflection {
 public:
  /// @param reach  time within which walls that would be reached at the present speed are hit too [s]
  /// @throws RunError when the gradient of a wall that is hit vanishes or is not finite
  Reflection(const Metric& metric, const Forces& forces, std::span<const Wall> walls,
             Arrival arrival, double reach);

  /// p+ = p- + lambda d for a way of the time T from here. Lambda keeps the discrete energy,
  ///
  ///   1/2 v.M v + 1/2 (V(q~) + V(q~ + T v)) = E,   v = M^-1 (p- + lambda d - (T/2) grad V(q~)),
  ///
  /// the larger root, by Newton's method from the right of it. Without a root that leaves the wall: -2 d.M^-1 p- / d.M^-1 d, the
  /// reflection at an instant. Then restitution and friction.
  Departure after(double duration) const;
  /// The same with the reflection at an instant, whatever the energy equation says.
  Departure at_once() const;

  const Arrival& arrival() const { return arrival_; }
  /// Parts that are hit, with their impulses for an impulse lambda along the direction.
  std::vector<ActivePart> parts(double lambda) const;
  /// What M (q~ - q_(i-alpha)), less the part of the forces, is off the normal cone, for ways of two times with two ends.
  double closest_point_error(const Vector& from, double time_to, const Vector& to,
                             double time_from) const;
  bool has_friction() const { return friction_ > 0; }

  /// A part that the system comes to or leaves too slowly against the forces there, or none.
  struct Rest {
    int wall = -1;
    double speed = 0;      ///< the lower one of both
    double threshold = 0;  ///< hand-over speed
  };
  Rest rest(const Departure& departure, const ImpactSettings& settings) const;

 private:
  void add_active(std::span<const Wall> walls, double reach, bool approached_only);
  void choose_direction();
  Departure with_losses(double lambda, bool grazing) const;
  double instant_impulse() const;

  const Metric& metric_;
  const Forces& forces_;
  Arrival arrival_;
  std::vector<ActivePart> parts_;  // impulse: share of the direction
  Matrix gradients_;
  Vector direction_, direction_velocity_;
  double direction_square_ = 0;  // d.M^-1 d
  double restitution_ = 1, friction_ = 0;
};

}  // namespace scree::variational
