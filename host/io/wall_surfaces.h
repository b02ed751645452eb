#pragma once
// The surfaces of fixed and kinematic bodies, as files for viewers hold them.

#include <cstddef>
#include <vector>

#include "host/scene.h"
#include "shapes/surface.h"

namespace scree {

struct WallSurface {
  std::size_t body = 0;  ///< id, which is also the index into Scene::bodies
  Surface surface;
};

/// One surface for each fixed or kinematic body, by id. What is unbounded becomes as large as the
/// scene.
std::vector<WallSurface> wall_surfaces(const Scene& scene);

}  // namespace scree
