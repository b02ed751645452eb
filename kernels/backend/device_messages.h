#pragma once
// Messages from the memory of one rank's device to that of another, carried by a library: for devices that cannot write into
// each other's memory, as those of other hosts.

#include <string>
#include <vector>

#include "kernels/backend/ranks.h"

namespace scree {

/// Belongs to a group of ranks and lives as long as that. Calls are those of Ranks: all ranks make the same ones in the same
/// order.
class DeviceMessages {
 public:
  virtual ~DeviceMessages() = default;

  /// Connects the ranks, the first time; they work with the current devices of their threads from then on. May take a second,
  /// and some hundred MiB on each device.
  /// @return  whether they are connected, the same on all of them; fault() says why not
  virtual bool open(Ranks& ranks) = 0;
  virtual const std::string& fault() const = 0;

  /// Sends and receives, as Ranks::exchange(), data on devices. Begins when all is done that was put in line on a stream
  /// before; wait() makes the stream wait for its end, and must come before data are read or written again.
  /// @param stream  of the backend, a cudaStream_t
  /// @throws DeviceError
  virtual void exchange(const std::vector<Ranks::Message>& send,
                        const std::vector<Ranks::Message>& receive, void* stream) = 0;
  virtual void wait(void* stream) = 0;
};

}  // namespace scree
