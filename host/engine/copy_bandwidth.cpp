#include "host/engine/copy_bandwidth.h"

#include <string>

#include "host/error.h"

namespace scree {

class Cpu;
class Cuda;

double copy_bandwidth(const WorldOptions& options) {
  std::string reason;
  if (!backend_available(options.backend, &reason, options.device))
    throw InputError("backend cuda: " + reason);
#ifdef SCREE_HAS_CUDA
  if (options.backend == BackendKind::cuda) return copy_bandwidth_on<Cuda>(options);
#endif
  return copy_bandwidth_on<Cpu>(options);
}

}  // namespace scree
