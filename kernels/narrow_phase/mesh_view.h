#pragma once
// Triangle meshes prepared for contact: neighborhood of triangles, edges and vertices, and a
// bounding volume hierarchy walked without a stack. All meshes of a scene are concatenated; every
// index is global.

#include "kernels/math/vec3.h"

namespace scree {

/// A node in depth-first order. When its box is missed the walk goes on at `skip`,
/// else at the next node.
struct MeshNode {
  float lower[3];  ///< body frame [m], rounded outward
  Index skip;      ///< global index of the first node past this subtree
  float upper[3];
  Index leaf;  ///< -1: inner node; else first triangle of the mesh's own count * 8 + triangle count
};

/// A triangle: vertices counter-clockwise from outside; edge k joins vertex k and
/// vertex (k + 1) % 3.
struct MeshTriangle {
  Index vertex[3];
  Index edge[3];
};

/// An edge with its two triangles; the first owns it.
struct MeshEdge {
  Index vertex[2];
  Index opposite[2];  ///< third vertex of each triangle, -1 at a border
  Index triangle[2];  ///< lower index first, -1 at a border
};

/// A vertex; the lowest of its triangles owns it.
struct MeshVertex {
  Index first_neighbor;  ///< into MeshView::neighbors
  Index neighbor_count;
  Index owner;
};

struct MeshInfo {
  Index first_node = 0;
  Index end_node = 0;
  Index first_triangle = 0;
  Index triangle_count = 0;
  bool closed = true;    ///< only the outside is solid surface; open meshes have two sides
  double tolerance = 0;  ///< half width of the strip that belongs to an edge [m]
};

template <class Real>
struct MeshView {
  Span<const Vec3<Real>> points;         ///< [vertex_count] body frame [m]
  Span<const Vec3<Real>> vertex_normal;  ///< [vertex_count] angle-weighted, unit
  Span<const Vec3<Real>> edge_normal;    ///< [edge_count] sum of the triangles' normals, unit
  Span<const MeshVertex> vertices;
  Span<const Index> neighbors;  ///< vertices joined by an edge
  Span<const MeshEdge> edges;
  Span<const MeshTriangle> triangles;
  Span<const MeshNode> nodes;
  Span<const MeshInfo> meshes;
};

}  // namespace scree
