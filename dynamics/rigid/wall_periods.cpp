#include "dynamics/rigid/wall_periods.h"

#include <algorithm>
#include <cmath>

#include "collision/mesh_seams.h"
#include "dynamics/rigid/collision_settings.h"
#include "host/scene/motion.h"
#include "kernels/math/quat.h"
#include "kernels/narrow_phase/wall_images.h"
#include "shapes/box.h"
#include "shapes/cylinder.h"
#include "shapes/shape_card.h"

namespace scree {
namespace {

/// Calls visit(axis, length of the period, the axis in the frame of the body) for those that keep their directions on a wall.
template <class F>
void visit_kept_axes(const Scene& scene, const BodyDescription& body, F&& visit) {
  if (body.kind == BodyKind::free) return;
  const Vec3d length = periodic_box(scene.periodicity).length;
  for (int k = 0; k < 3; ++k) {
    Vec3d axis;
    axis[k] = 1;
    if (length[k] > 0 && keeps_direction(body, axis))
      visit(k, length[k], rotate_back(body.orientation, axis));
  }
}

}  // namespace

std::vector<Vec3d> wall_periods(const Scene& scene, const BodyDescription& body) {
  std::vector<Vec3d> periods;
  const ShapeCard& card = shape_card(body.shape.kind);
  if (!card.has_mesh || card.is_hull || card.is_compound) return periods;
  visit_kept_axes(scene, body, [&](int, double length, const Vec3d& axis) {
    const std::vector<Vec3d>& points =
        scene.meshes[static_cast<std::size_t>(body.shape.mesh)].vertices;
    if (spans_period(points, length * axis)) periods.push_back(length * axis);
  });
  return periods;
}

std::optional<EndlessWall> endless_wall(const Scene& scene, const BodyDescription& body) {
  constexpr double kRounding = 1e-6;
  const bool is_box = body.shape.kind == shapes::Box::kind;
  if (!is_box && body.shape.kind != shapes::Cylinder::kind) return {};
  EndlessWall wall;
  wall.half_extents = core_half_extents(body.shape);
  visit_kept_axes(scene, body, [&](int k, double length, const Vec3d& axis) {
    for (int own = is_box ? 0 : 2; own < 3; ++own) {
      if (std::abs(axis[own]) < 1 - kRounding * kRounding) continue;
      double& half = wall.half_extents[own];
      if (2 * half < length * (1 - kRounding)) continue;
      // As far as images are searched: bodies may pass several periods in a step.
      half = std::max(half, kMostPeriods * length);
      wall.axes = static_cast<std::uint8_t>(wall.axes | 1u << k);
    }
  });
  if (wall.axes == 0) return {};
  return wall;
}

std::uint8_t axes_it_goes_on(const Scene& scene, const BodyDescription& body) {
  const std::optional<EndlessWall> wall = endless_wall(scene, body);
  unsigned axes = wall ? wall->axes : 0;
  for (const Vec3d& period : wall_periods(scene, body)) {
    const Vec3d along = rotate(body.orientation, period);
    for (int k = 0; k < 3; ++k)
      if (std::abs(along[k]) > 0.5 * norm(along)) axes |= 1u << k;
  }
  return static_cast<std::uint8_t>(axes);
}

}  // namespace scree
