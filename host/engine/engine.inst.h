// Compiled once per backend: the engine in both precisions.
#include "host/engine/engine_of.h"
#include "host/engine/expected_memory.h"

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
std::unique_ptr<Engine> make_engine<BuildBackend>(Scene scene, const WorldOptions& options) {
  const bool near_pairs = keeps_near_pairs(scene, options);
  auto backend = make_backend(options);
  if (options.precision == Precision::double_precision) {
    return std::make_unique<EngineOf<BuildBackend, double>>(std::move(backend), std::move(scene),
                                                            near_pairs);
  }
  return std::make_unique<EngineOf<BuildBackend, float>>(std::move(backend), std::move(scene),
                                                         near_pairs);
}

}  // namespace scree
