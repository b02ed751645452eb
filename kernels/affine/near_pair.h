#pragma once
// Pairs of features of bodies that may touch, as the passes of a step read them.

#include "kernels/affine/affine_state.h"
#include "kernels/affine/nearest.h"

namespace scree::affine {

/// A corner and a triangle, or two edges, of two bodies.
struct NearPair {
  Index vertex[4] = {};  ///< in the table of all corners, in the order of Four
  Index bodies = 0;      ///< their BodyPair
  PairKind kind = PairKind::point_triangle;
  bool is_swapped = false;  ///< the first feature belongs to the second body of that pair
};

/// Two bodies with near features, and where these are in the list.
struct BodyPair {
  Index body[2] = {};  ///< the first is lower
  Index begin = 0, end = 0;
};

/// Lists of a search, in an order that depends on bodies alone: body pairs rise by their two bodies, and
/// the features of each lie beside each other.
struct NearPairsView {
  Span<const NearPair> pairs;
  Span<const BodyPair> bodies;
  Span<const Vec3d> corners;  ///< of all surfaces, in coordinates of their bodies [m]

  /// The body of the first or second feature. @param side  0 or 1
  SCREE_HD Index body_of(const NearPair& pair, int side) const {
    return bodies[pair.bodies].body[pair.is_swapped ? 1 - side : side];
  }
  /// The four points of a pair in coordinates of their bodies [m].
  SCREE_HD Four rest_of(const NearPair& pair) const {
    Four rest;
    for (int i = 0; i < 4; ++i) rest[i] = corners[pair.vertex[i]];
    return rest;
  }
};

/// Where the points of a pair are, or how they move. @param q  by body
SCREE_HD inline Four points_of(const NearPairsView& near, const NearPair& pair, const Four& rest,
                               Span<const AffineVec> q) {
  const AffineVec &first = q[near.body_of(pair, 0)], &second = q[near.body_of(pair, 1)];
  const int split = first_points(pair.kind);
  Four x;
  for (int i = 0; i < 4; ++i) x[i] = point_of(i < split ? first : second, rest[i]);
  return x;
}

}  // namespace scree::affine
