#pragma once
// What the engine needs to know of a scene before anything is allocated.

#include <cstddef>

#include "host/scene.h"
#include "kernels/contact/contact_view.h"

namespace scree {

/// Bodies ever in a run, insertions included.
struct BodyCounts {
  std::size_t free = 0;
  std::size_t fixed = 0;  ///< fixed and kinematic ones
  std::size_t all() const { return free + fixed; }
};
BodyCounts count_bodies(const Scene& scene);

struct SceneSummary {
  int free_capacity = 0;        ///< free bodies ever in the run, insertions included
  int fixed_count = 0;          ///< fixed and kinematic bodies
  int shaped_count = 0;         ///< of the free ones, those that are no spheres
  double median_diameter = 0;   ///< of the free bodies [m]; spheres, else bounding spheres
  double largest_diameter = 0;  ///< of the free bodies [m]
  double envelope = 0;          ///< resolved contact envelope [m]
  double skin = 0;              ///< resolved skin of the list of near pairs [m]
  ContactLayout layout = ContactLayout::radial;
  bool solid_spheres = true;  ///< all free bodies are homogeneous spheres with no axis locked
  bool radial_bodies = true;  ///< all free bodies are spheres that turn about all axes or none
};

/// Radius of the sphere about a body's center that holds it [m]; 0: unbounded (half-spaces).
double bounding_radius(const Scene& scene, const Shape& shape);
double bounding_radius(const Scene& scene, const BodyDescription& body);

SceneSummary summarize(const Scene& scene);

}  // namespace scree
