// Walls that a periodic domain cannot hold: a plane that a repeating axis would have to pass, and
// boxes and meshes over more cells than are searched.

#include <fmt/format.h>

#include <cmath>

#include "host/scene/scene_checks.h"
#include "kernels/math/quat.h"
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

std::optional<Fault> plane_fault(const Periodicity& domain, const BodyDescription& body,
                                 const WallFace& face) {
  const Vec3d normal = rotate(body.orientation, face.normal);
  const int axis = crossed_axis(domain, normal);
  if (axis == 3) return {};
  if (face.name[0] == '\0')
    return Fault{"normal", fmt::format("[{}, {}, {}]", normal.x, normal.y, normal.z),
                 fmt::format("must have no component along {}: {}", "xyz"[axis], repeats(axis))};
  return Fault{"open",
               fmt::format("a {} closed at {}", shape_card(body.shape.kind).name, face.name),
               fmt::format("must name \"{}\": {}", face.name, repeats(axis))};
}

std::optional<Fault> solid_fault(const Scene& scene, const BodyDescription& body) {
  const ShapeCard& card = shape_card(body.shape.kind);
  const TriangleMesh* mesh = mesh_of(scene, body.shape);
  const Periodicity& domain = scene.periodicity;
  for (int k = 0; k < 3; ++k) {
    if (!domain.periodic[static_cast<std::size_t>(k)]) continue;
    Vec3d axis;
    axis[k] = 1;
    axis = rotate_back(body.orientation, axis);
    const double high = dot(card.support(body.shape, mesh, axis), axis);
    const double low = dot(card.support(body.shape, mesh, -axis), axis);
    const double period = domain.upper[k] - domain.lower[k];
    if (high - low > kMostPeriods * period)
      return Fault{"", fmt::format("a wall of {:.6g} m along {}", high - low, "xyz"[k]),
                   fmt::format("must span {} periods at most, {:.6g} m: it repeats with the domain",
                               kMostPeriods, kMostPeriods * period)};
  }
  return {};
}

}  // namespace

std::optional<Fault> periodic_wall_fault(const Scene& scene, const BodyDescription& body) {
  if (body.kind == BodyKind::free) return {};
  const ShapeCard& card = shape_card(body.shape.kind);
  if (card.is_ball) return {};
  if (card.faces == nullptr) return solid_fault(scene, body);
  for (const WallFace& face : card.faces(body.shape))
    if (auto fault = plane_fault(scene.periodicity, body, face)) return fault;
  return {};
}

}  // namespace scree
