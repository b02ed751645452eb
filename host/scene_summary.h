#pragma once
// What the engine needs to know of a scene before anything is allocated.

#include "host/scene.h"
#include "host/world.h"
#include "kernels/contact_view.h"

namespace scree {

struct SceneSummary {
  int free_capacity = 0;       ///< free bodies ever in the run, insertions included
  int fixed_count = 0;         ///< fixed and kinematic bodies
  double median_diameter = 0;  ///< of the free bodies [m]; spheres, else bounding spheres
  double envelope = 0;         ///< resolved contact envelope [m]
  ContactLayout layout = ContactLayout::radial;
  BodyConstants constants;  ///< of all bodies, by id
};

/// Radius of the sphere about a body's center that holds it [m]; 0: unbounded (half-spaces).
double bounding_radius(const Scene& scene, const BodyDescription& body);

SceneSummary summarize(const Scene& scene);

}  // namespace scree
