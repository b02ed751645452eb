#include <algorithm>
#include <cstring>
#include <random>

#include "kernels/backend/over_ranks.h"
#include "kernels/backend/peer_window.cuh"

namespace scree {
namespace {

/// How the others reach the memory of a rank.
struct Offer {
  cudaIpcMemHandle_t handle{};
  cudaUUID_t card{};
  unsigned char* address = nullptr;
  int device = 0;
  std::uint64_t process = 0;
};

/// A number that no other process has, as far as chance goes.
std::uint64_t this_process() {
  static const std::uint64_t number = [] {
    std::random_device random;
    return std::uint64_t{random()} << 32 | random();
  }();
  return number;
}

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

/// Whether each rank has a device of its own.
bool have_own_devices(const std::vector<Offer>& offers) {
  for (std::size_t r = 0; r < offers.size(); ++r)
    for (std::size_t q = 0; q < r; ++q)
      if (std::memcmp(&offers[r].card, &offers[q].card, sizeof(cudaUUID_t)) == 0) return false;
  return true;
}

bool have_one_process(const std::vector<Offer>& offers) {
  return std::any_of(offers.begin() + 1, offers.end(),
                     [&](const Offer& o) { return o.process == offers.front().process; });
}

}  // namespace

PeerWindow<Cuda>::~PeerWindow() {
  // A rank that failed is alone here: the memory goes with the process.
  if (std::uncaught_exceptions() > exceptions_) return;
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
  Offer own;
  own.process = this_process();
  bool works = done(cudaGetDevice(&own.device));
  cudaDeviceProp properties{};
  works = works && done(cudaGetDeviceProperties(&properties, own.device));
  own.card = properties.uuid;
  void* memory = nullptr;
  // Zeros, because a program knows by the number of a meeting what has come: none is the 0th.
  const std::size_t all = kBoardBytes + kRooms * size;
  works = works && done(cudaMalloc(&memory, all));
  works = works && done(cudaMemset(memory, 0, all)) && done(cudaDeviceSynchronize());
  own.address = static_cast<unsigned char*>(memory);
  works = works && done(cudaIpcGetMemHandle(&own.handle, memory));
  const std::vector<Offer> offers = gather(ranks, own);
  memory_.assign(offers.size(), nullptr);
  is_opened_.assign(offers.size(), false);
  has_threads_ = have_one_process(offers);
  can_meet_ = offers.size() <= PeerBoard::kMostRanks && have_own_devices(offers);
  memory_[me] = own.address;
  size_ = size;
  for (std::size_t r = 0; works && r < offers.size(); ++r) {
    if (r == me) continue;
    const Offer& other = offers[r];
    if (own.process == other.process) {
      works = can_reach(own.device, other.device);
      memory_[r] = other.address;
      continue;
    }
    void* opened = nullptr;
    // Fails for a GPU of another host.
    works = done(cudaIpcOpenMemHandle(&opened, other.handle, cudaIpcMemLazyEnablePeerAccess));
    memory_[r] = static_cast<unsigned char*>(opened);
    is_opened_[r] = works;
  }
  if (!any(ranks, !works)) return;
  fails_ = true;
  close();
}

void PeerWindow<Cuda>::close() {
  if (memory_.empty()) return;
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
