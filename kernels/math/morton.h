#pragma once
// Morton (Z-order) codes: cells that are close in space are mostly close in the order
// of their codes.

#include "kernels/types.h"

namespace scree {

inline constexpr int kMortonBits = 20;  ///< bits per axis
inline constexpr std::uint32_t kMortonMask = (1u << kMortonBits) - 1;

/// Moves bit k of the low 20 bits to bit 3 k.
SCREE_HD inline std::uint64_t spread_bits(std::uint32_t value) {
  std::uint64_t x = value & kMortonMask;
  x = (x | x << 32) & 0x001f00000000ffffull;
  x = (x | x << 16) & 0x001f0000ff0000ffull;
  x = (x | x << 8) & 0x100f00f00f00f00full;
  x = (x | x << 4) & 0x10c30c30c30c30c3ull;
  x = (x | x << 2) & 0x1249249249249249ull;
  return x;
}

/// Moves bit k of the low 8 bits to bit 2 k: codes in a plane.
SCREE_HD inline std::uint32_t spread_bits_plane(std::uint32_t value) {
  std::uint32_t x = value & 0xffu;
  x = (x | x << 4) & 0x0f0fu;
  x = (x | x << 2) & 0x3333u;
  x = (x | x << 1) & 0x5555u;
  return x;
}

/// Inverse of spread_bits.
SCREE_HD inline std::uint32_t gather_bits(std::uint64_t x) {
  x &= 0x1249249249249249ull;
  x = (x | x >> 2) & 0x10c30c30c30c30c3ull;
  x = (x | x >> 4) & 0x100f00f00f00f00full;
  x = (x | x >> 8) & 0x001f0000ff0000ffull;
  x = (x | x >> 16) & 0x001f00000000ffffull;
  x = (x | x >> 32) & kMortonMask;
  return static_cast<std::uint32_t>(x);
}

/// Code of the cell (x, y, z); coordinates wrap modulo 2^20.
SCREE_HD inline std::uint64_t morton_code(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return spread_bits(x) | spread_bits(y) << 1 | spread_bits(z) << 2;
}

}  // namespace scree
