#pragma once
// The cores of shapes that convex pair functions know.

#include "kernels/narrow_phase/pairs/convex_core.h"
#include "kernels/narrow_phase/pairs/pair_side.h"
#include "shapes/box.h"
#include "shapes/capsule.h"
#include "shapes/cone.h"
#include "shapes/cylinder.h"
#include "shapes/ellipsoid.h"
#include "shapes/hull.h"
#include "shapes/rounded.h"
#include "shapes/sphere.h"

namespace scree {

/// A core whose form is known by the box about it.
SCREE_HD inline ConvexCore core_in_box(ConvexCore::Form form, const PairSide& side,
                                       const Vec3d& center) {
  ConvexCore c = ConvexCore::brick(center, side.orientation, side.half_extents, 0);
  c.form = form;
  return c;
}

template <class S>
ConvexCore core_of(const PairSide& side, const Vec3d& center);

template <>
SCREE_HD inline ConvexCore core_of<shapes::Box>(const PairSide& side, const Vec3d& center) {
  return core_in_box(ConvexCore::Form::brick, side, center);
}
template <>
SCREE_HD inline ConvexCore core_of<shapes::Capsule>(const PairSide& side, const Vec3d& center) {
  const Vec3d along{0, 0, shapes::Capsule::half_length(side.half_extents)};
  return ConvexCore::brick(center, side.orientation, along,
                           shapes::Capsule::radius(side.half_extents));
}
template <>
SCREE_HD inline ConvexCore core_of<shapes::Cylinder>(const PairSide& side, const Vec3d& center) {
  return core_in_box(ConvexCore::Form::cylinder, side, center);
}
template <>
SCREE_HD inline ConvexCore core_of<shapes::Cone>(const PairSide& side, const Vec3d& center) {
  return core_in_box(ConvexCore::Form::cone, side, center);
}
template <>
SCREE_HD inline ConvexCore core_of<shapes::Ellipsoid>(const PairSide& side, const Vec3d& center) {
  return core_in_box(ConvexCore::Form::ellipsoid, side, center);
}
template <>
SCREE_HD inline ConvexCore core_of<shapes::Hull>(const PairSide& side, const Vec3d& center) {
  ConvexCore c = core_in_box(ConvexCore::Form::hull, side, center);
  c.hull = side.hull;
  return c;
}
template <>
SCREE_HD inline ConvexCore core_of<shapes::Rounded>(const PairSide& side, const Vec3d& center) {
  using Form = ConvexCore::Form;
  const ShapeKind core = side.rounded.core;
  const Form form = core == shapes::Cylinder::kind    ? Form::cylinder
                    : core == shapes::Cone::kind      ? Form::cone
                    : core == shapes::Ellipsoid::kind ? Form::ellipsoid
                    : core == shapes::Hull::kind      ? Form::hull
                                                      : Form::brick;
  ConvexCore c = core_in_box(form, side, center);
  c.center += side.rounded.shift * c.axis[2];
  c.rounding = side.rounded.radius;
  if (form == Form::hull) c.hull = side.hull;
  return c;
}
template <>
SCREE_HD inline ConvexCore core_of<shapes::Sphere>(const PairSide& side, const Vec3d& center) {
  ConvexCore c;
  c.center = center;
  c.axis[2] = {0, 0, 1};
  c.rounding = side.radius;
  return c;
}

}  // namespace scree
