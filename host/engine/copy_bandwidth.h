#pragma once
// Speed of a large copy: what a backend's memory can do, the measure of kernels limited by memory.

#include "host/world.h"

namespace scree {

/// Bytes read plus bytes written per second by a copy too large for any cache; the best of a few.
/// Takes 1 GiB of device memory, 256 MiB of host memory on the CPU.
/// @throws InputError when the backend is not there
double copy_bandwidth(const WorldOptions& options);

/// Compiled once per backend: B is Cpu or Cuda.
template <class B>
double copy_bandwidth_on(const WorldOptions& options);

}  // namespace scree
