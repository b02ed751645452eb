// Compiled once per backend: the engine in both precisions.
#include "dynamics/rigid/expected_memory.h"
#include "dynamics/rigid/rigid.h"

namespace scree {
namespace {

std::unique_ptr<BuildBackend> make_backend(const WorldOptions& options) {
  if constexpr (BuildBackend::kIsDevice) {
    return std::make_unique<BuildBackend>(options.device);
  } else {
    return std::make_unique<BuildBackend>(options.threads);
  }
}

}  // namespace

template <>
std::unique_ptr<Dynamics> make_dynamics<BuildBackend>(Scene scene, const WorldOptions& options) {
  const bool near_pairs = keeps_near_pairs(scene, options);
  auto backend = make_backend(options);
  if (options.precision == Precision::double_precision) {
    return std::make_unique<RigidDynamics<BuildBackend, double>>(std::move(backend),
                                                                 std::move(scene), near_pairs);
  }
  return std::make_unique<RigidDynamics<BuildBackend, float>>(std::move(backend), std::move(scene),
                                                              near_pairs);
}

}  // namespace scree
