#pragma once
// Contacts of one free body with solid walls, such as boxes and meshes.

#include "kernels/narrow_phase/convex_on_mesh.h"
#include "kernels/narrow_phase/mesh_way.h"
#include "kernels/narrow_phase/same_list.h"
#include "kernels/narrow_phase/wall_contacts.h"

namespace scree {

/// Whether a point is within reach of the box about a solid, in world axes.
/// @param d  from the point to the center of the solid [m]
SCREE_HD inline bool is_near_box(const WallSolid& solid, const Vec3d& d, double reach) {
  bool is_near = true;
  for (int k = 0; k < 3; ++k) {
    is_near = is_near && std::abs(d[k] + solid.middle[k]) <= solid.half[k] + reach;
  }
  return is_near;
}

/// Sphere A on a mesh, from the contact point found in the frame of the mesh.
/// @param d               center of A to the center of the mesh [m]
/// @param offset, normal  see MeshPoint
SCREE_HD inline ContactGeometry mesh_contact(const BodySample& a, const WallSolid& solid,
                                             const Vec3d& d, const Vec3d& offset,
                                             const Vec3d& normal) {
  const Vec3d world = rotate(solid.orientation, offset);
  return sphere_surface_point(world, rotate(solid.orientation, normal), -world - d, a.radius);
}

/// Sphere A and a box or mesh wall, in all images that it can touch.
template <class Real>
struct SphereOnSolid {
  const MeshView<Real>& meshes;
  const WallSolid& solid;
  const ContactRange& range;
  const BodySample& a;
  double envelope;           ///< contacts are listed up to this gap [m]
  double slack = 0;          ///< what is looked at beyond it [m]
  SameList* same = nullptr;  ///< notes what is decided; null: nothing does

  /// Calls emit(element) for each contact, or emit.way(element, plane) for one that is met on the way, ascending.
  template <class Emit>
  SCREE_HD void visit(Emit& emit) const {
    const WallImages images = reached_images();
    if (solid.kind == shapes::Box::kind) visit_box(images, emit);
    if (solid.kind == shapes::Mesh::kind) visit_mesh(images, emit);
  }

  /// Geometry of the contact with this element.
  /// @param way  the plane of one that is met on the way; null: another
  SCREE_HD ContactGeometry geometry(std::uint32_t element, const HoldingPlane* way) const {
    const std::uint32_t slot = element - solid.first_element;
    const Vec3d d = center_of(slot / solid.slots);
    if (solid.kind == shapes::Box::kind) {
      const ContactGeometry g = sphere_box(d, a.radius, solid.orientation, solid.half_extents);
      return sphere_box_on_way(g, d, range.h * wall_speed(d), a.radius, solid.orientation,
                               solid.half_extents);
    }
    if (way != nullptr) return mesh_contact(a, solid, d, way->height * way->normal, way->normal);
    const MeshInfo& info = meshes.meshes[solid.mesh];
    const auto t = info.first_triangle + static_cast<Index>(slot % solid.slots);
    MeshPoint point;
    sphere_mesh_triangle(meshes, info, t, in_mesh(d), point);
    return mesh_contact(a, solid, d, point.offset, point.normal);
  }

  /// Whether A may have a contact.
  SCREE_HD bool is_near() const {
    bool is_any = false;
    reached_images().for_each(range.period, [&](std::uint32_t image) {
      const Vec3d d = center_of(image);
      if (!is_near_box(solid, d, farthest_reach())) return;
      is_any = is_any || solid.kind != shapes::Mesh::kind ||
               is_near_mesh(meshes, meshes.meshes[solid.mesh], in_mesh(d), reach(d));
    });
    return is_any;
  }

 private:
  SCREE_HD Vec3d center_of(std::uint32_t image) const {
    return image_of_wall(solid, range.period, a.position, image);
  }
  /// Center of the sphere in the frame of the mesh. @param d  center of A to that of the mesh
  SCREE_HD Vec3d in_mesh(const Vec3d& d) const { return rotate_back(solid.orientation, -d); }
  SCREE_HD bool lists(double needed) const {
    return same != nullptr ? same->lists(needed, envelope) : needed <= envelope;
  }
  SCREE_HD bool is_contact(const ContactGeometry& g) const {
    return lists(needed_envelope(g.gap, separation_speed(g, a.motion, solid.motion), range.h));
  }
  /// Along a normal, every point of the wall body approaches the center of A as the point
  /// there does [m/s].
  SCREE_HD Vec3d wall_speed(const Vec3d& d) const {
    return solid.motion.linear - cross(solid.motion.angular, d) - a.motion.linear;
  }
  /// How far A may come to touch within the step [m].
  SCREE_HD double reach(const Vec3d& d) const {
    return a.radius + envelope + slack + range.h * norm(wall_speed(d));
  }
  /// The same whichever image it is that touches.
  SCREE_HD double farthest_reach() const {
    const double turn = range.h * norm(solid.motion.angular);
    const double way = range.h * norm(solid.motion.linear - a.motion.linear) +
                       turn * norm(solid.middle) + turn * norm(solid.half);
    return (a.radius + envelope + slack + way) / (1 - (turn < 0.5 ? turn : 0.5));
  }

  SCREE_HD WallImages reached_images() const {
    if (!(range.period.x > 0 || range.period.y > 0 || range.period.z > 0)) return {};
    return {solid, range.period, a.position, farthest_reach()};
  }

  template <class Emit>
  SCREE_HD void visit_box(const WallImages& images, Emit& emit) const {
    const auto contact = [&](std::uint32_t image, auto&& found) {
      const Vec3d d = center_of(image);
      const ContactGeometry g = sphere_box(d, a.radius, solid.orientation, solid.half_extents);
      if (is_contact(g)) found(d, g);
    };
    HoldingPlanes held;
    if (!images.is_one()) {
      images.for_each(range.period, [&](std::uint32_t image) {
        contact(image, [&](const Vec3d&, const ContactGeometry& g) {
          held.add({-g.normal, g.gap + a.radius}, image, 0);
        });
      });
    }
    images.for_each(range.period, [&](std::uint32_t image) {
      contact(image, [&](const Vec3d& d, const ContactGeometry& g) {
        const auto covers = [&](const HoldingPlane& plane) {
          const Vec3d n = rotate_back(solid.orientation, plane.normal);
          double top = dot(plane.normal, d);
          for (int k = 0; k < 3; ++k) top += std::abs(n[k]) * solid.half_extents[k];
          return plane.height + top <= kHiddenRise * a.radius;
        };
        if (held.other_image_hides(g.gap + a.radius, image, covers)) return;
        emit(solid.first_element + image * solid.slots);
      });
    });
  }

  /// Whether a contact with what is closest at the start is listed. Where the step leads farther,
  /// on_way() finds what is beyond the envelope, and from where it is met.
  SCREE_HD bool is_met(const ContactGeometry& g, bool is_fast) const {
    return is_fast ? lists(g.gap) : is_contact(g);
  }

  /// Calls found(t, point, g) for the listed contacts with what is closest at the start.
  template <class Found>
  SCREE_HD void closest_points(const Vec3d& d, bool is_fast, Found&& found) const {
    visit_sphere_mesh(
        meshes, meshes.meshes[solid.mesh], in_mesh(d),
        is_fast ? a.radius + envelope + slack : reach(d), [&](Index t, const MeshPoint& point) {
          const ContactGeometry g = mesh_contact(a, solid, d, point.offset, point.normal);
          if (is_met(g, is_fast)) found(t, point, g);
        });
  }

  template <class Emit>
  SCREE_HD void visit_mesh(const WallImages& images, Emit& emit) const {
    const MeshInfo& info = meshes.meshes[solid.mesh];
    const bool is_one = images.is_one();
    HoldingPlanes held;
    WayContacts found;
    const bool fast = is_fast();
    if (!is_one || fast) held = planes(images);
    if (fast) found = on_way(images, held);
    int next = 0;
    const auto emit_found = [&](std::uint32_t before) {
      for (; next < found.count && found.contact[next].element < before; ++next) {
        emit.way(found.contact[next].element, found.contact[next].plane);
      }
    };
    const auto emit_in_order = [&](std::uint32_t element) {
      emit_found(element);
      if (next < found.count && found.contact[next].element == element) ++next;
      emit(element);
    };
    if (is_one && fast && held.is_all) {
      for (int k = 0; k < held.count; ++k) emit_in_order(held.element[k]);
      emit_found(~0u);
      return;
    }
    images.for_each(range.period, [&](std::uint32_t image) {
      const Vec3d d = center_of(image);
      closest_points(d, fast, [&](Index t, const MeshPoint& point, const ContactGeometry& g) {
        const auto covers = [&](const HoldingPlane& plane) {
          return is_below(meshes, t, point.feature, point.index, in_mesh(d), plane,
                          kHiddenRise * a.radius);
        };
        if (!is_one && held.other_image_hides(g.gap + a.radius, image, covers)) return;
        emit_in_order(mesh_element(solid, info, image, t));
      });
    });
    emit_found(~0u);
  }

  /// Whether the step may lead from one part of a mesh to another: within half the envelope
  /// it does not matter.
  SCREE_HD bool is_fast() const {
    return range.h * norm(wall_speed(center_of(nearest_image()))) > 0.5 * range.envelope;
  }
  SCREE_HD std::uint32_t nearest_image() const {
    return static_cast<std::uint32_t>(image_count(range.period) / 2);
  }

  /// Planes of what is closest at the start, in the frame of the mesh.
  SCREE_HD HoldingPlanes planes(const WallImages& images) const {
    const MeshInfo& info = meshes.meshes[solid.mesh];
    HoldingPlanes held;
    const bool fast = is_fast();
    images.for_each(range.period, [&](std::uint32_t image) {
      closest_points(center_of(image), fast,
                     [&](Index t, const MeshPoint&, const ContactGeometry& g) {
                       held.add({rotate_back(solid.orientation, -g.normal), g.gap + a.radius},
                                image, mesh_element(solid, info, image, t));
                     });
    });
    return held;
  }

  /// What the sphere meets on its way.
  /// @param held  planes()
  SCREE_HD WayContacts on_way(const WallImages& images, HoldingPlanes held) const {
    const MeshInfo& info = meshes.meshes[solid.mesh];
    const double rise = kHiddenRise * a.radius;
    WayContacts found;
    while (found.count < WayContacts::kMaxContacts) {
      WayTouch first;
      std::uint32_t first_image = 0;
      Index first_triangle = 0;
      images.for_each(range.period, [&](std::uint32_t image) {
        const Vec3d d = center_of(image);
        const Vec3d free = rotate_back(solid.orientation, -range.h * wall_speed(d));
        const SphereWay s{in_mesh(d), held.allowed(free, a.radius), a.radius,
                          a.radius + range.envelope};
        visit_near_way(meshes, info, s, [&](Index t) {
          if (found.contains(mesh_element(solid, info, image, t))) return;
          const CornerOffsets corner(meshes, t, s.center);
          HiddenParts hidden = 0;
          for (int k = 0; k < held.count; ++k) {
            hidden |= parts_below(corner, held.plane[k], rise);
            if ((hidden & 1) != 0) return;
          }
          const WayTouch touch = touch_triangle(meshes, info.closed, t, s, hidden);
          if (!(touch.time < first.time)) return;
          first = touch;
          first_image = image;
          first_triangle = t;
        });
      });
      if (first.time > 1) break;
      found.insert({mesh_element(solid, info, first_image, first_triangle), first.plane});
      held.add(first.plane, first_image, 0);
    }
    return found;
  }
};

/// Body A and a solid wall, in all images that it can touch, by their pair function.
template <class Real>
struct PairOnSolid {
  const MeshView<Real>& meshes;
  const WallSolid& solid;
  const ContactRange& range;
  const BodySample& a;

  /// Calls emit(element) for each contact, ascending.
  /// @param envelope  contacts are listed up to this gap [m]
  /// @param slack     what is looked at beyond it [m]
  /// @param same      notes what is decided
  template <class Emit>
  SCREE_HD void visit(double envelope, double slack, SameList& same, Emit& emit) const {
    const double most = envelope + slack + farthest_way();
    const auto is_wanted = [&](const ContactGeometry& g) {
      return same.lists(
          needed_envelope(g.gap, separation_speed(g, a.motion, solid.motion), range.h), envelope);
    };
    reached_images(envelope + slack).for_each(range.period, [&](std::uint32_t image) {
      if (solid.kind == shapes::Mesh::kind) {
        on_mesh().visit(image, image_of_wall(solid, range.period, a.position, image), most,
                        is_wanted, emit);
        return;
      }
      with_pair(image, [&](auto pair, const auto& in_memory, const PairSide& first,
                           const PairSide& second, const Vec3d& d) {
        const auto listed = [&](const ContactGeometry& g) { return is_wanted(in_memory(g)); };
        list_features<decltype(pair)>(first, second, d, most, listed, [&](std::uint32_t feature) {
          emit(solid.first_element + image * solid.slots + feature);
        });
      });
    });
  }

  /// Geometry of the contact with this element.
  SCREE_HD ContactGeometry geometry(std::uint32_t element) const {
    const std::uint32_t slot = element - solid.first_element;
    if (solid.kind == shapes::Mesh::kind) {
      const Vec3d d = image_of_wall(solid, range.period, a.position, slot / solid.slots);
      return on_mesh().geometry(d, slot % solid.slots);
    }
    ContactGeometry g = no_contact();
    with_pair(slot / solid.slots, [&](auto pair, const auto& in_memory, const PairSide& first,
                                      const PairSide& second, const Vec3d& d) {
      g = in_memory(pair_contact<decltype(pair)>(first, second, d, slot % solid.slots));
    });
    return g;
  }

  /// Whether A may have a contact. @param envelope  as in visit()
  SCREE_HD bool is_near(double envelope) const {
    bool is_any = false;
    reached_images(envelope).for_each(range.period, [&](std::uint32_t image) {
      const Vec3d d = image_of_wall(solid, range.period, a.position, image);
      is_any = is_any || is_near_box(solid, d, a.radius + envelope + farthest_way());
    });
    return is_any;
  }

 private:
  SCREE_HD ConvexOnMesh<Real> on_mesh() const { return {meshes, solid, range, a}; }
  SCREE_HD double farthest_way() const {
    return range.h * most_speed(a, solid.motion, norm(solid.half) + norm(solid.middle));
  }
  SCREE_HD WallImages reached_images(double envelope) const {
    if (!(range.period.x > 0 || range.period.y > 0 || range.period.z > 0)) return {};
    return {solid, range.period, a.position, a.radius + envelope + farthest_way()};
  }
  /// Calls f(pair function, back to the order A, wall; first side, second side, first to second).
  template <class F>
  SCREE_HD void with_pair(std::uint32_t image, F&& f) const {
    const Vec3d d = image_of_wall(solid, range.period, a.position, image);
    const PairSide body = a.side(), wall = side();
    PairList::visit_bodies(a.kind, solid.kind, [&](auto pair, bool is_reversed) {
      const auto in_memory = [&](const ContactGeometry& g) { return is_reversed ? swapped(g) : g; };
      PairSide second = is_reversed ? body : wall;
      const Vec3d way = wall_way(solid, range, a, d);
      second.way = is_reversed ? -way : way;
      f(pair, in_memory, is_reversed ? wall : body, second, is_reversed ? -d : d);
    });
  }
  SCREE_HD PairSide side() const {
    return {0, solid.orientation, solid.half_extents, solid.kind, solid.hull, solid.rounded};
  }
};

/// Spheres meet boxes and meshes by SphereOnSolid, which follows their ways past the wall. All else
/// is for runs of any shapes.
SCREE_HD inline bool is_solid_of_spheres(ShapeKind kind) {
  return kind == shapes::Box::kind || kind == shapes::Mesh::kind;
}
SCREE_HD inline bool is_by_pair_function(const BodySample& a, const WallSolid& solid) {
  return a.kind != shapes::Sphere::kind || !is_solid_of_spheres(solid.kind);
}

/// Calls emit(element), or emit.way(element, plane), for each listed contact of body A with solid walls, in ascending
/// order: the triangles of a mesh are numbered along its tree.
/// @param envelope  contacts are listed up to this gap [m]
/// @return  for which others that holds
template <ShapeMix kMix, class Real, class Emit>
SCREE_HD SameList visit_solids(const WallView<Real>& walls, const ContactRange& range,
                               const BodySample& a, double envelope, Emit& emit) {
  const double slack = kSolidSlack * range.envelope;
  SameList same;
  same.to = envelope + slack;
  for (Index k = 0; k < static_cast<Index>(walls.solids.size); ++k) {
    if constexpr (kMix == ShapeMix::any) {
      if (is_by_pair_function(a, walls.solids[k])) {
        PairOnSolid<Real>{walls.meshes, walls.solids[k], range, a}.visit(envelope, slack, same,
                                                                         emit);
        continue;
      }
    }
    SphereOnSolid<Real>{walls.meshes, walls.solids[k], range, a, envelope, slack, &same}.visit(
        emit);
  }
  return same;
}

/// Whether body A may have contacts with solid walls; arguments as in visit_solids().
template <ShapeMix kMix, class Real>
SCREE_HD bool is_near_solids(const WallView<Real>& walls, const ContactRange& range,
                             const BodySample& a, double envelope) {
  for (Index k = 0; k < static_cast<Index>(walls.solids.size); ++k) {
    bool is_near = false;
    if (kMix == ShapeMix::any && is_by_pair_function(a, walls.solids[k])) {
      is_near = PairOnSolid<Real>{walls.meshes, walls.solids[k], range, a}.is_near(envelope);
    } else {
      is_near = SphereOnSolid<Real>{walls.meshes, walls.solids[k], range, a, envelope}.is_near();
    }
    if (is_near) return true;
  }
  return false;
}

/// Geometry of the contact with a solid wall.
/// @param way  see SphereOnSolid::geometry()
template <ShapeMix kMix, class Real>
SCREE_HD ContactGeometry solid_contact(const WallView<Real>& walls, const ContactRange& range,
                                       const WallSolid& solid, const BodySample& a,
                                       std::uint32_t element, const HoldingPlane* way) {
  if constexpr (kMix == ShapeMix::any) {
    if (is_by_pair_function(a, solid))
      return PairOnSolid<Real>{walls.meshes, solid, range, a}.geometry(element);
  }
  return SphereOnSolid<Real>{walls.meshes, solid, range, a, 0}.geometry(element, way);
}

}  // namespace scree
