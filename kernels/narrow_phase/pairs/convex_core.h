#pragma once
// Convex bodies as pair functions without a closed form see them: a core, and a radius by which it is rounded. A core is
// known by its support, the point farthest along a direction, and by the polygon, edge or point that faces a direction.
// A capsule is a segment that is rounded, a sphere a point.

#include "kernels/bodies/hull.h"
#include "kernels/math/room.h"
#include "kernels/narrow_phase/pairs/contact_geometry.h"
#include "shapes/cone.h"

namespace scree {

/// An edge of a core, or a point: then both ends are that.
struct CoreEdge {
  Vec3d from, to;  ///< [m]
  int from_name = 0, to_name = 0;
  int count = 1;  ///< of points

  SCREE_HD CoreEdge(const Vec3d& x, int name) : from(x), to(x), from_name(name), to_name(name) {}
  SCREE_HD CoreEdge(const Vec3d& x, int name, const Vec3d& y, int other)
      : from(x), to(y), from_name(name), to_name(other), count(2) {}
};

/// What of a core faces a direction; a polygon is counterclockwise seen from outside, an edge has two points. Of a disc these
/// are eight points of its rim; what lies over it is told by the disc itself.
struct CoreFacet {
  static constexpr int kMaxPoints = 8;
  int count = 0;
  double radius = 0;              ///< of a disc [m]; 0: it is none
  Vec3d middle, axis;             ///< of a disc: its middle [m], and unit along its normal
  Room<Vec3d, kMaxPoints> point;  ///< [m]
  Room<Vec3d, kMaxPoints>
      side;  ///< unit, out of the side from each point to the next: see set_sides()
  std::uint8_t
      name[kMaxPoints];  ///< of each point among those of its core; stays from step to step

  SCREE_HD void add(const Vec3d& x, int number) {
    point[count] = x;
    name[count] = static_cast<std::uint8_t>(number);
    ++count;
  }
  SCREE_HD void clear() {
    count = 0;
    radius = 0;
  }
  SCREE_HD void set(const CoreEdge& edge) {
    clear();
    add(edge.from, edge.from_name);
    if (edge.count == 2) add(edge.to, edge.to_name);
  }
  SCREE_HD int after(int k) const { return k + 1 < count ? k + 1 : 0; }
  /// Seen along a normal. @param normal  out of the core; an edge is seen along it
  SCREE_HD void set_sides(const Vec3d& normal) {
    for (int k = 0; k < count; ++k) {
      const Vec3d along = point[after(k)] - point[k];
      side[k] = normalized(count == 2 ? -along : cross(along, normal));
    }
  }
  /// How far a point is beyond side k [m].
  SCREE_HD double beyond(int k, const Vec3d& x) const { return dot(x - point[k], side[k]); }
  /// From the middle of a disc to where a point is seen along a direction.
  SCREE_HD Vec3d from_middle(const Vec3d& x, const Vec3d& direction) const {
    const Vec3d way = x - middle;
    return way - (dot(way, axis) / dot(direction, axis)) * direction;
  }
  /// Whether a point lies over the facet. @param direction  unit, of set_sides() @param but  a side that does not matter
  SCREE_HD bool is_under(const Vec3d& x, const Vec3d& direction, double tie, int but = -1) const {
    if (radius > 0) return norm(from_middle(x, direction)) <= radius + tie;
    for (int k = 0; k < count; ++k) {
      if (k != but && beyond(k, x) > tie) return false;
    }
    return true;
  }
  /// Of a polygon or an edge, the point nearest to another one, both seen along a direction.
  SCREE_HD Vec3d nearest_seen(const Vec3d& x, const Vec3d& direction) const {
    bool is_inside = count > 2;
    Vec3d nearest = point[0];
    double least2 = 1e300;
    for (int k = 0; k < count; ++k) {
      is_inside = is_inside && beyond(k, x) <= 0;
      const Vec3d way = point[after(k)] - point[k], from = x - point[k];
      const Vec3d seen = way - dot(way, direction) * direction;
      const double length2 = norm2(seen);
      double t = length2 > 0 ? dot(from, seen) / length2 : 0;
      t = t > 0 ? (t < 1 ? t : 1) : 0;
      const double found2 = norm2(from - dot(from, direction) * direction - t * seen);
      if (!(found2 < least2)) continue;
      least2 = found2;
      nearest = point[k] + t * way;
    }
    return is_inside ? x : nearest;
  }
  /// Place of the point of that name; -1: there is none.
  SCREE_HD int find(int number) const {
    for (int k = 0; k < count; ++k) {
      if (name[k] == number) return k;
    }
    return -1;
  }
};

/// A convex body in world axes. What is called from many places is one function each: inlined, all forms would be compiled
/// at each of them.
struct ConvexCore {
  /// A brick is a box, or a segment along its last axis, which is that of a cylinder and a cone, too. A triangle is one
  /// of a mesh.
  enum class Form : std::uint8_t { brick, triangle, cylinder, cone, ellipsoid, hull };
  /// Below every name of a point: those of one facet differ.
  static constexpr int kNames = 8;

  Form form = Form::brick;
  double rounding = 0;  ///< [m]
  Vec3d center;         ///< [m]
  Vec3d axis[3];        ///< brick: unit; triangle: its corners from the center [m]
  Vec3d half;           ///< half extents of the box about it; brick (0, 0, h): a segment [m]
  Vec3d normal;         ///< triangle: unit
  Hull hull;

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

  /// Round about its last axis.
  SCREE_HD bool is_round() const { return form == Form::cylinder || form == Form::cone; }
  /// Where the lower end of a round core is, along its axis [m].
  SCREE_HD double base() const { return form == Form::cone ? shapes::Cone::base(half) : -half.z; }
  /// What no polytope comes near with few corners; of a cylinder, core_distance() knows the normals.
  SCREE_HD bool is_curved() const { return form == Form::ellipsoid || form == Form::cone; }
  SCREE_HD bool is_segment() const { return form == Form::brick && half.x == 0 && half.y == 0; }

  /// Least half thickness, that of its rounding included; a triangle does not know what is behind it [m].
  SCREE_HD double thickness() const {
    if (form == Form::triangle) return 1e300;
    const double least = half.x < half.y ? half.x : half.y;
    return (least < half.z ? least : half.z) + rounding;
  }

  /// The size that rounding and ties are measured by [m].
  SCREE_HD double size() const {
    if (form == Form::triangle) return norm(axis[0]) + norm(axis[1]) + norm(axis[2]);
    return half.x + half.y + half.z;
  }

  /// The point farthest along a direction, from the center [m]. That of a hull, which takes longest, is inlined.
  SCREE_HD Vec3d support(const Vec3d& n) const {
    return form == Form::hull ? at(hull.farthest(local(n))) : support_of_others(n);
  }

  /// What tells the part of a core that faces a direction: of a hull its farthest point. To find it takes long, and face
  /// normals, facets and edges towards that direction need it.
  SCREE_HD std::uint32_t top(const Vec3d& n) const {
    return form == Form::hull ? hull.farthest(local(n)) : 0;
  }

  /// Normals that faces may have. Of a hull it is only the one nearest to a direction.
  SCREE_HD int normal_count() const {
    if (form == Form::brick) return is_segment() ? 0 : 6;
    return form == Form::ellipsoid ? 0 : form == Form::cone || form == Form::hull ? 1 : 2;
  }
  /// @param top  of that direction
  [[gnu::noinline]] SCREE_HD Vec3d face_normal(int k, const Vec3d& toward,
                                               std::uint32_t top) const {
    if (form == Form::hull) return world(hull.face[hull.facing(top, local(toward))].normal);
    if (form == Form::cone) return -axis[2];
    const Vec3d n = form == Form::brick ? axis[k / 2] : form == Form::triangle ? normal : axis[2];
    return k % 2 == 0 ? n : -n;
  }
  /// All normals that faces may have, of a hull those of the faces that meet at a corner.
  SCREE_HD int normal_count_at(std::uint32_t corner) const {
    if (form != Form::hull) return normal_count();
    return static_cast<int>(hull.first_face[corner + 1] - hull.first_face[corner]);
  }
  SCREE_HD Vec3d normal_at(int k, std::uint32_t corner) const {
    if (form != Form::hull) return face_normal(k, {}, 0);
    return world(hull.face_at[hull.first_face[corner] + static_cast<std::uint32_t>(k)].normal);
  }
  /// The point farthest along the normal of a face, from the center [m]. @param top  that the normal was found by
  SCREE_HD Vec3d on_face(const Vec3d& face, std::uint32_t top) const {
    return form == Form::hull ? at(top) : support(face);
  }
  /// Directions of straight edges, and of what a round side consists of. Those of a hull, and of a cone, which are many,
  /// are left to the search.
  SCREE_HD int edge_count() const {
    if (form == Form::hull || form == Form::ellipsoid || form == Form::cone) return 0;
    return form == Form::cylinder || is_segment() ? 1 : 3;
  }
  SCREE_HD Vec3d edge(int k) const {
    if (form == Form::triangle) return axis[(k + 1) % 3] - axis[k];
    return edge_count() == 1 ? axis[2] : axis[k];
  }

  /// The face whose normal is nearest to a direction; of a segment all of it, of a round core eight points of an end, of
  /// which the first is its farthest one, or a line on its round side, of an ellipsoid its farthest point. Of a hull, a
  /// face at its farthest point.
  /// @param top  of that direction
  [[gnu::noinline]] SCREE_HD void facing(const Vec3d& n, std::uint32_t top, CoreFacet& f) const {
    f.clear();
    if (form == Form::triangle) {
      const bool is_front = dot(normal, n) >= 0;
      for (int k = 0; k < 3; ++k) {
        const int corner = is_front ? k : 2 - k;
        f.add(center + axis[corner], corner);
      }
      return;
    }
    if (is_segment()) {
      f.add(center - half.z * axis[2], 0);
      f.add(center + half.z * axis[2], 4);
      return;
    }
    if (is_round()) return round_facing(n, f);
    if (form == Form::ellipsoid) {
      f.add(center + support(n), 0);
      return;
    }
    if (form == Form::hull) {
      static_assert(Hull::kMostCorners <= CoreFacet::kMaxPoints);
      const std::uint32_t face = hull.facing(top, local(n));
      for (std::uint32_t k = 0; k < hull.shown_count(face); ++k)
        f.add(center + at(hull.shown_corner(face, k, top)), static_cast<int>(k));
      return;
    }
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
  }

  SCREE_HD void round_facing(const Vec3d& n, CoreFacet& f) const {
    const double up = dot(axis[2], n), x = dot(axis[0], n), y = dot(axis[1], n);
    const double across = std::sqrt(x * x + y * y);
    const bool is_level = across <= 1e-6 * (up < 0 ? -up : up);
    const Vec3d out = is_level ? axis[0] : (x / across) * axis[0] + (y / across) * axis[1];
    if (faces_side(up, across)) {
      f.add(center + half.x * out + base() * axis[2], 0);
      f.add(center + (form == Form::cone ? 0 : half.x) * out + half.z * axis[2], 4);
      return;
    }
    f.axis = up < 0 ? -axis[2] : axis[2];
    f.radius = half.x;
    f.middle = center + (up < 0 ? base() : half.z) * axis[2];
    const Vec3d side = cross(f.axis, out);
    constexpr double kDiagonal = 0.70710678118654752440;
    const double cosine[] = {1, kDiagonal, 0, -kDiagonal, -1, -kDiagonal, 0, kDiagonal};
    for (int k = 0; k < CoreFacet::kMaxPoints; ++k) {
      const double sine = cosine[(k + 6) % 8];
      f.add(f.middle + half.x * (cosine[k] * out + sine * side), k);
    }
  }

  /// The edge of a polygon, or the point, that lies farthest along a direction. Edges count as facing it up to a slope.
  SCREE_HD CoreEdge edge_toward(const Vec3d& n, double slope) const {
    return edge_toward(n, slope, top(n));
  }
  /// @param top  of that direction
  SCREE_HD CoreEdge edge_toward(const Vec3d& n, double slope, std::uint32_t top) const {
    return form == Form::hull ? hull_edge_toward(local(n), slope, top) : edge_of_facet(n, slope);
  }

 private:
  SCREE_HD Vec3d local(const Vec3d& n) const {
    return {dot(axis[0], n), dot(axis[1], n), dot(axis[2], n)};
  }
  SCREE_HD Vec3d world(const Vec3d& x) const {
    return x.x * axis[0] + x.y * axis[1] + x.z * axis[2];
  }
  /// Point k of a hull, from the center [m].
  SCREE_HD Vec3d at(std::uint32_t k) const { return world(hull.scale * hull.point[k]); }

  [[gnu::noinline]] SCREE_HD Vec3d support_of_others(const Vec3d& n) const {
    if (form == Form::triangle) {
      const double a = dot(axis[0], n), b = dot(axis[1], n), c = dot(axis[2], n);
      return a >= b ? (a >= c ? axis[0] : axis[2]) : (b >= c ? axis[1] : axis[2]);
    }
    if (is_round()) {
      const double x = dot(axis[0], n), y = dot(axis[1], n), across = std::sqrt(x * x + y * y);
      const double part = across > 0 ? half.x / across : 0;
      const double up = dot(axis[2], n);
      if (form == Form::cone && up * (half.z - base()) > across * half.x) return half.z * axis[2];
      const double end = up < 0 || form == Form::cone ? base() : half.z;
      return end * axis[2] + (part * x) * axis[0] + (part * y) * axis[1];
    }
    if (form == Form::ellipsoid) {
      Vec3d x;
      for (int k = 0; k < 3; ++k) x[k] = half[k] * dot(axis[k], n);
      const double length = norm(x);
      for (int k = 0; k < 3; ++k) x[k] *= half[k] / (length > 0 ? length : 1);
      return world(x);
    }
    Vec3d x;
    for (int k = 0; k < 3; ++k) x += (dot(axis[k], n) < 0 ? -half[k] : half[k]) * axis[k];
    return x;
  }

  /// Whether the normal of a round side is nearer to a direction than that of an end. A cone ends in a point above.
  SCREE_HD bool faces_side(double up, double across) const {
    if (form == Form::cylinder) return across > std::abs(up);
    const double height = half.z - base(), slant = std::sqrt(height * height + half.x * half.x);
    return across * height + up * half.x > -up * slant;
  }

  /// The edge from the farthest point to the farthest of those it is joined with, or that point alone.
  [[gnu::noinline]] SCREE_HD CoreEdge hull_edge_toward(const Vec3d& n, double slope,
                                                       std::uint32_t top) const {
    std::uint32_t next = top;
    double least = 1e300;
    for (std::uint32_t k = hull.first_face[top]; k < hull.first_face[top + 1]; ++k) {
      const double falls = -dot(hull.face_at[k].along, n);
      if (falls < least) {
        least = falls;
        next = hull.face_at[k].next;
      }
    }
    if (least > slope) return {center + at(top), 0};
    return {center + at(top < next ? top : next), 0, center + at(top < next ? next : top), 4};
  }
  [[gnu::noinline]] SCREE_HD CoreEdge edge_of_facet(const Vec3d& n, double slope) const {
    CoreFacet f;
    facing(n, 0, f);
    double most = -1e300;
    for (int k = 0; k < f.count; ++k) most = dot(f.point[k], n) > most ? dot(f.point[k], n) : most;
    for (int k = 0; k < f.count && f.count > 1; ++k) {
      const int next = f.after(k);
      const Vec3d &x = f.point[k], &y = f.point[next];
      const double limit = most - slope * norm(y - x);
      if (dot(x, n) >= limit && dot(y, n) >= limit) return {x, f.name[k], y, f.name[next]};
    }
    int k = 0;
    while (k + 1 < f.count && dot(f.point[k], n) != most) ++k;
    return {f.point[k], f.name[k]};
  }
};

/// How far the points of one core lie apart from those of the other along a direction from A to B, without rounding [m].
SCREE_HD inline double separation_along(const ConvexCore& a, const ConvexCore& b, const Vec3d& n) {
  return dot(b.center + b.support(-n) - a.center - a.support(n), n);
}

}  // namespace scree
