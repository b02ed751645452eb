#pragma once
// Convex hulls of points, and the frame in which a body of that shape turns.

#include <optional>
#include <string>
#include <vector>

#include "host/hulls.h"
#include "shapes/polyhedron.h"

namespace scree {

/// A frame within another.
struct LocalFrame {
  Vec3d origin;  ///< [m]
  Quatd axes;    ///< from the one to the other
};

/// The convex hull of points, as triangles. Points that are nearer to its surface than 1e-10 of its size may be left out.
/// (Barber, Dobkin, Huhdanpaa, The Quickhull algorithm for convex hulls, 1996.)
/// @throws std::invalid_argument for points that are not finite, fewer than four, or in one plane
TriangleMesh convex_hull(const std::vector<Vec3d>& points, const std::string& name);

/// The frame of the center of mass and the principal axes. These are the old ones when they are principal already.
LocalFrame principal_frame(const SolidMoments& solid);

/// Puts the center of mass of a solid at the origin, and its principal axes along the axes. These stay when they are
/// principal already. @param rounding  by which the solid is rounded [m]; 0: not at all
/// @return  the new frame in the old one
LocalFrame move_to_principal_frame(TriangleMesh& mesh, double rounding = 0);

/// The shape of a hull in the size of its mesh, but for the number of that. @param rounding  as above
Shape hull_of(const TriangleMesh& mesh, double rounding);

/// What keeps a mesh from being that of a hull.
/// @param is_free   the frame must be the principal one
/// @param rounding  of the hull in the size of the mesh [m]
std::optional<std::string> hull_fault(const TriangleMesh& mesh, bool is_free, double rounding = 0);

}  // namespace scree
