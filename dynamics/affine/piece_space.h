#pragma once
// Room for what pieces of the entries of rows and of blocks above the diagonal add up, both by one launch.

#include "kernels/affine/assembly.h"
#include "kernels/backend/backend.h"

namespace scree::affine {

/// Memory: twice 104 bytes for each of the 12 lines of a piece.
template <class B>
class PieceSpace {
 public:
  explicit PieceSpace(B& b) : line_(b) {}

  /// Pieces of rows or of blocks.
  struct Pieces {
    EntryRuns runs;
    Index items = 0;      ///< 12 a piece
    Span<LineSum> sum{};  ///< by item
  };
  struct OfBoth {
    Pieces rows, blocks;
  };

  /// Valid until the next call.
  /// @param row_begin, row_end, first, end  where entries of rows and of blocks begin and end
  /// @param entries  all of them
  OfBoth reserve(Span<const Index> row_begin, Span<const Index> row_end, Span<const Index> first,
                 Span<const Index> end, Index entries) {
    const Index piece = EntryRuns::piece_of(entries);
    OfBoth both{{{row_begin, row_end, piece}}, {{first, end, piece}}};
    both.rows.items = 12 * both.rows.runs.piece_end(entries);
    if (first.size > 0) both.blocks.items = 12 * both.blocks.runs.piece_end(entries);
    line_.reserve_discard(Offset{both.rows.items} + both.blocks.items);
    both.rows.sum = line_.view(both.rows.items);
    both.blocks.sum = {line_.data() + both.rows.items, both.blocks.items};
    return both;
  }

 private:
  Buffer<B, LineSum> line_;
};

}  // namespace scree::affine
