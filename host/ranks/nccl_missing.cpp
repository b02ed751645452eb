// In place of nccl_messages.cpp in builds without NCCL.
#include "host/ranks/nccl_messages.h"

namespace scree {

std::unique_ptr<DeviceMessages> nccl_messages() { return nullptr; }

std::string nccl_version() { return {}; }

}  // namespace scree
