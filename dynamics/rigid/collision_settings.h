#pragma once
// What collision detection takes from a scene.

#include <algorithm>

#include "collision/contact_detector.h"
#include "host/scene/scene_summary.h"
#include "kernels/step/integrate.h"

namespace scree {

inline PeriodicBox periodic_box(const Periodicity& periodicity) {
  PeriodicBox box;
  for (int axis = 0; axis < 3; ++axis) {
    if (!periodicity.periodic[static_cast<std::size_t>(axis)]) continue;
    box.lower[axis] = periodicity.lower[axis];
    box.length[axis] = periodicity.upper[axis] - periodicity.lower[axis];
  }
  return box;
}

/// @param near_pairs  whether the list of near pairs is kept between steps
inline CollisionSettings collision_settings(const Scene& scene, const SceneSummary& summary,
                                            bool near_pairs) {
  CollisionSettings settings{summary.envelope, summary.layout,
                             periodic_box(scene.periodicity).length};
  settings.margin_limit = 0.25;
  settings.bounce_threshold = scene.stepping.restitution_threshold;
  settings.skin = summary.skin;
  settings.keep_candidates = near_pairs;
  for (const Joint& joint : scene.joints) {
    const bool has_world = std::count(joint.bodies.begin(), joint.bodies.end(), kWorldBody) > 0;
    if (!has_world) settings.held_pairs.push_back(joint.bodies);
  }
  for (const Material& pair : all_pair_values(scene)) {
    if (!scene.solver.exact_coulomb) settings.lift = std::max(settings.lift, pair.friction);
    if (scene.stepping.restitution_law == RestitutionLaw::poisson)
      settings.bounce = std::max(settings.bounce, pair.restitution);
  }
  return settings;
}

}  // namespace scree
