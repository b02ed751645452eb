#pragma once
// What the engine needs to know of a run: the scene, as far as its solver knows the contacts.

#include "host/scene/scene_summary.h"
#include "host/world.h"

namespace scree {

/// The summary of the scene with the contact layout of the run. Solvers that know one group only get
/// all contacts of a mixed scene as general ones.
SceneSummary summarize_run(const Scene& scene, const WorldOptions& options);

}  // namespace scree
