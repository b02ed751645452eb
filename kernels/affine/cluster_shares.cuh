#pragma once
// How the blocks of a cluster share the rows of a system, and what each keeps of them in its shared memory. See cluster_gradients.cuh.

#include "kernels/affine/block_gradients.h"
#include "kernels/backend/cuda.cuh"

namespace scree::affine::cluster_gradients {

inline constexpr int kThreads = 512;
inline constexpr int kWarps = kThreads / 32;
inline constexpr int kMostBlocks = 16;  ///< of a cluster; more than eight are not portable
/// Blocks share rows by their entries and this much a row, for the inverse, the diagonal block and what else there is to do. Less
/// where some blocks would have no room for their share of the matrix; two is what a row takes of that.
inline constexpr Index kRowWork = 8, kLeastRowWork = 2;
/// Most entries of a part of a row.
inline constexpr Index kPart = 16;
/// Lines 2 a and 2 a + 1 of a block's product are found by lanes a, a + 6, a + 12 and a + 18, from three columns each.
inline constexpr int kPairs = 6, kColumns = 3, kLanes = 24;

/// A 12x12 block as lanes read it: lane after lane, column after column of the lane.
struct LaneBlock {
  double2 entry[kColumns][kLanes];
};
static_assert(sizeof(LaneBlock) == sizeof(Dense<12>));

/// A part of a row, two numbers a lane of vectors: the direction of the row, and the share of the part in its image. Blocks of the
/// matrix have places in the order of rows: the inverse of a row, its diagonal block, the others.
struct Part {
  double2 p[kPairs], s[kPairs];
  Index row, from;  ///< the entry of the row that it begins with
  /// Of its blocks. The first part of a row has the diagonal block too, and the place before that is the one of the inverse.
  Index place, end;
  Index slot;      ///< where the block that has the row wants the share; below zero: it is this one
  unsigned owner;  ///< that block
};

/// What a row keeps besides its first part.
struct RowVectors {
  double2 x[kPairs], r[kPairs];
  Index tail, tail_end;  ///< its other parts in this block
  unsigned wanted;       ///< bit b: block b has a part that wants z of this one
  unsigned unused;
};

/// A place among the parts of all rows. Part 0 is there without entries too.
struct Cut {
  Index row, part;

  /// The first row that begins there or later.
  __device__ Index next_row() const { return part > 0 ? row + 1 : row; }
};

/// What blocks meet with.
struct alignas(16) Sums {
  double of_warp[kWarps];
  double of_block[2][kMostBlocks];  ///< in turn
  Cut cut[kMostBlocks + 1];         ///< where parts of blocks begin, and their end
  Index tails;
};
static_assert(kWarps == 16 && kMostBlocks == 16);  // halves of a warp

/// Bytes of shared memory besides the blocks of the matrix.
struct Needs {
  std::size_t z, sums = sizeof(Sums), row = sizeof(RowVectors) + sizeof(Part);
  static constexpr std::size_t kBlockLists = 2 * sizeof(Index);  ///< of a block of the matrix
  __host__ __device__ explicit Needs(std::size_t rows) : z(rows * sizeof(AffineVec)) {}
};
/// Most rows of a block.
inline std::size_t most_own_rows(std::size_t rows, std::size_t mixed, unsigned blocks,
                                 Index row_work) {
  const auto work = static_cast<std::size_t>(row_work);
  return std::min(rows, (2 * mixed + work * rows) / (work * blocks) + 1);
}
/// No block needs more, whatever the order of long and short rows.
inline std::size_t most_needed(std::size_t rows, std::size_t mixed, unsigned blocks) {
  const Needs needs(rows);
  const std::size_t own = most_own_rows(rows, mixed, blocks, kLeastRowWork);
  const std::size_t work = (2 * mixed + kRowWork * rows) / blocks + 1;
  const std::size_t tails = work / kPart + 1, slots = rows / kPart + 1;
  const std::size_t listed = work + kPart + 2 * own;
  return needs.z + needs.sums + own * needs.row + tails * sizeof(Part) + slots * sizeof(AffineVec) +
         listed * Needs::kBlockLists + sizeof(double2);
}

/// How the parts of rows are shared.
struct Shares {
  const Index* begin;  ///< of the entries of rows
  Index rows;
  unsigned blocks;
  Index row_work;

  __device__ Shares(const BlockLists& lists, Index all, unsigned of, unsigned bytes)
      : begin(lists.begin.data), rows(all), blocks(of) {
    const Needs needs(static_cast<std::size_t>(rows));
    const auto own = static_cast<std::size_t>(rows) / blocks + 1;
    const auto left =
        static_cast<Offset>(bytes) - static_cast<Offset>(needs.z + needs.sums + own * needs.row);
    constexpr Index kSpare = kPart + 8;  // a block may have that much more than its share
    const Offset room = left / static_cast<Offset>(sizeof(LaneBlock) + Needs::kBlockLists) - kSpare;
    const Offset work = (room * blocks - begin[rows]) / rows;
    row_work = static_cast<Index>(
        min(max(work, static_cast<Offset>(kLeastRowWork)), static_cast<Offset>(kRowWork)));
  }

  __device__ Offset before(Index row) const { return begin[row] + Offset{row_work} * row; }
  /// The first part that begins no earlier than the share of a block.
  __device__ Cut cut(unsigned block) const {
    const Offset wanted = before(rows) * block / blocks;
    Index low = 0, high = rows;
    while (low < high) {
      const Index middle = (low + high) / 2;
      if (before(middle) < wanted) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    if (low == 0) return {0, 0};
    const Offset missing = wanted - before(low - 1) - row_work;
    const auto part = static_cast<Index>(missing > kPart ? (missing + kPart - 1) / kPart : 1);
    return part < parts(low - 1) ? Cut{low - 1, part} : Cut{low, 0};
  }
  __device__ Index parts(Index row) const {
    const Index entries = begin[row + 1] - begin[row];
    return entries > kPart ? (entries + kPart - 1) / kPart : 1;
  }
};

}  // namespace scree::affine::cluster_gradients
