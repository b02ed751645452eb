#pragma once
// Triangle meshes from STL (binary and ASCII) and OBJ files.

#include <filesystem>

#include "host/scene.h"

namespace scree {

struct MeshOptions {
  /// Coordinates of the file are multiplied by this [m per unit of the file], > 0.
  double scale = 1;
  bool closed = true;  ///< the surface must be watertight; false: edges with one triangle are fine
};

/// Reads a mesh; equal vertices (to 1e-9 of the diagonal) become one, polygons become triangles,
/// and a closed mesh that is inside out is turned right.
/// @throws InputError naming the file: missing, unreadable, truncated, a number that is not one,
///         an index out of range, a degenerate triangle, an edge that is open or shared by more
///         than two triangles, neighbors of opposite orientation, or a closed mesh that encloses no
///         volume or crosses itself
TriangleMesh read_mesh(const std::filesystem::path& file, const MeshOptions& options = {});

/// Reads a surface as the file has it, from an OFF file too: with vertices that no triangle uses, and
/// possibly without any triangle. Only vertices of STL files become one where they are equal.
/// @throws InputError naming the file: missing, unreadable, truncated, a number that is not one or
///         too far out, or an index out of range
TriangleMesh read_surface(const std::filesystem::path& file);

/// Whether every edge of a surface is used once in each direction.
bool is_closed(const TriangleMesh& mesh);

}  // namespace scree
