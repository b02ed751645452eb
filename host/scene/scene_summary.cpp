#include "host/scene/scene_summary.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "host/scene/added_bodies.h"
#include "host/scene/bodies_by_id.h"
#include "host/scene/motion.h"
#include "host/scene/particle_shapes.h"
#include "host/scene/scene_checks.h"

namespace scree {
namespace {

/// Fraction of the median diameter up to which gaps are listed as contacts by default.
constexpr double kDefaultEnvelope = 0.01;
/// Fraction of the median diameter by which the list of near pairs reaches farther by default.
constexpr double kDefaultSkin = 0.1;

bool has_rolling_friction(const Scene& scene) {
  const std::vector<Material> pairs = all_pair_values(scene);
  return std::any_of(pairs.begin(), pairs.end(), [](const Material& m) {
    return m.rolling_friction > 0 || m.spinning_friction > 0;
  });
}

bool fits_radial_layout(std::uint8_t locks) { return locks == 0 || locks == lock_rotation; }

/// Spheres whose locks leave all of the translation and all or nothing of the rotation.
bool fits_radial_layout(const BodyDescription& body) {
  if (body.kind != BodyKind::free) return !rotates(body);
  return shape_card(body.shape.kind).is_ball && fits_radial_layout(body.locks);
}

bool is_free_solid_sphere(const BodyDescription& body) {
  if (!shape_card(body.shape.kind).is_ball || body.locks != 0) return false;
  const double solid = 0.4 * body.mass * body.shape.radius * body.shape.radius;
  const auto is_solid = [&](double moment) { return std::abs(moment - solid) <= 1e-9 * solid; };
  return is_solid(body.inertia.x) && is_solid(body.inertia.y) && is_solid(body.inertia.z);
}

}  // namespace

double bounding_radius(const Scene& scene, const Shape& shape) {
  return shape_card(shape.kind).bounding_radius(shape, mesh_of(scene, shape));
}

double bounding_radius(const Scene& scene, const BodyDescription& body) {
  return bounding_radius(scene, body.shape);
}

namespace {

/// Calls f(diameter, count) for the free bodies with ids below `end`; count: how many bodies in a row have it.
template <class F>
void for_each_diameter(const Scene& scene, std::size_t end, F f) {
  for_each_by_id(
      scene,
      [&](std::size_t id, const BodyDescription& body) {
        if (id < end && body.kind == BodyKind::free)
          f(2 * bounding_radius(scene, body), std::size_t{1});
      },
      [&](std::size_t, const ParticleSet& set) {
        const std::size_t count = set.position.size();
        if (set.radius.uniform()) {
          if (count > 0) f(2 * set.radius[0], count);
        } else {
          for (std::size_t i = 0; i < count; ++i) f(2 * set.radius[i], std::size_t{1});
        }
      });
}

/// The median is that of the scene: bodies that a program adds leave tolerance, envelope and skin as they are.
void find_diameters(const Scene& scene, const BodyCounts& count, SceneSummary& s) {
  const std::size_t end = count.all() - added_count(scene);
  double smallest = std::numeric_limits<double>::infinity();
  for_each_diameter(scene, end, [&](double diameter, std::size_t) {
    smallest = std::min(smallest, diameter);
    s.median_diameter = std::max(s.median_diameter, diameter);
  });
  for_each_diameter(scene, count.all(), [&](double diameter, std::size_t) {
    s.largest_diameter = std::max(s.largest_diameter, diameter);
  });
  if (!(smallest < s.median_diameter)) return;  // one size: no list of them is needed
  std::vector<double> diameters;
  diameters.reserve(count.free);
  for_each_diameter(scene, end, [&](double diameter, std::size_t count) {
    diameters.insert(diameters.end(), count, diameter);
  });
  const auto middle = diameters.begin() + static_cast<std::ptrdiff_t>(diameters.size() / 2);
  std::nth_element(diameters.begin(), middle, diameters.end());
  s.median_diameter = *middle;
}

}  // namespace

BodyCounts count_bodies(const Scene& scene) {
  BodyCounts count;
  for_each_by_id(
      scene,
      [&](std::size_t, const BodyDescription& body) {
        ++(body.kind == BodyKind::free ? count.free : count.fixed);
      },
      [&](std::size_t, const ParticleSet& set) { count.free += set.position.size(); });
  return count;
}

SceneSummary summarize(const Scene& scene) {
  const BodyCounts count = count_bodies(scene);
  SceneSummary s;
  s.free_capacity = static_cast<int>(count.free);
  s.fixed_count = static_cast<int>(count.fixed);
  bool radial = true, has_spheres = false, has_compounds = false;
  const auto see_free = [&](bool fits) {
    has_spheres = has_spheres || fits;
    s.radial_bodies = s.radial_bodies && fits;
  };
  for_each_by_id(
      scene,
      [&](std::size_t, const BodyDescription& body) {
        radial = radial && fits_radial_layout(body);
        has_compounds = has_compounds || shape_card(body.shape.kind).is_compound;
        if (body.kind == BodyKind::free) {
          see_free(fits_radial_layout(body));
          s.shaped_count += shape_card(body.shape.kind).is_ball ? 0 : 1;
        }
        s.solid_spheres =
            s.solid_spheres && (body.kind != BodyKind::free || is_free_solid_sphere(body));
      },
      [&](std::size_t, const ParticleSet& set) {
        for (const auto& [kind, particles] : particle_shape_counts(set)) {
          const bool is_ball = shape_card(kind).is_ball;
          const bool fits = is_ball && fits_radial_layout(set.locks);
          radial = radial && fits;
          has_compounds = has_compounds || shape_card(kind).is_compound;
          see_free(fits);
          s.shaped_count += is_ball ? 0 : static_cast<int>(particles);
          s.solid_spheres = s.solid_spheres && is_ball && set.locks == 0;
        }
      });
  find_diameters(scene, count, s);
  s.envelope =
      scene.stepping.envelope >= 0 ? scene.stepping.envelope : kDefaultEnvelope * s.median_diameter;
  s.skin = scene.stepping.skin >= 0 ? scene.stepping.skin : kDefaultSkin * s.median_diameter;
  if (!scene.joints.empty()) {
    s.layout = ContactLayout::jointed;
  } else if (has_rolling_friction(scene)) {
    s.layout = ContactLayout::rolling;
  } else if (!radial || has_compounds) {
    s.layout = has_spheres && !has_compounds ? ContactLayout::mixed : ContactLayout::general;
  }
  return s;
}

}  // namespace scree
