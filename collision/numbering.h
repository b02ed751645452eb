#pragma once
// Counts that pass through 64 bits before anything is numbered with an Index.

#include <limits>
#include <stdexcept>
#include <string>

#include "kernels/broad_phase/pair_candidates.h"

namespace scree {

/// Whether an Index numbers so many elements and the place behind the last one.
constexpr bool can_number(Offset count) { return count < std::numeric_limits<Index>::max(); }

/// The same for the pairs of a list of near pairs and its pieces.
inline bool can_number(Index owned_count, Offset pairs) {
  return can_number(pairs) && can_number(first_piece(owned_count, pairs));
}

/// The count as an Index.
/// @param fits  whether it can be numbered
/// @param what  is counted, for the message
/// @throws std::runtime_error with the number when it does not fit
inline Index checked_index(Offset count, bool fits, const char* what) {
  if (fits) return static_cast<Index>(count);
  throw std::runtime_error(std::to_string(count) + " " + what +
                           " are more than one run can number (2^31)");
}

}  // namespace scree
