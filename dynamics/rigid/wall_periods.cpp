#include "dynamics/rigid/wall_periods.h"

#include <algorithm>
#include <cmath>

#include "collision/mesh_seams.h"
#include "dynamics/rigid/collision_settings.h"
#include "host/scene/motion.h"
#include "kernels/math/quat.h"
#include "shapes/box.h"
#include "shapes/cylinder.h"
#include "shapes/rounded.h"
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

/// Calls visit(axis, period in the frame of the body) for those over which a mesh wall is joined with its images.
template <class F>
void visit_periods_of_mesh(const Scene& scene, const BodyDescription& body, F&& visit) {
  const ShapeCard& card = shape_card(body.shape.kind);
  if (!card.has_mesh || card.is_hull || card.is_compound) return;
  const TriangleMesh& mesh = scene.meshes[static_cast<std::size_t>(body.shape.mesh)];
  visit_kept_axes(scene, body, [&](int k, double length, const Vec3d& axis) {
    const Vec3d period = length * axis;
    auto triangles = mesh.triangles;
    if (!take_seams(mesh.vertices, triangles, mesh.closed, {period}).empty()) visit(k, period);
  });
}

}  // namespace

std::vector<Vec3d> wall_periods(const Scene& scene, const BodyDescription& body) {
  std::vector<Vec3d> periods;
  visit_periods_of_mesh(scene, body, [&](int, const Vec3d& period) { periods.push_back(period); });
  return periods;
}

std::optional<EndlessWall> endless_wall(const Scene& scene, const BodyDescription& body) {
  constexpr double kRounding = 1e-6;
  const Shape& shape = body.shape;
  const bool is_rounded = shape.kind == shapes::Rounded::kind;
  const ShapeKind core = is_rounded ? shape.rounded.core : shape.kind;
  const double rounding = is_rounded ? shape.rounded.radius : 0;
  const bool is_box = core == shapes::Box::kind;
  if (!is_box && core != shapes::Cylinder::kind) return {};
  EndlessWall wall;
  wall.half_extents = core_half_extents(shape);
  visit_kept_axes(scene, body, [&](int k, double length, const Vec3d& axis) {
    for (int own = is_box ? 0 : 2; own < 3; ++own) {
      if (std::abs(axis[own]) < 1 - kRounding * kRounding) continue;
      double& half = wall.half_extents[own];
      if (2 * (half + rounding) < length * (1 - kRounding)) continue;
      // Only what goes farther than that in a step meets its end. No more: rounding is measured by it.
      half = std::max(half, 2 * length);
      wall.axes = static_cast<std::uint8_t>(wall.axes | 1u << k);
    }
  });
  if (wall.axes == 0) return {};
  return wall;
}

std::uint8_t axes_it_goes_on(const Scene& scene, const BodyDescription& body) {
  const std::optional<EndlessWall> wall = endless_wall(scene, body);
  unsigned axes = wall ? wall->axes : 0;
  visit_periods_of_mesh(scene, body, [&](int k, const Vec3d&) { axes |= 1u << k; });
  return static_cast<std::uint8_t>(axes);
}

}  // namespace scree
