#include "host/io/wall_surfaces.h"

#include <algorithm>

#include "host/scene/motion.h"
#include "host/scene/scene_checks.h"
#include "host/scene/scene_summary.h"

namespace scree {
namespace {

/// Half edge for half spaces: reaches past every body from wherever the half space was put.
double size_of(const Scene& scene) {
  Vec3d low, high;
  double extent = 0;
  const auto reach = [&](const Vec3d& position) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], position[k]);
      high[k] = std::max(high[k], position[k]);
    }
  };
  for (const ParticleSet& set : scene.particles) {
    for (std::size_t i = 0; i < set.position.size(); ++i) {
      reach(set.position[i]);
      extent = std::max(extent, set.radius[i]);
    }
  }
  for (const BodyDescription& body : scene.bodies) {
    reach(pose_at(body, 0).position);
    extent = std::max(extent, bounding_radius(scene, body));
  }
  return norm(high - low) + extent;
}

}  // namespace

std::vector<WallSurface> wall_surfaces(const Scene& scene) {
  std::vector<WallSurface> walls;
  const double scene_size = size_of(scene);
  for (std::size_t id = 0; id < scene.bodies.size(); ++id) {
    const BodyDescription& body = scene.bodies[id];
    if (body.kind == BodyKind::free) continue;
    const ShapeCard& card = shape_card(body.shape.kind);
    walls.push_back({id, card.surface(body.shape, mesh_of(scene, body.shape), scene_size)});
  }
  return walls;
}

}  // namespace scree
