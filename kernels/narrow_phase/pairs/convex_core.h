#pragma once
// Convex bodies as pair functions without a closed form see them: a core, and a radius by which it is rounded. A core is
// known by its support, the point farthest along a direction, and by the polygon, edge or point that faces a direction.
// A capsule is a segment that is rounded.

#include "kernels/narrow_phase/pairs/contact_geometry.h"

namespace scree {

/// What of a core faces a direction; a polygon is counterclockwise seen from outside, an edge has two points.
struct CoreFacet {
  static constexpr int kMaxPoints = 8;
  int count = 0;
  Vec3d point[kMaxPoints];  ///< [m]
  int name[kMaxPoints];     ///< of each point among those of its core; stays from step to step

  SCREE_HD void add(const Vec3d& x, int number) {
    point[count] = x;
    name[count] = number;
    ++count;
  }
  /// Place of the point of that name; -1: there is none.
  SCREE_HD int find(int number) const {
    for (int k = 0; k < count; ++k) {
      if (name[k] == number) return k;
    }
    return -1;
  }
};

/// A convex body in world axes.
struct ConvexCore {
  /// A brick is a box, or a segment along its last axis, which is that of a cylinder, too. A triangle is one of a mesh.
  enum class Form : std::uint8_t { brick, triangle, cylinder };
  /// Below every name of a point: those of one facet differ.
  static constexpr int kNames = 8;

  Form form = Form::brick;
  double rounding = 0;  ///< [m]
  Vec3d center;         ///< [m]
  Vec3d axis[3];        ///< brick: unit; triangle: its corners from the center [m]
  Vec3d half;           ///< brick: half extents; (0, 0, h): a segment [m]
  Vec3d normal;         ///< triangle: unit

  SCREE_HD static ConvexCore brick(const Vec3d& center, const Quatd& q, const Vec3d& half_extents,
                                   double rounding) {
    ConvexCore c;
    c.rounding = rounding;
    c.center = center;
    c.half = half_extents;
    c.axis[0] = rotate(q, Vec3d{1, 0, 0});
    c.axis[1] = rotate(q, Vec3d{0, 1, 0});
    c.axis[2] = rotate(q, Vec3d{0, 0, 1});
    return c;
  }
  SCREE_HD static ConvexCore triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c,
                                      const Vec3d& normal) {
    ConvexCore t;
    t.form = Form::triangle;
    t.center = (1.0 / 3) * (a + b + c);
    t.axis[0] = a - t.center;
    t.axis[1] = b - t.center;
    t.axis[2] = c - t.center;
    t.normal = normal;
    return t;
  }

  SCREE_HD bool is_segment() const { return form == Form::brick && half.x == 0 && half.y == 0; }

  /// The size that rounding and ties are measured by [m].
  SCREE_HD double size() const {
    if (form == Form::triangle) return norm(axis[0]) + norm(axis[1]) + norm(axis[2]);
    return half.x + half.y + half.z;
  }

  /// The point farthest along a direction, from the center [m].
  SCREE_HD Vec3d support(const Vec3d& n) const {
    if (form == Form::triangle) {
      const double a = dot(axis[0], n), b = dot(axis[1], n), c = dot(axis[2], n);
      return a >= b ? (a >= c ? axis[0] : axis[2]) : (b >= c ? axis[1] : axis[2]);
    }
    if (form == Form::cylinder) {
      const double x = dot(axis[0], n), y = dot(axis[1], n), across = std::sqrt(x * x + y * y);
      const double part = across > 0 ? half.x / across : 0;
      return (dot(axis[2], n) < 0 ? -half.z : half.z) * axis[2] + (part * x) * axis[0] +
             (part * y) * axis[1];
    }
    Vec3d x;
    for (int k = 0; k < 3; ++k) x += (dot(axis[k], n) < 0 ? -half[k] : half[k]) * axis[k];
    return x;
  }

  /// Normals of faces, without their opposites.
  SCREE_HD int normal_count() const { return form != Form::brick ? 1 : is_segment() ? 0 : 3; }
  SCREE_HD Vec3d face_normal(int k) const {
    return form == Form::brick ? axis[k] : form == Form::triangle ? normal : axis[2];
  }
  /// Directions of straight edges, and of what a round side consists of.
  SCREE_HD int edge_count() const { return form == Form::cylinder || is_segment() ? 1 : 3; }
  SCREE_HD Vec3d edge(int k) const {
    if (form == Form::triangle) return axis[(k + 1) % 3] - axis[k];
    return edge_count() == 1 ? axis[2] : axis[k];
  }

  /// The face whose normal is nearest to a direction; of a segment all of it, of a cylinder eight points of an end, of
  /// which the first is its farthest one, or a line on its round side.
  SCREE_HD CoreFacet facing(const Vec3d& n) const {
    CoreFacet f;
    if (form == Form::triangle) {
      const bool is_front = dot(normal, n) >= 0;
      for (int k = 0; k < 3; ++k) {
        const int corner = is_front ? k : 2 - k;
        f.add(center + axis[corner], corner);
      }
      return f;
    }
    if (is_segment()) {
      f.add(center - half.z * axis[2], 0);
      f.add(center + half.z * axis[2], 4);
      return f;
    }
    if (form == Form::cylinder) return round_facing(n);
    int m = 0;
    for (int k = 1; k < 3; ++k) {
      if (std::abs(dot(axis[k], n)) > std::abs(dot(axis[m], n)) + 1e-9) m = k;
    }
    const bool is_positive = dot(axis[m], n) >= 0;
    const int u = (m + 1) % 3, v = (m + 2) % 3;
    for (int k = 0; k < 4; ++k) {
      const int turn = is_positive ? k : 3 - k;
      const bool at_u = turn == 1 || turn == 2, at_v = turn >= 2;
      f.add(center + (is_positive ? half[m] : -half[m]) * axis[m] +
                (at_u ? half[u] : -half[u]) * axis[u] + (at_v ? half[v] : -half[v]) * axis[v],
            (is_positive ? 1 << m : 0) | (at_u ? 1 << u : 0) | (at_v ? 1 << v : 0));
    }
    return f;
  }

  SCREE_HD CoreFacet round_facing(const Vec3d& n) const {
    CoreFacet f;
    const double up = dot(axis[2], n), x = dot(axis[0], n), y = dot(axis[1], n);
    const double across = std::sqrt(x * x + y * y);
    const bool is_level = across <= 1e-6 * (up < 0 ? -up : up);
    const Vec3d out = is_level ? axis[0] : (x / across) * axis[0] + (y / across) * axis[1];
    if (across > std::abs(up)) {
      f.add(center + half.x * out - half.z * axis[2], 0);
      f.add(center + half.x * out + half.z * axis[2], 4);
      return f;
    }
    const Vec3d side = cross(up < 0 ? -axis[2] : axis[2], out);
    const Vec3d middle = center + (up < 0 ? -half.z : half.z) * axis[2];
    constexpr double kDiagonal = 0.70710678118654752440;
    const double cosine[] = {1, kDiagonal, 0, -kDiagonal, -1, -kDiagonal, 0, kDiagonal};
    for (int k = 0; k < CoreFacet::kMaxPoints; ++k) {
      const double sine = cosine[(k + 6) % 8];
      f.add(middle + half.x * (cosine[k] * out + sine * side), k);
    }
    return f;
  }

  /// The edge of a polygon, or the point, that lies farthest along a direction. Edges count as facing it up to a slope.
  SCREE_HD CoreFacet edge_toward(const Vec3d& n, double slope) const {
    CoreFacet best;
    const CoreFacet face = facing(n);
    double most = -1e300;
    for (int k = 0; k < face.count; ++k)
      most = dot(face.point[k], n) > most ? dot(face.point[k], n) : most;
    for (int k = 0; k < face.count; ++k) {
      const int next = (k + 1) % face.count;
      const Vec3d &a = face.point[k], &b = face.point[next];
      const double limit = most - slope * norm(b - a);
      if (dot(a, n) < limit || dot(b, n) < limit) continue;
      best.add(a, face.name[k]);
      best.add(b, face.name[next]);
      return best;
    }
    for (int k = 0; k < face.count; ++k) {
      if (dot(face.point[k], n) == most) {
        best.add(face.point[k], face.name[k]);
        return best;
      }
    }
    return best;
  }
};

/// How far the points of one core lie apart from those of the other along a direction from A to B, without rounding [m].
SCREE_HD inline double separation_along(const ConvexCore& a, const ConvexCore& b, const Vec3d& n) {
  return dot(b.center + b.support(-n) - a.center - a.support(n), n);
}

}  // namespace scree
