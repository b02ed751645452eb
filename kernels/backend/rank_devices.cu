#include <cuda_runtime.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "kernels/backend/rank_devices.h"

namespace scree {
namespace {

std::uint64_t this_process() {
  static const std::uint64_t number = [] {
    std::random_device random;
    return std::uint64_t{random()} << 32 | random();
  }();
  return number;
}

/// Whether two of them are equal in what `key` gives.
template <class Key>
bool any_two(const std::vector<RankDevice>& devices, const Key& key) {
  for (auto a = devices.begin(); a != devices.end(); ++a)
    if (std::any_of(devices.begin(), a, [&](const RankDevice& b) { return key(*a) == key(b); }))
      return true;
  return false;
}

}  // namespace

RankDevice this_device() {
  RankDevice device;
  device.process = this_process();
  cudaDeviceProp properties{};
  if (cudaGetDevice(&device.number) == cudaSuccess &&
      cudaGetDeviceProperties(&properties, device.number) == cudaSuccess) {
    static_assert(sizeof properties.uuid == sizeof device.card);
    std::memcpy(device.card.data(), &properties.uuid, sizeof device.card);
  } else {
    cudaGetLastError();
  }
  return device;
}

bool have_own_cards(const std::vector<RankDevice>& devices) {
  const auto is_unknown = [](const RankDevice& d) { return d.card == RankDevice{}.card; };
  if (std::any_of(devices.begin(), devices.end(), is_unknown)) return false;
  return !any_two(devices, [](const RankDevice& d) { return d.card; });
}

bool share_a_process(const std::vector<RankDevice>& devices) {
  return any_two(devices, [](const RankDevice& d) { return d.process; });
}

}  // namespace scree
