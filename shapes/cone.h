#pragma once
// A cone about its axis, z of the body, its point up. The origin is its center of mass, a quarter of its length above its
// base. The half extents are those of the box about the origin that holds it: its radius twice, and three quarters of its length.

#include <algorithm>

#include "shapes/ray.h"
#include "shapes/shape_card.h"

namespace scree::shapes {

struct Cone {
  static constexpr ShapeKind kind{8};
  static constexpr const char* name = "cone";
  static constexpr const char* description =
      "a solid cone, its axis along z of the body, its center of mass a quarter of the length "
      "above its base";
  static constexpr ShapeKey keys[]{{"radius", ShapeKey::Type::length, "radius [m].", true},
                                   {"length", ShapeKey::Type::length, "length [m].", true},
                                   kRoundingKey};

  static void read(const ShapeSource& source, Shape& shape, Vec3d&) {
    const double r = source.length("radius");
    shape.half_extents = {r, r, 0.75 * source.length("length")};
  }
  static std::optional<Fault> fault(const Shape& shape) { return round_fault(shape); }

  /// Height of its base [m].
  SCREE_HD static double base(const Vec3d& half_extents) { return -half_extents.z / 3; }
  /// From base to point [m].
  SCREE_HD static double length(const Vec3d& half_extents) { return 4 * half_extents.z / 3; }

  static double bounding_radius(const Shape& shape, const TriangleMesh*) {
    const Vec3d& e = shape.half_extents;
    return std::max(e.z, std::sqrt(e.x * e.x + base(e) * base(e)));
  }
  static MassProperties mass(const Shape& shape, double density) {
    const double r = shape.half_extents.x, h = length(shape.half_extents);
    constexpr double pi = 3.14159265358979323846;
    const double mass = density * pi * r * r * h / 3;
    const double across = mass * (3.0 / 20) * (r * r + h * h / 4);
    return {mass, {across, across, mass * 0.3 * r * r}};
  }
  /// Of its round side at half of its length, over which the point of contact moves as it rolls.
  static double rounding(const Shape& shape) { return 0.5 * shape.half_extents.x; }
  static Vec3d farthest(const Shape& shape, const TriangleMesh*, const Vec3d& direction) {
    const Vec3d& e = shape.half_extents;
    const Vec3d across{direction.x, direction.y, 0};
    if (direction.z * length(e) > norm(across) * e.x) return {0, 0, e.z};
    const Vec3d out = e.x * normalized(across, {1, 0, 0});
    return {out.x, out.y, base(e)};
  }
  static Chord chord(const Shape& shape, const TriangleMesh*, const Vec3d& x, const Vec3d& d) {
    const Vec3d& e = shape.half_extents;
    const double slope = e.x / length(e), below = slope * (e.z - x.z), falls = slope * d.z;
    const double square = d.x * d.x + d.y * d.y - falls * falls;
    const double linear = x.x * d.x + x.y * d.y + below * falls;
    const double constant = x.x * x.x + x.y * x.y - below * below;
    Chord c;
    if (square > 0) {
      c.cut_quadric(square, linear, constant);
    } else {  // through the base: the double cone is left between its two parts
      const double root = std::sqrt(std::max(0.0, linear * linear - square * constant));
      const double first = (-linear + root) / square, last = (-linear - root) / square;
      if (d.z > 0)
        c.cut(c.in, first);
      else
        c.cut(last, c.out);
    }
    c.cut_above(x.z - e.z, d.z);
    c.cut_above(base(e) - x.z, -d.z);
    return c;
  }
  static Surface surface(const Shape& shape, const TriangleMesh*, double) {
    constexpr int kAround = 24;
    constexpr double pi = 3.14159265358979323846;
    const Vec3d& e = shape.half_extents;
    Surface s;
    std::vector<int> bottom;
    for (int k = 0; k < kAround; ++k) {
      const double angle = 2 * pi * k / kAround;
      s.vertices.push_back({e.x * std::cos(angle), e.x * std::sin(angle), base(e)});
      s.faces.push_back({k, (k + 1) % kAround, kAround});
      bottom.push_back(kAround - 1 - k);
    }
    s.vertices.push_back({0, 0, e.z});
    s.faces.push_back(bottom);
    return s;
  }

  static constexpr Outline outline = Outline::box;
  /// Where a ray enters through the round side and through the base; kFar where it does not.
  struct Entry {
    float side, base;
  };
  static constexpr float kFar = 1e30f;
  template <class M>
  SCREE_HD static Entry entry(const M& m, const Ray& ray) {
    const float r = m.half_extents.x, top = m.half_extents.z, height = top * (4.0f / 3);
    const Vec3f o = ray.origin, d = ray.direction;
    Entry e{kFar, kFar};
    if (d.z > kTiny) {
      const float t = (top - height - o.z) / d.z, x = o.x + t * d.x, y = o.y + t * d.y;
      if (x * x + y * y <= r * r) e.base = t;
    }
    // x^2 + y^2 = slope^2 (top - z)^2, from the point of the ray that is nearest to the top.
    const float slope2 = r * r / (height * height);
    const float shift = (d.z * top - dot(o, d)) / norm2(d);
    const Vec3f p = o + shift * d - Vec3f{0, 0, top};
    const float a = d.x * d.x + d.y * d.y - slope2 * d.z * d.z;
    const float b = p.x * d.x + p.y * d.y - slope2 * p.z * d.z;
    const float c = p.x * p.x + p.y * p.y - slope2 * p.z * p.z;
    const float inside = b * b - a * c;
    if (inside < 0.0f || std::abs(a) < kTiny) return e;
    const float root = std::sqrt(inside);
    for (int sign = -1; sign <= 1; sign += 2) {
      const float t = (static_cast<float>(sign) * root - b) / a, z = p.z + t * d.z;
      const bool is_side = z <= 0.0f && z >= -height;
      if (is_side && shift + t < e.side) e.side = shift + t;
    }
    return e;
  }
  template <class M>
  SCREE_HD static float hit(const M& m, const Ray& ray) {
    const Entry e = entry(m, ray);
    const float first = e.side < e.base ? e.side : e.base;
    return first < kFar ? first : kMiss;
  }
  template <class M>
  SCREE_HD static Vec3f normal_at(const M& m, const Ray& ray, float depth) {
    const Entry e = entry(m, ray);
    if (e.base < e.side) return {0, 0, -1.0f};
    const float r = m.half_extents.x, height = m.half_extents.z * (4.0f / 3);
    const Vec3f p = ray.origin + depth * ray.direction;
    const float across = std::sqrt(p.x * p.x + p.y * p.y);
    const float inv = 1.0f / (across > kTiny ? across : kTiny);
    return normalized(Vec3f{height * p.x * inv, height * p.y * inv, r});
  }
  template <class M>
  SCREE_HD static float paint(const M& m, const Vec3f& p, const Vec3f&, float footprint) {
    return two_halves(m.half_extents.x, p, footprint);
  }
};

}  // namespace scree::shapes
