#pragma once
// An ellipsoid, its axes those of the body.

#include "shapes/ray.h"
#include "shapes/shape_card.h"
#include "shapes/sphere.h"

namespace scree::shapes {

struct Ellipsoid {
  static constexpr ShapeKind kind{9};
  static constexpr const char* name = "ellipsoid";
  static constexpr const char* description = "a solid ellipsoid";
  static constexpr ShapeKey keys[]{
      {"size", ShapeKey::Type::vector, "full edge lengths [m], positive.", true}, kRoundingKey};

  static void read(const ShapeSource& source, Shape& shape, Vec3d&) {
    shape.half_extents = 0.5 * source.edges("size");
  }
  static std::optional<Fault> fault(const Shape& shape) {
    return lengths_fault("half_extents", shape.half_extents);
  }
  static double bounding_radius(const Shape& shape, const TriangleMesh*) {
    const Vec3d& e = shape.half_extents;
    const double most = e.x > e.y ? e.x : e.y;
    return most > e.z ? most : e.z;
  }
  static MassProperties mass(const Shape& shape, double density) {
    const Vec3d& e = shape.half_extents;
    constexpr double pi = 3.14159265358979323846;
    const double mass = density * 4.0 / 3.0 * pi * e.x * e.y * e.z;
    const Vec3d square = hadamard(e, e);
    return {mass,
            0.2 * mass * Vec3d{square.y + square.z, square.z + square.x, square.x + square.y}};
  }
  /// The mean of its half axes: the point of contact moves over it as it rolls. See curvature_radius().
  static double rounding(const Shape& shape) {
    const Vec3d& e = shape.half_extents;
    return (e.x + e.y + e.z) / 3;
  }
  /// Point farthest along a direction, body frame [m].
  SCREE_HD static Vec3d extreme(const Vec3d& half_extents, const Vec3d& direction) {
    const Vec3d x = hadamard(half_extents, direction);
    const double length = norm(x);
    return (1 / (length > 0 ? length : 1)) * hadamard(half_extents, x);
  }
  static Vec3d farthest(const Shape& shape, const TriangleMesh*, const Vec3d& direction) {
    return extreme(shape.half_extents, direction);
  }
  /// Radius of curvature of its surface, where that has this unit normal, in the direction of a tangent [m]: what the Hessian of
  /// its support function sqrt(sum e_k^2 n_k^2) is there. Body frame.
  SCREE_HD static double curvature_radius(const Vec3d& half_extents, const Vec3d& normal,
                                          const Vec3d& tangent) {
    const Vec3d x = hadamard(half_extents, normal), y = hadamard(half_extents, tangent);
    const double height2 = norm2(x), along = dot(x, y), length2 = norm2(tangent);
    if (!(height2 > 0 && length2 > 0)) return 0;
    return (norm2(y) - along * along / height2) / (std::sqrt(height2) * length2);
  }
  static Chord chord(const Shape& shape, const TriangleMesh*, const Vec3d& x, const Vec3d& d) {
    const Vec3d& e = shape.half_extents;
    const Vec3d from{x.x / e.x, x.y / e.y, x.z / e.z}, along{d.x / e.x, d.y / e.y, d.z / e.z};
    Chord c;
    c.cut_quadric(norm2(along), dot(from, along), norm2(from) - 1);
    return c;
  }
  static Surface surface(const Shape& shape, const TriangleMesh*, double) {
    Shape ball;
    ball.radius = 1;
    Surface s = Sphere::surface(ball, nullptr, 0);
    for (Vec3d& v : s.vertices) v = hadamard(v, shape.half_extents);
    return s;
  }

  /// The point of its surface nearest to x, body frame [m]: e_k^2 x_k / (e_k^2 + t) with the root t of
  /// sum (e_k x_k / (e_k^2 + t))^2 = 1 above -e_min^2 (Eberly, Distance from a point to an ellipsoid, 2013). The sum falls
  /// as t grows, and bisection halves what is left to the last digit. In the middle plane of the shortest axis the root
  /// may be at its end; then the rest of the way is along that axis.
  SCREE_HD static Vec3d nearest(const Vec3d& half_extents, const Vec3d& x) {
    const Vec3d e2 = hadamard(half_extents, half_extents);
    const int least = e2.x <= e2.y ? (e2.x <= e2.z ? 0 : 2) : (e2.y <= e2.z ? 1 : 2);
    const Vec3d ex = hadamard(half_extents, x);
    const auto sum = [&](double t) {
      double s = 0;
      for (int k = 0; k < 3; ++k) {
        const double part = ex[k] / (e2[k] + t);
        s += part * part;
      }
      return s;
    };
    double low = -e2[least] + std::abs(ex[least]), high = norm(ex);
    for (int step = 0; step < 100; ++step) {
      const double middle = 0.5 * (low + high);
      if (!(middle > low && middle < high)) break;
      (sum(middle) > 1 ? low : high) = middle;
    }
    Vec3d y;
    double rest = 1;
    for (int k = 0; k < 3; ++k) {
      if (k == least) continue;
      y[k] = e2[k] * x[k] / (e2[k] + high);
      rest -= y[k] * y[k] / e2[k];
    }
    const double apart = e2[least] + high;
    const double up = half_extents[least] * std::sqrt(rest > 0 ? rest : 0);
    y[least] = apart > 1e-6 * e2[least] ? e2[least] * x[least] / apart : x[least] < 0 ? -up : up;
    return y;
  }

  static constexpr Outline outline = Outline::box;
  /// As a unit ball: a ray is stretched with it, which keeps its depths.
  template <class M>
  SCREE_HD static float hit(const M& m, const Ray& ray) {
    return Sphere::hit(1.0f, Ray{shrunk(m, ray.origin), shrunk(m, ray.direction)});
  }
  template <class M>
  SCREE_HD static Vec3f normal_at(const M& m, const Ray& ray, float depth) {
    return normalized(shrunk(m, shrunk(m, ray.origin + depth * ray.direction)));
  }
  template <class M>
  SCREE_HD static float paint(const M& m, const Vec3f& p, const Vec3f&, float footprint) {
    return two_halves(m.half_extents.x, p, footprint);
  }

 private:
  template <class M>
  SCREE_HD static Vec3f shrunk(const M& m, const Vec3f& v) {
    return {v.x / m.half_extents.x, v.y / m.half_extents.y, v.z / m.half_extents.z};
  }
};

}  // namespace scree::shapes
