#pragma once
// Nested dissection: an order of elimination in which sparse factors fill up little.

#include <vector>

namespace scree {

/// Part of a graph that is eliminated at once.
struct DissectedPart {
  std::vector<int> nodes;
  /// Part that separates this one from others; -1: none. Larger than its own index.
  int parent = -1;
};

/// Splits a graph by levels of breadth-first search from one end of it: the smallest level near the
/// middle separates what is before it from what is behind it, and both are split in turn, down to
/// parts of a few nodes or to graphs without a middle, as those of dense matrices.
/// @param row_start, column  neighbors of every node, symmetric [count + 1], [row_start.back()]
/// @return parts, children before their parents; edges lead from a part only to itself, its
///         ancestors and its descendants
/// Source: George, SIAM J. Numer. Anal. 10, 1973; level structures as in George and Liu, Computer
/// Solution of Large Sparse Positive Definite Systems, 1981.
std::vector<DissectedPart> dissect(const std::vector<int>& row_start,
                                   const std::vector<int>& column);

}  // namespace scree
