#include <cuda_runtime.h>

#include <cstdint>

#include "host/cuda_device.h"

namespace scree {

bool cuda_available(std::string* reason) {
  int count = 0;
  const cudaError_t error = cudaGetDeviceCount(&count);
  if (error == cudaSuccess && count > 0) return true;
  if (reason != nullptr) {
    *reason = error == cudaSuccess ? "no CUDA device found" : cudaGetErrorString(error);
  }
  return false;
}

namespace {

/// Memory that allocations can still get: what the driver has left, and blocks that the pool of
/// the backends keeps but does not use.
std::size_t free_device_memory() {
  std::size_t free = 0, all = 0;
  if (cudaMemGetInfo(&free, &all) != cudaSuccess) return 0;
  cudaMemPool_t pool = nullptr;
  std::uint64_t kept = 0, used = 0;
  if (cudaDeviceGetDefaultMemPool(&pool, 0) == cudaSuccess &&
      cudaMemPoolGetAttribute(pool, cudaMemPoolAttrReservedMemCurrent, &kept) == cudaSuccess &&
      cudaMemPoolGetAttribute(pool, cudaMemPoolAttrUsedMemCurrent, &used) == cudaSuccess)
    free += static_cast<std::size_t>(kept - used);
  return free;
}

}  // namespace

DeviceInfo cuda_device_info() {
  DeviceInfo info;
  cudaDeviceProp properties{};
  if (cudaGetDeviceProperties(&properties, 0) == cudaSuccess) {
    info.name = properties.name;
    info.memory_bytes = properties.totalGlobalMem;
    info.free_bytes = free_device_memory();
    info.threads = properties.multiProcessorCount;
  }
  return info;
}

}  // namespace scree
