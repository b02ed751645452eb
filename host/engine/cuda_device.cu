#include <cuda_runtime.h>

#include <cstdint>
#include <string>

#include "host/engine/cuda_device.h"

namespace scree {

namespace {

__global__ void probe_kernel() {}

/// Why the device cannot run the kernels of this build; empty when it can.
std::string missing_code(int device) {
  cudaFuncAttributes attributes{};
  const cudaError_t error = cudaFuncGetAttributes(&attributes, probe_kernel);
  if (error == cudaSuccess) return {};
  cudaGetLastError();  // clear it
  cudaDeviceProp properties{};
  if (cudaGetDeviceProperties(&properties, device) != cudaSuccess) return cudaGetErrorString(error);
  const std::string wanted = std::to_string(properties.major) + std::to_string(properties.minor);
  return std::string(properties.name) + " needs code for architecture " + wanted +
         ", this program has code for " SCREE_CUDA_ARCHITECTURES
         " only; configure with -DSCREE_CUDA_ARCHITECTURES=" +
         wanted;
}

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

bool cuda_available(std::string* reason) {
  int count = 0;
  const cudaError_t error = cudaGetDeviceCount(&count);
  std::string why;
  if (error != cudaSuccess) {
    why = cudaGetErrorString(error);
  } else if (count == 0) {
    why = "no CUDA device found";
  } else {
    why = missing_code(0);
  }
  if (reason != nullptr) *reason = why;
  return why.empty();
}

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
