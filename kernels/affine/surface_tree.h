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
  Index tree[4] = {};   ///< trees of corners, edges and triangles: nodes [tree[k], tree[k + 1])
  Index block[4] = {};  ///< of these trees: places [block[k], block[k + 1]) in the list of blocks
  Index outline_begin = 0, outline_end = 0;
  double radius = 0;  ///< of the farthest corner [m]
};

/// Tables of all surfaces.
struct SurfacesView {
  Span<const Vec3d> corners;           ///< surface by surface, in their order there
  Span<const Feature> features;        ///< in the order of the trees
  Span<const TreeNode> nodes;          ///< of all trees
  Span<const Index> blocks;            ///< nodes that hold all features, and one behind them
  Span<const TreeNode> outline;        ///< a few boxes that hold each surface
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

/// A box in coordinates of a body, where its trees and features are as they were made.
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
  SCREE_HD bool meets(Span<const Vec3d> corners, const Feature& feature) const {
    const Vec3d first = corners[feature.corner[0]];
    Vec3d low = first, high = first;
    for (int i = 1; i < 3; ++i) {
      if (i >= feature.count) break;
      const Vec3d x = corners[feature.corner[i]];
      for (int k = 0; k < 3; ++k) {
        low[k] = x[k] < low[k] ? x[k] : low[k];
        high[k] = x[k] > high[k] ? x[k] : high[k];
      }
    }
    return !(low.x > center.x + half.x || high.x < center.x - half.x || low.y > center.y + half.y ||
             high.y < center.y - half.y || low.z > center.z + half.z || high.z < center.z - half.z);
  }
};

/// How one body goes along its straight way, as another that goes along its own sees it at the same time. With the other at
/// A + t dA at a time t from 0 to 1 and E = A^-1 dA, a corner that is at y = A^-1 (x - p) at first, and w away at the end from
/// where the other carries y, goes along y + t (I + t E)^-1 A^-1 w: bodies that go together hardly move. Where the other turns
/// far, the ways of both in the world are taken, at any times. docs/theory.md, "Barrier contact".
struct RelativeWay {
  AffineVec first,
      last;    ///< places in the other's coordinates: straight from one to the other but for `bend`
  Vec3d room;  ///< by which boxes about what goes so are widened [m]
  double bend = 0;   ///< by which the way leaves a straight one, over its length
  double slack = 0;  ///< see BodySpaceBox

  RelativeWay() = default;
  /// @param from, to    the body
  /// @param start, end  the other
  /// @param radius, other_radius  distances of their farthest corners [m]
  /// @param reach       distance of what is near [m]
  SCREE_HD RelativeWay(const AffineVec& from, const AffineVec& to, double radius,
                       const AffineVec& start, const AffineVec& end, double other_radius,
                       double reach)
      : slack(1e-6 * other_radius) {
    const double per_volume = 1 / determinant(start);
    Vec3d across[3];  // rows of A^-1
    double length2 = 0, inverse2 = 0, size2 = 0;
    for (int k = 0; k < 3; ++k) {
      across[k] = per_volume * cofactor(start, k + 1);
      length2 += norm2(start.node[k + 1]), inverse2 += norm2(across[k]);
      size2 += norm2(from.node[k + 1]) + norm2(to.node[k + 1]);
    }
    if (!(length2 * inverse2 < 1e8)) {  // it has no inverse to speak of: all of it is near
      room = {1e300, 1e300, 1e300};
      return;
    }
    const auto in_other = [&](const Vec3d& x) {
      return Vec3d{dot(across[0], x), dot(across[1], x), dot(across[2], x)};
    };
    // |(I + t E) x|^2 >= 1 - 2 lambda for all |x| = 1, where -lambda is below all eigenvalues of the symmetric part of E: of a
    // turn they are of second order in its angle.
    Vec3d e[3];  // columns
    double e2 = 0, lambda = 0;
    for (int k = 0; k < 3; ++k) e[k] = in_other(end.node[k + 1] - start.node[k + 1]);
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      const double low =
          0.5 * std::abs(e[k][i] + e[i][k]) + 0.5 * std::abs(e[k][j] + e[j][k]) - e[k][k];
      lambda = low > lambda ? low : lambda;
      e2 += norm2(e[k]);
    }
    const bool turns_far = !(lambda < kMostShrunk);
    Vec3d shift;  // of a point that is at x some time: it was at x less its way till then
    Vec3d reaches;
    double near = 0;  // distance in the other's coordinates at any time of what is within reach
    if (turns_far) {
      for (int k = 0; k < 3; ++k) {
        const double way = end.node[0][k] - start.node[0][k];
        const Vec3d turn{end.node[1][k] - start.node[1][k], end.node[2][k] - start.node[2][k],
                         end.node[3][k] - start.node[3][k]};
        const double most = other_radius * norm(turn);
        const double low = way - most < 0 ? way - most : 0, high = way + most > 0 ? way + most : 0;
        shift[k] = -0.5 * (low + high);
        reaches[k] = reach + 0.5 * (high - low);
      }
    } else {
      bend = std::sqrt(e2 / (1 - 2 * lambda));
      near = largest_stretch(across) * reach / std::sqrt(1 - 2 * lambda);
    }
    for (int n = 0; n < 4; ++n) {
      const Vec3d before = n == 0 ? from.node[0] - start.node[0] + shift : from.node[n];
      first.node[n] = in_other(before);
      const Vec3d carried = end.node[1] * first.node[n].x + end.node[2] * first.node[n].y +
                            end.node[3] * first.node[n].z;
      if (turns_far) {
        last.node[n] = in_other(n == 0 ? to.node[0] - start.node[0] + shift : to.node[n]);
      } else {
        last.node[n] =
            first.node[n] + in_other((n == 0 ? to.node[0] - end.node[0] : to.node[n]) - carried);
      }
    }
    // What rounding may do to all of that.
    const double size = norm(from.node[0] - start.node[0]) + norm(to.node[0] - start.node[0]) +
                        std::sqrt(size2) * radius;
    for (int k = 0; k < 3; ++k) {
      const Vec3d& r = across[k];
      room[k] = std::abs(r.x) * reaches.x + std::abs(r.y) * reaches.y + std::abs(r.z) * reaches.z +
                2e-11 * size * norm(r) + near;
    }
  }

  /// A box that meets all nodes and features of the other which may come within reach of a feature, and more of them.
  SCREE_HD BodySpaceBox around(Span<const Vec3d> corners, const Feature& feature) const {
    Bounds box;
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
      if (k >= feature.count) break;
      const Vec3d rest = corners[feature.corner[k]];
      const Vec3d a = point_of(first, rest), b = point_of(last, rest);
      box.add(a), box.add(b);
      const double way = norm2(b - a);
      longest = way > longest ? way : longest;
    }
    BodySpaceBox seen = widened(box, bend * std::sqrt(longest));
    seen.slack = slack;
    return seen;
  }

  /// The same about all that is in a node.
  SCREE_HD BodySpaceBox around(const TreeNode& node) const {
    double more = 0;
    if (bend > 0) {
      Vec3d way = last.node[0] - first.node[0];
      double length = 0;
      for (int k = 0; k < 3; ++k) {
        const Vec3d along = last.node[k + 1] - first.node[k + 1];
        way += static_cast<double>(node.center[k]) * along;
        length += node.half[k] * norm(along);
      }
      more = bend * (norm(way) + length);
    }
    return widened(swept(first, last, node), more + slack);
  }

 private:
  static constexpr double kMostShrunk = 0.375;  ///< lengths become half as long at most

  SCREE_HD BodySpaceBox widened(const Bounds& box, double more) const {
    BodySpaceBox seen;
    for (int k = 0; k < 3; ++k) {
      seen.center[k] = 0.5 * (box.low[k] + box.high[k]);
      seen.half[k] = 0.5 * (box.high[k] - box.low[k]) + room[k] + more;
    }
    return seen;
  }
  /// A bound of the largest singular value.
  static SCREE_HD double largest_stretch(const Vec3d rows[3]) {
    double most = 0;
    for (int i = 0; i < 3; ++i) {
      double sum = 0;
      for (int k = 0; k < 3; ++k) sum += std::abs(dot(rows[i], rows[k]));
      most = sum > most ? sum : most;
    }
    return std::sqrt(most);
  }
};

}  // namespace scree::affine
