#pragma once
// Backend memory that a run may count on.

#include "host/world.h"

namespace scree {

struct MemoryRoom {
  /// Of the device of the options, held to their limit.
  explicit MemoryRoom(const WorldOptions& options);
  double all = 0;           ///< [bytes]
  double free = 0;          ///< [bytes]
  bool is_limited = false;  ///< free is the limit of the options
  /// How much of the bodies of a scene is on this device. Ranks divide them, and take the GPUs of their host in turn; those
  /// without one share the memory of their host.
  double share = 1;
};

}  // namespace scree
