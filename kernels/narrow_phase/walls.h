#pragma once
// Walls: fixed and kinematic bodies that are not spheres. Shapes that have faces as planes, such as
// half-spaces and containers, become these; others, such as boxes and meshes, stay solids. Their world geometry is refreshed each step, since
// kinematic bodies move.

#include "kernels/broad_phase/contact_range.h"
#include "kernels/narrow_phase/pairs/contact_geometry.h"
#include "shapes/hull.h"

namespace scree {

/// Where a plane comes from. Constant over a run.
struct PlaneSource {
  Index shape = 0;  ///< index of the ShapeRecord
  Vec3d point;      ///< on the plane, body frame [m]
  Vec3d normal;     ///< unit, body frame
};

/// An infinite plane in world axes.
struct WallPlane {
  Vec3d point;         ///< on the plane [m]
  Vec3d normal;        ///< unit; bodies are on this side
  Vec3d center;        ///< position of the wall body [m]
  RigidMotion motion;  ///< of the wall body, on its course: see course_velocity()
  Index body = 0;
  bool moves = false;  ///< the wall body has a velocity
};

/// A solid among the walls.
struct WallSolid {
  ShapeKind kind = kNoShape;
  Index mesh = -1;
  Index body = 0;
  std::uint32_t element_offset = 0;  ///< of its contact elements among those of all solids
  std::uint32_t first_element = 0;   ///< of its contact elements
  std::uint32_t slots = 1;           ///< contact elements of one image
  Vec3d
      half_extents;  ///< of the box about it, or about its core, body frame [m]; longer where it is endless
  Rounding<double> rounded;  ///< of a rounded shape
  Hull hull;                 ///< of a hull, or one that is rounded
  Vec3d center;              ///< position of the wall body [m]
  Quatd orientation;
  RigidMotion motion;        ///< on its course, see course_velocity()
  Vec3d local_middle;        ///< middle of the box about it, body frame [m]
  Vec3d middle;              ///< the same from the center, world axes [m]
  Vec3d half;                ///< half the edges of a box about it, world axes [m]
  std::uint8_t endless = 0;  ///< bit k: along periodic axis k it is the same everywhere
};

/// Records follow their fixed bodies, which moved back in storage.
template <class T>
struct FollowFixedBodies {
  static constexpr const char* name = "follow_fixed_bodies";
  Span<T> record;  ///< of a wall, or of any shape
  Index shift;
  SCREE_HD void operator()(Index k) const {
    if (record[k].body >= 0) record[k].body += shift;
  }
};

template <class Real>
SCREE_HD RigidMotion load_motion(const BodyView<Real>& bodies, const ContactRange& range, Index i) {
  return {course_velocity(bodies, range, i), Vec3d(bodies.angular_velocity[i])};
}

/// Orientation in double. Normalized again: the length error of float would act over large walls.
template <class Real>
SCREE_HD Quatd load_orientation(const BodyView<Real>& bodies, Index i) {
  return normalized(Quatd(bodies.orientation[i]));
}

template <class Real>
struct RefreshPlanes {
  static constexpr const char* name = "refresh_planes";
  BodyView<Real> bodies;
  ContactRange range;
  Span<const ShapeRecord<Real>> shapes;
  Span<const PlaneSource> source;
  Span<WallPlane> plane;

  SCREE_HD void operator()(Index p) const {
    const ShapeRecord<Real>& shape = shapes[source[p].shape];
    const Quatd q = load_orientation(bodies, shape.body);
    const PlaneSource local = source[p];
    WallPlane w;
    w.body = shape.body;
    w.center = bodies.position[shape.body];
    w.point = w.center + rotate(q, local.point);
    w.normal = normalized(rotate(q, local.normal));
    w.motion = load_motion(bodies, range, shape.body);
    w.moves = norm2(bodies.velocity[shape.body]) + norm2(bodies.angular_velocity[shape.body]) > 0;
    plane[p] = w;
  }
};

template <class Real>
struct RefreshSolids {
  static constexpr const char* name = "refresh_solids";
  BodyView<Real> bodies;
  ContactRange range;
  HullSet hulls;
  std::uint32_t solid_begin;  ///< first element of all solids
  Span<WallSolid> solid;

  SCREE_HD void operator()(Index k) const {
    WallSolid& w = solid[k];
    w.first_element = solid_begin + w.element_offset;
    w.center = bodies.position[w.body];
    w.orientation = load_orientation(bodies, w.body);
    w.motion = load_motion(bodies, range, w.body);
    if (shapes::has_hull(w)) w.hull = hulls.hull(w.mesh, w.half_extents.x);
    w.middle = rotate(w.orientation, w.local_middle);
    for (int axis = 0; axis < 3; ++axis) {
      Vec3d local;
      local[axis] = w.half_extents[axis];
      const Vec3d turned = rotate(w.orientation, local);
      for (int k = 0; k < 3; ++k) {
        const double more = std::abs(turned[k]);
        w.half[k] = axis == 0 ? more + w.rounded.reach() : w.half[k] + more;
      }
    }
  }
};

}  // namespace scree
