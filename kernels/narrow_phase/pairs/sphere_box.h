#pragma once
// A sphere and a solid box.

#include "kernels/narrow_phase/pairs/sphere_sphere.h"
#include "shapes/box.h"

namespace scree {

/// Sphere A, box B. The contact is at the point of the box closest to the center of the sphere; a
/// center inside the box leaves through the nearest face.
/// @param d            center of A to center of B [m]
/// @param orientation  of the box, body to world
SCREE_HD inline ContactGeometry sphere_box(const Vec3d& d, double radius, const Quatd& orientation,
                                           const Vec3d& half_extents) {
  const Vec3d center = rotate_back(orientation, -d);
  Vec3d closest = center;
  bool inside = true;
  int nearest_axis = 0;
  double depth = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double limit = half_extents[axis];
    const double x = center[axis];
    if (x > limit || x < -limit) {
      inside = false;
      closest[axis] = x > limit ? limit : -limit;
    }
    const double axis_depth = limit - (x < 0 ? -x : x);
    if (axis == 0 || axis_depth < depth) {
      depth = axis_depth;
      nearest_axis = axis;
    }
  }
  Vec3d outward;  // body frame, out of the box
  double distance;
  if (inside) {
    const double side = center[nearest_axis] < 0 ? -1 : 1;
    outward[nearest_axis] = side;
    closest[nearest_axis] = side * half_extents[nearest_axis];
    distance = -depth;
  } else {
    const Vec3d offset = center - closest;
    distance = norm(offset);
    outward = offset * (1 / distance);
  }
  ContactGeometry g;
  g.normal = rotate(orientation, -outward);
  g.gap = distance - radius;
  g.arm_a = radius * g.normal;
  g.arm_b = rotate(orientation, closest);
  return g;
}

struct SphereBox {
  using A = shapes::Sphere;
  using B = shapes::Box;
  static constexpr int kFeatureBits = 0;
  SCREE_HD static ContactGeometry contact(const PairSide& a, const PairSide& b, const Vec3d& d,
                                          std::uint32_t) {
    return sphere_box(d, a.radius, b.orientation, b.half_extents);
  }
};

/// The same for a sphere on a straight way. One that misses the box, but would cut the plane of the
/// start, is held to that of its nearest pass, see spheres_on_way().
/// @param g    sphere_box() at the start
/// @param way  of B relative to A in the step [m]
SCREE_HD inline ContactGeometry sphere_box_on_way(const ContactGeometry& g, const Vec3d& d,
                                                  const Vec3d& way, double radius,
                                                  const Quatd& orientation,
                                                  const Vec3d& half_extents) {
  const double least = 2 * kMinTurningWay * radius;
  if (!(g.gap > 0 && norm2(way) > least * least && g.gap + dot(g.normal, way) < 0)) return g;
  const Vec3d start = rotate_back(orientation, -d), along = rotate_back(orientation, -way);
  // The distance to a box is a convex function of the way: its slope changes sign once.
  double from = 0, to = 1;
  for (int k = 0; k < 50; ++k) {
    const double at = 0.5 * (from + to);
    const Vec3d x = start + at * along;
    (dot(x - shapes::Box::nearest(half_extents, x), along) < 0 ? from : to) = at;
  }
  const Vec3d x = start + to * along, closest = shapes::Box::nearest(half_extents, x);
  const double distance = norm(x - closest);
  if (distance < radius) return g;
  const Vec3d outward = (1 / distance) * (x - closest);
  ContactGeometry met;
  met.normal = rotate(orientation, -outward);
  met.gap = dot(outward, start - closest) - radius;
  met.arm_a = radius * met.normal;
  met.arm_b = rotate(orientation, closest);
  return met;
}

}  // namespace scree
