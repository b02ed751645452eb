#pragma once
// From the four points of a pair to the twelve coordinates of its two bodies.

#include "kernels/affine/affine_state.h"
#include "kernels/affine/nearest.h"
#include "kernels/math/dense.h"

namespace scree::affine {

/// Adds the forces on four points to those on their bodies: f += J^T g.
/// @param rest  the points in coordinates of their bodies [m]
SCREE_HD inline void add_forces(PairKind kind, const Four& rest, const Four& g, AffineVec& first,
                                AffineVec& second) {
  for (int i = 0; i < 4; ++i) add_force(i < first_points(kind) ? first : second, rest[i], g[i]);
}

/// Adds s (1, X) (1, Y)^T x K, the matrix K between two points of bodies, to a block of bodies.
SCREE_HD inline void add_between_points(const Vec3d& x, const Vec3d& y, const Dense<3>& k, double s,
                                        Dense<12>& block) {
  for (int c = 0; c < 4; ++c) {
    for (int d = 0; d < 4; ++d) {
      const double scale = s * node_weight(x, c) * node_weight(y, d);
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) block(3 * c + i, 3 * d + j) += scale * k(i, j);
    }
  }
}

/// Blocks of the two bodies of a pair; the one below the diagonal is the transpose of `mixed`.
struct BodyBlocks {
  Dense<12> first;   ///< first body with itself
  Dense<12> mixed;   ///< first with second
  Dense<12> second;  ///< second body with itself
};

/// Adds J^T h J for the matrix h of four points.
SCREE_HD inline void add_blocks(PairKind kind, const Four& rest, const Dense<12>& h,
                                BodyBlocks& blocks) {
  const int split = first_points(kind);
  for (int p = 0; p < 4; ++p) {
    for (int q = 0; q < 4; ++q) {
      if (p >= split && q < split) continue;
      Dense<3> k;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) k(i, j) = h(3 * p + i, 3 * q + j);
      add_between_points(rest[p], rest[q], k, 1,
                         q < split   ? blocks.first
                         : p < split ? blocks.mixed
                                     : blocks.second);
    }
  }
}

/// The points of both bodies that touch, in their coordinates: a pair whose matrix has the blocks
/// w_i w_j K acts as K between these two, six numbers in place of twelve.
struct TouchingPoints {
  Vec3d first, second;  ///< [m]
};

SCREE_HD inline TouchingPoints touching_points(PairKind kind, const Four& rest,
                                               const double (&weight)[4]) {
  TouchingPoints t;
  for (int i = 0; i < 4; ++i) {
    if (i < first_points(kind))
      t.first += weight[i] * rest[i];
    else
      t.second -= weight[i] * rest[i];
  }
  return t;
}

/// Adds the blocks of such a pair: K between the touching points, against each other.
SCREE_HD inline void add_blocks(const TouchingPoints& t, const Dense<3>& k, BodyBlocks& blocks) {
  add_between_points(t.first, t.first, k, 1, blocks.first);
  add_between_points(t.first, t.second, k, -1, blocks.mixed);
  add_between_points(t.second, t.second, k, 1, blocks.second);
}

}  // namespace scree::affine
