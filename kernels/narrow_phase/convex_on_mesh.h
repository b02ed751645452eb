#pragma once
// Contacts of a convex body with a mesh wall. Each triangle is a core, but it has neighbors: a normal counts only where
// the surface around the triangle lets a body leave along it. Inside of a flat floor that is the normal of the
// triangle alone, so a body that slides over inner edges meets no ghost. Points at inner edges that are flat or concave
// are left out, too: the corners of the body are over one of the triangles there, or in the notch below both.

#include "kernels/narrow_phase/pairs/box_box.h"
#include "kernels/narrow_phase/pairs/convex_manifold.h"
#include "kernels/narrow_phase/wall_contacts.h"
#include "kernels/narrow_phase/wall_images.h"

namespace scree {

/// How far a wall goes in a step relative to body A, see relative_way(), without what gravity adds: A may rest on what lies beside [m].
/// @param d  center of A to that of the wall [m]
SCREE_HD inline Vec3d wall_way(const WallSolid& solid, const ContactRange& range,
                               const BodySample& a, const Vec3d& d) {
  RigidMotion motion = solid.motion;
  motion.linear += range.gravity_step;
  return relative_way(a.motion, a.radius, motion, 1e300, d, range.h);
}

template <class Real>
struct ConvexOnMesh {
  const MeshView<Real>& meshes;
  const WallSolid& solid;
  const ContactRange& range;
  const BodySample& a;

  /// Slope up to which surfaces count as flat [-].
  static constexpr double kFlat = 1e-4;
  /// Part of the half thickness to which a body is held by a plane that is not its shortest way out.
  static constexpr double kDeepest = 0.1;
  /// A triangle holds a body without a corner over it whose depth along its normal is at most so many times the least depth: the normals
  /// about a notch lie far apart.
  static constexpr double kAsDeep = 5;

  /// Calls emit(element) for each contact with an image of the mesh, ascending.
  /// @param d     center of A to that of the image [m]
  /// @param most  farther triangles have none [m]
  template <class Listed, class Emit>
  SCREE_HD void visit(std::uint32_t image, const Vec3d& d, double most, Listed&& listed,
                      Emit&& emit) const {
    const MeshInfo& info = meshes.meshes[solid.mesh];
    const ConvexCore body = core();
    const Vec3d center = rotate_back(solid.orientation, -d);
    Vec3d reach;
    for (int k = 0; k < 3; ++k) {
      Vec3d n;
      n[k] = 1;
      const Vec3d axis = rotate(solid.orientation, n);
      const double up = dot(body.center + body.support(axis), axis);
      const double down = -dot(body.center + body.support(-axis), axis);
      reach[k] = (up > down ? up : down) + body.rounding + most;
    }
    MeshReach(center - reach, center + reach).visit(meshes, info, [&](Index t) {
      Corner corner(*this, info, t, d);
      CoreDistance distance;
      bool is_nearest = false;
      if (!find(t, corner, body, d, most, distance, is_nearest)) return;
      const CoreMeeting meeting(body, corner.core, distance);
      fast_contacts(meeting, d + corner.way, wall_way(solid, range, a, d), corner.way, is_nearest,
                    Wanted{*this, corner, meeting, t, d}, listed,
                    [&](std::uint32_t feature, const ContactGeometry&) {
                      emit(element(info, image, t, feature));
                    });
    });
  }

  /// Geometry of the contact with this slot of an image.
  SCREE_HD ContactGeometry geometry(const Vec3d& d, std::uint32_t slot) const {
    const MeshInfo& info = meshes.meshes[solid.mesh];
    slot -= static_cast<std::uint32_t>(info.triangle_count);
    const Index t = info.first_triangle + static_cast<Index>(slot >> ConvexFeature::kBits);
    const ConvexCore body = core();
    Corner corner(*this, info, t, d);
    CoreDistance distance;
    bool is_nearest = false;
    if (!find(t, corner, body, d, 1e300, distance, is_nearest)) return no_contact();
    const CoreMeeting meeting(body, corner.core, distance);
    const std::uint32_t feature = slot & ((1u << ConvexFeature::kBits) - 1);
    return fast_contact(meeting, d + corner.way, corner.way, feature);
  }

 private:
  /// A triangle in world axes, from the center of A. That of an open mesh shows its front to A.
  struct Corner {
    ConvexCore core;
    Vec3d normal;  ///< the same in the frame of the mesh
    Vec3d way;     ///< how far it was moved, to the end of the step, see ahead.h [m]
    bool is_turned = false;
    bool is_behind = false;

    SCREE_HD Corner(const ConvexOnMesh& on, const MeshInfo& info, Index t, const Vec3d& d) {
      const MeshTriangle& triangle = on.meshes.triangles[t];
      Vec3d p[3];
      for (int k = 0; k < 3; ++k) p[k] = Vec3d(on.meshes.points[triangle.vertex[k]]);
      normal = normalized(cross(p[1] - p[0], p[2] - p[0]));
      const Quatd& q = on.solid.orientation;
      Vec3d x[3];
      for (int k = 0; k < 3; ++k) x[k] = d + rotate(q, p[k]);
      Vec3d n = rotate(q, normal);
      is_behind = dot(n, x[0]) > 0;
      if (is_behind && !info.closed) {
        is_turned = true;
        is_behind = false;
        normal = -normal;
        n = -n;
      }
      core = ConvexCore::triangle(x[0], is_turned ? x[2] : x[1], is_turned ? x[1] : x[2], n);
    }
  };

  /// What of a meeting with a triangle is asked for, see convex_contacts().
  struct Wanted {
    const ConvexOnMesh& on;
    const Corner& corner;
    const CoreMeeting& meeting;
    Index t;
    const Vec3d& d;
    SCREE_HD bool has(std::uint32_t feature) const {
      return !on.is_inner(corner, meeting, t, feature);
    }
    SCREE_HD bool reaches(const Vec3d& x) const {
      return on.is_in_notch(corner, t, d, x, meeting.tie) ||
             on.is_before(corner, x, on.deepest(meeting.a), meeting.tie);
    }
    SCREE_HD bool has_middle(bool is_met) const {
      return is_met || on.is_over(corner, corner.way, 0);
    }
  };

  SCREE_HD ConvexCore core() const { return CoresOfAny::core(a.side(), {}); }

  SCREE_HD std::uint32_t element(const MeshInfo& info, std::uint32_t image, Index t,
                                 std::uint32_t feature) const {
    // Behind those of spheres, one a triangle.
    const auto own = static_cast<std::uint32_t>(t - info.first_triangle);
    return solid.first_element + image * solid.slots +
           static_cast<std::uint32_t>(info.triangle_count) +
           (own << ConvexFeature::kBits | feature);
  }

  /// How A and a triangle lie. @return  false: the triangle does not hold A
  SCREE_HD bool find(Index t, Corner& corner, const ConvexCore& body, const Vec3d& d, double most,
                     CoreDistance& out, bool& is_nearest) const {
    if (corner.is_behind) return false;
    const double farthest = most + body.rounding;
    const Vec3d n = corner.core.normal;
    if (separation_along(body, corner.core, -n) > farthest) return false;
    CoreSearch search = whole_search(body, corner.core, farthest);
    if (search.separation > farthest) return false;
    out = search.distance();
    const Vec3d way = wall_way(solid, range, a, d);
    if (may_pass(body, corner.core, way, search)) look_ahead(body, corner.core, way, search);
    if (search.is_ahead && is_way_out(t, rotate_back(solid.orientation, -search.point[0]))) {
      out = search.distance();
      corner.way = way;
      corner.core.center += way;
    }
    // Along its own normal the triangle has what is over it, or leaves it to its neighbors.
    is_nearest = std::abs(dot(out.normal, n)) < kFaceCosine;
    if (is_way_out(t, rotate_back(solid.orientation, -out.normal))) return true;
    is_nearest = false;
    const bool was_apart = out.is_apart;
    const double least = was_apart ? 0 : out.separation;
    out.normal = -n;
    out.separation = separation_along(body, corner.core, -n);
    out.is_apart = false;
    if (out.separation >= kAsDeep * least - 1e-6 * body.size()) return true;
    const bool is_fast = MiddleContact::is_wanted(body, corner.core, out.normal, way);
    if (was_apart && !is_fast) return false;
    const bool is_middle_over = is_over(corner, corner.way, 0);
    return (is_fast && is_middle_over) ||
           (!was_apart && is_held(corner, body, t, d, is_middle_over));
  }

  /// Whether a body may leave the surface around triangle t along a direction in the frame of the mesh: what of the
  /// triangle is farthest along it is farther than all around it. Of an edge that is the triangle behind it. The surface
  /// may rise again at the ends of a sharp edge: there it belongs to others.
  SCREE_HD bool is_way_out(Index t, const Vec3d& way) const {
    const MeshTriangle& triangle = meshes.triangles[t];
    double height[3], longest = 0, top = -1e300;
    for (int k = 0; k < 3; ++k) {
      const Vec3d x(meshes.points[triangle.vertex[k]]);
      const double edge = norm(Vec3d(meshes.points[triangle.vertex[(k + 1) % 3]]) - x);
      longest = edge > longest ? edge : longest;
      height[k] = dot(x, way);
      top = height[k] > top ? height[k] : top;
    }
    const auto is_top = [&](int k) { return height[k] >= top - kFlat * longest; };
    const auto rises = [&](Index from, Index to) {
      const Vec3d up = Vec3d(meshes.points[to]) - Vec3d(meshes.points[from]);
      return dot(up, way) > kFlat * norm(up);
    };
    const int tops = is_top(0) + is_top(1) + is_top(2);
    for (int k = 0; k < 3; ++k) {
      if (!is_top(k)) continue;
      if (tops == 2) {
        if (!is_top((k + 1) % 3)) continue;
        const Index opposite = behind(t, k);
        return opposite < 0 || !rises(triangle.vertex[k], opposite);
      }
      const MeshVertex& vertex = meshes.vertices[triangle.vertex[k]];
      for (Index j = 0; j < vertex.neighbor_count; ++j)
        if (rises(triangle.vertex[k], meshes.neighbors[vertex.first_neighbor + j])) return false;
    }
    return true;
  }

  /// Whether a deepest point of A is one for a triangle to hold, and not too deep. None is where the middle of A is over the triangle:
  /// the triangle is between the two.
  SCREE_HD bool is_held(const Corner& corner, const ConvexCore& body, Index t, const Vec3d& d,
                        bool is_middle_over) const {
    const Vec3d n = corner.core.normal;
    const double tie = 1e-5 * body.size();
    const double most = deepest(body);
    CoreFacet face;
    body.facing(-n, body.top(-n), face);
    for (int k = 0; k < face.count; ++k) {
      const Vec3d& x = face.point[k];
      if (is_before(corner, x, most, tie)) return true;
      if (!is_middle_over && dot(x - corner.core.center, n) < -most) continue;
      if (is_over(corner, x, tie) || is_in_notch(corner, t, d, x, tie)) return true;
    }
    return false;
  }
  /// Depth from which a body is too deep to be held by a plane that is not its shortest way out [m].
  SCREE_HD static double deepest(const ConvexCore& body) {
    return body.rounding + kDeepest * box_box_parts::smallest(body.half);
  }

  /// Whether a triangle lies between the middle of A and a point that is too deep: on whatever way it went there, it goes back.
  SCREE_HD bool is_before(const Corner& corner, const Vec3d& x, double most, double tie) const {
    const Vec3d n = corner.core.normal;
    const double from = -dot(corner.core.center, n), to = from + dot(x, n);
    return to < -most && from > 0 && is_over(corner, (from / (from - to)) * x, tie);
  }

  /// Whether a point lies over a triangle, or below it.
  SCREE_HD bool is_over(const Corner& corner, const Vec3d& x, double tie) const {
    for (int k = 0; k < 3; ++k) {
      const Vec3d from = corner.core.center + corner.core.axis[k];
      const Vec3d along = corner.core.axis[(k + 1) % 3] - corner.core.axis[k];
      if (dot(x - from, cross(along, corner.core.normal)) > tie * norm(along)) return false;
    }
    return true;
  }

  /// Whether a point of A below the plane of a triangle, beyond its edges, lies below no other one either: below an edge from which
  /// the surface rises, or below a pit. There the planes of all triangles of that edge, or that pit, hold it.
  [[gnu::noinline]] SCREE_HD bool is_in_notch(const Corner& corner, Index t, const Vec3d& d,
                                              const Vec3d& x, double tie) const {
    if (!(dot(x - corner.core.center, corner.core.normal) < 0)) return false;
    const Vec3d local = rotate_back(solid.orientation, x - d - corner.way);
    const MeshTriangle& triangle = meshes.triangles[t];
    for (int k = 0; k < 3; ++k) {
      const Vec3d from(meshes.points[triangle.vertex[k]]), way = local - from;
      const Vec3d along = Vec3d(meshes.points[triangle.vertex[(k + 1) % 3]]) - from;
      const double length2 = norm2(along), place = dot(way, along);
      // How far the point is beyond the edge of a triangle that has this third vertex.
      const auto beyond = [&](Index third) {
        const Vec3d inward = Vec3d(meshes.points[third]) - from;
        const Vec3d across = inward - (dot(inward, along) / length2) * along;
        return -dot(way, across) / norm(across);
      };
      if (beyond(triangle.vertex[(k + 2) % 3]) <= tie) continue;
      if (!(slope_behind(corner, t, k) > kFlat)) return false;
      if (place < 0 || place > length2) {
        if (!is_nearest(triangle.vertex[place < 0 ? k : (k + 1) % 3], local)) return false;
      } else if (beyond(behind(t, k)) < -tie) {
        return false;
      }
    }
    return true;
  }
  /// Whether no edge leads from a vertex toward a point.
  SCREE_HD bool is_nearest(Index v, const Vec3d& x) const {
    const MeshVertex& vertex = meshes.vertices[v];
    const Vec3d at(meshes.points[v]);
    for (Index j = 0; j < vertex.neighbor_count; ++j)
      if (dot(Vec3d(meshes.points[meshes.neighbors[vertex.first_neighbor + j]]) - at, x - at) > 0)
        return false;
    return true;
  }

  /// Whether a feature of the triangle as the reference is left to others: a point of it at edges that are not sharp, or
  /// one of the body over such an edge that another triangle owns.
  SCREE_HD bool is_inner(const Corner& corner, const CoreMeeting& meeting, Index t,
                         std::uint32_t feature) const {
    const int number = static_cast<int>(feature) - 1 - ConvexFeature::kPoints;
    if (number < 0) return false;
    const auto edge_of = [&](int side) { return corner.is_turned ? 2 - side : side; };
    if (number < ConvexFeature::kOwn) {
      const Vec3d x = meeting.other.point[meeting.other.find(number)];
      for (int side = 0; side < 3; ++side) {
        const int k = edge_of(side);
        if (meshes.edges[meshes.triangles[t].edge[k]].triangle[0] == t) continue;
        const Vec3d from = corner.core.axis[side];
        const Vec3d along = corner.core.axis[(side + 1) % 3] - from;
        const double inside = dot(corner.core.center + from - x, cross(along, corner.core.normal));
        // Its owner takes what is beyond the edge by twice as much.
        if (inside < 0.5 * meeting.tie * norm(along) && is_flat(corner, t, k)) return true;
      }
      return false;
    }
    if (number >= ConvexFeature::kSides) {
      return !is_sharp(corner, t,
                       edge_of((number - ConvexFeature::kSides) % ConvexFeature::kNames));
    }
    const int point = number - ConvexFeature::kOwn;
    return !is_sharp(corner, t, edge_of(point)) && !is_sharp(corner, t, edge_of((point + 2) % 3));
  }
  /// Whether the surface falls off behind an edge.
  SCREE_HD bool is_sharp(const Corner& corner, Index t, int k) const {
    return slope_behind(corner, t, k) < -kFlat;
  }
  SCREE_HD bool is_flat(const Corner& corner, Index t, int k) const {
    return std::abs(slope_behind(corner, t, k)) <= kFlat;
  }
  /// How the surface goes on behind an edge: up, or down where it is negative.
  SCREE_HD double slope_behind(const Corner& corner, Index t, int k) const {
    const Index opposite = behind(t, k);
    if (opposite < 0) return -1;
    const Vec3d to =
        Vec3d(meshes.points[opposite]) - Vec3d(meshes.points[meshes.triangles[t].vertex[k]]);
    return dot(to, corner.normal) / norm(to);
  }
  /// The third vertex of the triangle behind an edge; negative: there is none.
  SCREE_HD Index behind(Index t, int k) const {
    const MeshEdge& edge = meshes.edges[meshes.triangles[t].edge[k]];
    return edge.opposite[edge.triangle[0] == t ? 1 : 0];
  }
};

}  // namespace scree
