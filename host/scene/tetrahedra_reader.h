#pragma once
// Tetrahedra from files of Gmsh (.msh, formats 2 and 4.1) and VTK (.vtk, legacy unstructured grids), both as text.

#include <string>

#include "shapes/shape.h"

namespace scree {

/// @param kind  lower-case ending of the name of a file
bool is_tetrahedra_file(const std::string& kind);

/// The mesh of a file: mesh_of_tetrahedra() of its tetrahedra of four corners; cells of other kinds are left out.
/// @param bytes  of the file
/// @param name   of the file
/// @throws InputError naming the file: another format, truncated, a number that is not one, an unknown vertex, tetrahedra of ten
///         corners, or as mesh_of_tetrahedra() does
TriangleMesh read_tetrahedra(const std::string& bytes, const std::string& kind,
                             const std::string& name);

}  // namespace scree
