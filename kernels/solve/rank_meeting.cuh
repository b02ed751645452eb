#pragma once
// How the GPUs of ranks meet at the end of a trial without leaving their kernels: each writes the new velocities of the
// bodies that others mirror, and its sums, into the memory of the others over NVLink, and waits until theirs have come.
//
// Bytes that a rank sends: 24 for each body that it shows, about 250 KB for 1e6 bodies, and 28 to each other rank. Neighboring
// threads write neighboring bytes: single words in packets of their own would take three times as long.

#include "kernels/backend/cuda.cuh"
#include "kernels/backend/device_counter.cuh"
#include "kernels/bodies/ghosts.h"
#include "kernels/solve/apgd_decide.cuh"

namespace scree {

/// Where the blocks of a rank agree about a meeting, in device memory. Zero at the start of a solve.
struct RankMeeting {
  unsigned* sent;   ///< blocks that have sent what is theirs to send, over all trials
  unsigned* taken;  ///< blocks that have taken what came
};

/// What a block notes at a meeting, in shared memory.
struct RankNotes {
  double of_rank[PeerBoard::kMostRanks][3];  ///< sums
  Sums<3> sums;
  bool is_last;  ///< to have sent
};

namespace rank_meeting {

inline constexpr Index kThreads = kApgdThreads;  ///< of a block

/// A velocity in pieces, as they are sent.
using Piece = float2;
inline constexpr Index kPieces = sizeof(Twist<float>) / sizeof(Piece);
static_assert(kPieces * sizeof(Piece) == sizeof(Twist<float>));

using SystemFlag = cuda::atomic_ref<unsigned, cuda::thread_scope_system>;

__device__ inline void system_fence() {
  cuda::atomic_thread_fence(cuda::memory_order_acq_rel, cuda::thread_scope_system);
}

/// Blocks that move so many velocities, a piece to a thread where the grid is large enough.
__device__ inline Index blocks_that_move(Index twists) {
  return min((twists * kPieces + kThreads - 1) / kThreads, static_cast<Index>(gridDim.x));
}

/// The share of the thread, when so many blocks send.
__device__ inline void send(const GhostLinks& links, int room, const Twist<float>* velocity,
                            Index blocks) {
  const auto pieces = static_cast<Index>(links.sent.size) * kPieces;
  for (auto k = static_cast<Index>(blockIdx.x * kThreads + threadIdx.x); k < pieces;
       k += blocks * kThreads) {
    const Index row = k / kPieces, piece = k % kPieces;
    const auto* from = reinterpret_cast<const Piece*>(velocity + links.sent[row]);
    auto* to = reinterpret_cast<Piece*>(links.place(row, room, sizeof(Twist<float>)));
    to[piece] = from[piece];
  }
}

/// The same of what has come.
__device__ inline void take(const GhostLinks& links, int room, Twist<float>* velocity,
                            Index blocks) {
  const auto* from = reinterpret_cast<const Piece*>(links.rooms + room * links.room_bytes);
  auto* to = reinterpret_cast<Piece*>(velocity + links.first);
  for (auto k = static_cast<Index>(blockIdx.x * kThreads + threadIdx.x); k < links.count * kPieces;
       k += blocks * kThreads)
    to[k] = from[k];
}

/// Waits until another rank has come to a meeting.
__device__ inline void wait_for_rank(PeerBoard& board, int rank, unsigned meeting) {
  const SystemFlag came(board.came[rank]);
  while (static_cast<int>(came.load(cuda::memory_order_relaxed) - meeting) < 0) {
  }
  system_fence();
}

}  // namespace rank_meeting

/// Called by all blocks when the velocities of all bodies that this rank owns are written. Gives ghosts the velocities that
/// their owners found.
///
/// Rooms and sums alternate between two places: a rank that comes to a meeting has taken all of the meeting before, so what
/// was there one meeting earlier is no longer needed.
///
/// It is a function of its own, which gets and gives sums in shared memory: as a part of the sweep it would make that spill
/// registers.
/// @param meeting   its number over the life of the window, from 1  @param of_solve  the same, of this solve
/// @param notes     with the sums of this rank, written by thread 0; then with those of all ranks, added in their order, so
///                  that each has the same bits
/// @param velocity  of all bodies
static __device__ __noinline__ void meet_ranks(const GhostLinks* all_links, RankMeeting here,
                                               unsigned meeting, unsigned of_solve,
                                               RankNotes* notes, Twist<float>* velocity) {
  using namespace rank_meeting;
  const GhostLinks& links = *all_links;
  PeerBoard& board = *links.board[links.rank];
  const auto thread = static_cast<int>(threadIdx.x), block = static_cast<int>(blockIdx.x);
  const bool is_other = thread < links.ranks && thread != links.rank;
  const int turn = static_cast<int>(meeting % 2);
  const int room = Ghosts<Cuda>::kFirstOfPrograms + turn;

  const Index senders = max(blocks_that_move(static_cast<Index>(links.sent.size)), 1);
  if (block < senders) {
    send(links, room, velocity, senders);
    __syncthreads();
    if (thread == 0) {
      system_fence();
      const unsigned before = DeviceCounter(*here.sent).fetch_add(1, cuda::memory_order_acq_rel);
      notes->is_last = before + 1 == of_solve * static_cast<unsigned>(senders);
      system_fence();
    }
    __syncthreads();
    if (notes->is_last && is_other) {  // it speaks for its rank
      PeerBoard& there = *links.board[thread];
      for (int v = 0; v < 3; ++v) there.sums[turn][links.rank][v] = notes->sums.value[v];
      SystemFlag(there.came[links.rank]).store(meeting, cuda::memory_order_release);
    }
  }
  if (is_other) {
    wait_for_rank(board, thread, meeting);
    for (int v = 0; v < 3; ++v) notes->of_rank[thread][v] = board.sums[turn][thread][v];
  }
  __syncthreads();
  const Index takers = blocks_that_move(links.count);
  if (block < takers) {
    take(links, room, velocity, takers);
    __syncthreads();
    if (thread == 0) DeviceCounter(*here.taken).fetch_add(1, cuda::memory_order_release);
  }
  if (thread == 0) {
    for (int v = 0; v < 3; ++v) notes->of_rank[links.rank][v] = notes->sums.value[v];
    Sums<3> all;
    for (int r = 0; r < links.ranks; ++r)
      for (int v = 0; v < 3; ++v) all.value[v] += notes->of_rank[r][v];
    notes->sums = all;
    wait_for(*here.taken, of_solve * static_cast<unsigned>(takers));
  }
  __syncthreads();
}

}  // namespace scree
