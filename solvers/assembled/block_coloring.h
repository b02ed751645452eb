#pragma once
// Colors of contacts, so that those of one color can be visited at once.

#include <vector>

#include "solvers/assembled/assembled_problem.h"

namespace scree {

/// Contacts color by color.
struct BlockColoring {
  std::vector<Index> contact;  ///< [contact_count] ascending within a color
  std::vector<Index> start;    ///< [color_count + 1] where in `contact` a color begins
  int color_count() const { return static_cast<int>(start.size()) - 1; }
};

/// Contacts of one color have no block in common, neither W_ck nor W_kc. Greedy: each contact, by
/// its number, takes the first color that no neighbor has yet, so there are at most as many as the
/// longest row has blocks when the pattern of W is symmetric. Time and memory grow with the blocks.
BlockColoring color_blocks(const AssembledProblem& p);

}  // namespace scree
