#pragma once
// The inside of a box, with up to six faces. A face that is present acts as an infinite plane of the body frame, so
// nothing leaves past its rim: bodies above an open top still feel the planes of the side walls.

#include "shapes/box.h"

namespace scree::shapes {

struct Container {
  static constexpr ShapeKind kind{3};
  static constexpr const char* name = "container";
  static constexpr const char* description = "the inside of a box";
  static constexpr ShapeKey keys[]{
      {"size", ShapeKey::Type::vector, "full edge lengths [m], positive."},
      {"min", ShapeKey::Type::vector, "lower corner [m]."},
      {"max", ShapeKey::Type::vector, "upper corner [m]."},
      {"open", ShapeKey::Type::faces, "faces that are missing."}};

  static void read(const ShapeSource& source, Shape& shape, Vec3d& position) {
    if (source.has("min") || source.has("max")) {
      static constexpr const char* others[]{"size", "position"};
      source.exclude(others, "give either min and max, or size and position");
      const Vec3d low = source.point("min", "must be the lower corner [x, y, z] [m]");
      const Vec3d high = source.point("max", "must be the upper corner [x, y, z] [m]");
      if (!(low.x < high.x && low.y < high.y && low.z < high.z))
        source.refuse("max", "must be above min on every axis [m]");
      shape.half_extents = 0.5 * (high - low);
      position = 0.5 * (low + high);
    } else {
      shape.half_extents = 0.5 * source.edges("size");
    }
    if (source.has("open")) shape.open_faces = source.faces("open");
  }
  static std::optional<Fault> fault(const Shape& shape) {
    if (shape.open_faces > 63u)
      return Fault{"open_faces", std::to_string(shape.open_faces), "must be bits 0 to 5"};
    return lengths_fault("half_extents", shape.half_extents);
  }
  static double bounding_radius(const Shape& shape, const TriangleMesh*) {
    return norm(shape.half_extents);
  }
  static Vec3d farthest(const Shape& shape, const TriangleMesh* mesh, const Vec3d& direction) {
    return Box::farthest(shape, mesh, direction);
  }
  static Surface surface(const Shape& shape, const TriangleMesh*, double) {
    return box_surface(shape.half_extents, shape.open_faces);
  }
  static std::vector<WallFace> faces(const Shape& shape) {
    static constexpr const char* names[]{"-x", "+x", "-y", "+y", "-z", "+z"};
    std::vector<WallFace> faces;
    for (int face = 0; face < 6; ++face) {
      if ((shape.open_faces >> face & 1) != 0) continue;
      const int axis = face / 2;
      const double side = face % 2 == 0 ? -1 : 1;
      WallFace plane{names[face], {}, {}};
      plane.point[axis] = side * shape.half_extents[axis];
      plane.normal[axis] = -side;
      faces.push_back(plane);
    }
    return faces;
  }

  static constexpr Outline outline = Outline::box;
  static constexpr bool is_backdrop = true;
  /// Index 0..5 (-x +x -y +y -z +z) of the face through which the ray leaves.
  SCREE_HD static int leaving_face(const Ray& ray, const BoxSpan& span) {
    return 2 * span.leave_axis + (ray.direction[span.leave_axis] > 0.0f ? 1 : 0);
  }
  /// Inner side of the faces. Faces between the eye and the inside are never hit, so they hide
  /// nothing; a ray that leaves through a missing face goes on.
  template <class M>
  SCREE_HD static float hit(const M& m, const Ray& ray) {
    const BoxSpan span = span_in_box(ray, m.half_extents);
    if (span.enter > span.leave) return kMiss;
    return ((m.open_faces >> leaving_face(ray, span)) & 1u) != 0 ? kMiss : span.leave;
  }
  template <class M>
  SCREE_HD static Vec3f normal_at(const M& m, const Ray& ray, float) {
    return side_normal(ray, span_in_box(ray, m.half_extents).leave_axis);
  }
};

}  // namespace scree::shapes
