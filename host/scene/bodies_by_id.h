#pragma once
// The order in which the bodies of a scene are numbered.

#include <cstddef>

#include "host/scene.h"

namespace scree {

/// Passes over all bodies a run of the scene can ever have, in the order of their ids:
/// calls on_body(id, body) for those described one by one and on_set(first id, set)
/// for sets of particles.
template <class OnBody, class OnSet>
void for_each_by_id(const Scene& scene, OnBody on_body, OnSet on_set) {
  std::size_t id = 0;
  const auto pass = [&](const auto& batch) {
    for (const BodyDescription& body : batch.bodies) on_body(id++, body);
    for (const ParticleSet& set : batch.particles) {
      on_set(id, set);
      id += set.position.size();
    }
  };
  pass(scene);
  for (const Insertion& insertion : scene.insertions) pass(insertion);
}

}  // namespace scree
