#include "host/body_constants.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "host/scene/bodies_by_id.h"
#include "host/scene/scene_summary.h"
#include "shapes/sphere.h"

namespace scree {

BodyConstants::BodyConstants(const Scene& scene) {
  const auto add_body = [&](std::size_t id, const BodyDescription& body) {
    if (ranges_.empty() || ranges_.back().bodies.empty()) ranges_.push_back({id, {}, {}});
    const double mass = body.kind == BodyKind::free ? body.mass : 0;
    ranges_.back().bodies.push_back(
        {bounding_radius(scene, body), mass, body.group, body.kind, body.shape.kind, body.entry});
    size_ = id + 1;
  };
  const auto add_set = [&](std::size_t first, const ParticleSet& set) {
    Range range{first, {}, {}};
    range.particles.radius = set.radius;
    range.particles.density = set.density;
    range.particles.mass = set.mass;
    range.particles.group = set.group;
    range.particles.entry = set.entry;
    ranges_.push_back(std::move(range));
    size_ = first + set.position.size();
  };
  for_each_by_id(scene, add_body, add_set);
}

BodyConstant BodyConstants::operator[](std::size_t id) const {
  const auto after = std::upper_bound(ranges_.begin(), ranges_.end(), id,
                                      [](std::size_t i, const Range& r) { return i < r.begin; });
  const Range& range = *std::prev(after);
  const std::size_t i = id - range.begin;
  if (!range.bodies.empty()) return range.bodies[i];
  BodyConstant particle;
  particle.shape = shapes::Sphere::kind;
  particle.radius = range.particles.radius[i];
  particle.mass = particle_mass(range.particles, i);
  particle.group = range.particles.group[i];
  particle.entry = range.particles.entry;
  particle.is_particle = true;
  particle.number = i;
  return particle;
}

}  // namespace scree
