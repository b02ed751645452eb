#pragma once
// Surfaces of all bodies in one table, each with trees of boxes about its triangles and its edges. Surfaces and trees are in
// coordinates of bodies and never change: a body that moves takes its tree along, and bodies of one shape share it.

#include "kernels/affine/near_pair.h"

namespace scree::affine {

/// A box in world or body coordinates [m].
struct Bounds {
  Vec3d low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};

  SCREE_HD void add(const Vec3d& x) {
    for (int k = 0; k < 3; ++k) {
      low[k] = x[k] < low[k] ? x[k] : low[k];
      high[k] = x[k] > high[k] ? x[k] : high[k];
    }
  }
  SCREE_HD void add(const Bounds& o) {
    add(o.low);
    add(o.high);
  }
  SCREE_HD bool near(const Bounds& o, double distance) const {
    for (int k = 0; k < 3; ++k)
      if (low[k] > o.high[k] + distance || o.low[k] > high[k] + distance) return false;
    return true;
  }
};

/// A node of a tree, with two children beside each other or with features.
struct TreeNode {
  Vec3d center, half;  ///< of its box, in coordinates of the body [m]
  Index first = 0;     ///< child, or place of the first feature in the order of the tree
  Index count = 0;     ///< of features; 0: children
};

struct SurfaceRecord {
  Index first_corner = 0, corner_count = 0;
  Index first_edge = 0, edge_count = 0;
  Index first_triangle = 0, triangle_count = 0;
  Index edge_root = 0, triangle_root = 0;
  Vec3d center, half;  ///< of the box about it [m]
};

struct EdgeCorners {
  Index v[2] = {};
};
struct TriangleCorners {
  Index v[3] = {};
};

/// Features lie in the order of their trees; corners are numbered in the table of all.
struct SurfacesView {
  Span<const Vec3d> corners;
  Span<const EdgeCorners> edges;
  Span<const TriangleCorners> triangles;
  Span<const TreeNode> nodes;
  Span<const SurfaceRecord> surfaces;
  Span<const Index> surface_of_body;

  SCREE_HD const SurfaceRecord& surface(Index body) const {
    return surfaces[surface_of_body[body]];
  }
};

/// Deepest tree: twice as many features a level.
inline constexpr int kMostTreeDepth = 48;

/// Adds the box of a body box where the body is.
SCREE_HD inline void add_placed(const AffineVec& q, const Vec3d& center, const Vec3d& half,
                                Bounds& bounds) {
  const Vec3d middle = point_of(q, center);
  Vec3d reach;
  for (int k = 0; k < 3; ++k)
    reach[k] = std::abs(q.node[1][k]) * half.x + std::abs(q.node[2][k]) * half.y +
               std::abs(q.node[3][k]) * half.z;
  // Corners are placed with other rounding than their box.
  const double slack = 1e-14 * (norm(middle) + norm(reach));
  for (int k = 0; k < 3; ++k) reach[k] += slack;
  bounds.add(middle - reach);
  bounds.add(middle + reach);
}

/// The box about the way of a body box.
SCREE_HD inline Bounds swept(const AffineVec& from, const AffineVec& to, const Vec3d& center,
                             const Vec3d& half) {
  Bounds b;
  add_placed(from, center, half, b);
  add_placed(to, center, half, b);
  return b;
}

/// The box about the ways of corners.
template <int N>
SCREE_HD Bounds swept_corners(const AffineVec& from, const AffineVec& to, Span<const Vec3d> corners,
                              const Index (&v)[N]) {
  Bounds b;
  for (int k = 0; k < N; ++k) {
    b.add(point_of(from, corners[v[k]]));
    b.add(point_of(to, corners[v[k]]));
  }
  return b;
}

}  // namespace scree::affine
