// Compiled once per backend.
#include "host/engine/copy_bandwidth.h"
#include "host/engine/copy_bandwidth_of.h"

namespace scree {

template <>
double copy_bandwidth_on<BuildBackend>(const WorldOptions& options) {
  if constexpr (BuildBackend::kIsDevice) {
    BuildBackend backend(options.device);
    return copy_bandwidth_of(backend);
  } else {
    BuildBackend backend(options.threads);
    return copy_bandwidth_of(backend);
  }
}

}  // namespace scree
