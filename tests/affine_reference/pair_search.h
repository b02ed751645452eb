#pragma once
// Pairs of corners, edges and triangles of different bodies that are near each other.

#include <array>
#include <functional>
#include <vector>

#include "kernels/affine/contact_potential.h"
#include "tests/affine_reference/affine_system.h"

namespace scree::affine {

/// A pair: the point or edge A of one body, the triangle or edge B of another.
struct SurfacePair {
  PairKind kind = PairKind::point_triangle;
  std::array<int, 2> body{};
  std::array<int, 4> vertex{};
};

/// The four points of a pair in coordinates of their bodies [m].
Four rest_points(const std::vector<AffineBody>& bodies, const SurfacePair& pair);

/// Where they are with the bodies at `q`, or how they move. @param q  one entry a body
Four points_of(const std::vector<AffineVec>& q, const SurfacePair& pair, const Four& rest);

/// Pairs whose boxes come within a distance while the bodies move straight from one place to
/// another, in a fixed order. Two fixed bodies have none.
/// @param may_touch  of two bodies by their numbers; those that do not have none. Left out: all do
std::vector<SurfacePair> pairs_near(const std::vector<AffineBody>& bodies,
                                    const std::vector<AffineVec>& from,
                                    const std::vector<AffineVec>& to, double distance,
                                    const std::function<bool(int, int)>& may_touch = {});

}  // namespace scree::affine
