// Bodies that put planes around an inside, such as containers: planes of one that lead through another would stop
// what is in there.

#include <fmt/format.h>

#include <cmath>

#include "host/scene/scene_checks.h"

namespace scree {
namespace {

/// Half length of the box's shadow on a direction.
double shadow(const BodyDescription& box, const Vec3d& direction) {
  const Vec3d d = rotate_back(box.orientation, direction);
  const Vec3d& e = box.shape.half_extents;
  return std::abs(d.x) * e.x + std::abs(d.y) * e.y + std::abs(d.z) * e.z;
}

/// True when the interior of box `inner` lies inside box `outer`.
bool lies_inside(const BodyDescription& inner, const BodyDescription& outer, double tolerance) {
  const Vec3d offset = inner.position - outer.position;
  for (int k = 0; k < 3; ++k) {
    Vec3d axis;
    axis[k] = 1;
    axis = rotate(outer.orientation, axis);
    if (std::abs(dot(offset, axis)) + shadow(inner, axis) > outer.shape.half_extents[k] + tolerance)
      return false;
  }
  return true;
}

/// Separating axis test of two boxes; touching is not overlap.
bool interiors_meet(const BodyDescription& a, const BodyDescription& b, double tolerance) {
  std::array<Vec3d, 15> axes;
  for (int k = 0; k < 3; ++k) {
    Vec3d unit;
    unit[k] = 1;
    axes[k] = rotate(a.orientation, unit);
    axes[3 + k] = rotate(b.orientation, unit);
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) axes[6 + 3 * i + j] = cross(axes[i], axes[3 + j]);
  const Vec3d offset = b.position - a.position;
  for (const Vec3d& axis : axes) {
    const double size = norm(axis);
    if (size < 1e-9) continue;  // parallel edges: covered by the face axes
    if (std::abs(dot(offset, axis)) >= shadow(a, axis) + shadow(b, axis) - tolerance * size)
      return false;
  }
  return true;
}

}  // namespace

std::optional<Fault> room_fault(const Scene& scene) {
  std::vector<std::size_t> rooms;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    if (shape_card(scene.bodies[i].shape.kind).is_room()) rooms.push_back(i);
  for (std::size_t i = 0; i < rooms.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const BodyDescription& a = scene.bodies[rooms[j]];
      const BodyDescription& b = scene.bodies[rooms[i]];
      const double tolerance = 1e-9 * (norm(a.shape.half_extents) + norm(b.shape.half_extents));
      if (interiors_meet(a, b, tolerance) && !lies_inside(a, b, tolerance) &&
          !lies_inside(b, a, tolerance))
        return Fault{fmt::format("bodies[{}]", rooms[i]),
                     fmt::format("a {}", shape_card(b.shape.kind).name),
                     fmt::format("its interior partly overlaps that of bodies[{}]; containers must "
                                 "be apart, touch, or lie one inside the other",
                                 rooms[j])};
    }
  }
  return std::nullopt;
}

}  // namespace scree
