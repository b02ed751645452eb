#pragma once
// The contact layout of a run: that of the scene, as far as the solver knows it.

#include "host/scene/scene_summary.h"
#include "host/world.h"
#include "solvers/solver_card.h"

namespace scree {

/// Solvers that know one group only get all contacts of a mixed scene as general ones.
inline SceneSummary summarize_run(const Scene& scene, const WorldOptions& options) {
  SceneSummary s = summarize(scene);
  const bool is_split =
      options.contact_groups && solver_card(scene.solver.name).knows(ContactLayout::mixed);
  if (s.layout == ContactLayout::mixed && !is_split) s.layout = ContactLayout::general;
  return s;
}

}  // namespace scree
