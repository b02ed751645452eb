#pragma once
// Compounds: their parts, mass properties and frames.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/compounds.h"
#include "host/scene/convex_hull.h"
#include "shapes/polyhedron.h"

namespace scree {

/// Volume, center and moments of parts. Sums are exact; of what parts have in common, which counts once, volume and moments
/// come from 2^20 lines through it: their error is about 1e-5 of those of what is common.
/// @throws std::invalid_argument for parts that cannot overlap, as their shape says nothing of lines
SolidMoments moments_of(const Scene& scene, const std::vector<ShapePart>& parts, SharedMass shared);

struct CompoundBody {
  TriangleMesh mesh;
  Shape shape;
  LocalFrame frame;  ///< of the body, in that of the parts
};

/// @param is_free  the body gets its principal frame
/// @throws std::invalid_argument as set_compound() does
CompoundBody make_compound(const Scene& scene, std::vector<ShapePart> parts, SharedMass shared,
                           bool is_free);

/// The same of a body whose mass is given, and with it its frame.
/// @param frame  in that of the parts
CompoundBody make_compound_in(const Scene& scene, std::vector<ShapePart> parts,
                              const LocalFrame& frame);

/// What keeps parts of a mesh from being those of a compound.
std::optional<std::string> compound_fault(const Scene& scene, const TriangleMesh& mesh);

/// Parts of a shape in their size; none: it is no compound.
std::vector<ShapePart> parts_of(const Scene& scene, const Shape& shape);
/// As what collision detection sees it: 1 when it is no compound.
std::size_t part_count_of(const Scene& scene, const Shape& shape);

/// Shapes of the parts of the particles of a set by kind, each with how many there are.
std::map<ShapeKind, std::size_t> part_shape_counts(const Scene& scene, const ParticleSet& set);

/// Calls f(shape) for the parts of a shape, or for itself.
template <class F>
void for_each_part(const Scene& scene, const Shape& shape, F f) {
  const std::vector<ShapePart> parts = parts_of(scene, shape);
  if (parts.empty()) f(shape);
  for (const ShapePart& part : parts) f(part.shape);
}

}  // namespace scree
