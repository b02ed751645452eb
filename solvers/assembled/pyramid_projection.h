#pragma once
// Projections on a friction pyramid and its tangent cones, as a set in the space of impulses.

namespace scree {

/// Euclidean projection on {(n, t) : t in the polygon of radius mu n}, friction_pyramid.h, in
/// place.
/// @param sides  even, 4 or more
/// @param x      [3]
void project_on_pyramid(int sides, double mu, double* x);

/// Euclidean projection of v on the tangent cone of the pyramid at one of its points x, in place.
/// Closer to a face than 1e-10 mu n is on it.
void project_on_pyramid_tangent(int sides, double mu, const double* x, double* v);

}  // namespace scree
