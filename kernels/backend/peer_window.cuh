#pragma once
// Windows between GPUs of one host: memory that other processes open by CUDA's interprocess handles, or that threads of one
// process reach as it is. What is written there crosses NVLink, and is there when the writer's stream has been waited for,
// with a record that follows it (peer_meeting.cuh), or word by word, as each says (kernels/solve/rank_meeting.cuh).

#include <exception>
#include <vector>

#include "kernels/backend/peer_meeting.cuh"
#include "kernels/backend/peer_window.h"

namespace scree {

template <>
class PeerWindow<Cuda> {
 public:
  explicit PeerWindow(Cuda& cuda) : cuda_(&cuda) {}
  ~PeerWindow();
  PeerWindow(const PeerWindow&) = delete;
  PeerWindow& operator=(const PeerWindow&) = delete;

  bool reserve(Ranks& ranks, std::size_t bytes);
  unsigned char* rooms(int rank) const {
    return memory_[static_cast<std::size_t>(rank)] + kBoardBytes;
  }
  std::size_t room_bytes() const { return size_; }
  PeerBoards boards() const;
  bool can_meet() const { return can_meet_; }
  bool has_threads() const { return has_threads_; }

 private:
  /// Two by turns for what hosts queue, two for programs that meet, two for swaps: what lies in one has its own numbers.
  static constexpr int kRooms = 6;
  static constexpr std::size_t kBoardBytes = 16384;
  static_assert(sizeof(PeerBoard) <= kBoardBytes);

  void open(Ranks& ranks, std::size_t size);
  /// Memory goes when no other rank has it open. A call that all make together.
  void close();

  Cuda* cuda_;
  Ranks* ranks_ = nullptr;
  PeerMeetings meetings_;               ///< of the backend, see set_peers()
  std::vector<unsigned char*> memory_;  ///< of each rank, as this one reaches it
  std::vector<bool> is_opened_;         ///< by a handle, to be closed
  std::size_t size_ = 0;                ///< of a room [bytes]
  bool can_meet_ = false;
  bool has_threads_ = false;
  bool fails_ = false;
  int exceptions_ = std::uncaught_exceptions();  ///< in flight when this was made
};

}  // namespace scree
