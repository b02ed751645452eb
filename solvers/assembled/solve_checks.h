#pragma once
// What every solve checks before it starts, whatever the rows of a contact.

#include <cstddef>
#include <utility>
#include <vector>

#include "solvers/assembled/assembled_result.h"

namespace scree {

/// Parts of a problem by matrices whose sizes have to agree.
struct ProblemParts {
  int contact_count = 0;
  int contact_rows = 3;  ///< of q
  const std::vector<double>& q;
  /// One value a contact, with their names.
  std::vector<std::pair<const char*, const std::vector<double>*>> coefficients;
  std::size_t matrix_rows = 0;  ///< of W as it is stored: contacts where that is in blocks
  const std::vector<int>& row_start;
  const std::vector<int>& column;
  std::size_t entry_count = 0;  ///< numbers or blocks of W
};

/// @throws AssembledError naming the first part of the wrong size, or option out of its range, and
///         what is expected
void check_rows_and_options(const ProblemParts& p, const AssembledOptions& o);

}  // namespace scree
