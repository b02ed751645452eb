#pragma once
// Whether surfaces of a run of affine bodies touch, without rounding.

#include <map>
#include <vector>

#include "dynamics/affine/affine_setup.h"
#include "host/world.h"
#include "tests/exact_triangles.h"

namespace scree::affine {

/// Whether triangles of two bodies of the scene have a point in common. @param setup  of the scene of the run
inline bool triangles_touch(const AffineSetup& setup, World& world) {
  const std::vector<Vec3d> nodes = world.save().at<Vec3d>("affine/position");  // four a row
  std::map<Index, std::vector<exact::Triangle>> triangles;                     // by id
  for (std::size_t b = 0; b < setup.bodies.size(); ++b) {
    AffineVec q = setup.position[b];
    if (setup.bodies[b].row >= 0)
      for (std::size_t n = 0; n < 4; ++n)
        q.node[n] = nodes[4 * static_cast<std::size_t>(setup.bodies[b].row) + n];
    const Surface& surface = *setup.surfaces[static_cast<std::size_t>(setup.surface_of_body[b])];
    for (const auto& t : surface.triangles) {
      exact::Triangle corners;
      for (std::size_t c = 0; c < 3; ++c)
        corners[c] = point_of(q, surface.vertices[static_cast<std::size_t>(t[c])]);
      triangles[setup.id_of_body[b]].push_back(corners);
    }
  }
  for (auto a = triangles.begin(); a != triangles.end(); ++a)
    for (auto b = std::next(a); b != triangles.end(); ++b)
      for (const exact::Triangle& s : a->second)
        for (const exact::Triangle& t : b->second)
          if (exact::triangles_touch(s, t)) return true;
  return false;
}

}  // namespace scree::affine
