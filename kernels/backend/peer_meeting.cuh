#pragma once
// How GPUs of ranks meet between kernels without their hosts: each writes a record into the memory of the others over NVLink,
// waits until theirs have come, and combines all. Where hosts do that, a GPU has nothing to do from the end of the
// reduction until the host has read it, told it and launched what comes next.
//
// Each word of 8 bytes that crosses carries 4 bytes of data and the number of the meeting. Who waits for it sees by itself
// that it is there, so nobody waits for the end of a write, and no flag follows one.

#include <cuda/atomic>

#include "kernels/backend/cuda.cuh"
#include "kernels/backend/peer_board.h"

namespace scree {

/// What goes in one word.
using PeerPiece = std::uint32_t;
template <class T>
inline constexpr Index kPeerPieces = sizeof(T) / sizeof(PeerPiece);

using SystemWord = cuda::atomic_ref<PeerWord, cuda::thread_scope_system>;

__device__ inline void put_piece(PeerWord& there, PeerPiece piece, unsigned meeting) {
  SystemWord(there).store(PeerWord{meeting} << 32 | piece, cuda::memory_order_relaxed);
}
/// Waits for the piece of a meeting.
__device__ inline PeerPiece take_piece(PeerWord& here, unsigned meeting) {
  PeerWord word;
  do {
    word = SystemWord(here).load(cuda::memory_order_relaxed);
  } while (static_cast<unsigned>(word >> 32) != meeting);
  return static_cast<PeerPiece>(word);
}

template <class T>
__device__ PeerPiece* pieces_of(T* x) {
  return reinterpret_cast<PeerPiece*>(x);
}
template <class T>
__device__ const PeerPiece* pieces_of(const T* x) {
  return reinterpret_cast<const PeerPiece*>(x);
}

inline constexpr int kPeerThreads = 128;

/// Brings the records of all ranks together, by one block. Records alternate between two places: a rank writes over one only
/// after it has got all of the meeting between.
/// @param own   in device memory
/// @param take  called by one thread: take(records in the order of ranks, number of this rank, number of ranks)
template <class R, class F>
__global__ void __launch_bounds__(kPeerThreads)
    meet_peers(const __grid_constant__ PeerBoards peers, unsigned meeting, const R* own,
               const __grid_constant__ F take) {
  constexpr int kWords = kPeerPieces<R>;
  static_assert(sizeof(R) % sizeof(PeerPiece) == 0 && kWords <= PeerBoard::kRecordWords);
  __shared__ alignas(R) unsigned char storage[PeerBoard::kMostRanks * sizeof(R)];
  R* const of_rank = reinterpret_cast<R*>(storage);
  const auto turn = static_cast<int>(meeting % 2);
  const int words = peers.ranks * kWords;
  __threadfence_system();  // what kernels before this one wrote to peers is there before the record
  for (auto k = static_cast<int>(threadIdx.x); k < words; k += kPeerThreads) {
    const int rank = k / kWords, piece = k % kWords;
    const PeerPiece mine = pieces_of(own)[piece];
    if (rank == peers.rank) {
      pieces_of(of_rank + rank)[piece] = mine;
    } else {
      put_piece(peers.board[rank]->record[turn][peers.rank][piece], mine, meeting);
    }
  }
  for (auto k = static_cast<int>(threadIdx.x); k < words; k += kPeerThreads) {
    const int rank = k / kWords, piece = k % kWords;
    if (rank == peers.rank) continue;
    pieces_of(of_rank + rank)[piece] =
        take_piece(peers.board[peers.rank]->record[turn][rank][piece], meeting);
  }
  __threadfence_system();  // and what peers wrote before theirs is there for kernels after this one
  __syncthreads();
  if (threadIdx.x == 0) take(of_rank, peers.rank, peers.ranks);
}

/// Combines records in the order of ranks, so that the total has the same bits everywhere.
template <class G>
struct CombineRecords {
  G finish;  ///< see finish_over_ranks()
  template <class R>
  __device__ void operator()(const R* of_rank, int rank, int ranks) const {
    R total;
    for (int r = 0; r < ranks; ++r) total.combine(of_rank[r]);
    finish_over_ranks(finish, of_rank[rank], total);
  }
};

template <class R>
struct KeepRecords {
  Span<R> all;
  __device__ void operator()(const R* of_rank, int, int ranks) const {
    for (int r = 0; r < ranks; ++r) all[r] = of_rank[r];
  }
};

/// Meetings of the GPUs of ranks. All ranks make its calls together, in the same order.
class PeerMeetings {
 public:
  PeerMeetings() = default;
  /// @param meeting  number of the last one
  PeerMeetings(const PeerBoards& peers, unsigned meeting) : peers_(peers), meeting_(meeting) {}

  /// @param own  in device memory, written by what is in line before
  template <class R, class G>
  void combine(Cuda& cuda, const R* own, const G& finish) {
    meet(cuda, own, CombineRecords<G>{finish});
  }
  /// @param all  in device memory: the records of all ranks
  template <class R>
  void gather(Cuda& cuda, const R* own, Span<R> all) {
    meet(cuda, own, KeepRecords<R>{all});
  }
  /// Number of one that a kernel of the caller holds, in which each rank hears of all others by the first word of a record.
  unsigned next_meeting() { return ++meeting_; }

 private:
  template <class R, class F>
  void meet(Cuda& cuda, const R* own, const F& take) {
    meet_peers<R, F><<<1, kPeerThreads, 0, cuda.stream()>>>(peers_, next_meeting(), own, take);
    cuda.check_launch("meet_peers");
  }

  PeerBoards peers_;
  unsigned meeting_ = 0;
};

}  // namespace scree
