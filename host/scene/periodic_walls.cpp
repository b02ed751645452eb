// Walls that a periodic domain cannot hold: a plane that a repeating axis would have to pass, and
// boxes and meshes over more cells than are searched.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/scene/scene_checks.h"
#include "kernels/math/quat.h"
#include "kernels/narrow_phase/pairs/container.h"
#include "kernels/narrow_phase/wall_images.h"

namespace scree {
namespace {

/// Component of a unit normal that is taken for rounding.
constexpr double kUnitRounding = 1e-6;

/// The first periodic axis along which a normal has a component, else 3.
int crossed_axis(const Periodicity& domain, const Vec3d& normal) {
  for (int k = 0; k < 3; ++k) {
    if (domain.periodic[static_cast<std::size_t>(k)] && std::abs(normal[k]) > kUnitRounding)
      return k;
  }
  return 3;
}

std::string repeats(int axis) {
  return fmt::format("the domain repeats along {0}, so no plane can bound {0}", "xyz"[axis]);
}

std::optional<Fault> container_fault(const Periodicity& domain, const BodyDescription& body) {
  for (int face = 0; face < kContainerFaces; ++face) {
    if ((body.shape.open_faces >> face & 1) != 0) continue;
    const FacePlane plane = container_face(body.shape.half_extents, face);
    const int axis = crossed_axis(domain, rotate(body.orientation, plane.normal));
    if (axis == 3) continue;
    const std::string name = fmt::format("{}{}", face % 2 == 0 ? '-' : '+', "xyz"[face / 2]);
    return Fault{"open", fmt::format("a container closed at {}", name),
                 fmt::format("must name \"{}\": {}", name, repeats(axis))};
  }
  return {};
}

/// Corners of what the body takes up, body frame [m].
std::vector<Vec3d> outline(const Scene& scene, const Shape& shape) {
  if (shape.kind == Shape::Kind::mesh)
    return scene.meshes[static_cast<std::size_t>(shape.mesh)].vertices;
  std::vector<Vec3d> corners;
  corners.reserve(8);
  for (int k = 0; k < 8; ++k) {
    corners.push_back(
        hadamard(shape.half_extents, {k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0, k & 4 ? 1.0 : -1.0}));
  }
  return corners;
}

std::optional<Fault> solid_fault(const Scene& scene, const BodyDescription& body) {
  Vec3d low, high;
  bool is_first = true;
  for (const Vec3d& corner : outline(scene, body.shape)) {
    const Vec3d x = rotate(body.orientation, corner);
    for (int k = 0; k < 3; ++k) {
      low[k] = is_first ? x[k] : std::min(low[k], x[k]);
      high[k] = is_first ? x[k] : std::max(high[k], x[k]);
    }
    is_first = false;
  }
  const Periodicity& domain = scene.periodicity;
  for (int k = 0; k < 3; ++k) {
    if (!domain.periodic[static_cast<std::size_t>(k)]) continue;
    const double period = domain.upper[k] - domain.lower[k];
    if (high[k] - low[k] > kMostPeriods * period)
      return Fault{"", fmt::format("a wall of {:.6g} m along {}", high[k] - low[k], "xyz"[k]),
                   fmt::format("must span {} periods at most, {:.6g} m: it repeats with the domain",
                               kMostPeriods, kMostPeriods * period)};
  }
  return {};
}

}  // namespace

std::optional<Fault> periodic_wall_fault(const Scene& scene, const BodyDescription& body) {
  if (body.kind == BodyKind::free) return {};
  switch (body.shape.kind) {
    case Shape::Kind::half_space: {
      const Vec3d normal = rotate(body.orientation, body.shape.normal);
      const int axis = crossed_axis(scene.periodicity, normal);
      if (axis == 3) return {};
      return Fault{"normal", fmt::format("[{}, {}, {}]", normal.x, normal.y, normal.z),
                   fmt::format("must have no component along {}: {}", "xyz"[axis], repeats(axis))};
    }
    case Shape::Kind::container:
      return container_fault(scene.periodicity, body);
    case Shape::Kind::box:
    case Shape::Kind::mesh:
      return solid_fault(scene, body);
    case Shape::Kind::sphere:
      break;
  }
  return {};
}

}  // namespace scree
