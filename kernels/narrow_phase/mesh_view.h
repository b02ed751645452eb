#pragma once
// Triangle meshes prepared for contact: neighborhood of triangles, edges and vertices, and a
// bounding volume hierarchy walked without a stack. All meshes of a scene are concatenated; every
// index is global.

#include "kernels/math/scalar.h"
#include "kernels/math/vec3.h"

namespace scree {

/// A node in depth-first order. When its box is missed the walk goes on at `skip`,
/// else at the next node. Two loads of 16 bytes.
struct alignas(16) MeshNode {
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

/// An edge with its two triangles; the first owns it. Where a mesh goes on in its image both have an edge, whose second
/// triangle is that of the image.
struct MeshEdge {
  Index vertex[2];
  Index opposite[2];  ///< third vertex of each triangle, -1 at a border
  Index triangle[2];  ///< lower index first, -1 at a border
  float slack = 0;    ///< how far rounding may have moved that of an image [m]
};

/// A vertex; the lowest of its triangles owns it, those of images among them.
struct MeshVertex {
  Index first_neighbor;  ///< into MeshView::neighbors
  Index neighbor_count;
  Index owner;
  float slack = 0;  ///< see MeshEdge
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

/// A box in the frame of a mesh, and what of a mesh it meets.
struct MeshReach {
  /// Rounded inward: a float compares with them as with the numbers that they stand for.
  float low[3], high[3];

  /// @param lowest, highest  corners [m]
  SCREE_HD MeshReach(const Vec3<double>& lowest, const Vec3<double>& highest) {
    for (int k = 0; k < 3; ++k) {
      low[k] = float_above(lowest[k]);
      high[k] = float_below(highest[k]);
    }
  }

  SCREE_HD bool meets(const MeshNode& node) const {
    bool is_met = true;
    for (int k = 0; k < 3; ++k) is_met &= high[k] >= node.lower[k] && low[k] <= node.upper[k];
    return is_met;
  }

  /// The first leaf from node n on that it meets, or `end`.
  SCREE_HD Index next_leaf(Span<const MeshNode> nodes, Index n, Index end) const {
    while (n < end) {
      const MeshNode node = nodes[n];
      if (!meets(node)) {
        n = node.skip;
      } else if (node.leaf >= 0) {
        return n;
      } else {
        ++n;
      }
    }
    return end;
  }

  /// Calls visit(triangle) for those of the leaves that it meets.
  template <class Real, class Visit>
  SCREE_HD void visit(const MeshView<Real>& mesh, const MeshInfo& info, Visit&& visit) const {
    for (Index n = next_leaf(mesh.nodes, info.first_node, info.end_node); n < info.end_node;
         n = next_leaf(mesh.nodes, n + 1, info.end_node)) {
      const Index leaf = mesh.nodes[n].leaf, first = info.first_triangle + (leaf >> 3);
      for (Index t = first; t < first + (leaf & 7); ++t) visit(t);
    }
  }
};

}  // namespace scree
