#pragma once
// Memory of each rank that the others write into, so that data need not go through the host.

#include <cstddef>

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
  /// Room for what comes next, in turn one of two: its first byte at a rank, this one included.
  unsigned char* at(int /*rank*/) const { return nullptr; }
  void turn() {}
};

}  // namespace scree

#ifdef __CUDACC__
#include "kernels/backend/peer_window.cuh"
#endif
