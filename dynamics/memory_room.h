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
  /// That divide the bodies of a scene, one to a rank. Ranks without a GPU share the memory of their host.
  int devices = 1;
};

}  // namespace scree
