// Compiled once per backend: the model in both precisions.
#include "dynamics/rigid/contact_layout.h"
#include "dynamics/rigid/rigid.h"

namespace scree {

template <>
std::unique_ptr<Dynamics> make_dynamics<BuildBackend>(Scene scene, const WorldOptions& options) {
  const bool near_pairs = keeps_near_pairs(scene, options);
  const SceneSummary summary = summarize_run(scene, options);
  auto backend = make_backend<BuildBackend>(options);
  if (options.precision == Precision::double_precision) {
    return std::make_unique<RigidDynamics<BuildBackend, double>>(
        std::move(backend), std::move(scene), summary, near_pairs);
  }
  return std::make_unique<RigidDynamics<BuildBackend, float>>(std::move(backend), std::move(scene),
                                                              summary, near_pairs);
}

}  // namespace scree
