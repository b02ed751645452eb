#pragma once
// The exchange of rows of bodies by one kernel on each GPU, where GPUs of ranks write into each other's memory: nothing waits
// for a kernel to end or for a host. Bytes that a rank sends: twice those of its rows.

#include "kernels/backend/peer_meeting.cuh"
#include "kernels/bodies/ghosts.h"

namespace scree {

/// All blocks are on the device at a time: they send before they wait. Each rank also hears of all others, so that none runs
/// ahead by two meetings, and two rooms do.
template <class Arrays>
__global__ void __launch_bounds__(Cuda::kBlock)
    swap_rows_kernel(const __grid_constant__ GhostLinks links,
                     const __grid_constant__ Arrays arrays, unsigned meeting) {
  constexpr Index kWords = Arrays::kBytes / static_cast<Index>(sizeof(PeerPiece));
  constexpr auto kRowBytes = static_cast<Index>(kWords * sizeof(PeerWord));
  const auto turn = static_cast<int>(meeting % 2);
  const int room = GhostLinks::kFirstOfSwaps + turn;
  const auto first = static_cast<Index>(blockIdx.x * blockDim.x + threadIdx.x);
  const auto stride = static_cast<Index>(gridDim.x * blockDim.x);
  const auto sent = static_cast<Index>(links.sent.size) * kWords;
  for (Index k = first; k < sent; k += stride) {
    const Index row = k / kWords, piece = k % kWords;
    auto* const to = reinterpret_cast<PeerWord*>(links.place(row, room, kRowBytes));
    put_piece(to[piece], *arrays.piece(links.sent[row], piece), meeting);
  }
  const bool is_other = first < links.ranks && first != links.rank;
  if (is_other) put_piece(links.board[first]->record[turn][links.rank][0], 0, meeting);
  auto* const from = reinterpret_cast<PeerWord*>(links.rooms + room * links.room_bytes);
  const Index came = links.count * kWords;
  for (Index k = first; k < came; k += stride)
    *arrays.piece(links.first + k / kWords, k % kWords) = take_piece(from[k], meeting);
  if (is_other) take_piece(links.board[links.rank]->record[turn][first][0], meeting);
}

/// Gives ghosts the rows that their owners have. A call that all ranks make together.
template <class Arrays>
void swap_rows(Cuda& cuda, const GhostLinks& links, const Arrays& arrays) {
  static_assert(PeerBoard::kMostRanks <= Cuda::kBlock);
  constexpr Index kMostBlocks = 64;
  const Index rows = std::max(static_cast<Index>(links.sent.size), links.count);
  const Offset words = Offset{rows} * Arrays::kBytes / static_cast<Offset>(sizeof(PeerPiece));
  const auto blocks = static_cast<unsigned>(
      std::clamp<Offset>((words + Cuda::kBlock - 1) / Cuda::kBlock, 1, kMostBlocks));
  swap_rows_kernel<<<blocks, Cuda::kBlock, 0, cuda.stream()>>>(links, arrays,
                                                               cuda.peers()->next_meeting());
  cuda.check_launch("swap_rows");
}

}  // namespace scree
