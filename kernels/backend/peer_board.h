#pragma once
// Where GPUs of ranks leave words for each other.

#include <cstdint>

namespace scree {

/// What a rank writes from within a kernel: 4 bytes of data, and in its upper half the number of the meeting they belong to.
using PeerWord = std::uint64_t;

/// Where ranks meet from within their kernels: what the others tell a rank lies on its own board. It starts at zero.
struct PeerBoard {
  static constexpr int kMostRanks = 16;
  static constexpr int kSumWords = 6;      ///< three sums in double
  static constexpr int kRecordWords = 32;  ///< of a record of a reduction

  PeerWord sums[2][kMostRanks][kSumWords];       ///< what each rank brought, by turns
  PeerWord record[2][kMostRanks][kRecordWords];  ///< the same between kernels
  unsigned meetings;                             ///< within kernels so far; the rank's own
};

/// The boards of all ranks, as one of them reaches them. Programs on the device have it by value.
struct PeerBoards {
  int rank = 0, ranks = 0;
  PeerBoard* board[PeerBoard::kMostRanks] = {};  ///< of each rank
};

}  // namespace scree
