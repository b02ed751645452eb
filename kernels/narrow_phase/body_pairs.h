#pragma once
// The table of pair functions for two binned bodies, by shape kinds.

#include "kernels/broad_phase/contact_range.h"
#include "kernels/narrow_phase/pairs/sphere_box.h"
#include "kernels/narrow_phase/pairs/sphere_sphere.h"
#include "kernels/narrow_phase/walls.h"

namespace scree {

/// What a run holds. Element programs are compiled for each, so that simple runs do not carry the
/// registers of the others.
enum class ShapeMix {
  spheres_and_planes,  ///< binned bodies are spheres, walls are half-spaces and containers
  spheres,             ///< binned bodies are spheres, walls of any kind
  any
};

/// What pair functions need of one body.
struct BodySample {
  ShapeKind kind = ShapeKind::sphere;
  Vec3d position;
  double radius = 0;
  RigidMotion motion;  ///< on its course, see course_velocity()
  Quatd orientation;   ///< boxes only
  Vec3d half_extents;  ///< boxes only
};

/// @tparam kMix  without `any` no binned body has a shape record, so none is looked up
template <ShapeMix kMix, class Real>
SCREE_HD BodySample load_body(const BodyView<Real>& bodies, Span<const ShapeRecord<Real>> shapes,
                              const ContactRange& range, Index i) {
  BodySample s;
  s.position = bodies.position[i];
  s.radius = bodies.radius[i];
  s.motion.linear = course_velocity(bodies, range, i);
  if constexpr (kMix == ShapeMix::any) {
    s.motion.angular = Vec3d(bodies.angular_velocity[i]);
    if (bodies.shape[i] >= 0) {
      const ShapeRecord<Real>& shape = shapes[bodies.shape[i]];
      s.kind = shape.kind;
      s.half_extents = Vec3d(shape.half_extents);
      s.orientation = load_orientation(bodies, i);
    }
  }
  return s;
}

/// Two kinds as one number, for a switch.
SCREE_HD constexpr int pair_of(ShapeKind a, ShapeKind b) {
  return static_cast<int>(a) * 16 + static_cast<int>(b);
}

/// Contacts a pair of shapes can have. More than one needs feature bits in the contact key.
SCREE_HD inline int pair_features(ShapeKind a, ShapeKind b) {
  switch (pair_of(a, b)) {
    case pair_of(ShapeKind::sphere, ShapeKind::sphere):
    case pair_of(ShapeKind::sphere, ShapeKind::box):
    case pair_of(ShapeKind::box, ShapeKind::sphere):
      return 1;
    default:
      return 0;  // no pair function; a generic convex path goes here
  }
}

/// Contact `feature` of two bodies. Every pair of kinds with pair_features() > 0 has its line here.
/// @param d  center of A to center of B, nearest image [m]
template <ShapeMix kMix>
SCREE_HD ContactGeometry body_pair(const BodySample& a, const BodySample& b, const Vec3d& d,
                                   [[maybe_unused]] std::uint32_t feature) {
  if constexpr (kMix == ShapeMix::any) {
    switch (pair_of(a.kind, b.kind)) {
      case pair_of(ShapeKind::sphere, ShapeKind::box):
        return sphere_box(d, a.radius, b.orientation, b.half_extents);
      case pair_of(ShapeKind::box, ShapeKind::sphere):
        return swapped(sphere_box(-d, b.radius, a.orientation, a.half_extents));
      default:
        break;
    }
  }
  return sphere_sphere(d, a.radius, b.radius);
}

}  // namespace scree
