#include "dynamics/affine/nested_bodies.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "kernels/affine/surface_tree.h"
#include "shapes/solid_angle.h"

namespace scree::affine {
namespace {

using Corners = std::array<Vec3d, 3>;

/// What has one id: a body, or all tetrahedra of an elastic one.
struct Whole {
  std::vector<Index> bodies;
  std::vector<Corners> triangles;
  Bounds box;
  bool is_elastic = false;
  bool is_wall = false;  ///< planes, as triangles far larger than the scene
};

bool holds(const Bounds& outer, const Bounds& inner) {
  for (int k = 0; k < 3; ++k)
    if (inner.low[k] < outer.low[k] || inner.high[k] > outer.high[k]) return false;
  return true;
}

/// Whether a point is inside of a closed surface, or behind a wall.
bool is_inside(const Vec3d& x, const Whole& outer) {
  constexpr double kWhole = 4 * std::numbers::pi,
                   kLeast = 0.99;  // an open surface is less than all around
  double sum = 0;
  for (const Corners& corner : outer.triangles) {
    const double angle = solid_angle(corner, x);
    if (outer.is_wall && angle > 0) return true;
    sum += angle;
  }
  return !outer.is_wall && sum > kLeast * kWhole;
}

bool is_inside(const Whole& inner, const Whole& outer) {
  return !inner.is_wall && !inner.triangles.empty() &&
         (outer.is_wall || holds(outer.box, inner.box)) && is_inside(inner.triangles[0][0], outer);
}

bool meet(const AffineSetup& setup, const Whole& a, const Whole& b) {
  return std::all_of(a.bodies.begin(), a.bodies.end(), [&](Index i) {
    return std::all_of(b.bodies.begin(), b.bodies.end(),
                       [&](Index k) { return may_touch(setup, i, k); });
  });
}

std::map<int, Whole> wholes_of(const AffineSetup& setup) {
  std::map<int, Whole> wholes;
  for (std::size_t b = 0; b < setup.bodies.size(); ++b) {
    Whole& whole = wholes[static_cast<int>(setup.id_of_body[b])];
    whole.is_elastic = whole.is_elastic || setup.bodies[b].lame.is_elastic();
    const Surface& surface = *setup.surfaces[static_cast<std::size_t>(setup.surface_of_body[b])];
    if (surface.triangles.empty()) continue;
    whole.bodies.push_back(static_cast<Index>(b));
    whole.is_wall = surface.radius > 10 * setup.size;
    for (const auto& t : surface.triangles) {
      Corners& corner = whole.triangles.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        corner[k] = point_of(setup.position[b], surface.vertices[static_cast<std::size_t>(t[k])]);
        whole.box.add(corner[k]);
      }
    }
  }
  return wholes;
}

}  // namespace

std::vector<Nested> nested_with_elastic(const AffineSetup& setup) {
  std::vector<Nested> found;
  if (setup.bodies.size() == setup.scene_bodies) return found;  // no tetrahedra
  const std::map<int, Whole> wholes = wholes_of(setup);
  for (const auto& [id, elastic] : wholes) {
    if (!elastic.is_elastic) continue;
    for (const auto& [other_id, other] : wholes) {
      if (other_id == id || (other.is_elastic && other_id < id)) continue;
      const bool is_in = is_inside(elastic, other);
      if ((is_in || is_inside(other, elastic)) && meet(setup, elastic, other))
        found.push_back(is_in ? Nested{id, other_id} : Nested{other_id, id});
    }
  }
  return found;
}

std::string nested_warning(const std::vector<Nested>& nested, const BodyNames& name) {
  const std::string more =
      nested.size() > 1 ? fmt::format(", and {} more bodies so", nested.size() - 1) : "";
  return fmt::format(
      "{} starts inside of {}, or behind it{}: surfaces keep what is inside from coming "
      "out",
      name(nested[0].inner), name(nested[0].outer), more);
}

}  // namespace scree::affine
