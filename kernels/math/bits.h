#pragma once
// Bits of a word.

#include <bit>
#include <cstdint>

#include "kernels/types.h"

namespace scree {

/// Place of the lowest bit that is set. @param bits  not zero
SCREE_HD inline int lowest_bit(std::uint32_t bits) {
#ifdef __CUDA_ARCH__
  return __ffs(static_cast<int>(bits)) - 1;
#else
  return std::countr_zero(bits);
#endif
}

/// How many bits are set.
SCREE_HD inline int count_bits(std::uint32_t bits) {
#ifdef __CUDA_ARCH__
  return __popc(bits);
#else
  return std::popcount(bits);
#endif
}

}  // namespace scree
