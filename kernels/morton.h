#pragma once
// Morton (Z-order) codes: cells that are close in space are mostly close in the order of their
// codes.

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

/// The same for the low 10 bits, in 32-bit arithmetic.
SCREE_HD inline std::uint32_t spread_bits_10(std::uint32_t value) {
  std::uint32_t x = value & 0x3ffu;
  x = (x | x << 16) & 0x030000ffu;
  x = (x | x << 8) & 0x0300f00fu;
  x = (x | x << 4) & 0x030c30c3u;
  x = (x | x << 2) & 0x09249249u;
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
