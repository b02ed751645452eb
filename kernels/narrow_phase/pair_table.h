#pragma once
// Which shapes can be in contact: what the list of pair functions holds, for the host.

#include <cstdint>
#include <vector>

#include "shapes/shape_kind.h"

namespace scree {

/// A pair function.
struct PairEntry {
  ShapeKind a;
  ShapeKind b;
  int feature_bits;  ///< that tell its contacts apart, of meshes those with one triangle; of planes and spheres 0
};

/// All of them, in the order of the list.
const std::vector<PairEntry>& pair_table();

/// That of two shapes in either order; null: there is none.
const PairEntry* find_pair(ShapeKind a, ShapeKind b);

/// Contact elements of an image of a mesh wall: one a triangle for spheres, then those of convex bodies.
/// @param bits  most feature bits of free bodies that meet it
constexpr std::uint64_t mesh_slots(std::uint64_t triangles, int bits) {
  return bits == 0 ? triangles : triangles + (triangles << bits);
}

}  // namespace scree
