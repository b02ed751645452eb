#pragma once
// A cylinder with round ends about the center of its body, its axis along z of the body. The half extents are those of
// the box about it: its radius twice, and half its whole length.

#include <algorithm>

#include "shapes/ray.h"
#include "shapes/shape_card.h"
#include "shapes/sphere.h"

namespace scree::shapes {

struct Capsule {
  static constexpr ShapeKind kind{5};
  static constexpr const char* name = "capsule";
  static constexpr const char* description =
      "a solid cylinder with round ends, its axis along z of the body";
  static constexpr ShapeKey keys[]{
      {"radius", ShapeKey::Type::length, "radius [m].", true},
      {"length", ShapeKey::Type::length, "length of the cylinder, without the ends [m].", true}};

  /// Radius [m].
  template <class Real>
  SCREE_HD static Real radius(const Vec3<Real>& half_extents) {
    return half_extents.x;
  }
  /// From the center to the center of an end [m].
  template <class Real>
  SCREE_HD static Real half_length(const Vec3<Real>& half_extents) {
    return half_extents.z - half_extents.x;
  }

  static void read(const ShapeSource& source, Shape& shape, Vec3d&) {
    const double r = source.length("radius");
    shape.half_extents = {r, r, r + 0.5 * source.length("length")};
  }
  static std::optional<Fault> fault(const Shape& shape) {
    const Vec3d& e = shape.half_extents;
    if (auto fault = lengths_fault("half_extents", e)) return fault;
    if (e.x == e.y && e.z > e.x) return std::nullopt;
    return Fault{"half_extents", vector_text(e),
                 "must be the radius twice, and more than it along the axis [m]"};
  }
  static double bounding_radius(const Shape& shape, const TriangleMesh*) {
    return shape.half_extents.z;
  }
  static MassProperties mass(const Shape& shape, double density) {
    const double r = radius(shape.half_extents), length = 2 * half_length(shape.half_extents);
    constexpr double pi = 3.14159265358979323846;
    const double cylinder = density * pi * r * r * length;
    const double ends = Sphere::mass_of(r, density);
    const double along = cylinder * r * r / 2 + ends * 0.4 * r * r;
    // The center of mass of an end is 3/8 r beyond its flat side.
    const double across = cylinder * (length * length / 12 + r * r / 4) +
                          ends * (0.4 * r * r + length * length / 4 + 0.375 * length * r);
    return {cylinder + ends, {across, across, along}};
  }
  static double rounding(const Shape& shape) { return radius(shape.half_extents); }
  static Chord chord(const Shape& shape, const TriangleMesh*, const Vec3d& x, const Vec3d& d) {
    const double r = radius(shape.half_extents), end = half_length(shape.half_extents);
    Chord whole;
    whole.cut_quadric(d.x * d.x + d.y * d.y, x.x * d.x + x.y * d.y, x.x * x.x + x.y * x.y - r * r);
    whole.cut_slab(x.z, d.z, end);
    for (const double z : {-end, end}) {
      const Vec3d from = x - Vec3d{0, 0, z};
      Chord ball;
      ball.cut_quadric(norm2(d), dot(from, d), norm2(from) - r * r);
      if (ball.is_empty()) continue;
      whole = whole.is_empty() ? ball
                               : Chord{std::min(whole.in, ball.in), std::max(whole.out, ball.out)};
    }
    return whole;
  }
  static Vec3d farthest(const Shape& shape, const TriangleMesh*, const Vec3d& direction) {
    const double end = half_length(shape.half_extents);
    return Vec3d{0, 0, direction.z < 0 ? -end : end} +
           radius(shape.half_extents) * normalized(direction);
  }
  /// Rings from one pole to the other: enough to see where it is.
  static Surface surface(const Shape& shape, const TriangleMesh*, double) {
    constexpr int kAround = 16, kRings = 8;  // an even number of rings, half of them on each end
    constexpr double pi = 3.14159265358979323846;
    const double r = radius(shape.half_extents), end = half_length(shape.half_extents);
    Surface s;
    for (int ring = 0; ring < kRings; ++ring) {
      const bool is_upper = ring >= kRings / 2;
      const double steps = ring - (is_upper ? kRings / 2 : kRings / 2 - 1);
      const double latitude = steps * pi / kRings;
      for (int k = 0; k < kAround; ++k) {
        const double angle = 2 * pi * k / kAround, across = r * std::cos(latitude);
        s.vertices.push_back({across * std::cos(angle), across * std::sin(angle),
                              (is_upper ? end : -end) + r * std::sin(latitude)});
      }
    }
    const int south = static_cast<int>(s.vertices.size()), last = south - kAround;
    s.vertices.push_back({0, 0, -end - r});
    s.vertices.push_back({0, 0, end + r});
    for (int k = 0; k < kAround; ++k) {
      const int next = (k + 1) % kAround;
      s.faces.push_back({south, next, k});
      for (int first = 0; first < last; first += kAround)
        s.faces.push_back({first + k, first + next, first + kAround + next, first + kAround + k});
      s.faces.push_back({last + k, last + next, south + 1});
    }
    return s;
  }

  /// Point of the axis nearest to x, body frame [m].
  template <class Real>
  SCREE_HD static Vec3<Real> on_axis(const Vec3<Real>& half_extents, const Vec3<Real>& x) {
    const Real end = half_length(half_extents);
    return {0, 0, x.z > end ? end : x.z < -end ? -end : x.z};
  }
  /// Point of it nearest to x, body frame [m].
  SCREE_HD static Vec3d nearest(const Vec3d& half_extents, const Vec3d& x) {
    const Vec3d middle = on_axis(half_extents, x), offset = x - middle;
    const double distance = norm(offset), r = radius(half_extents);
    return distance > r ? middle + (r / distance) * offset : x;
  }

  static constexpr Outline outline = Outline::box;
  template <class M>
  SCREE_HD static float hit(const M& m, const Ray& ray) {
    const float r = radius(m.half_extents), end = half_length(m.half_extents);
    const Vec3f o = ray.origin, d = ray.direction;
    const float across = d.x * d.x + d.y * d.y;
    const float inv = 1.0f / (across > kTiny ? across : kTiny);
    const float closest = -(o.x * d.x + o.y * d.y) * inv;
    const float x = o.x + closest * d.x, y = o.y + closest * d.y;
    const float inside = r * r - (x * x + y * y);
    if (inside < 0.0f) return kMiss;
    const float depth = closest - std::sqrt(inside * inv);
    const float z = o.z + depth * d.z;
    if (z >= -end && z <= end) return depth;
    // What enters the infinite cylinder beyond an end can only meet that end.
    return Sphere::hit(r, Ray{o - Vec3f{0, 0, z > 0.0f ? end : -end}, d});
  }
  template <class M>
  SCREE_HD static Vec3f normal_at(const M& m, const Ray& ray, float depth) {
    const Vec3f p = ray.origin + depth * ray.direction;
    return (1.0f / radius(m.half_extents)) * (p - on_axis(m.half_extents, p));
  }
  /// A dark belt and two unlike sides.
  template <class M>
  SCREE_HD static float paint(const M& m, const Vec3f& p, const Vec3f& n, float footprint) {
    const float r = radius(m.half_extents);
    const float blur = 0.02f + footprint / r;
    const float belt = 1.0f - smooth_step(0.20f - blur, 0.20f + blur, std::abs(p.z) / r);
    const float side = smooth_step(-blur, blur, n.x);
    return 1.0f - smooth_step(2.0f, 7.0f, r / footprint) * (0.38f * belt + 0.10f * side);
  }
};

}  // namespace scree::shapes
