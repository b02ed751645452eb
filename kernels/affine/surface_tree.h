#pragma once
// Surfaces of all bodies in one table, each with trees of boxes about its corners, its edges and its triangles. Surfaces and trees
// are in coordinates of bodies and never change: a body that moves takes its trees along, and bodies of one shape share them.

#include "kernels/affine/near_pair.h"

namespace scree::affine {

/// A box in world or body coordinates [m]; at first an empty one, which is near nothing.
struct Bounds {
  Vec3d low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};

  SCREE_HD void add(const Vec3d& x) {
    add_axis(x.x, low.x, high.x);
    add_axis(x.y, low.y, high.y);
    add_axis(x.z, low.z, high.z);
  }
  /// An empty one changes nothing.
  SCREE_HD void add(const Bounds& o) {
    for (int k = 0; k < 3; ++k) {
      low[k] = o.low[k] < low[k] ? o.low[k] : low[k];
      high[k] = o.high[k] > high[k] ? o.high[k] : high[k];
    }
  }
  /// The same for reductions.
  SCREE_HD void combine(const Bounds& o) { add(o); }
  SCREE_HD bool near(const Bounds& o, double distance) const {
    return !(low.x > o.high.x + distance || o.low.x > high.x + distance ||
             low.y > o.high.y + distance || o.low.y > high.y + distance ||
             low.z > o.high.z + distance || o.low.z > high.z + distance);
  }
  SCREE_HD Bounds widened(double by) const {
    Bounds b;
    b.low = low - Vec3d{by, by, by};
    b.high = high + Vec3d{by, by, by};
    return b;
  }

 private:
  static SCREE_HD void add_axis(double x, double& low, double& high) {
    low = x < low ? x : low;
    high = x > high ? x : high;
  }
};

/// A corner, an edge or a triangle.
struct alignas(16) Feature {
  Index corner[3] = {};  ///< in the table of all
  Index count = 0;       ///< of its corners: 1, 2 or 3
};

/// A box of a tree whose nodes lie in the order in which a search visits them: the first child of a node lies behind it, and
/// `skip` is where to go on without what is below. In coordinates of the body [m], rounded outward.
struct alignas(16) TreeNode {
  float center[3] = {}, half[3] = {};
  Index skip =
      0;  ///< next node that is not below this one; of a leaf: less the number of its features
  Index begin = 0;  ///< its first feature

  SCREE_HD bool is_leaf() const { return skip < 0; }
  SCREE_HD Index feature_count() const { return -skip; }
  SCREE_HD Index after(Index own) const { return is_leaf() ? own + 1 : skip; }
};

/// Features of a leaf and of a block at most, and boxes of an outline. A block has a bit for each.
inline constexpr Index kLeafFeatures = 4, kBlockFeatures = 32, kOutlineBoxes = 32;

/// Where things of a surface are in the tables.
struct SurfaceRecord {
  Index tree[4] = {};  ///< trees of corners, edges and triangles: nodes [tree[k], tree[k + 1])
  Index block_begin = 0, block_end = 0;
  Index outline_begin = 0, outline_end = 0;
  double radius = 0;  ///< of the farthest corner [m]
};

/// Tables of all surfaces.
struct SurfacesView {
  Span<const Vec3d> corners;     ///< surface by surface, in their order there
  Span<const Feature> features;  ///< in the order of the trees
  Span<const TreeNode> nodes;    ///< of all trees
  Span<const Index> blocks;      ///< nodes that a search begins at: together they hold all features
  Span<const TreeNode> outline;  ///< a few boxes that hold each surface
  Span<const SurfaceRecord> surfaces;  ///< by surface
  Span<const Index> surface_of_body;

  SCREE_HD const SurfaceRecord& surface(Index body) const {
    return surfaces[surface_of_body[body]];
  }
};

/// The box about the ways of the corners of a feature: what decides which pairs are near.
SCREE_HD inline Bounds swept(const AffineVec& from, const AffineVec& to, Span<const Vec3d> corners,
                             const Feature& feature) {
  Bounds b;
  for (int k = 0; k < 3; ++k) {
    if (k >= feature.count) break;
    const Vec3d rest = corners[feature.corner[k]];
    b.add(point_of(from, rest));
    b.add(point_of(to, rest));
  }
  return b;
}

/// Whether the ways of corners leave a range of one axis on its lower or its upper side.
struct AxisRange {
  double low = 1e300, high = -1e300;

  /// The same sums as in point_of(), so that no pair is near for one and not for the other.
  SCREE_HD void add(double p, double a, double b, double c, const Vec3d& rest) {
    const double x = p + rest.x * a + rest.y * b + rest.z * c;
    low = x < low ? x : low;
    high = x > high ? x : high;
  }
  SCREE_HD bool near(double other_low, double other_high, double distance) const {
    return !(other_low > high + distance || low > other_high + distance);
  }
};

/// box.near(swept(from, to, corners, feature), distance), axis by axis: most are far along the first.
SCREE_HD inline bool swept_near(const Bounds& box, const AffineVec& from, const AffineVec& to,
                                Span<const Vec3d> corners, const Feature& feature,
                                double distance) {
  const Vec3d *f = from.node, *t = to.node;
  Vec3d rest[3];
  for (int k = 0; k < 3; ++k) rest[k] = corners[feature.corner[k < feature.count ? k : 0]];
  AxisRange x, y, z;
  for (const Vec3d& r : rest) {
    x.add(f[0].x, f[1].x, f[2].x, f[3].x, r);
    x.add(t[0].x, t[1].x, t[2].x, t[3].x, r);
  }
  if (!x.near(box.low.x, box.high.x, distance)) return false;
  for (const Vec3d& r : rest) {
    y.add(f[0].y, f[1].y, f[2].y, f[3].y, r);
    y.add(t[0].y, t[1].y, t[2].y, t[3].y, r);
  }
  if (!y.near(box.low.y, box.high.y, distance)) return false;
  for (const Vec3d& r : rest) {
    z.add(f[0].z, f[1].z, f[2].z, f[3].z, r);
    z.add(t[0].z, t[1].z, t[2].z, t[3].z, r);
  }
  return z.near(box.low.z, box.high.z, distance);
}

/// Least and largest coordinate of the box of a node along its way, on one axis.
SCREE_HD inline void sweep_axis(double p0, double a0, double b0, double c0, double p1, double a1,
                                double b1, double c1, const TreeNode& n, double& low,
                                double& high) {
  const double x = n.center[0], y = n.center[1], z = n.center[2];
  const double hx = n.half[0], hy = n.half[1], hz = n.half[2];
  const double m0 = p0 + x * a0 + y * b0 + z * c0, m1 = p1 + x * a1 + y * b1 + z * c1;
  const double r0 = hx * std::abs(a0) + hy * std::abs(b0) + hz * std::abs(c0);
  const double r1 = hx * std::abs(a1) + hy * std::abs(b1) + hz * std::abs(c1);
  low = m0 - r0 < m1 - r1 ? m0 - r0 : m1 - r1;
  high = m0 + r0 > m1 + r1 ? m0 + r0 : m1 + r1;
}

/// The box about the way of a node, but for rounding.
SCREE_HD inline Bounds swept(const AffineVec& from, const AffineVec& to, const TreeNode& n) {
  const Vec3d *f = from.node, *t = to.node;
  Bounds b;
  sweep_axis(f[0].x, f[1].x, f[2].x, f[3].x, t[0].x, t[1].x, t[2].x, t[3].x, n, b.low.x, b.high.x);
  sweep_axis(f[0].y, f[1].y, f[2].y, f[3].y, t[0].y, t[1].y, t[2].y, t[3].y, n, b.low.y, b.high.y);
  sweep_axis(f[0].z, f[1].z, f[2].z, f[3].z, t[0].z, t[1].z, t[2].z, t[3].z, n, b.low.z, b.high.z);
  return b;
}

/// Whether the way of a node comes into a box; most do not along the first axis.
SCREE_HD inline bool comes_into(const Bounds& box, const AffineVec& from, const AffineVec& to,
                                const TreeNode& n) {
  const Vec3d *f = from.node, *t = to.node;
  double low, high;
  sweep_axis(f[0].x, f[1].x, f[2].x, f[3].x, t[0].x, t[1].x, t[2].x, t[3].x, n, low, high);
  if (low > box.high.x || high < box.low.x) return false;
  sweep_axis(f[0].y, f[1].y, f[2].y, f[3].y, t[0].y, t[1].y, t[2].y, t[3].y, n, low, high);
  if (low > box.high.y || high < box.low.y) return false;
  sweep_axis(f[0].z, f[1].z, f[2].z, f[3].z, t[0].z, t[1].z, t[2].z, t[3].z, n, low, high);
  return !(low > box.high.z || high < box.low.z);
}

/// Part of a coordinate that rounding changes at most, where boxes of corners and boxes of nodes are worked out with other sums:
/// a few times 2^-53, and ten times as much to be sure.
inline constexpr double kRounding = 1e-14;

/// How far rounding moves what is worked out of a body along its way at most [m].
SCREE_HD inline double rounding_of(const AffineVec& from, const AffineVec& to, double radius) {
  double largest = 0;
  for (int k = 0; k < 3; ++k) {
    for (int end = 0; end < 2; ++end) {
      const AffineVec& q = end == 0 ? from : to;
      const double size =
          std::abs(q.node[0][k]) +
          radius * (std::abs(q.node[1][k]) + std::abs(q.node[2][k]) + std::abs(q.node[3][k]));
      largest = size > largest ? size : largest;
    }
  }
  return kRounding * largest;
}

/// A box in coordinates of a body, where its trees are as they were made.
struct BodySpaceBox {
  Vec3d center, half;  ///< [m]
  double slack = 0;    ///< by which leaves may stick out of boxes above them, as floats are [m]

  /// Never a leaf without all that is above it: then a search that begins in the middle of a tree finds the same.
  SCREE_HD bool meets(const TreeNode& n) const {
    const double more = n.is_leaf() ? 0 : slack;
    return !(std::abs(n.center[0] - center.x) > n.half[0] + half.x + more ||
             std::abs(n.center[1] - center.y) > n.half[1] + half.y + more ||
             std::abs(n.center[2] - center.z) > n.half[2] + half.z + more);
  }
};

/// A body that goes straight from one place to another, as what comes near is looked for in its trees.
struct SearchedBody {
  Vec3d center;         ///< at the start
  Vec3d across[3];      ///< rows of A^-1 there
  Vec3d low, high;      ///< least and largest coordinates of the ways of its points [m]
  double slack;         ///< see BodySpaceBox
  bool is_flat = true;  ///< A has no inverse to speak of: all of the body is searched

  SCREE_HD SearchedBody(const AffineVec& from, const AffineVec& to, double radius)
      : center(from.node[0]), slack(1e-6 * radius) {
    const Vec3d *a = from.node + 1, *b = to.node + 1;
    const double per_volume = 1 / determinant(from);
    for (int k = 0; k < 3; ++k) across[k] = per_volume * cofactor(from, k + 1);
    double length = 0, inverse = 0;
    for (int k = 0; k < 3; ++k) length += norm2(a[k]), inverse += norm2(across[k]);
    is_flat = !(length * inverse < 1e8);
    for (int k = 0; k < 3; ++k) {
      const Vec3d turn{b[0][k] - a[0][k], b[1][k] - a[1][k], b[2][k] - a[2][k]};
      const double most = radius * norm(turn), way = to.node[0][k] - center[k];
      low[k] = way - most < 0 ? way - most : 0;
      high[k] = way + most > 0 ? way + most : 0;
    }
  }

  /// A box that meets all nodes which may come within a reach, along every axis of the world, of a feature of another body on
  /// its way, at any times; and more of them.
  SCREE_HD BodySpaceBox around(const AffineVec& from, const AffineVec& to,
                               Span<const Vec3d> corners, const Feature& feature,
                               double reach) const {
    if (is_flat) return {{}, {1e300, 1e300, 1e300}, slack};
    Bounds box;
    double far = 0;
    for (int k = 0; k < 6; ++k) {
      if (k >= 2 * feature.count) break;
      const Vec3d at = point_of(k % 2 == 0 ? from : to, corners[feature.corner[k / 2]]) - center;
      box.add(Vec3d{dot(across[0], at), dot(across[1], at), dot(across[2], at)});
      const double own = norm2(at);
      far = own > far ? own : far;
    }
    far = 1e-11 * std::sqrt(far);  // what rounding of the inverse may do
    // A point of the body that is at x some time was at x less its way till then.
    const Vec3d shift = -0.5 * (low + high), room = 0.5 * (high - low) + Vec3d{reach, reach, reach};
    BodySpaceBox seen;
    seen.slack = slack;
    for (int k = 0; k < 3; ++k) {
      const Vec3d& r = across[k];
      seen.center[k] = 0.5 * (box.low[k] + box.high[k]) + dot(r, shift);
      seen.half[k] = 0.5 * (box.high[k] - box.low[k]) + std::abs(r.x) * room.x +
                     std::abs(r.y) * room.y + std::abs(r.z) * room.z + far * norm(r);
    }
    return seen;
  }
};

}  // namespace scree::affine
