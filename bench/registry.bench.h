// Registers all benchmarks of one backend, size by size, so that a bed is made once.

#include "bench/suite.h"

namespace scree::bench {

std::shared_ptr<void> register_benchmarks(BackendTag<BenchBackend>, const Options& options) {
  auto suite = std::make_shared<Suite<BenchBackend>>(options);
  std::vector<Index> sizes = options.sizes;
  if (sizes.empty()) {
    sizes = BenchBackend::kIsDevice ? std::vector<Index>{100'000, 1'000'000, 10'000'000}
                                    : std::vector<Index>{10'000, 100'000};
  }
  for (const Index spheres : sizes) {
    add_primitives(*suite, spheres);
    add_contact_passes(*suite, spheres);
    add_apgd(*suite, spheres);
    add_operators(*suite, spheres);
  }
  return suite;
}

}  // namespace scree::bench
