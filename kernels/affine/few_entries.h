#pragma once
// Rows and blocks that few elements add to, listed by one launch: a tuned twin of NameEntries, a sort, FindRows, MarkBlocks,
// EndBlocks, NameHalves and the running sums between them, which for few entries are as many launches as they have to wait for.

#include "kernels/affine/assembly.h"

namespace scree {
class Cuda;
}

namespace scree::affine {

/// What is listed, and where.
struct FewEntries {
  /// Most entries: a block of threads sorts them in registers and shared memory.
  static constexpr Index kMost = 4096, kMostRows = 4096;

  Span<const BodyConstant> bodies;
  Span<const Element> elements;
  EntryKeys keys;
  Span<std::uint64_t> key;  ///< out, of each entry, rising
  Span<Index> entry;        ///< out: 2 element + side, in the order of the keys
  Span<Index> row_begin;    ///< out: see FindRows
  /// Out, as many as elements: first entry of each block above the diagonal, and where they end. Those behind the last block have none.
  Span<Index> block_begin, block_end;
  Span<Index> half, half_begin;  ///< out: see BlockHalves; room for two an element

  static constexpr bool fit(Index rows, Index entries) {
    return entries <= kMost && rows <= kMostRows;
  }
  Index count() const { return static_cast<Index>(2 * elements.size); }
};

/// Bytes: 100 an entry; it takes the latency of a sort of 4 bits at a time.
void list_few_entries(Cuda& cuda, const FewEntries& few);

}  // namespace scree::affine
