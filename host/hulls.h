#pragma once
// Bodies that are convex hulls, for scenes in code.

#include <vector>

#include "host/scene.h"

namespace scree {

/// Adds the hull of points to a scene, and makes it the shape of a body: its pose, as given, is that of the frame of the
/// points; as left, that of the principal frame when the body is free.
/// @param points    [m]
/// @param rounding  radius of a ball that is swept along the hull [m]; 0: none. Shapes without a mesh are rounded by
///                  shapes::Rounded::of()
/// @throws std::invalid_argument for points that are not finite, fewer than four, or in one plane, and for such a radius
void set_hull(Scene& scene, BodyDescription& body, const std::vector<Vec3d>& points,
              double rounding = 0);

}  // namespace scree
