#include <cuda_runtime.h>

#include <cstdint>
#include <string>

#include "host/engine/cuda_device.h"
#include "kernels/backend/cuda.cuh"

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

/// The devices with their names, for messages.
std::string device_list(int count) {
  std::string list;
  for (int device = 0; device < count; ++device) {
    cudaDeviceProp properties{};
    const bool is_known = cudaGetDeviceProperties(&properties, device) == cudaSuccess;
    list += (device > 0 ? ", " : "") + std::to_string(device) + " " +
            (is_known ? properties.name : "unknown");
  }
  return list;
}

/// Memory of the current device that allocations can still get: what the driver has left, and
/// blocks that the pool of the backends keeps but does not use.
/// @param device  the current one
std::size_t free_device_memory(int device) {
  std::size_t free = 0, all = 0;
  if (cudaMemGetInfo(&free, &all) != cudaSuccess) return 0;
  cudaMemPool_t pool = nullptr;
  std::uint64_t kept = 0, used = 0;
  if (cudaDeviceGetDefaultMemPool(&pool, device) == cudaSuccess &&
      cudaMemPoolGetAttribute(pool, cudaMemPoolAttrReservedMemCurrent, &kept) == cudaSuccess &&
      cudaMemPoolGetAttribute(pool, cudaMemPoolAttrUsedMemCurrent, &used) == cudaSuccess)
    free += static_cast<std::size_t>(kept - used);
  return free;
}

}  // namespace

bool cuda_available(std::string* reason, int device) {
  int count = 0;
  const cudaError_t error = cudaGetDeviceCount(&count);
  std::string why;
  if (error != cudaSuccess) {
    why = cudaGetErrorString(error);
  } else if (count == 0) {
    why = "no CUDA device found";
  } else if (device < 0 || device >= count) {
    why = "there is no CUDA device " + std::to_string(device) +
          "; those there: " + device_list(count);
  } else {
    try {
      const CudaDeviceScope scope(device);
      why = missing_code(device);
    } catch (const DeviceError& fault) {
      why = fault.what();
    }
  }
  if (reason != nullptr) *reason = why;
  return why.empty();
}

int cuda_device_count() {
  int count = 0;
  return cudaGetDeviceCount(&count) == cudaSuccess ? count : 0;
}

DeviceInfo cuda_device_info(int device) {
  DeviceInfo info;
  cudaDeviceProp properties{};
  if (cudaGetDeviceProperties(&properties, device) != cudaSuccess) return info;
  info.name = properties.name;
  info.memory_bytes = properties.totalGlobalMem;
  info.threads = properties.multiProcessorCount;
  try {
    const CudaDeviceScope scope(device);
    info.free_bytes = free_device_memory(device);
  } catch (const DeviceError&) {
    info.free_bytes = 0;  // another process has the device for itself
  }
  return info;
}

CudaDeviceScope::CudaDeviceScope(int device) {
  if (device < 0) return;
  int current = 0;
  check_cuda(cudaGetDevice(&current), "current device");
  if (current == device) return;
  check_cuda(cudaSetDevice(device), "select device");
  before_ = current;
}

CudaDeviceScope::~CudaDeviceScope() {
  if (before_ >= 0) cudaSetDevice(before_);
}

}  // namespace scree
