#include <cuda_runtime.h>

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

DeviceInfo cuda_device_info() {
  DeviceInfo info;
  cudaDeviceProp properties{};
  if (cudaGetDeviceProperties(&properties, 0) == cudaSuccess) {
    info.name = properties.name;
    info.memory_bytes = properties.totalGlobalMem;
    info.threads = properties.multiProcessorCount;
  }
  return info;
}

}  // namespace scree
