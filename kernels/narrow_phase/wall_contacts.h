#pragma once
// Contacts of one free body with half spaces and the faces of containers. Those with solid walls, such as boxes and
// meshes, are in solid_walls.h.

#include "kernels/broad_phase/binning.h"
#include "kernels/contact/contact_key.h"
#include "kernels/narrow_phase/body_pairs.h"
#include "kernels/narrow_phase/mesh_view.h"

namespace scree {

template <class Real>
struct WallView {
  Span<const WallPlane> planes;
  Span<const WallSolid> solids;
  MeshView<Real> meshes;
};

/// Contact of body A with a plane. @param corner  below plane_corners()
template <ShapeMix kMix>
SCREE_HD ContactGeometry plane_contact(const BodySample& a, const WallPlane& plane, int corner) {
  const double height = dot(a.position - plane.point, plane.normal);
  const Vec3d d = plane.center - a.position;
  if constexpr (kMix != ShapeMix::any) {
    return sphere_half_space(height, plane.normal, d, a.radius);
  } else {
    ContactGeometry g = no_contact();
    PairList::visit_plane(a.kind, [&](auto pair) {
      g = decltype(pair)::contact(a.side(), height, plane.normal, d, corner);
    });
    return g;
  }
}

/// Contacts that body A may have with one plane.
template <ShapeMix kMix>
SCREE_HD int plane_corners([[maybe_unused]] const BodySample& a) {
  int corners = 1;
  if constexpr (kMix == ShapeMix::any) {
    corners = 0;
    PairList::visit_plane(a.kind, [&](auto pair) {
      static_assert(decltype(pair)::kCorners <= kPlaneSlots);
      corners = decltype(pair)::kCorners;
    });
  }
  return corners;
}

/// Whether a body may have contacts with a plane. @param inflated  its inflated radius [m], see inflated_radius()
SCREE_HD inline bool is_near_plane(const WallPlane& plane, const Vec3d& position, double envelope,
                                   double inflated) {
  // Half of the envelope, and the way of the body in one step, are in the inflated radius already.
  return plane.moves || !(dot(position - plane.point, plane.normal) > inflated + 0.5 * envelope);
}

/// Calls emit(element) for each listed contact of body A with planes, in ascending order.
/// @param envelope  contacts are listed up to this gap [m]
/// @param inflated  inflated radius of A [m], see inflated_radius()
template <ShapeMix kMix, class Emit>
SCREE_HD void visit_planes(Span<const WallPlane> planes, const ContactRange& range,
                           const ContactKeys& keys, const BodySample& a, double envelope,
                           double inflated, Emit&& emit) {
  for (Index p = 0; p < static_cast<Index>(planes.size); ++p) {
    const WallPlane& plane = planes[p];
    if (!is_near_plane(plane, a.position, envelope, inflated)) continue;
    const int corners = plane_corners<kMix>(a);
    for (int corner = 0; corner < corners; ++corner) {
      const ContactGeometry g = plane_contact<kMix>(a, plane, corner);
      if (g.gap > envelope &&
          !is_listed(g.gap, separation_speed(g, a.motion, plane.motion), envelope, range.h)) {
        continue;
      }
      emit(keys.plane_element(p, corner));
    }
  }
}

/// Geometry of the contact with a plane an element names, and the wall body.
template <ShapeMix kMix>
SCREE_HD ContactGeometry plane_contact(Span<const WallPlane> planes, const ContactKeys& keys,
                                       const BodySample& a, std::uint32_t element, Index& body_b) {
  const std::uint32_t slot = element - keys.wall_begin;
  const WallPlane& plane = planes[slot / kPlaneSlots];
  body_b = plane.body;
  return plane_contact<kMix>(a, plane, static_cast<int>(slot % kPlaneSlots));
}

/// The box or mesh wall that an element names.
template <class Real>
SCREE_HD const WallSolid& solid_of(const WallView<Real>& walls, std::uint32_t element) {
  Index k = static_cast<Index>(walls.solids.size) - 1;
  while (k > 0 && element < walls.solids[k].first_element) --k;
  return walls.solids[k];
}

/// The wall body that an element names.
template <class Real>
SCREE_HD Index wall_body(const WallView<Real>& walls, const ContactKeys& keys,
                         std::uint32_t element) {
  if (element >= keys.solid_begin) return solid_of(walls, element).body;
  return walls.planes[(element - keys.wall_begin) / kPlaneSlots].body;
}

}  // namespace scree
