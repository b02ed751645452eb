#pragma once
// Walls that go on in their images: as long as the period along an axis that keeps its direction on them.

#include <cstdint>
#include <optional>
#include <vector>

#include "collision/obstacles.h"
#include "host/scene.h"

namespace scree {

/// Periods that the mesh of a fixed or kinematic body spans [m], in its frame: see MeshSource::periods.
std::vector<Vec3d> wall_periods(const Scene& scene, const BodyDescription& body);

/// The axes that boxes along axes of the domain, and cylinders along one, fill, rounded or not. None: there is no such axis.
std::optional<EndlessWall> endless_wall(const Scene& scene, const BodyDescription& body);

/// Bits of the axes along which it goes on, whatever its shape.
std::uint8_t axes_it_goes_on(const Scene& scene, const BodyDescription& body);

}  // namespace scree
