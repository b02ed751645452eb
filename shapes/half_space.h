#pragma once
// Everything behind an infinite plane through the center of its body.

#include "shapes/ray.h"
#include "shapes/shape_card.h"

namespace scree::shapes {

struct HalfSpace {
  static constexpr ShapeKind kind{2};
  static constexpr const char* name = "half_space";
  static constexpr const char* description = "everything behind a plane";
  static constexpr ShapeKey keys[]{
      {"normal", ShapeKey::Type::vector,
       "outward normal in the body frame; bodies are on this side. Any length but zero. Default: "
       "[0, 0, 1]."},
      {"point", ShapeKey::Type::vector, "a point on the plane [m]; another name for position."}};

  static void read(const ShapeSource& source, Shape& shape, Vec3d& position) {
    if (source.has("normal")) shape.normal = source.direction("normal");
    if (!source.has("point")) return;
    static constexpr const char* other[]{"position"};
    source.exclude(other, "give either point or position");
    position = source.point("point", "must be a point on the plane [x, y, z] [m]");
  }
  static std::optional<Fault> fault(const Shape& shape) {
    return unit_fault("normal", shape.normal);
  }
  static double bounding_radius(const Shape&, const TriangleMesh*) { return 0; }
  /// A square.
  static Surface surface(const Shape& shape, const TriangleMesh*, double scene_size) {
    const Vec3d a = any_orthogonal(shape.normal) * scene_size;
    const Vec3d b = cross(shape.normal, a);
    return {{-a - b, a - b, a + b, b - a}, {{0, 1, 2, 3}}};
  }
  static std::vector<WallFace> faces(const Shape& shape) { return {{"", {}, shape.normal}}; }

  static constexpr Outline outline = Outline::plane;
  /// Part of the background: takes its color, casts no shadow.
  static constexpr bool is_backdrop = true;
  /// Seen from the side that its normal points to.
  template <class M>
  SCREE_HD static float hit(const M& m, const Ray& ray) {
    const float slope = dot(ray.direction, m.normal);
    const float height = dot(ray.origin, m.normal);
    return slope < -1e-6f && height > 0.0f ? -height / slope : kMiss;
  }
  template <class M>
  SCREE_HD static Vec3f normal_at(const M& m, const Ray&, float) {
    return m.normal;
  }
};

}  // namespace scree::shapes
