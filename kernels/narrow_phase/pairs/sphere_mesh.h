#pragma once
// A sphere on a triangle mesh. A triangle gives a contact only where its distance to the center has
// a local minimum over the whole surface: on its face, on an edge it owns, or at a vertex it owns.
// So a flat floor of many triangles is one contact, and a sphere rolling over inner
// edges meets no ghost.
//
// Whether the foot of the center lies inside a triangle, past an edge or past a vertex is decided
// from the edge alone, by the same arithmetic for both triangles. A strip around each edge
// (MeshInfo::tolerance, 1e-11 of the mesh) belongs to the edge, and what is within twice that of a
// vertex to the vertex: no center falls between two features, and none is claimed twice. Where a mesh goes on in its image
// the arithmetic is not the same: what owns an edge or a vertex there also claims as much more as rounding may be, so
// that a center may be claimed twice, but not fall between.

#include "kernels/narrow_phase/mesh_view.h"
#include "kernels/narrow_phase/pairs/sphere_triangle.h"
#include "shapes/mesh.h"
#include "shapes/sphere.h"

namespace scree {

/// Where a center stands relative to one edge.
struct EdgeSides {
  bool past[2];    ///< not on the inner side of triangle 0, 1; true at a border
  bool beside[2];  ///< the same, or on the inner side by no more than the slack of the edge
  double
      from[2];  ///< distance of its foot on the edge from either end [m], negative beyond the end
};

template <class Real>
SCREE_HD EdgeSides edge_sides(const MeshView<Real>& mesh, const MeshEdge& edge, double tolerance,
                              const Vec3d& center) {
  const Vec3d a(mesh.points[edge.vertex[0]]), b(mesh.points[edge.vertex[1]]);
  const Vec3d along = normalized(b - a), from_a = center - a;
  EdgeSides sides;
  sides.from[0] = dot(from_a, along);
  sides.from[1] = dot(center - b, -along);
  for (int k = 0; k < 2; ++k) {
    sides.past[k] = sides.beside[k] = true;
    if (edge.triangle[k] < 0) continue;
    const Vec3d to_opposite = Vec3d(mesh.points[edge.opposite[k]]) - a;
    const Vec3d inward = to_opposite - dot(to_opposite, along) * along;
    const double inside = dot(from_a, inward), length = norm(inward);
    sides.past[k] = inside <= tolerance * length;
    sides.beside[k] = inside <= (tolerance + static_cast<double>(edge.slack)) * length;
  }
  return sides;
}

/// Whether a vertex is the point of its surroundings closest to the center.
template <class Real>
SCREE_HD bool is_closest_vertex(const MeshView<Real>& mesh, Index v, double tolerance,
                                const Vec3d& center) {
  const MeshVertex& vertex = mesh.vertices[v];
  const Vec3d point(mesh.points[v]);
  for (Index k = 0; k < vertex.neighbor_count; ++k) {
    const Vec3d along = Vec3d(mesh.points[mesh.neighbors[vertex.first_neighbor + k]]) - point;
    if (dot(center - point, along) > 2 * tolerance * norm(along)) return false;
  }
  return true;
}

/// What of triangle t, or of the edges and vertices it owns, is closest to the center of a sphere.
template <class Real>
SCREE_HD bool closest_feature(const MeshView<Real>& mesh, double tolerance, Index t,
                              const Vec3d& center, TriangleFeature& feature, int& index) {
  const MeshTriangle& triangle = mesh.triangles[t];
  // From each corner along the edges of t, the nearer end.
  double from_vertex[3] = {INFINITY, INFINITY, INFINITY};
  bool inside = true;
  int edge = -1;
  for (int k = 0; k < 3; ++k) {
    const MeshEdge& e = mesh.edges[triangle.edge[k]];
    const EdgeSides sides = edge_sides(mesh, e, tolerance, center);
    inside = inside && !sides.past[e.triangle[0] == t ? 0 : 1];
    if (e.triangle[0] == t && sides.beside[0] && sides.beside[1] && sides.from[0] > tolerance &&
        sides.from[1] > tolerance) {
      edge = k;
    }
    for (int end = 0; end < 2; ++end) {
      double& from = from_vertex[e.vertex[end] == triangle.vertex[k] ? k : (k + 1) % 3];
      from = sides.from[end] < from ? sides.from[end] : from;
    }
  }
  for (int k = 0; k < 3; ++k) {
    const Index v = triangle.vertex[k];
    const bool is_owner = mesh.vertices[v].owner == t;
    const double width = tolerance + (is_owner ? static_cast<double>(mesh.vertices[v].slack) : 0);
    if (from_vertex[k] > 2 * width || !is_closest_vertex(mesh, v, width, center)) continue;
    feature = TriangleFeature::vertex;
    index = k;
    return is_owner;
  }
  feature = edge >= 0 ? TriangleFeature::edge : TriangleFeature::face;
  index = edge;
  return edge >= 0 || inside;
}

/// A contact of a sphere with a mesh, in the frame of the mesh.
struct MeshPoint {
  Vec3d offset;  ///< contact point on the mesh to the center [m]
  Vec3d normal;  ///< unit outward direction of the surface there
  TriangleFeature feature = TriangleFeature::face;
  int index = 0;  ///< of the edge or vertex in its triangle
};

/// The contact of a sphere with what triangle t owns.
/// @param center  of the sphere, in the frame of the mesh [m]
/// @return        false: no contact
template <class Real>
SCREE_HD bool sphere_mesh_triangle(const MeshView<Real>& mesh, const MeshInfo& info, Index t,
                                   const Vec3d& center, MeshPoint& point) {
  int& k = point.index;
  if (!closest_feature(mesh, info.tolerance, t, center, point.feature, k)) return false;
  const MeshTriangle& triangle = mesh.triangles[t];
  Vec3d& offset = point.offset;
  Vec3d& normal = point.normal;
  if (point.feature == TriangleFeature::vertex) {
    offset = center - Vec3d(mesh.points[triangle.vertex[k]]);
    normal = Vec3d(mesh.vertex_normal[triangle.vertex[k]]);
  } else if (point.feature == TriangleFeature::edge) {
    const MeshEdge& edge = mesh.edges[triangle.edge[k]];
    const Vec3d a(mesh.points[edge.vertex[0]]);
    const Vec3d along = normalized(Vec3d(mesh.points[edge.vertex[1]]) - a);
    offset = (center - a) - dot(center - a, along) * along;
    normal = Vec3d(mesh.edge_normal[triangle.edge[k]]);
  } else {
    const Vec3d a(mesh.points[triangle.vertex[0]]);
    normal = normalized(cross(Vec3d(mesh.points[triangle.vertex[1]]) - a,
                              Vec3d(mesh.points[triangle.vertex[2]]) - a));
    offset = dot(center - a, normal) * normal;
  }
  return !info.closed || dot(offset, normal) >= 0;
}

/// What is within `reach` of a point along each axis.
SCREE_HD inline MeshReach reach_about(const Vec3d& center, double reach) {
  const Vec3d each{reach, reach, reach};
  return {center - each, center + each};
}

/// Whether a leaf of the mesh is within `reach` of the center.
template <class Real>
SCREE_HD bool is_near_mesh(const MeshView<Real>& mesh, const MeshInfo& info, const Vec3d& center,
                           double reach) {
  return reach_about(center, reach).next_leaf(mesh.nodes, info.first_node, info.end_node) <
         info.end_node;
}

/// Calls visit(triangle, point) for each contact within `reach` of the center.
template <class Real, class Visit>
SCREE_HD void visit_sphere_mesh(const MeshView<Real>& mesh, const MeshInfo& info,
                                const Vec3d& center, double reach, Visit&& visit) {
  reach_about(center, reach).visit(mesh, info, [&](Index t) {
    const MeshTriangle& triangle = mesh.triangles[t];
    const TrianglePoint nearest = closest_on_triangle(
        center, Vec3d(mesh.points[triangle.vertex[0]]), Vec3d(mesh.points[triangle.vertex[1]]),
        Vec3d(mesh.points[triangle.vertex[2]]));
    if (!(norm2(center - nearest.point) <= reach * reach)) return;
    MeshPoint point;
    if (sphere_mesh_triangle(mesh, info, t, center, point)) visit(t, point);
  });
}

/// Walls have passes of their own for these, see SphereOnSolid.
struct SphereMesh {
  using A = shapes::Sphere;
  using B = shapes::Mesh;
};

}  // namespace scree
