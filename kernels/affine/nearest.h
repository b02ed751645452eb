#pragma once
// Nearest points of a point and a triangle, and of two edges, with derivatives of their squared
// distance. docs/theory.md, "Barrier contact".

#include "kernels/math/vec3.h"

namespace scree::affine {

using Vec3d = Vec3<double>;

/// Four points of a pair, or a vector for each: a point and the corners of a triangle, or the ends
/// of edge A and of edge B.
struct Four {
  Vec3d at[4];
  SCREE_HD Vec3d& operator[](int i) { return at[i]; }
  SCREE_HD const Vec3d& operator[](int i) const { return at[i]; }
};

enum class PairKind : std::uint8_t { point_triangle, edge_edge };

/// How many of the four points belong to the first body.
SCREE_HD inline int first_points(PairKind kind) { return kind == PairKind::point_triangle ? 1 : 2; }

/// Nearest points of a pair as weights of the four points: the nearest point of A less that of B is
/// their weighted sum. Weights of A add up to 1, those of B to -1.
struct Nearest {
  Vec3d gap;               ///< nearest point of A less that of B [m]
  double squared = 1e300;  ///< its square D [m^2]
  double weight[4] = {};
  int free = 0;             ///< parameters that are not at a bound: 0 to 2, where points are fixed,
                            ///< on an edge, or on a triangle or two edges
  double slope[2][4] = {};  ///< derivatives of the weights with respect to these
};

/// Nearest points before their weights are worked out.
struct NearestPlace {
  Vec3d gap;                ///< as of Nearest
  double squared = 1e300;   ///< its square [m^2]
  double s = 0, t = 0;      ///< of nearest_parameters() where both are inside, else t on the edge
  int point = -1;           ///< a point next to an edge; -1: both are inside
  int edge[2] = {};         ///< its ends
  double sign = 1;          ///< 1 where the point belongs to A, -1 where the edge does
  bool is_on_edge = false;  ///< and not at one of its ends
};

/// Takes the nearest point of the edge (a, b) to the point p if it is nearer than what was found.
/// @param sign  1 where the point belongs to A, -1 where the edge does
SCREE_HD inline void try_point_edge(const Four& x, int p, int a, int b, double sign,
                                    NearestPlace& best) {
  const Vec3d edge = x[b] - x[a], d = x[p] - x[a];
  const double along = dot(d, edge), length = norm2(edge);
  const bool free = along > 0 && along < length;
  const double t = free ? along / length : along > 0 ? 1 : 0;
  const Vec3d gap = t == 1 ? x[p] - x[b] : d - t * edge;
  const double squared = norm2(gap);
  if (!(squared < best.squared)) return;
  best = {sign * gap, squared, 0, t, p, {a, b}, sign, free};
}

/// Parameters of the smallest |d + s e + t f|, with one step that takes out what rounding left of
/// the residual. @return the square of the sine between e and f; 0 where they are too near parallel
SCREE_HD inline double nearest_parameters(const Vec3d& d, const Vec3d& e, const Vec3d& f, double& s,
                                          double& t) {
  const Vec3d n = cross(e, f);
  const double area = norm2(n), ee = norm2(e), ff = norm2(f), ef = dot(e, f);
  if (!(area > 1e-20 * ee * ff)) return 0;
  s = dot(cross(f, d), n) / area;
  t = dot(cross(d, e), n) / area;
  const Vec3d r = d + s * e + t * f;
  const double re = dot(r, e), rf = dot(r, f);
  s -= (ff * re - ef * rf) / area;
  t -= (ee * rf - ef * re) / area;
  return area / (ee * ff);
}

/// Above this square of the sine, nearest points inside are the nearest ones for certain: no edge or end is tried.
inline constexpr double kWellDefined = 1e-4;

/// Of the point x[0] and the triangle of the others.
SCREE_HD inline NearestPlace nearest_place_on_triangle(const Four& x) {
  NearestPlace best;
  const Vec3d d = x[0] - x[1], e = x[2] - x[1], f = x[3] - x[1];
  const double sine = nearest_parameters(d, -e, -f, best.s, best.t);
  if (sine > 0 && best.s > 0 && best.t > 0 && best.s + best.t < 1) {
    best.gap = d - best.s * e - best.t * f;
    best.squared = norm2(best.gap);
    if (sine > kWellDefined) return best;
  }
  try_point_edge(x, 0, 1, 2, 1, best);
  try_point_edge(x, 0, 2, 3, 1, best);
  try_point_edge(x, 0, 3, 1, 1, best);
  return best;
}

/// Of the edges (x[0], x[1]) and (x[2], x[3]).
SCREE_HD inline NearestPlace nearest_place_on_edges(const Four& x) {
  NearestPlace best;
  const Vec3d d = x[0] - x[2], e = x[1] - x[0], f = x[3] - x[2];
  const double sine = nearest_parameters(d, e, -f, best.s, best.t);
  if (sine > 0 && best.s > 0 && best.s < 1 && best.t > 0 && best.t < 1) {
    best.gap = d + best.s * e - best.t * f;
    best.squared = norm2(best.gap);
    if (sine > kWellDefined) return best;
  }
  try_point_edge(x, 0, 2, 3, 1, best);
  try_point_edge(x, 1, 2, 3, 1, best);
  try_point_edge(x, 2, 0, 1, -1, best);
  try_point_edge(x, 3, 0, 1, -1, best);
  return best;
}

SCREE_HD inline NearestPlace nearest_place(PairKind kind, const Four& x) {
  return kind == PairKind::point_triangle ? nearest_place_on_triangle(x)
                                          : nearest_place_on_edges(x);
}

/// Square of the distance of a pair: all that most passes need [m^2].
SCREE_HD inline double squared_distance(PairKind kind, const Four& x) {
  return nearest_place(kind, x).squared;
}

SCREE_HD inline Nearest nearest_points(PairKind kind, const Four& x) {
  const NearestPlace at = nearest_place(kind, x);
  Nearest n;
  n.gap = at.gap;
  n.squared = at.squared;
  if (at.point >= 0) {
    n.free = at.is_on_edge ? 1 : 0;
    // Arrays whose indices a compiler does not know would lie in memory.
    for (int i = 0; i < 4; ++i) {
      if (i == at.point) n.weight[i] = at.sign;
      if (i == at.edge[0]) n.weight[i] = -at.sign * (1 - at.t);
      if (i == at.edge[1]) n.weight[i] = -at.sign * at.t;
      if (!at.is_on_edge) continue;
      if (i == at.edge[0]) n.slope[0][i] = at.sign;
      if (i == at.edge[1]) n.slope[0][i] = -at.sign;
    }
    return n;
  }
  n.free = 2;
  const double s = at.s, t = at.t;
  const bool is_triangle = kind == PairKind::point_triangle;
  const double on_triangle[3][4] = {{1, -(1 - s - t), -s, -t}, {0, 1, -1, 0}, {0, 1, 0, -1}};
  const double on_edges[3][4] = {{1 - s, s, -(1 - t), -t}, {-1, 1, 0, 0}, {0, 0, 1, -1}};
  for (int i = 0; i < 4; ++i) {
    n.weight[i] = is_triangle ? on_triangle[0][i] : on_edges[0][i];
    for (int k = 0; k < 2; ++k)
      n.slope[k][i] = is_triangle ? on_triangle[k + 1][i] : on_edges[k + 1][i];
  }
  return n;
}

/// Gradient of the squared distance: the free parameters are at a minimum and so do not add to it.
SCREE_HD inline Four distance_gradient(const Nearest& n) {
  Four g;
  for (int i = 0; i < 4; ++i) g[i] = (2 * n.weight[i]) * n.gap;
  return g;
}

}  // namespace scree::affine
