#include "host/problems/require_solver.h"

#include "dynamics/dynamics_card.h"
#include "host/scene/run_summary.h"
#include "solvers/solver_card.h"

namespace scree {

void require_solver(const Scene& scene, const WorldOptions& options) {
  if (!dynamics_card(scene.dynamics.type).has_contacts) return;
  const bool knows_all = solver_card(scene.solver.name).layouts.size() == kAllLayouts.size();
  require_solver("solver.name", scene.solver.name, options.backend,
                 knows_all ? ContactLayout::radial : summarize_run(scene, options).layout);
}

}  // namespace scree
