#include "host/scene/particle_shapes.h"

#include <algorithm>

#include "shapes/shape_card.h"
#include "shapes/sphere.h"

namespace scree {

ShapeKind particle_kind(const ParticleSet& set, std::size_t i) {
  const ShapeKind kind = set.shape[i].kind;
  return kind == kNoShape ? shapes::Sphere::kind : kind;
}

std::map<ShapeKind, std::size_t> particle_shape_counts(const ParticleSet& set) {
  const std::size_t count = set.position.size();
  std::map<ShapeKind, std::size_t> counts;
  if (count == 0) return counts;
  if (set.shape.uniform()) return {{particle_kind(set, 0), count}};
  for (std::size_t i = 0; i < count; ++i) ++counts[particle_kind(set, i)];
  return counts;
}

bool are_spheres(const ParticleSet& set) {
  const std::map<ShapeKind, std::size_t> counts = particle_shape_counts(set);
  return std::all_of(counts.begin(), counts.end(), [](const auto& shape) {
    return is_shape(shape.first) && shape_card(shape.first).is_ball;
  });
}

Shape particle_shape(const ParticleSet& set, std::size_t i) {
  Shape shape = set.shape[i];
  shape.kind = particle_kind(set, i);
  if (shape.kind == shapes::Sphere::kind) shape.radius = set.radius[i];
  return shape;
}

}  // namespace scree
