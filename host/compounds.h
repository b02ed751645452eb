#pragma once
// Bodies of several parts, for scenes in code.

#include <vector>

#include "host/scene.h"

namespace scree {

/// How the mass of what parts of a compound have in common counts.
enum class SharedMass {
  once,      ///< the body is the union of its parts
  each_part  ///< its mass is the sum of those of its parts
};

/// Adds the compound of parts to a scene, and makes it the shape of a body: its pose, as given, is that of the frame of
/// the parts; as left, that of the principal frame when the body is free.
/// @param parts  shapes of bodies that may be free, with their places. A hull has a mesh of the scene, in its
///               principal frame (set_hull())
/// @throws std::invalid_argument for no parts, a part that cannot be one, or that is not in range
void set_compound(Scene& scene, BodyDescription& body, std::vector<ShapePart> parts,
                  SharedMass shared = SharedMass::once);

}  // namespace scree
