#pragma once
// What a sphere meets on its way past a mesh wall in one step, beside the points of the mesh that
// are closest to it at the start.
//
// Contacts hold the sphere above planes. Its way is that which they leave it: the part of its free
// way nearest to the free one that no plane cuts. What that way touches, and no plane hides, is a
// contact more, and gives a plane more; so on until the way is clear. Neither concave edges nor any
// speed leads through a mesh then, and what lies below a plane, as the neighbors of a triangle on a
// flat or convex surface do, makes no contact of its own. What is left out here, and what is met
// because contacts push the sphere off that way, is left to kernels/step/guarded_way.h.

#include "kernels/narrow_phase/pairs/sphere_mesh_way.h"
#include "kernels/narrow_phase/wall_images.h"

namespace scree {

/// How far a surface may rise above a plane that hides it, as a part of the radius.
inline constexpr double kHiddenRise = 1e-3;

/// Whether a feature of triangle t lies below a plane, for all of the surface around it.
/// @param center  of the sphere in the frame of the mesh, from where the plane is measured [m]
template <class Real>
SCREE_HD bool is_below(const MeshView<Real>& mesh, Index t, TriangleFeature feature, int index,
                       const Vec3d& center, const HoldingPlane& plane, double rise) {
  const auto is_point_below = [&](Index v) {
    return plane.height + dot(plane.normal, Vec3d(mesh.points[v]) - center) <= rise;
  };
  const MeshTriangle& triangle = mesh.triangles[t];
  if (feature == TriangleFeature::face) {
    return is_point_below(triangle.vertex[0]) && is_point_below(triangle.vertex[1]) &&
           is_point_below(triangle.vertex[2]);
  }
  if (feature == TriangleFeature::edge) {
    const MeshEdge& edge = mesh.edges[triangle.edge[index]];
    bool is_all = is_point_below(edge.vertex[0]) && is_point_below(edge.vertex[1]);
    for (int k = 0; k < 2; ++k) {
      is_all = is_all && (edge.opposite[k] < 0 || is_point_below(edge.opposite[k]));
    }
    return is_all;
  }
  const Index v = triangle.vertex[index];
  const MeshVertex& vertex = mesh.vertices[v];
  bool is_all = is_point_below(v);
  for (Index k = 0; k < vertex.neighbor_count && is_all; ++k) {
    is_all = is_point_below(mesh.neighbors[vertex.first_neighbor + k]);
  }
  return is_all;
}

/// Planes of the contacts of a sphere with one wall, the nearest if there are too many.
struct HoldingPlanes {
  static constexpr int kMaxPlanes = 8;
  HoldingPlane plane[kMaxPlanes];
  std::uint32_t image[kMaxPlanes];    ///< of the wall
  std::uint32_t element[kMaxPlanes];  ///< of the contact
  int count = 0;
  bool is_all = true;  ///< there were not too many; they are in the order they came in

  SCREE_HD void add(const HoldingPlane& p, std::uint32_t of_image, std::uint32_t of_element) {
    int at = count;
    if (count == kMaxPlanes) {
      is_all = false;
      at = 0;
      for (int k = 1; k < kMaxPlanes; ++k) at = plane[k].height > plane[at].height ? k : at;
      if (!(p.height < plane[at].height)) return;
    } else {
      ++count;
    }
    plane[at] = p;
    image[at] = of_image;
    element[at] = of_element;
  }

  /// Whether another image of the wall gives a plane that is nearer, such that covers(plane).
  template <class Covers>
  SCREE_HD bool other_image_hides(double height, std::uint32_t of_image, Covers&& covers) const {
    for (int k = 0; k < count; ++k) {
      if (image[k] == of_image || plane[k].height > height) continue;
      if (plane[k].height == height && image[k] > of_image) continue;
      if (covers(plane[k])) return true;
    }
    return false;
  }

  /// The way nearest to a free one that no plane cuts, by Hildreth's method.
  SCREE_HD Vec3d allowed(const Vec3d& free, double radius) const {
    double push[kMaxPlanes] = {};
    Vec3d way = free;
    for (int round = 0; round < 60; ++round) {
      double most = 0;
      for (int k = 0; k < count; ++k) {
        const double gap = plane[k].height > radius ? plane[k].height - radius : 0;
        const double lacks = -gap - dot(plane[k].normal, way);
        const double next = push[k] + lacks > 0 ? push[k] + lacks : 0;
        way += (next - push[k]) * plane[k].normal;
        most = std::abs(next - push[k]) > most ? std::abs(next - push[k]) : most;
        push[k] = next;
      }
      if (most <= 1e-6 * radius) break;
    }
    return way;
  }
};

/// A contact that is found on the way only.
struct WayContact {
  std::uint32_t element = 0;  ///< see mesh_element()
  HoldingPlane plane;         ///< in the frame of the mesh
};

/// Element of the contact with a triangle of an image of a mesh wall.
SCREE_HD inline std::uint32_t mesh_element(const WallSolid& solid, const MeshInfo& info,
                                           std::uint32_t image, Index t) {
  return solid.first_element + image * solid.slots +
         static_cast<std::uint32_t>(t - info.first_triangle);
}

/// Contacts that are found on the way only, ascending.
struct WayContacts {
  static constexpr int kMaxContacts = 6;
  WayContact contact[kMaxContacts];
  int count = 0;

  SCREE_HD bool contains(std::uint32_t element) const {
    for (int k = 0; k < count; ++k) {
      if (contact[k].element == element) return true;
    }
    return false;
  }
  SCREE_HD void insert(const WayContact& c) {
    int at = count++;
    for (; at > 0 && contact[at - 1].element > c.element; --at) contact[at] = contact[at - 1];
    contact[at] = c;
  }
};

}  // namespace scree
