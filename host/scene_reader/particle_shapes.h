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

/// Refuses the keys that say something of shapes and of scales.
void refuse_particle_shapes(const Node& node, const std::string& why);

/// Gives a set the shapes, sizes and groups of placed particles, and takes their centers over.
/// @param scene  has the meshes
void set_placed(const ParticleShapes& from, PlacedSpheres placed, const Scene& scene,
                ParticleSet& set);

}  // namespace scree::reader
