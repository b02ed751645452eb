#pragma once
// The surfaces of fixed and kinematic bodies, as files for viewers hold them.

#include <array>
#include <cstddef>
#include <vector>

#include "host/scene.h"

namespace scree {

/// Corners [m] and faces of one body in its own frame; faces counter-clockwise seen from outside.
struct Surface {
  std::vector<Vec3d> vertices;
  std::vector<std::vector<int>> faces;
};

struct WallSurface {
  std::size_t body = 0;  ///< id, which is also the index into Scene::bodies
  Surface surface;
};

/// One surface for each fixed or kinematic body, by id. Half spaces become squares as
/// large as the scene.
std::vector<WallSurface> wall_surfaces(const Scene& scene);

}  // namespace scree
