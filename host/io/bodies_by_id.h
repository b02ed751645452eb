#pragma once
// Ids of bodies: those of Scene::bodies in their order, then those of the insertions in theirs.

#include <vector>

#include "host/scene.h"

namespace scree {

/// Descriptions of all bodies a run of the scene can ever have; the index is the body's id.
/// The pointers live as long as the scene is not changed.
inline std::vector<const BodyDescription*> bodies_by_id(const Scene& scene) {
  std::size_t count = scene.bodies.size();
  for (const Insertion& insertion : scene.insertions) count += insertion.bodies.size();
  std::vector<const BodyDescription*> bodies;
  bodies.reserve(count);
  for (const BodyDescription& body : scene.bodies) bodies.push_back(&body);
  for (const Insertion& insertion : scene.insertions)
    for (const BodyDescription& body : insertion.bodies) bodies.push_back(&body);
  return bodies;
}

}  // namespace scree
