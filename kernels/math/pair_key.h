#pragma once
// Two 32-bit numbers as one 64-bit key, in the order of the first and then of the second.

#include "kernels/types.h"

namespace scree {

SCREE_HD inline std::uint64_t make_key(Index a, std::uint32_t element) {
  return static_cast<std::uint64_t>(a) << 32 | element;
}
SCREE_HD inline Index key_body(std::uint64_t key) { return static_cast<Index>(key >> 32); }
SCREE_HD inline std::uint32_t key_element(std::uint64_t key) {
  return static_cast<std::uint32_t>(key);
}

}  // namespace scree
