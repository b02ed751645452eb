#pragma once
// The cores of shapes that convex pair functions know.

#include "kernels/narrow_phase/pairs/convex_core.h"
#include "kernels/narrow_phase/pairs/pair_side.h"
#include "shapes/box.h"
#include "shapes/capsule.h"
#include "shapes/cylinder.h"

namespace scree {

template <class S>
ConvexCore core_of(const PairSide& side, const Vec3d& center);

template <>
SCREE_HD inline ConvexCore core_of<shapes::Box>(const PairSide& side, const Vec3d& center) {
  return ConvexCore::brick(center, side.orientation, side.half_extents, 0);
}
template <>
SCREE_HD inline ConvexCore core_of<shapes::Capsule>(const PairSide& side, const Vec3d& center) {
  const Vec3d along{0, 0, shapes::Capsule::half_length(side.half_extents)};
  return ConvexCore::brick(center, side.orientation, along,
                           shapes::Capsule::radius(side.half_extents));
}
template <>
SCREE_HD inline ConvexCore core_of<shapes::Cylinder>(const PairSide& side, const Vec3d& center) {
  ConvexCore c = ConvexCore::brick(center, side.orientation, side.half_extents, 0);
  c.form = ConvexCore::Form::cylinder;
  return c;
}

}  // namespace scree
