#pragma once
// What the host asks about CUDA devices. Compiled with nvcc; absent from builds without CUDA.

#include <string>

#include "host/world.h"

namespace scree {

/// Whether a CUDA device can be used; the runtime's reason when not.
bool cuda_available(std::string* reason);
DeviceInfo cuda_device_info();

}  // namespace scree
