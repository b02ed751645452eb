#pragma once
// Names of contacts: 64-bit keys that stay the same from step to step.
//
//   key = group << 63 | a << 32 | element
//   group: 0, or 1 for general contacts of the mixed layout
//   a: the owned body with the lower storage index
//   element, in 32 bits:
//     [0, wall_begin)              body b << feature_bits | feature
//     [wall_begin, solid_begin)    plane p of the walls, slot corner: wall_begin + 8 p + corner
//     [solid_begin, end)           solid walls, each with a range of its own: for a box one slot,
//                                  or one per feature where boxes meet it; for a mesh one per
//                                  triangle, and behind them one per triangle and feature where
//                                  boxes or capsules meet it

#include "kernels/math/pair_key.h"

namespace scree {

inline constexpr int kPlaneSlots = 8;

/// The bit of the group.
inline constexpr std::uint64_t kGeneralGroup = std::uint64_t{1} << 63;
/// Body A of a contact.
SCREE_HD inline Index contact_body(std::uint64_t key) { return key_body(key & ~kGeneralGroup); }

struct ContactKeys {
  int feature_bits = 0;     ///< 0 when every pair of bodies has at most one contact
  bool has_groups = false;  ///< mixed layout
  std::uint32_t wall_begin = 0;
  std::uint32_t solid_begin = 0;

  SCREE_HD std::uint32_t body_element(Index b, std::uint32_t feature) const {
    return static_cast<std::uint32_t>(b) << feature_bits | feature;
  }
  SCREE_HD bool is_body(std::uint32_t element) const { return element < wall_begin; }
  SCREE_HD Index body(std::uint32_t element) const {
    return static_cast<Index>(element >> feature_bits);
  }
  SCREE_HD std::uint32_t feature(std::uint32_t element) const {
    return element & ((1u << feature_bits) - 1);
  }
  SCREE_HD std::uint32_t plane_element(Index plane, int corner) const {
    return wall_begin + static_cast<std::uint32_t>(plane * kPlaneSlots + corner);
  }
};

}  // namespace scree
