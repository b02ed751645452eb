#include <algorithm>

#include "kernels/backend/peer_window.cuh"
#include "kernels/backend/rank_devices.h"

namespace scree {
namespace {

/// How the others reach the memory of a rank.
struct Offer {
  cudaIpcMemHandle_t handle{};
  unsigned char* address = nullptr;
};

/// Whether a call did what it should; forgets the error otherwise.
bool done(cudaError_t error) {
  if (error != cudaSuccess) cudaGetLastError();
  return error == cudaSuccess;
}

bool can_reach(int from, int device) {
  int can = 0;
  if (from == device) return true;
  if (!done(cudaDeviceCanAccessPeer(&can, from, device)) || can == 0) return false;
  const cudaError_t error = cudaDeviceEnablePeerAccess(device, 0);
  if (error == cudaErrorPeerAccessAlreadyEnabled) cudaGetLastError();
  return error == cudaErrorPeerAccessAlreadyEnabled || done(error);
}

}  // namespace

PeerWindow<Cuda>::~PeerWindow() {
  cuda_->set_peers(nullptr);
  // A rank that failed may be alone here: the memory goes with the process.
  const bool is_alone = ranks_ == nullptr || !ranks_->ends_together();
  if (is_alone && std::uncaught_exceptions() > exceptions_) return;
  try {
    close();
  } catch (const std::exception&) {  // another rank ended: the driver takes the memory back
  }
}

bool PeerWindow<Cuda>::reserve(Ranks& ranks, std::size_t bytes) {
  if (fails_) return false;
  if (!any(ranks, memory_.empty() || bytes > size_)) return true;
  constexpr std::size_t kLeast = std::size_t{1} << 20;
  constexpr std::size_t kUnit = 256;
  const std::size_t wanted = std::max(bytes + bytes / 2, kLeast);
  std::size_t largest = 0;
  for (const std::size_t of_rank : gather(ranks, wanted)) largest = std::max(largest, of_rank);
  close();
  open(ranks, (largest + kUnit - 1) / kUnit * kUnit);
  return !fails_;
}

void PeerWindow<Cuda>::open(Ranks& ranks, std::size_t size) {
  ranks_ = &ranks;
  const auto me = static_cast<std::size_t>(ranks.rank());
  const std::vector<RankDevice> devices = gather(ranks, this_device());
  Offer own;
  void* memory = nullptr;
  // Zeros, because a program knows by the number of a meeting what has come: none is the 0th.
  const std::size_t all = kBoardBytes + kRooms * size;
  // Handles are of this host alone.
  bool works = ranks.count_here() == ranks.count() && done(cudaMalloc(&memory, all));
  works = works && done(cudaMemset(memory, 0, all)) && done(cudaDeviceSynchronize());
  own.address = static_cast<unsigned char*>(memory);
  works = works && done(cudaIpcGetMemHandle(&own.handle, memory));
  const std::vector<Offer> offers = gather(ranks, own);
  memory_.assign(offers.size(), nullptr);
  is_opened_.assign(offers.size(), false);
  has_threads_ = share_a_process(devices);
  can_meet_ = offers.size() <= PeerBoard::kMostRanks && have_own_cards(devices);
  memory_[me] = own.address;
  size_ = size;
  for (std::size_t r = 0; works && r < offers.size(); ++r) {
    if (r == me) continue;
    const Offer& other = offers[r];
    if (devices[me].process == devices[r].process) {
      works = can_reach(devices[me].number, devices[r].number);
      memory_[r] = other.address;
      continue;
    }
    void* opened = nullptr;
    works = done(cudaIpcOpenMemHandle(&opened, other.handle, cudaIpcMemLazyEnablePeerAccess));
    memory_[r] = static_cast<unsigned char*>(opened);
    is_opened_[r] = works;
  }
  if (any(ranks, !works)) {
    fails_ = true;
    close();
    return;
  }
  // A thread that waits for its GPU must not keep another one from launching what that GPU waits for.
  if (!can_meet_ || has_threads_) return;
  meetings_ = {boards(), 0};
  cuda_->set_peers(&meetings_);
}

PeerBoards PeerWindow<Cuda>::boards() const {
  PeerBoards all;
  all.rank = ranks_->rank();
  all.ranks = ranks_->count();
  for (std::size_t r = 0; r < memory_.size() && r < PeerBoard::kMostRanks; ++r)
    all.board[r] = reinterpret_cast<PeerBoard*>(memory_[r]);
  return all;
}

void PeerWindow<Cuda>::close() {
  if (memory_.empty()) return;
  cuda_->set_peers(nullptr);
  cuda_->synchronize();  // what is in line writes to others
  const auto me = static_cast<std::size_t>(ranks_->rank());
  for (std::size_t r = 0; r < memory_.size(); ++r)
    if (is_opened_[r]) cudaIpcCloseMemHandle(memory_[r]);
  unsigned char* own = memory_[me];
  memory_.clear();
  is_opened_.clear();
  size_ = 0;
  any(*ranks_, false);  // all have closed theirs
  if (own != nullptr) cudaFree(own);
}

}  // namespace scree
