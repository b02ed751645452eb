#pragma once
// What the command line of scree_bench sets, beside Google Benchmark's own flags.

#include <memory>
#include <vector>

#include "kernels/types.h"

namespace scree {
class Cpu;
class Cuda;
}  // namespace scree

namespace scree::bench {

struct Options {
  std::vector<Index> sizes;  ///< spheres; empty: the backend's default sizes
  int batches = 0;           ///< timed batches per benchmark; 0: the backend's default
  int threads = 0;           ///< of the CPU backend; 0: all
  bool cpu = true;           ///< which backends run
  bool cuda = true;
};

template <class B>
struct BackendTag {};

/// Registers all benchmarks of a backend. What it returns must live until they have run.
/// @throws DeviceError  no such device
std::shared_ptr<void> register_benchmarks(BackendTag<Cpu>, const Options& options);
std::shared_ptr<void> register_benchmarks(BackendTag<Cuda>, const Options& options);

}  // namespace scree::bench
