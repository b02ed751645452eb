#pragma once
// Meshes of tetrahedra.

#include <array>
#include <string>
#include <vector>

#include "shapes/shape.h"

namespace scree {

/// A mesh of tetrahedra, with their surface: its vertices come first. Vertices that no tetrahedron has are left out, tetrahedra
/// that are inside out are turned right.
/// @param name      for messages
/// @param vertices  [m], or units of a file
/// @throws InputError naming the mesh: no tetrahedra, a flat one, or three with one triangle in common
TriangleMesh mesh_of_tetrahedra(const std::string& name, const std::vector<Vec3d>& vertices,
                                std::vector<std::array<int, 4>> tetrahedra);

}  // namespace scree
