#pragma once
// The way of a system in a step, or in a part of one.

#include "host/variational/metric.h"

namespace scree::variational {

/// q(s) = start + s velocity + s^2/2 acceleration for 0 <= s <= duration: where steps of all lengths s lead.
struct Way {
  Vector start, velocity, acceleration;
  double duration = 0;  ///< [s]
  double step = 0;  ///< of which it is a part [s]; what coordinates change by in it is rounded too

  void place(double s, Vector& q) const { q = start + s * (velocity + (0.5 * s) * acceleration); }
  void rate(double s, Vector& v) const { v = velocity + s * acceleration; }
};

}  // namespace scree::variational
