#include "dynamics/memory_room.h"

#include <algorithm>

#include "kernels/backend/ranks.h"

namespace scree {

MemoryRoom::MemoryRoom(const WorldOptions& options) {
  const DeviceInfo device = device_info(options.backend, options.device);
  all = static_cast<double>(device.memory_bytes);
  free = static_cast<double>(device.free_bytes);
  if (options.ranks != nullptr) {
    const int here = options.ranks->count_here();
    const int devices =
        options.backend == BackendKind::cuda ? std::max(1, device_count(options.backend)) : 1;
    const int on_device = (here + devices - 1) / devices;
    share = static_cast<double>(on_device) / options.ranks->count();
  }
  if (options.memory_limit == 0) return;
  const auto limit = static_cast<double>(options.memory_limit);
  all = std::min(all, limit);
  is_limited = limit < free;
  free = std::min(free, limit);
}

}  // namespace scree
