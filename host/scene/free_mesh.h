#pragma once
// Triangle surfaces as free bodies: the solid inside, and the frame in which the body turns.

#include <optional>
#include <string>

#include "host/meshes.h"
#include "host/scene/convex_hull.h"

namespace scree {

/// The solid inside a surface. Of one with holes: what the cones over its triangles enclose whose tip
/// is their own center of mass, so that it is the same wherever the mesh is.
SolidMoments moments_inside(const TriangleMesh& mesh);

/// Puts the center of mass of the solid inside at the origin, and its principal axes along the axes.
/// @return  the new frame in the old one; nothing for a surface without a solid inside: the mesh is
/// then as it was
std::optional<LocalFrame> move_inside_to_principal_frame(TriangleMesh& mesh);

/// What keeps a mesh from being that of a free body.
std::optional<std::string> free_mesh_fault(const TriangleMesh& mesh);

}  // namespace scree
