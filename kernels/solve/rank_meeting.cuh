#pragma once
// How the GPUs of ranks meet at the end of a trial without leaving their kernels: each writes the new velocities of the
// bodies that others mirror, and its sums, into the memory of the others over NVLink, and waits until theirs have come. All
// goes in words with the number of the meeting (peer_meeting.cuh).
//
// Bytes that a rank sends: 48 for each body that it shows, about 500 KB for 1e6 bodies, and 48 to each other rank.
// Neighboring threads write neighboring words: each in a packet of its own would take three times as long.
//
// All blocks share the sending when all tiles are done. To send while blocks are at work on other tiles was slower, each way
// that was tried (bench/results/h200/2026-11-29-ranks.md): a block that sends waits for loads one after the other, and all
// wait for the slowest block. Shared by all, sending takes half a microsecond.

#include "kernels/backend/cuda.cuh"
#include "kernels/backend/device_counter.cuh"
#include "kernels/backend/peer_meeting.cuh"
#include "kernels/bodies/ghosts.h"
#include "kernels/solve/apgd_decide.cuh"

namespace scree {

/// What a block notes at a meeting, in shared memory.
struct RankNotes {
  Sums<3> sums;
  Sums<3> of_rank[PeerBoard::kMostRanks];
};

namespace rank_meeting {

inline constexpr Index kThreads = kApgdThreads;  ///< of a block

static_assert(kPeerPieces<Sums<3>> == PeerBoard::kSumWords);

/// Sends the share of the block of the velocities that others wait for.
__device__ inline void send_velocities(const GhostLinks& links, int room, unsigned meeting,
                                       const Twist<float>* velocity) {
  constexpr Index kOfTwist = kPeerPieces<Twist<float>>;
  const auto words = static_cast<Index>(links.sent.size) * kOfTwist;
  const auto first = static_cast<Index>(blockIdx.x * kThreads + threadIdx.x);
  for (Index k = first; k < words; k += static_cast<Index>(gridDim.x) * kThreads) {
    const Index row = k / kOfTwist, piece = k % kOfTwist;
    auto* to = reinterpret_cast<PeerWord*>(links.place(row, room, kOfTwist * sizeof(PeerWord)));
    put_piece(to[piece], pieces_of(velocity + links.sent[row])[piece], meeting);
  }
}

/// Takes the share of the block of the velocities that come.
__device__ inline void take_velocities(const GhostLinks& links, int room, unsigned meeting,
                                       Twist<float>* velocity) {
  const Index words = links.count * kPeerPieces<Twist<float>>;
  auto* from = reinterpret_cast<PeerWord*>(links.rooms + room * links.room_bytes);
  PeerPiece* to = pieces_of(velocity + links.first);
  const auto first = static_cast<Index>(blockIdx.x * kThreads + threadIdx.x);
  for (Index k = first; k < words; k += static_cast<Index>(gridDim.x) * kThreads)
    to[k] = take_piece(from[k], meeting);
}

/// Blocks that take velocities.
__device__ inline Index takers(const GhostLinks& links) {
  const Index words = links.count * kPeerPieces<Twist<float>>;
  return min((words + kThreads - 1) / kThreads, static_cast<Index>(gridDim.x));
}

}  // namespace rank_meeting

/// Called by all blocks when the velocities of all bodies that this rank owns are written. Gives ghosts the velocities that
/// their owners found.
///
/// Rooms and sums alternate between two places. A rank sends its sums when all its blocks have left the meeting before, and
/// each block waits for the sums of all ranks: so what it writes over at the next meeting but one is no longer needed.
///
/// It is a function of its own, which gets and gives sums in shared memory: as a part of the sweep it would make that spill
/// registers.
/// @param taken     blocks that have taken what came, over all trials; in device memory, zero at the start of a solve
/// @param meeting   its number over the life of the window, from 1  @param of_solve  the same, of this solve
/// @param notes     with the sums of this rank, written by thread 0; then with those of all ranks, added in their order, so
///                  that each has the same bits
/// @param velocity  of all bodies
static __device__ __noinline__ void meet_ranks(const GhostLinks* all_links, unsigned* taken,
                                               unsigned meeting, unsigned of_solve,
                                               RankNotes* notes, Twist<float>* velocity) {
  using namespace rank_meeting;
  constexpr int kOfSums = PeerBoard::kSumWords;
  static_assert(PeerBoard::kMostRanks * kOfSums <= kThreads);
  const GhostLinks& links = *all_links;
  const auto thread = static_cast<int>(threadIdx.x);
  const int rank = thread / kOfSums, piece = thread % kOfSums;
  const bool is_other = rank < links.ranks && rank != links.rank;
  const int turn = static_cast<int>(meeting % 2);
  const int room = GhostLinks::kFirstOfPrograms + turn;

  send_velocities(links, room, meeting, velocity);
  __syncthreads();
  // The last block has the fewest velocities to send.
  if (is_other && blockIdx.x + 1 == gridDim.x)
    put_piece(links.board[rank]->sums[turn][links.rank][piece], pieces_of(&notes->sums)[piece],
              meeting);
  take_velocities(links, room, meeting, velocity);
  if (is_other)
    pieces_of(notes->of_rank + rank)[piece] =
        take_piece(links.board[links.rank]->sums[turn][rank][piece], meeting);
  __syncthreads();
  if (thread == 0) {
    const auto all_takers = static_cast<unsigned>(takers(links));
    if (blockIdx.x < all_takers) DeviceCounter(*taken).fetch_add(1, cuda::memory_order_release);
    notes->of_rank[links.rank] = notes->sums;
    Sums<3> all;
    for (int r = 0; r < links.ranks; ++r) all.combine(notes->of_rank[r]);
    notes->sums = all;
    wait_for(*taken, of_solve * all_takers);
  }
  __syncthreads();
}

}  // namespace scree
