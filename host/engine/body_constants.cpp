#include "host/body_constants.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "host/scene/bodies_by_id.h"
#include "host/scene/particle_shapes.h"
#include "host/scene/scene_summary.h"

namespace scree {
namespace {

/// Masses of the particles of a set, where finding one from the density takes long.
PerParticle<double> found_masses(const ParticleSet& set) {
  if (are_spheres(set)) return set.mass;
  if (set.shape.uniform() && set.density.uniform() && set.mass.uniform())
    return particle_mass(set, 0);
  std::vector<double> masses(set.position.size());
  for (std::size_t i = 0; i < masses.size(); ++i) masses[i] = particle_mass(set, i);
  return PerParticle<double>(std::move(masses));
}

}  // namespace

BodyConstants::BodyConstants(const Scene& scene) {
  const auto add_body = [&](std::size_t id, const BodyDescription& body) {
    if (ranges_.empty() || ranges_.back().bodies.empty()) ranges_.push_back({id, {}, {}, {}});
    const double mass = body.kind == BodyKind::free ? body.mass : 0;
    ranges_.back().bodies.push_back(
        {bounding_radius(scene, body), mass, body.group, body.kind, body.shape.kind, body.entry});
    ranges_.back().half_extents.push_back(body.shape.half_extents);
    size_ = id + 1;
  };
  const auto add_set = [&](std::size_t first, const ParticleSet& set) {
    Range range{first, {}, {}, {}};
    range.particles.radius = set.radius;
    range.particles.density = set.density;
    range.particles.shape = set.shape;
    range.particles.mass = found_masses(set);
    range.particles.group = set.group;
    range.particles.entry = set.entry;
    ranges_.push_back(std::move(range));
    size_ = first + set.position.size();
  };
  for_each_by_id(scene, add_body, add_set);
}

const BodyConstants::Range& BodyConstants::range_of(std::size_t id) const {
  return *std::prev(std::upper_bound(ranges_.begin(), ranges_.end(), id,
                                     [](std::size_t i, const Range& r) { return i < r.begin; }));
}

Vec3d BodyConstants::half_extents(std::size_t id) const {
  const Range& range = range_of(id);
  const std::size_t i = id - range.begin;
  return range.bodies.empty() ? range.particles.shape[i].half_extents : range.half_extents[i];
}

BodyConstant BodyConstants::operator[](std::size_t id) const {
  const Range& range = range_of(id);
  const std::size_t i = id - range.begin;
  if (!range.bodies.empty()) return range.bodies[i];
  BodyConstant particle;
  particle.shape = particle_kind(range.particles, i);
  particle.radius = range.particles.radius[i];
  particle.mass = particle_mass(range.particles, i);
  particle.group = range.particles.group[i];
  particle.entry = range.particles.entry;
  particle.is_particle = true;
  particle.number = i;
  return particle;
}

}  // namespace scree
