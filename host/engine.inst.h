// Compiled once per backend: the engine in both precisions.
#include "host/engine_of.h"

namespace scree {
namespace {

std::unique_ptr<BuildBackend> make_backend([[maybe_unused]] const WorldOptions& options) {
  if constexpr (BuildBackend::kIsDevice) {
    return std::make_unique<BuildBackend>();
  } else {
    return std::make_unique<BuildBackend>(options.threads);
  }
}

}  // namespace

template <>
std::unique_ptr<Engine> make_engine<BuildBackend>(Scene scene, const WorldOptions& options) {
  if (options.precision == Precision::double_precision) {
    return std::make_unique<EngineOf<BuildBackend, double>>(make_backend(options),
                                                            std::move(scene));
  }
  return std::make_unique<EngineOf<BuildBackend, float>>(make_backend(options), std::move(scene));
}

}  // namespace scree
