#pragma once
// Mass of surfaces without a solid inside, as points at their vertices.

#include <vector>

#include "host/scene.h"

namespace scree {

/// Area that is nearest to each vertex of a surface, or half of an obtuse triangle and a quarter of it at the other
/// corners [m^2]. (Meyer et al., Discrete Differential-Geometry Operators for Triangulated 2-Manifolds, 2003.)
std::vector<double> vertex_areas(const TriangleMesh& mesh);

/// Center of mass of such points; the first vertex where there is no area.
Vec3d center_of_surface(const TriangleMesh& mesh);

}  // namespace scree
