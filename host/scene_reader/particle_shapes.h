#pragma once
// The shapes of an entry of `particles`, and how they and their sizes are drawn.

#include <string>
#include <vector>

#include "host/layouts/layouts.h"
#include "host/scene_reader/parts.h"

namespace scree::reader {

struct ParticleShapes {
  std::vector<Shape> shapes;  ///< at scale one; none: spheres
  std::vector<int> groups;    ///< of the shapes; -1: that of the entry
  SizeLaw size;
};

/// Reads `radius`, or else `shape` or `shapes` with `scale`.
ParticleShapes read_particle_shapes(const Node& node, Draft& draft);

/// The same of particles from a file, which may give radii. None: spheres, whose `radius` is not read.
ParticleShapes read_shapes_of_file(const Node& node, Draft& draft);

/// @param named  whose fault it is
/// @param scale  of each particle, from a file; uniform: there are none
/// @throws InputError where a shape cannot have a scale
void check_scales(const Node& named, const ParticleShapes& shapes, const PerParticle<double>& scale,
                  std::size_t count);

/// Gives a set the shapes, sizes and groups of placed particles, and takes their centers over.
/// @param scene  has the meshes
void set_placed(const ParticleShapes& from, PlacedSpheres placed, const Scene& scene,
                ParticleSet& set);

}  // namespace scree::reader
