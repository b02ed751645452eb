#pragma once
// Messages between the GPUs of ranks by NCCL. scree may be built without it.

#include <memory>
#include <string>

#include "kernels/backend/device_messages.h"

namespace scree {

/// Null in a build without NCCL.
std::unique_ptr<DeviceMessages> nccl_messages();

/// "2.28.3"; empty: built without.
std::string nccl_version();

}  // namespace scree
