#pragma once
// Contacts of one free body with the walls.

#include "kernels/binning.h"
#include "kernels/body_pairs.h"
#include "kernels/contact_key.h"
#include "kernels/pairs/box_plane.h"
#include "kernels/pairs/sphere_mesh.h"
#include "kernels/pairs/sphere_plane.h"
#include "kernels/periodic.h"

namespace scree {

template <class Real>
struct WallView {
  Span<const WallPlane> planes;
  Span<const WallSolid> solids;
  MeshView<Real> meshes;
};

/// Contact of body A with a plane; `corner` counts for boxes only.
template <ShapeMix kMix>
SCREE_HD ContactGeometry plane_contact(const BodySample& a, const WallPlane& plane, int corner) {
  const double height = dot(a.position - plane.point, plane.normal);
  const Vec3d d = plane.center - a.position;
  if constexpr (kMix == ShapeMix::any) {
    if (a.kind == ShapeKind::box) {
      return box_half_space(height, plane.normal, d, a.orientation, a.half_extents, corner);
    }
  }
  return sphere_half_space(height, plane.normal, d, a.radius);
}

/// Sphere A on a mesh, from the contact point found in the frame of the mesh.
/// @param offset, normal  see sphere_mesh_triangle
SCREE_HD inline ContactGeometry mesh_contact(const BodySample& a, const WallSolid& solid,
                                             const Vec3d& d, const Vec3d& offset,
                                             const Vec3d& normal) {
  const Vec3d world = rotate(solid.orientation, offset);
  return sphere_surface_point(world, rotate(solid.orientation, normal), -world - d, a.radius);
}

/// Calls emit(element) for each listed contact of body A with the walls, in ascending order: planes
/// come before solid walls, and the triangles of a mesh are numbered along its tree.
/// @param envelope  contacts are listed up to this gap [m]
/// @param inflated  inflated radius of A [m], see inflated_radius()
template <ShapeMix kMix, class Real, class Emit>
SCREE_HD void visit_walls(const WallView<Real>& walls, const ContactRange& range,
                          const ContactKeys& keys, const BodySample& a, double envelope,
                          double inflated, Emit&& emit) {
  const bool is_box = kMix == ShapeMix::any && a.kind == ShapeKind::box;
  for (Index p = 0; p < static_cast<Index>(walls.planes.size); ++p) {
    const WallPlane& plane = walls.planes[p];
    // Half of it, and the way of A in one step, are in the inflated radius already.
    const double height = dot(a.position - plane.point, plane.normal);
    if (!plane.moves && height > inflated + 0.5 * envelope) continue;
    const int corners = is_box ? kBoxCorners : 1;
    for (int corner = 0; corner < corners; ++corner) {
      const ContactGeometry g = plane_contact<kMix>(a, plane, corner);
      if (g.gap > envelope &&
          !is_listed(g.gap, separation_speed(g, a.motion, plane.motion), envelope, range.h)) {
        continue;
      }
      emit(keys.plane_element(p, corner));
    }
  }
  if constexpr (kMix == ShapeMix::spheres_and_planes) return;
  if (is_box) return;  // a box against a solid wall has no pair function yet
  for (Index k = 0; k < static_cast<Index>(walls.solids.size); ++k) {
    const WallSolid& solid = walls.solids[k];
    const Vec3d d = minimum_image(solid.center - a.position, range.period);
    if (solid.kind == ShapeKind::box) {
      const ContactGeometry g = sphere_box(d, a.radius, solid.orientation, solid.half_extents);
      if (is_listed(g.gap, separation_speed(g, a.motion, solid.motion), envelope, range.h)) {
        emit(solid.first_element);
      }
      continue;
    }
    // Along the normal, every point of the wall body approaches the center of A as the point there
    // does.
    const Vec3d u = solid.motion.linear - cross(solid.motion.angular, d) - a.motion.linear;
    const double reach = a.radius + envelope + range.h * norm(u);
    const MeshInfo& info = walls.meshes.meshes[solid.mesh];
    visit_sphere_mesh(
        walls.meshes, info, rotate_back(solid.orientation, -d), reach,
        [&](Index t, const Vec3d& offset, const Vec3d& normal) {
          const ContactGeometry g = mesh_contact(a, solid, d, offset, normal);
          if (is_listed(g.gap, separation_speed(g, a.motion, solid.motion), envelope, range.h)) {
            emit(solid.first_element + static_cast<std::uint32_t>(t - info.first_triangle));
          }
        });
  }
}

/// Geometry of the wall contact an element names, and the wall body.
template <ShapeMix kMix, class Real>
SCREE_HD ContactGeometry wall_contact(const WallView<Real>& walls, const ContactRange& range,
                                      const ContactKeys& keys, const BodySample& a,
                                      std::uint32_t element, Index& body_b) {
  if (kMix == ShapeMix::spheres_and_planes || element < keys.solid_begin) {
    const std::uint32_t slot = element - keys.wall_begin;
    const WallPlane& plane = walls.planes[slot / kPlaneSlots];
    body_b = plane.body;
    return plane_contact<kMix>(a, plane, static_cast<int>(slot % kPlaneSlots));
  }
  Index k = static_cast<Index>(walls.solids.size) - 1;
  while (k > 0 && element < walls.solids[k].first_element) --k;
  const WallSolid& solid = walls.solids[k];
  body_b = solid.body;
  const Vec3d d = minimum_image(solid.center - a.position, range.period);
  if (solid.kind == ShapeKind::box) {
    return sphere_box(d, a.radius, solid.orientation, solid.half_extents);
  }
  const MeshInfo& info = walls.meshes.meshes[solid.mesh];
  const auto t = info.first_triangle + static_cast<Index>(element - solid.first_element);
  Vec3d offset, normal;
  sphere_mesh_triangle(walls.meshes, info, t, rotate_back(solid.orientation, -d), offset, normal);
  return mesh_contact(a, solid, d, offset, normal);
}

}  // namespace scree
