#pragma once
// A solid ball about the center of its body. Bodies of this shape need no shape record.

#include "shapes/ray.h"
#include "shapes/shape_card.h"

namespace scree::shapes {

struct Sphere {
  static constexpr ShapeKind kind{0};
  static constexpr const char* name = "sphere";
  static constexpr const char* description = "a solid ball";
  static constexpr ShapeKey keys[]{{"radius", ShapeKey::Type::length, "radius [m].", true}};

  static void read(const ShapeSource& source, Shape& shape, Vec3d&) {
    shape.radius = source.length("radius");
  }
  static std::optional<Fault> fault(const Shape& shape) {
    return length_fault("radius", shape.radius);
  }
  static double bounding_radius(const Shape& shape, const TriangleMesh*) { return shape.radius; }
  /// Mass of a ball alone [kg].
  static double mass_of(double radius, double density) {
    constexpr double pi = 3.14159265358979323846;
    return density * 4.0 / 3.0 * pi * radius * radius * radius;
  }
  static MassProperties mass(const Shape& shape, double density) {
    const double r = shape.radius;
    const double mass = mass_of(r, density);
    const double moment = 0.4 * mass * r * r;
    return {mass, {moment, moment, moment}};
  }
  static Vec3d farthest(const Shape& shape, const TriangleMesh*, const Vec3d& direction) {
    return shape.radius * normalized(direction);
  }
  static double rounding(const Shape& shape) { return shape.radius; }
  static Chord chord(const Shape& shape, const TriangleMesh*, const Vec3d& x, const Vec3d& d) {
    Chord c;
    c.cut_quadric(norm2(d), dot(x, d), norm2(x) - shape.radius * shape.radius);
    return c;
  }

  /// An octahedron refined twice: enough to see where it is.
  static Surface surface(const Shape& shape, const TriangleMesh*, double) {
    Surface s;
    s.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    s.faces = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
               {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    for (int level = 0; level < 2; ++level) {
      std::vector<std::vector<int>> finer;
      for (const std::vector<int>& f : s.faces) {
        const int first = static_cast<int>(s.vertices.size());
        for (std::size_t k = 0; k < 3; ++k)
          s.vertices.push_back(normalized(s.vertices[static_cast<std::size_t>(f[k])] +
                                          s.vertices[static_cast<std::size_t>(f[(k + 1) % 3])]));
        finer.push_back({f[0], first, first + 2});
        finer.push_back({f[1], first + 1, first});
        finer.push_back({f[2], first + 2, first + 1});
        finer.push_back({first, first + 1, first + 2});
      }
      s.faces = std::move(finer);
    }
    for (Vec3d& v : s.vertices) v *= shape.radius;
    return s;
  }

  static constexpr Outline outline = Outline::ball;
  /// Works with the point of closest approach, which keeps its digits when the sphere is small and
  /// far away.
  SCREE_HD static float hit(float radius, const Ray& ray) {
    const float inv_dd = 1.0f / norm2(ray.direction);
    const float t_closest = -dot(ray.origin, ray.direction) * inv_dd;
    const Vec3f closest = ray.origin + t_closest * ray.direction;
    const float inside = radius * radius - norm2(closest);
    if (inside < 0.0f) return kMiss;
    return t_closest - std::sqrt(inside * inv_dd);
  }
  template <class M>
  SCREE_HD static float hit(const M& m, const Ray& ray) {
    return hit(m.radius, ray);
  }
  template <class M>
  SCREE_HD static Vec3f normal_at(const M& m, const Ray& ray, float depth) {
    return (1.0f / m.radius) * (ray.origin + depth * ray.direction);
  }
  /// A dark belt and two unlike halves; gone before it would flicker on spheres of a few samples.
  template <class M>
  SCREE_HD static float paint(const M& m, const Vec3f&, const Vec3f& n, float footprint) {
    const float blur = 0.02f + footprint / m.radius;
    const float belt = 1.0f - smooth_step(0.20f - blur, 0.20f + blur, std::abs(n.z));
    const float half = smooth_step(-blur, blur, n.z);
    const float strength = smooth_step(2.0f, 7.0f, m.radius / footprint);
    return 1.0f - strength * (0.38f * belt + 0.10f * half);
  }
};

}  // namespace scree::shapes
