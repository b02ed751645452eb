#pragma once
// A cylinder about the center of its body, its axis along z of the body. The half extents are those of the box about it:
// its radius twice, and half its length.

#include "shapes/ray.h"
#include "shapes/shape_card.h"

namespace scree::shapes {

struct Cylinder {
  static constexpr ShapeKind kind{6};
  static constexpr const char* name = "cylinder";
  static constexpr const char* description = "a solid cylinder, its axis along z of the body";
  static constexpr ShapeKey keys[]{{"radius", ShapeKey::Type::length, "radius [m].", true},
                                   {"length", ShapeKey::Type::length, "length [m].", true},
                                   kRoundingKey};

  static void read(const ShapeSource& source, Shape& shape, Vec3d&) {
    const double r = source.length("radius");
    shape.half_extents = {r, r, 0.5 * source.length("length")};
  }
  static std::optional<Fault> fault(const Shape& shape) { return round_fault(shape); }
  static double bounding_radius(const Shape& shape, const TriangleMesh*) {
    return std::sqrt(shape.half_extents.x * shape.half_extents.x +
                     shape.half_extents.z * shape.half_extents.z);
  }
  static MassProperties mass(const Shape& shape, double density) {
    const double r = shape.half_extents.x, length = 2 * shape.half_extents.z;
    constexpr double pi = 3.14159265358979323846;
    const double mass = density * pi * r * r * length;
    const double across = mass * (3 * r * r + length * length) / 12;
    return {mass, {across, across, mass * r * r / 2}};
  }
  /// Of its round side, over which the point of contact moves as it rolls.
  static double rounding(const Shape& shape) { return shape.half_extents.x; }
  static Vec3d farthest(const Shape& shape, const TriangleMesh*, const Vec3d& direction) {
    const Vec3d& e = shape.half_extents;
    const Vec3d out = e.x * normalized(Vec3d{direction.x, direction.y, 0}, {1, 0, 0});
    return {out.x, out.y, direction.z < 0 ? -e.z : e.z};
  }
  static Chord chord(const Shape& shape, const TriangleMesh*, const Vec3d& x, const Vec3d& d) {
    const double r = shape.half_extents.x;
    Chord c;
    c.cut_quadric(d.x * d.x + d.y * d.y, x.x * d.x + x.y * d.y, x.x * x.x + x.y * x.y - r * r);
    c.cut_slab(x.z, d.z, shape.half_extents.z);
    return c;
  }
  static Surface surface(const Shape& shape, const TriangleMesh*, double) {
    constexpr int kAround = 24;
    constexpr double pi = 3.14159265358979323846;
    const Vec3d& e = shape.half_extents;
    Surface s;
    for (const double z : {-e.z, e.z})
      for (int k = 0; k < kAround; ++k)
        s.vertices.push_back(
            {e.x * std::cos(2 * pi * k / kAround), e.x * std::sin(2 * pi * k / kAround), z});
    std::vector<int> bottom, top;
    for (int k = 0; k < kAround; ++k) {
      const int next = (k + 1) % kAround;
      s.faces.push_back({k, next, kAround + next, kAround + k});
      bottom.push_back(kAround - 1 - k);
      top.push_back(kAround + k);
    }
    s.faces.push_back(bottom);
    s.faces.push_back(top);
    return s;
  }

  /// Point of it nearest to x, body frame [m].
  SCREE_HD static Vec3d nearest(const Vec3d& half_extents, const Vec3d& x) {
    const double r = half_extents.x, end = half_extents.z;
    const double across = std::sqrt(x.x * x.x + x.y * x.y);
    const double part = across > r ? r / across : 1;
    return {part * x.x, part * x.y, x.z > end ? end : x.z < -end ? -end : x.z};
  }

  static constexpr Outline outline = Outline::box;
  /// Where a ray enters the round side and the slab between the ends.
  struct Entry {
    float side, slab, leave;
  };
  template <class M>
  SCREE_HD static Entry entry(const M& m, const Ray& ray) {
    const float r = m.half_extents.x, end = m.half_extents.z;
    const Vec3f o = ray.origin, d = ray.direction;
    const float across = d.x * d.x + d.y * d.y;
    const float inv = 1.0f / (across > kTiny ? across : kTiny);
    const float closest = -(o.x * d.x + o.y * d.y) * inv;
    const float x = o.x + closest * d.x, y = o.y + closest * d.y;
    const float inside = r * r - (x * x + y * y);
    if (inside < 0.0f) return {0, 0, kMiss};
    const float half = std::sqrt(inside * inv);
    const float inv_z = 1.0f / (std::abs(d.z) < kTiny ? kTiny : d.z);
    const float middle = -o.z * inv_z, half_z = end * std::abs(inv_z);
    const float leave = closest + half < middle + half_z ? closest + half : middle + half_z;
    return {closest - half, middle - half_z, leave};
  }
  template <class M>
  SCREE_HD static float hit(const M& m, const Ray& ray) {
    const Entry e = entry(m, ray);
    const float enter = e.side > e.slab ? e.side : e.slab;
    return e.leave != kMiss && enter <= e.leave ? enter : kMiss;
  }
  template <class M>
  SCREE_HD static Vec3f normal_at(const M& m, const Ray& ray, float depth) {
    const Entry e = entry(m, ray);
    if (e.slab > e.side) return {0, 0, ray.direction.z > 0.0f ? -1.0f : 1.0f};
    const Vec3f p = ray.origin + depth * ray.direction;
    return (1.0f / m.half_extents.x) * Vec3f{p.x, p.y, 0};
  }
  template <class M>
  SCREE_HD static float paint(const M& m, const Vec3f& p, const Vec3f&, float footprint) {
    return two_halves(m.half_extents.x, p, footprint);
  }
};

}  // namespace scree::shapes
