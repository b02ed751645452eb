#pragma once
// A sphere on a straight way past a triangle mesh: where it first touches a triangle, or an edge or
// a vertex which that owns. A feature counts while it is what of its surroundings is closest to the
// center, as in sphere_mesh.h. Times are parts of the way, 0 to 1.

#include "kernels/narrow_phase/pairs/sphere_mesh.h"

namespace scree {

/// A sphere and its way, in the frame of a mesh.
struct SphereWay {
  Vec3d center;       ///< at the start [m]
  Vec3d way;          ///< of the center [m]
  double radius = 0;  ///< [m]
  double reach = 0;   ///< distance of the center at which the sphere counts as touching [m]

  /// Slack at the borders of features: no way leads between two [m].
  SCREE_HD double slack() const { return 1e-6 * radius; }
};

/// A plane that holds the sphere: its center must stay at least the radius above it.
struct HoldingPlane {
  Vec3d normal;       ///< unit, toward the center
  double height = 0;  ///< of the center at the start [m]
};

/// How a sphere touches a triangle on its way.
struct WayTouch {
  double time = 2;  ///< above 1: not at all
  HoldingPlane plane;
};

/// A part of the way.
struct WayPart {
  double from = 0, to = 1;

  SCREE_HD bool is_empty() const { return !(from <= to); }
  /// Keeps the times s with value + s rate >= 0.
  SCREE_HD void keep(double value, double rate) {
    if (rate > 0) {
      from = -value / rate > from ? -value / rate : from;
    } else if (rate < 0) {
      to = -value / rate < to ? -value / rate : to;
    } else if (value < 0) {
      to = -1;
    }
  }
};

/// Takes the touch of a face if it is earlier.
template <class Real>
SCREE_HD void touch_face(const MeshView<Real>& mesh, bool is_closed, Index t, const SphereWay& s,
                         WayTouch& touch) {
  const MeshTriangle& triangle = mesh.triangles[t];
  Vec3d p[3];
  for (int k = 0; k < 3; ++k) p[k] = Vec3d(mesh.points[triangle.vertex[k]]);
  const Vec3d outward = normalized(cross(p[1] - p[0], p[2] - p[0]));
  const double side = dot(s.center - p[0], outward);
  if (is_closed && side < 0) return;
  const Vec3d normal = side < 0 ? -outward : outward;
  const double height = side < 0 ? -side : side, rate = dot(s.way, normal);
  if (!(rate < 0)) return;
  WayPart part;
  part.keep(s.reach - height, -rate);
  part.keep(height, rate);
  if (part.is_empty() || !(part.from < touch.time)) return;
  for (int k = 0; k < 3; ++k) {
    const Vec3d inward = normalized(cross(outward, p[(k + 1) % 3] - p[k]));
    part.keep(dot(s.center - p[k], inward) + s.slack(), dot(s.way, inward));
  }
  if (part.is_empty() || !(part.from < touch.time)) return;
  touch = {part.from, {normal, height}};
}

/// Whether the center comes within reach of a line or a point; arguments as below.
SCREE_HD inline bool comes_near(const SphereWay& s, const Vec3d& offset, const Vec3d& way) {
  const double a = norm2(way), b = dot(offset, way), lacks = norm2(offset) - s.reach * s.reach;
  return b < 0 && (b * b >= a * lacks);
}

/// Takes the touch of a line or a point if it is earlier. The normal is that where the sphere
/// touches it, or passes it nearest.
/// The center comes_near().
/// @param offset   from it to the center at the start [m], its part along a line does not matter
/// @param way      of the offset [m]
/// @param outward  of the surface there; zero: any direction will do
SCREE_HD inline void touch_ridge(const SphereWay& s, const Vec3d& offset, const Vec3d& way,
                                 const Vec3d& outward, WayPart part, WayTouch& touch) {
  const double a = norm2(way), b = dot(offset, way);
  if (part.is_empty()) return;
  const double nearest = -b / a;
  const auto first = [&](double distance) {
    const double inside = b * b - a * (norm2(offset) - distance * distance);
    return inside > 0 ? (-b - std::sqrt(inside)) / a : nearest;
  };
  part.from = first(s.reach) > part.from ? first(s.reach) : part.from;
  part.to = nearest < part.to ? nearest : part.to;
  if (part.is_empty() || !(part.from < touch.time)) return;
  double at = first(s.radius);
  at = at < part.from ? part.from : at > part.to ? part.to : at;
  const Vec3d there = offset + at * way;
  const double distance = norm(there);
  if (!(distance > 0) || dot(there, outward) < 0) return;
  const Vec3d normal = (1 / distance) * there;
  touch = {part.from, {normal, dot(offset, normal)}};
}

/// The same of an edge.
template <class Real>
SCREE_HD void touch_edge(const MeshView<Real>& mesh, bool is_closed, Index e, const SphereWay& s,
                         WayTouch& touch) {
  const MeshEdge& edge = mesh.edges[e];
  const Vec3d a(mesh.points[edge.vertex[0]]), b(mesh.points[edge.vertex[1]]);
  const Vec3d along = normalized(b - a), from_a = s.center - a;
  const double rate = dot(s.way, along);
  const Vec3d offset = from_a - dot(from_a, along) * along, way = s.way - rate * along;
  if (!comes_near(s, offset, way)) return;
  WayPart part;
  part.keep(dot(from_a, along) + s.slack(), rate);
  part.keep(dot(b - s.center, along) + s.slack(), -rate);
  for (int k = 0; k < 2; ++k) {
    if (edge.triangle[k] < 0) continue;
    const Vec3d to_opposite = Vec3d(mesh.points[edge.opposite[k]]) - a;
    const Vec3d inward = normalized(to_opposite - dot(to_opposite, along) * along);
    part.keep(s.slack() - dot(from_a, inward), -dot(s.way, inward));
  }
  const Vec3d outward = is_closed ? Vec3d(mesh.edge_normal[e]) : Vec3d{};
  touch_ridge(s, offset, way, outward, part, touch);
}

/// The same of a vertex.
template <class Real>
SCREE_HD void touch_vertex(const MeshView<Real>& mesh, bool is_closed, Index v, const SphereWay& s,
                           WayTouch& touch) {
  const MeshVertex& vertex = mesh.vertices[v];
  const Vec3d point(mesh.points[v]), offset = s.center - point;
  if (!comes_near(s, offset, s.way)) return;
  WayPart part;
  for (Index k = 0; k < vertex.neighbor_count && !part.is_empty(); ++k) {
    const Vec3d along =
        normalized(Vec3d(mesh.points[mesh.neighbors[vertex.first_neighbor + k]]) - point);
    part.keep(s.slack() - dot(offset, along), -dot(s.way, along));
  }
  const Vec3d outward = is_closed ? Vec3d(mesh.vertex_normal[v]) : Vec3d{};
  touch_ridge(s, offset, s.way, outward, part, touch);
}

/// What of a triangle is hidden: bit 0 the face and with it all, bits 1 to 3 the edges,
/// bits 4 to 6 the vertices.
using HiddenParts = unsigned;

/// Corners of a triangle, from the point from where planes are measured [m].
struct CornerOffsets {
  Vec3d of[3];

  template <class Real>
  SCREE_HD CornerOffsets(const MeshView<Real>& mesh, Index t, const Vec3d& center) {
    const MeshTriangle& triangle = mesh.triangles[t];
    for (int k = 0; k < 3; ++k) of[k] = Vec3d(mesh.points[triangle.vertex[k]]) - center;
  }
};

/// Parts of a triangle that lie below a plane, but for a rise.
SCREE_HD inline HiddenParts parts_below(const CornerOffsets& corner, const HoldingPlane& plane,
                                        double rise) {
  bool is_below[3];
  for (int k = 0; k < 3; ++k) is_below[k] = plane.height + dot(plane.normal, corner.of[k]) <= rise;
  HiddenParts parts = is_below[0] && is_below[1] && is_below[2] ? 1 : 0;
  for (int k = 0; k < 3; ++k) {
    if (is_below[k] && is_below[(k + 1) % 3]) parts |= 2u << k;
    if (is_below[k]) parts |= 16u << k;
  }
  return parts;
}

/// The first touch of what triangle t owns and what is not hidden.
template <class Real>
SCREE_HD WayTouch touch_triangle(const MeshView<Real>& mesh, bool is_closed, Index t,
                                 const SphereWay& s, HiddenParts hidden) {
  const MeshTriangle& triangle = mesh.triangles[t];
  WayTouch touch;
  touch_face(mesh, is_closed, t, s, touch);
  for (int k = 0; k < 3; ++k) {
    const Index e = triangle.edge[k], v = triangle.vertex[k];
    if ((hidden >> (1 + k) & 1) == 0 && mesh.edges[e].triangle[0] == t) {
      touch_edge(mesh, is_closed, e, s, touch);
    }
    if ((hidden >> (4 + k) & 1) == 0 && mesh.vertices[v].owner == t) {
      touch_vertex(mesh, is_closed, v, s, touch);
    }
  }
  return touch;
}

/// Calls visit(triangle) for those whose leaf is within `reach` of the way.
template <class Real, class Visit>
SCREE_HD void visit_near_way(const MeshView<Real>& mesh, const MeshInfo& info, const SphereWay& s,
                             Visit&& visit) {
  Vec3d low, high;
  for (int k = 0; k < 3; ++k) {
    low[k] = (s.way[k] < 0 ? s.center[k] + s.way[k] : s.center[k]) - s.reach;
    high[k] = (s.way[k] < 0 ? s.center[k] : s.center[k] + s.way[k]) + s.reach;
  }
  MeshReach(low, high).visit(mesh, info, visit);
}

}  // namespace scree
