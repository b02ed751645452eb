#pragma once
// Memory of each rank that the others write into, so that data need not go through the host.

#include <cstddef>

#include "kernels/backend/peer_board.h"
#include "kernels/backend/ranks.h"

namespace scree {

/// Each backend may have its own class; this one has no such memory.
template <class B>
class PeerWindow {
 public:
  explicit PeerWindow(B&) {}
  /// Makes room for so many bytes from all others together. A call that all ranks make together.
  /// @return  whether ranks can write into each other's memory, which is the same on all of them
  bool reserve(Ranks&, std::size_t /*bytes*/) { return false; }
  /// The first of the rooms at a rank, this one included; they follow each other.
  unsigned char* rooms(int /*rank*/) const { return nullptr; }
  std::size_t room_bytes() const { return 0; }
  PeerBoards boards() const { return {}; }
  /// Whether kernels of the ranks may wait for each other: each rank has a device of its own.
  bool can_meet() const { return false; }
  /// Whether ranks are threads of one process.
  bool has_threads() const { return false; }
};

}  // namespace scree

#ifdef __CUDACC__
#include "kernels/backend/peer_window.cuh"
#endif
