#pragma once
// Prepares triangle meshes for contact, once per run, on the host.

#include <array>
#include <vector>

#include "kernels/narrow_phase/mesh_view.h"

namespace scree {

/// A triangle surface in its body's frame.
struct MeshSource {
  std::vector<Vec3<double>> vertices;           ///< [m]
  std::vector<std::array<Index, 3>> triangles;  ///< counter-clockwise seen from outside
  bool closed = true;                           ///< false: both sides are surface
  /// Those of a periodic domain, in its body's frame, where the wall keeps its direction: a mesh as long as one goes on in
  /// its image [m].
  std::vector<Vec3<double>> periods = {};
};

/// All meshes, concatenated; see MeshView for the fields. Triangles are renumbered
/// along the hierarchy. Behind the points of a mesh come those of its images that it is joined with.
template <class Real>
struct MeshTopology {
  std::vector<Vec3<Real>> points;
  std::vector<Vec3<Real>> vertex_normal;
  std::vector<Vec3<Real>> edge_normal;
  std::vector<MeshVertex> vertices;
  std::vector<Index> neighbors;
  std::vector<MeshEdge> edges;
  std::vector<MeshTriangle> triangles;
  std::vector<MeshNode> nodes;
  std::vector<MeshInfo> meshes;
};

/// An edge of more than two triangles is taken apart: from the third on, each has
/// an edge of its own.
/// @throws std::runtime_error when a triangle names a vertex that does not exist
template <class Real>
MeshTopology<Real> build_mesh_topology(const std::vector<MeshSource>& meshes);

}  // namespace scree
