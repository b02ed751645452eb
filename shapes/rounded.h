#pragma once
// A shape rounded by a ball: all points that are no farther from its core than a radius. Scenes name the core and the
// radius, `rounding`. The half extents are those of the box about all of it; records of bodies have those of the core. A free
// body has its center of mass and its principal axes as frame: the core of a cone is shifted along its axis, and the mesh
// of a hull lies in the frame of what is rounded.

#include <algorithm>
#include <array>

#include "shapes/box.h"
#include "shapes/cone.h"
#include "shapes/cylinder.h"
#include "shapes/ellipsoid.h"
#include "shapes/hull.h"
#include "shapes/rounded_moments.h"
#include "shapes/rounded_surface.h"
#include "shapes/shape_types.h"

namespace scree::shapes {

/// A hull of some size as the mesh of a scene holds it.
struct MeshHull {
  const Vec3d* vertex = nullptr;  ///< [m], before scaling
  const std::array<int, 3>* triangle = nullptr;
  std::size_t triangle_count = 0;
  double scale = 1;
};

/// Takes the point of a flat convex polygon nearest to x if it is nearer than what was found before.
/// @param n       unit normal, from which the corners are seen counterclockwise
/// @param height  of x above its plane [m]
/// @param corner  corner(k) [m]
template <class Corner>
SCREE_HD void take_nearest_of_polygon(const Vec3d& x, const Vec3d& n, double height,
                                      std::uint32_t count, Corner&& corner, double& least2,
                                      Vec3d& found) {
  const auto take = [&](const Vec3d& y) {
    const double distance2 = norm2(x - y);
    if (!(distance2 < least2)) return;
    least2 = distance2;
    found = y;
  };
  const Vec3d foot = x - height * n;
  bool is_over = true;
  for (std::uint32_t k = 0; k < count; ++k) {
    const Vec3d from = corner(k), along = corner(k + 1 < count ? k + 1 : 0) - from;
    if (!(dot(cross(along, n), foot - from) > 0)) continue;
    is_over = false;
    const double length2 = norm2(along), t = length2 > 0 ? dot(x - from, along) / length2 : 0;
    take(from + (t > 0 ? (t < 1 ? t : 1.0) : 0.0) * along);
  }
  if (is_over) take(foot);
}

/// The point of a hull nearest to x [m].
SCREE_HD inline Vec3d nearest_of_hull(const scree::Hull& hull, const Vec3d& x) {
  double least2 = 1e300;
  Vec3d found = x;
  for (std::uint32_t f = 0; f < hull.face_count; ++f) {
    const HullFace& face = hull.face[f];
    const double height = dot(face.normal, x) - hull.scale * face.height;
    if (!(height > 0)) continue;
    take_nearest_of_polygon(
        x, face.normal, height, face.count,
        [&](std::uint32_t k) { return hull.scale * hull.point[hull.corner[face.corner + k]]; },
        least2, found);
  }
  return found;
}
SCREE_HD inline Vec3d nearest_of_hull(const MeshHull& hull, const Vec3d& x) {
  double least2 = 1e300;
  Vec3d found = x;
  for (std::size_t t = 0; t < hull.triangle_count; ++t) {
    const auto corner = [&](std::uint32_t k) {
      return hull.scale * hull.vertex[hull.triangle[t][k]];
    };
    const Vec3d n = normalized(cross(corner(1) - corner(0), corner(2) - corner(0)));
    const double height = dot(n, x - corner(0));
    if (height > 0) take_nearest_of_polygon(x, n, height, 3, corner, least2, found);
  }
  return found;
}

/// The point of a cone nearest to x [m].
SCREE_HD inline Vec3d nearest_of_cone(const Vec3d& half_extents, const Vec3d& x) {
  const double r = half_extents.x, base = Cone::base(half_extents), height = half_extents.z - base;
  const double across = std::sqrt(x.x * x.x + x.y * x.y);
  const bool is_below = x.z < base;
  if ((across - r) * height + (x.z - base) * r <= 0 && !is_below) return x;
  double t = ((r - across) * r + (x.z - base) * height) / (r * r + height * height);
  t = t > 0 ? (t < 1 ? t : 1.0) : 0.0;
  double near = r - t * r, z = base + t * height;
  const double on_base = across < r ? across : r;
  const auto distance2 = [&](double a, double b) {
    return (across - a) * (across - a) + (x.z - b) * (x.z - b);
  };
  if (is_below && distance2(on_base, base) < distance2(near, z)) near = on_base, z = base;
  const double part = across > 0 ? near / across : 0;
  return {part * x.x, part * x.y, z};
}

struct Rounded {
  static constexpr ShapeKind kind{11};
  static constexpr const char* name = "rounded";
  static constexpr const char* description = "another shape, rounded by a ball";
  static constexpr bool is_named = false;
  static constexpr std::array<ShapeKey, 0> keys{};
  using Cores = ShapeTypes<Box, Cylinder, Cone, Ellipsoid, Hull>;

  /// Scenes name the core: of() makes the shape of it.
  static void read(const ShapeSource&, Shape&, Vec3d&) {}

  static bool may_round(ShapeKind core) {
    bool is_one = false;
    Cores::visit(core, [&](auto) { is_one = true; });
    return is_one;
  }
  /// What is rounded.
  static Shape core(const Shape& shape) {
    Shape c;
    c.kind = shape.rounded.core;
    c.half_extents = core_half_extents(shape);
    c.mesh = shape.mesh;
    return c;
  }
  /// A shape rounded.
  /// @param core    a box, cylinder, cone, ellipsoid, or a hull in the size of its mesh
  /// @param radius  of the ball [m], > 0
  /// @param mesh    of a hull
  static Shape of(const Shape& core, double radius, const TriangleMesh* mesh = nullptr) {
    const SolidMoments solid = moments(core, radius, mesh);
    Shape out = core;
    out.kind = kind;
    out.rounded = {core.kind, radius, core.kind == Cone::kind ? -solid.center.z : 0};
    out.half_extents += Vec3d{radius, radius, radius + out.rounded.shift};
    out.volume = solid.volume;
    out.moments = solid.principal_moments();
    return out;
  }
  /// Of such a shape, from the center of its core.
  static SolidMoments moments(const Shape& core, double radius, const TriangleMesh* mesh) {
    const Vec3d& e = core.half_extents;
    if (core.kind == Cylinder::kind) {
      SolidMoments m = rounded::moments_of_round(e.x, e.x, 2 * e.z, radius);
      m.center.z = 0;
      return m;
    }
    if (core.kind == Cone::kind) {
      SolidMoments m = rounded::moments_of_round(e.x, 0, Cone::length(e), radius);
      m.center.z += Cone::base(e);
      return m;
    }
    if (core.kind == Ellipsoid::kind) return rounded::moments_of_ellipsoid(e, radius);
    if (core.kind == Hull::kind) return rounded::moments_of_hull(*mesh, radius);
    return rounded::moments_of_box(e, radius);
  }

  static std::optional<Fault> fault(const Shape& shape) {
    if (!may_round(shape.rounded.core))
      return Fault{"rounded.core", std::to_string(static_cast<int>(shape.rounded.core)),
                   "must be the number of a shape that can be rounded"};
    if (auto fault = length_fault("rounding", shape.rounded.radius)) return fault;
    const Shape own = core(shape);
    if (auto fault = shape_card(own.kind).fault(own)) return fault;
    const Vec3d& e = own.half_extents;
    if (auto fault = rounding_fault(shape.rounded.radius, std::max({e.x, e.y, e.z}))) return fault;
    if (shape.volume > 0) return std::nullopt;
    return Fault{"volume", std::to_string(shape.volume),
                 "must be positive: shapes::Rounded::of() or set_hull() gives it [m^3]"};
  }
  static double bounding_radius(const Shape& shape, const TriangleMesh* mesh) {
    const Shape own = core(shape);
    const Vec3d& e = own.half_extents;
    const double r = shape.rounded.radius, shift = shape.rounded.shift;
    if (own.kind == Cone::kind)
      return r + std::max(e.z + shift, std::hypot(e.x, Cone::base(e) + shift));
    return r + shape_card(own.kind).bounding_radius(own, mesh);
  }
  static MassProperties mass(const Shape& shape, double density) {
    const double mass = density * shape.volume;
    return {mass, mass * shape.moments};
  }
  /// That of its core, and the radius.
  static double rounding(const Shape& shape) {
    const Shape own = core(shape);
    const ShapeCard& card = shape_card(own.kind);
    return shape.rounded.radius + (card.rounding == nullptr ? 0 : card.rounding(own));
  }
  static Shape scaled(const Shape& shape, double factor) {
    Shape out = shape;
    out.half_extents *= factor;
    out.rounded.radius *= factor;
    out.rounded.shift *= factor;
    out.volume *= factor * factor * factor;
    out.moments *= factor * factor;
    return out;
  }
  static Vec3d farthest(const Shape& shape, const TriangleMesh* mesh, const Vec3d& direction) {
    const Shape own = core(shape);
    return shape_card(own.kind).support(own, mesh, direction) + Vec3d{0, 0, shape.rounded.shift} +
           shape.rounded.radius * normalized(direction);
  }
  /// From both ends of the line that the ball about it cuts off, see first_touch().
  static Chord chord(const Shape& shape, const TriangleMesh* mesh, const Vec3d& x, const Vec3d& d) {
    const double bound = bounding_radius(shape, mesh);
    Chord ball;
    ball.cut_quadric(norm2(d), dot(x, d), norm2(x) - bound * bound);
    if (ball.is_empty()) return ball;
    const Shape own = core(shape);
    struct {
      Vec3d half_extents;
      Rounding<double> rounded;
      MeshHull hull;
    } m{own.half_extents, shape.rounded, {}};
    if (own.kind == Hull::kind)
      m.hull = {mesh->vertices.data(), mesh->triangles.data(), mesh->triangles.size(),
                Hull::scale(own, *mesh)};
    const Touch in = first_touch(m, x, d, ball.in, ball.out, 1e-14 * bound);
    if (!in.is) return Chord{0, 0};
    const Touch out = first_touch(m, x, -d, -ball.out, -ball.in, 1e-14 * bound);
    return out.is ? Chord{in.time, -out.time} : Chord{0, 0};
  }
  static Surface surface(const Shape& shape, const TriangleMesh* mesh, double) {
    const Shape own = core(shape);
    const Vec3d& e = own.half_extents;
    const double r = shape.rounded.radius;
    Surface s;
    if (own.kind == Cylinder::kind) {
      s = rounded::surface_of_round(e.x, e.x, -e.z, e.z, r);
    } else if (own.kind == Cone::kind) {
      s = rounded::surface_of_round(e.x, 0, Cone::base(e), e.z, r);
    } else if (own.kind == Ellipsoid::kind) {
      s = Ellipsoid::surface(own, nullptr, 0);
      for (Vec3d& v : s.vertices)
        v += r * normalized(Vec3d{v.x / (e.x * e.x), v.y / (e.y * e.y), v.z / (e.z * e.z)});
    } else {
      TriangleMesh polyhedron;
      const Surface sharp = shape_card(own.kind).surface(own, mesh, 0);
      polyhedron.vertices = sharp.vertices;
      for (const std::vector<int>& face : sharp.faces)
        for (std::size_t k = 2; k < face.size(); ++k)
          polyhedron.triangles.push_back({face[0], face[k - 1], face[k]});
      s = rounded::surface_of_polyhedron(polyhedron, r);
    }
    for (Vec3d& v : s.vertices) v.z += shape.rounded.shift;
    return s;
  }

  /// Point of the core nearest to x, body frame [m].
  /// @param m  with half extents of the core, `rounded`, and `hull` of a hull
  template <class M>
  SCREE_HD static Vec3d on_core(const M& m, const Vec3d& x) {
    const Vec3d e(m.half_extents), shift{0, 0, static_cast<double>(m.rounded.shift)};
    const ShapeKind core = m.rounded.core;
    const Vec3d from = x - shift;
    if (core == Box::kind) return Box::nearest(e, from);
    if (core == Cylinder::kind) return Cylinder::nearest(e, from);
    if (core == Cone::kind) return shift + nearest_of_cone(e, from);
    if (core == Hull::kind) return nearest_of_hull(m.hull, from);
    const Vec3d measure{from.x / e.x, from.y / e.y, from.z / e.z};
    return norm2(measure) <= 1 ? from : Ellipsoid::nearest(e, from);
  }
  /// Point of it nearest to x, body frame [m].
  template <class M>
  requires requires(const M& m) { m.rounded; }
  SCREE_HD static Vec3d nearest(const M& m, const Vec3d& x) {
    const Vec3d middle = on_core(m, x), offset = x - middle;
    const double distance = norm(offset), r = m.rounded.radius;
    return distance > r ? middle + (r / distance) * offset : x;
  }

  /// Where a line enters.
  struct Touch {
    bool is = false;
    double time = 0;
    Vec3d offset;  ///< from the nearest point of the core [m]
  };
  /// On a line the distance from a convex core is a convex function: from a point before it, Newton's steps come to the place
  /// where it is the radius without passing it, and where the distance no longer falls there is none.
  /// @param x, d       of the line x + t d; where it starts lies outside
  /// @param tolerance  of the distance [m]
  template <class M>
  SCREE_HD static Touch first_touch(const M& m, const Vec3d& x, const Vec3d& d, double start,
                                    double end, double tolerance) {
    Touch touch;
    touch.time = start;
    for (int step = 0; step < 100; ++step) {
      const Vec3d at = x + touch.time * d;
      touch.offset = at - on_core(m, at);
      const double distance = norm(touch.offset);
      const double excess = distance - static_cast<double>(m.rounded.radius);
      if (excess <= tolerance) {
        touch.is = true;
        return touch;
      }
      const double falls = -dot(touch.offset, d) / distance;
      if (!(falls > 0)) return touch;
      const double next = touch.time + excess / falls;
      if (!(next <= end)) return touch;
      if (!(next > touch.time)) break;
      touch.time = next;
    }
    touch.is = true;
    return touch;
  }

  static constexpr Outline outline = Outline::box;
  /// Of a ray, from the point of it that is nearest to the center, which keeps its depths.
  /// @param m  with reach(), half extents of the box about all of it
  template <class M>
  SCREE_HD static Touch touch(const M& m, const Ray& ray, float& closest) {
    closest = -dot(ray.origin, ray.direction) / norm2(ray.direction);
    const Vec3f middle = ray.origin + closest * ray.direction;
    const Vec3f reach = m.reach();
    const BoxSpan span = span_in_box(Ray{middle, ray.direction}, reach);
    if (span.enter > span.leave) return {};
    const auto size = static_cast<double>(reach.x + reach.y + reach.z);
    // A little before the box: that is what rounding may have moved its sides.
    const double room = 1e-6 * static_cast<double>(span.leave - span.enter);
    return first_touch(m, Vec3d(middle), Vec3d(ray.direction),
                       static_cast<double>(span.enter) - room,
                       static_cast<double>(span.leave) + room, 1e-7 * size);
  }
  template <class M>
  SCREE_HD static float hit(const M& m, const Ray& ray) {
    float closest = 0;
    const Touch found = touch(m, ray, closest);
    return found.is ? closest + static_cast<float>(found.time) : kMiss;
  }
  template <class M>
  SCREE_HD static Vec3f normal_at(const M& m, const Ray& ray, float) {
    float closest = 0;
    return normalized(Vec3f(touch(m, ray, closest).offset), -normalized(ray.direction));
  }
  template <class M>
  SCREE_HD static float paint(const M& m, const Vec3f& p, const Vec3f&, float footprint) {
    return two_halves(m.reach().x, p, footprint);
  }
};

}  // namespace scree::shapes
