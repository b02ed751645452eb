#pragma once
// Normal cones of walls, in the metric of the kinetic energy.

#include "host/variational/metric.h"

namespace scree::variational {

/// Where a momentum lies to a normal cone { -G x : x >= 0 }.
struct ConeProjection {
  Vector multipliers;   ///< x of the nearest point of the cone
  double distance = 0;  ///< to it, in the metric M^-1
};

/// Projects p on the normal cone that the columns of G, gradients of walls, span: minimizes |p + G x| in the metric M^-1
/// over x >= 0, by the active set method of Lawson and Hanson (Solving Least Squares Problems, 1974).
ConeProjection project_on_normal_cone(const Metric& metric, const Matrix& gradients,
                                      const Vector& p);

}  // namespace scree::variational
