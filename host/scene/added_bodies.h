#pragma once
// Bodies that a program added to a run: the last batch of the insertions of its scene, at a time that no run reaches, so
// that their ids come after all others.

#include <cstddef>
#include <limits>
#include <vector>

#include "host/scene.h"

namespace scree {

inline constexpr double kAddedByProgram = std::numeric_limits<double>::max();  ///< [s]

/// Insertions that have a time in a run.
inline std::size_t timed_insertions(const Scene& scene) {
  const bool has_added =
      !scene.insertions.empty() && scene.insertions.back().time == kAddedByProgram;
  return scene.insertions.size() - (has_added ? 1 : 0);
}

/// The bodies that programs added.
inline std::size_t added_count(const Scene& scene) {
  return timed_insertions(scene) < scene.insertions.size() ? scene.insertions.back().bodies.size()
                                                           : 0;
}

/// The list of them, made when there is none.
inline std::vector<BodyDescription>& added_bodies(Scene& scene) {
  if (timed_insertions(scene) == scene.insertions.size()) {
    scene.insertions.emplace_back();
    scene.insertions.back().time = kAddedByProgram;
  }
  return scene.insertions.back().bodies;
}

}  // namespace scree
