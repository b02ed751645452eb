#pragma once
// A container is a box seen from inside, with up to six faces. A face that is present acts as an
// infinite plane of the body frame, so nothing leaves past its rim: bodies above an open top still
// feel the planes of the side walls. Spheres and boxes meet each face by sphere_half_space and
// box_half_space.

#include "kernels/narrow_phase/pairs/contact_geometry.h"

namespace scree {

inline constexpr int kContainerFaces = 6;  ///< -x +x -y +y -z +z

/// A face of a container in its body frame.
struct FacePlane {
  Vec3d point;   ///< center of the face [m]
  Vec3d normal;  ///< unit, into the container
};

SCREE_HD inline FacePlane container_face(const Vec3d& half_extents, int face) {
  const int axis = face / 2;
  const double side = face % 2 == 0 ? -1 : 1;
  FacePlane plane;
  plane.point[axis] = side * half_extents[axis];
  plane.normal[axis] = -side;
  return plane;
}

}  // namespace scree
