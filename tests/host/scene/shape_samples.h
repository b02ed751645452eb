#pragma once
// Shapes by name and size, and parts of compounds.

#include <string>
#include <vector>

#include "host/hulls.h"
#include "shapes/shape_card.h"

namespace scree::test {

inline Shape shape_of(const std::string& name) {
  for (const ShapeCard& card : shape_cards()) {
    if (card.name != name) continue;
    Shape shape;
    shape.kind = card.kind;
    return shape;
  }
  return {};
}
inline Shape ball_of(double radius) {
  Shape shape = shape_of("sphere");
  shape.radius = radius;
  return shape;
}
/// @param half  edges
inline Shape box_of(const Vec3d& half) {
  Shape shape = shape_of("box");
  shape.half_extents = half;
  return shape;
}
inline Shape ellipsoid_of(const Vec3d& half) {
  Shape shape = shape_of("ellipsoid");
  shape.half_extents = half;
  return shape;
}
/// @param half_height  of the box about it
inline Shape round_of(const std::string& name, double radius, double half_height) {
  Shape shape = shape_of(name);
  shape.half_extents = {radius, radius, half_height};
  return shape;
}

inline ShapePart part(const Shape& shape, const Vec3d& position, const Quatd& orientation = {}) {
  ShapePart part;
  part.shape = shape;
  part.position = position;
  part.orientation = orientation;
  return part;
}

/// @param scene  gets the mesh of the hull
inline std::vector<ShapePart> a_part_of_every_shape(Scene& scene, const Vec3d& position,
                                                    const Quatd& orientation) {
  BodyDescription hull;
  set_hull(scene, hull, {{0, 0, 0}, {1, 0.1, 0}, {0.2, 1.1, 0}, {0.1, 0.3, 0.9}, {0.8, 0.9, 0.7}});
  std::vector<ShapePart> parts;
  for (const Shape& shape : {ball_of(0.6), box_of({0.3, 0.5, 0.8}), ellipsoid_of({0.3, 0.5, 0.8}),
                             round_of("capsule", 0.4, 0.9), round_of("cylinder", 0.4, 0.9),
                             round_of("cone", 0.5, 0.9), hull.shape})
    parts.push_back(part(shape, position, orientation));
  return parts;
}

}  // namespace scree::test
