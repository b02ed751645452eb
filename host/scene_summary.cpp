#include "host/scene_summary.h"

#include <algorithm>
#include <cmath>

#include "host/motion.h"

namespace scree {
namespace {

/// Fraction of the median diameter up to which gaps are listed as contacts by default.
constexpr double kDefaultEnvelope = 0.01;

bool has_rolling_friction(const Scene& scene) {
  const int n = static_cast<int>(scene.materials.size());
  for (int a = 0; a < n; ++a) {
    for (int b = 0; b <= a; ++b) {
      const Material m = pair_values(scene, a, b);
      if (m.rolling_friction > 0 || m.spinning_friction > 0) return true;
    }
  }
  return false;
}

/// Spheres whose locks leave all of the translation and all or nothing of the rotation.
bool fits_radial_layout(const BodyDescription& body) {
  if (body.kind != BodyKind::free) return !rotates(body);
  return body.shape.kind == Shape::Kind::sphere && (body.locks == 0 || body.locks == lock_rotation);
}

}  // namespace

double bounding_radius(const Scene& scene, const BodyDescription& body) {
  switch (body.shape.kind) {
    case Shape::Kind::sphere:
      return body.shape.radius;
    case Shape::Kind::box:
    case Shape::Kind::container:
      return norm(body.shape.half_extents);
    case Shape::Kind::half_space:
      return 0;
    case Shape::Kind::mesh:
      break;
  }
  double largest = 0;
  for (const Vec3d& v : scene.meshes[static_cast<std::size_t>(body.shape.mesh)].vertices) {
    largest = std::max(largest, norm2(v));
  }
  return std::sqrt(largest);
}

SceneSummary summarize(const Scene& scene) {
  SceneSummary s;
  std::vector<double> diameters;
  bool radial = true;
  const auto visit = [&](const BodyDescription& body) {
    const double radius = bounding_radius(scene, body);
    const bool moves = body.kind == BodyKind::free;
    s.constants.radius.push_back(radius);
    s.constants.mass.push_back(moves ? body.mass : 0);
    s.constants.group.push_back(body.group);
    s.constants.kind.push_back(body.kind);
    s.constants.shape.push_back(body.shape.kind);
    radial = radial && fits_radial_layout(body);
    if (moves) {
      ++s.free_capacity;
      diameters.push_back(2 * radius);
    } else {
      ++s.fixed_count;
    }
  };
  for (const BodyDescription& body : scene.bodies) visit(body);
  for (const Insertion& insertion : scene.insertions) {
    for (const BodyDescription& body : insertion.bodies) visit(body);
  }
  if (!diameters.empty()) {
    const auto middle = diameters.begin() + static_cast<std::ptrdiff_t>(diameters.size() / 2);
    std::nth_element(diameters.begin(), middle, diameters.end());
    s.median_diameter = *middle;
  }
  s.envelope =
      scene.stepping.envelope >= 0 ? scene.stepping.envelope : kDefaultEnvelope * s.median_diameter;
  if (has_rolling_friction(scene)) {
    s.layout = ContactLayout::rolling;
  } else if (!radial) {
    s.layout = ContactLayout::general;
  }
  return s;
}

}  // namespace scree
