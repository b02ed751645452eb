#pragma once
// Windows between GPUs of one host: memory that other processes open by CUDA's interprocess handles, or that threads of one
// process reach as it is. What is written there crosses NVLink, and is there when the writer's stream has been waited for.

#include <exception>
#include <vector>

#include "kernels/backend/cuda.cuh"
#include "kernels/backend/peer_window.h"

namespace scree {

template <>
class PeerWindow<Cuda> {
 public:
  explicit PeerWindow(Cuda&) {}
  ~PeerWindow();
  PeerWindow(const PeerWindow&) = delete;
  PeerWindow& operator=(const PeerWindow&) = delete;

  bool reserve(Ranks& ranks, std::size_t bytes);
  unsigned char* at(int rank) const {
    return memory_[static_cast<std::size_t>(rank)] + static_cast<std::size_t>(turn_) * size_;
  }
  void turn() { turn_ = 1 - turn_; }

 private:
  void open(Ranks& ranks, std::size_t size);
  /// Memory goes when no other rank has it open. A call that all make together.
  void close();

  Ranks* ranks_ = nullptr;
  std::vector<unsigned char*> memory_;  ///< of each rank, as this one reaches it
  std::vector<bool> is_opened_;         ///< by a handle, to be closed
  std::size_t size_ = 0;                ///< of one of two halves [bytes]
  int turn_ = 0;
  bool fails_ = false;
  int exceptions_ = std::uncaught_exceptions();  ///< in flight when this was made
};

}  // namespace scree
