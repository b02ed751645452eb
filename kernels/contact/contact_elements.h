#pragma once
// How many contact elements a run takes, see kernels/contact/contact_key.h: they must fit 32 bits.

#include "kernels/contact/contact_key.h"

namespace scree {

struct ContactElements {
  std::uint64_t bodies = 0;
  int feature_bits = 0;      ///< that tell the contacts of two bodies apart
  std::uint64_t planes = 0;  ///< faces of half spaces and containers
  std::uint64_t solids = 0;  ///< elements of solid walls, in all their images

  std::uint64_t wall_begin() const { return bodies << feature_bits; }
  std::uint64_t solid_begin() const { return wall_begin() + planes * kPlaneSlots; }
  std::uint64_t end() const { return solid_begin() + solids; }
  bool fit() const { return end() < std::uint64_t{1} << 32; }
};

}  // namespace scree
