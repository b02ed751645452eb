#include "host/scene/run_summary.h"

#include "solvers/solver_card.h"

namespace scree {

SceneSummary summarize_run(const Scene& scene, const WorldOptions& options) {
  SceneSummary s = summarize(scene);
  const bool is_split =
      options.contact_groups && solver_card(scene.solver.name).knows(ContactLayout::mixed);
  if (s.layout == ContactLayout::mixed && !is_split) s.layout = ContactLayout::general;
  return s;
}

}  // namespace scree
