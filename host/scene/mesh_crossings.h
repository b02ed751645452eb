#pragma once
// Triangles of a mesh that pass through each other.

#include <optional>
#include <utility>

#include "host/scene.h"

namespace scree {

/// Two triangles without a common corner of which an edge of one passes through the inside of the other; the first pair in
/// the order of a search that is the same for the same mesh. What only touches, to 1e-9 of the size of the mesh, and what
/// overlaps in one plane, does not count. Takes some n log n steps.
std::optional<std::pair<int, int>> crossing_triangles(const TriangleMesh& mesh);

}  // namespace scree
