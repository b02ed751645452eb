#pragma once
// Which shapes the particles of a set have, without a look at each where all have the same.

#include <cstddef>
#include <map>

#include "host/scene.h"

namespace scree {

/// Kind of the shape of one particle.
ShapeKind particle_kind(const ParticleSet& set, std::size_t i);

/// Shapes of the particles of a set by kind, each with how many there are.
std::map<ShapeKind, std::size_t> particle_shape_counts(const ParticleSet& set);

/// Whether all particles of a set are spheres. Takes kinds that are no shape, too.
bool are_spheres(const ParticleSet& set);

}  // namespace scree
