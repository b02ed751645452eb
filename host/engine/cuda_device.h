#pragma once
// What the host asks about CUDA devices. Compiled with nvcc; absent from builds without CUDA.

#include <string>

#include "host/world.h"

namespace scree {

/// Whether a CUDA device can be used; the runtime's reason when not, or the devices that are there.
bool cuda_available(std::string* reason, int device = 0);
/// CUDA devices that this process sees.
int cuda_device_count();
DeviceInfo cuda_device_info(int device = 0);

/// Makes a CUDA device the current one of this thread for its lifetime; after it the one before is
/// current again, so that neither other worlds nor the rest of the program notice.
class CudaDeviceScope {
 public:
  /// @param device  negative: leaves all as it is @throws DeviceError when there is no such device
  explicit CudaDeviceScope(int device);
  ~CudaDeviceScope();
  CudaDeviceScope(const CudaDeviceScope&) = delete;
  CudaDeviceScope& operator=(const CudaDeviceScope&) = delete;

 private:
  int before_ = -1;  ///< negative: nothing to restore
};

}  // namespace scree
