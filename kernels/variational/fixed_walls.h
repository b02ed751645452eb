#pragma once
// Fixed walls as sets of convex parts: planes, convex solids, triangles of meshes. What of a part is nearest to the
// center of a sphere may be a face, an edge or a corner: the normal is the direction from there to the center.

#include "kernels/narrow_phase/solid_walls.h"
#include "kernels/variational/impact_time.h"
#include "shapes/shape_list.h"

namespace scree {

/// Gap of a sphere to what lies behind a plane.
struct PlaneGap {
  Vec3d point, normal;
  double radius;
  SCREE_HD double operator()(const Vec3d& x, Vec3d& n) const {
    n = normal;
    return dot(x - point, normal) - radius;
  }
};

/// Gap of a sphere to a convex body. @tparam Closest  closest(x): point of it nearest to x
template <class Closest>
struct ConvexGap {
  Closest closest;
  double radius;
  SCREE_HD double operator()(const Vec3d& x, Vec3d& n) const {
    const Vec3d offset = x - closest(x);
    const double distance = norm(offset);
    n = distance > 0 ? (1 / distance) * offset : Vec3d{0, 0, 1};
    return distance - radius;
  }
};
template <class Closest>
ConvexGap(Closest, double) -> ConvexGap<Closest>;

struct ClosestOnTriangle {
  Vec3d a, b, c;
  SCREE_HD Vec3d operator()(const Vec3d& x) const { return closest_on_triangle(x, a, b, c).point; }
};

/// Of a convex solid.
template <class S>
struct ClosestOnSolid {
  const WallSolid& solid;
  SCREE_HD Vec3d operator()(const Vec3d& x) const {
    if constexpr (std::is_same_v<S, shapes::Hull>) {
      return shapes::nearest_of_hull(solid.hull, x);
    } else if constexpr (std::is_same_v<S, shapes::Cone>) {
      return shapes::nearest_of_cone(solid.half_extents, x);
    } else if constexpr (requires { S::nearest(solid.half_extents, x); }) {
      return S::nearest(solid.half_extents, x);
    } else {
      return S::nearest(solid, x);
    }
  }
};

/// Solids that ClosestOnSolid knows.
template <class S>
inline constexpr bool kIsConvexWall = std::is_same_v<S, shapes::Hull> ||
                                      std::is_same_v<S, shapes::Cone> ||
                                      requires(const WallSolid& solid, const Vec3d& x) {
  S::nearest(solid.half_extents, x);
}
|| requires(const WallSolid& solid, const Vec3d& x) { S::nearest(solid, x); };

/// @tparam kSolids  whether there are walls that are not planes
template <bool kSolids>
struct FixedWalls {
  WallView<double> walls;
  Vec3d period;  ///< [m]; zero: not periodic

  /// Calls meet(flight, gap, turn, body) for each part that a falling sphere may touch: its flight and gap(x, n)
  /// in a frame that `turn` brings to the world, and the wall body.
  template <class Meet>
  SCREE_HD void visit(const Flight& f, double horizon, double radius, Meet&& meet) const {
    for (Offset k = 0; k < walls.planes.size; ++k) {
      const WallPlane& plane = walls.planes[k];
      meet(f, PlaneGap{plane.point, plane.normal, radius}, Quatd{}, plane.body);
    }
    if constexpr (kSolids) {
      const double reach = 1.001 * radius + horizon * (norm(f.v) + 0.5 * horizon * norm(f.g));
      for (Offset k = 0; k < walls.solids.size; ++k)
        visit_solid(f, horizon, radius, reach, walls.solids[k], meet);
    }
  }

  /// First time in [0, horizon] at which the sphere touches a wall; kNever.
  /// @param least_gap  lowered to the gap to a wall that it may touch now [m]
  SCREE_HD double time(const Flight& f, double horizon, double radius, double& least_gap) const {
    double first = kNever;
    visit(f, horizon, radius, [&](const Flight& own, const auto& gap, const Quatd&, Index) {
      Vec3d n;
      const double d = gap(own.x, n);
      if (d < least_gap) least_gap = d;
      const double limit = first < horizon ? first : horizon;
      const double s = time_to_touch(own, limit, touching_gap(size_of(own, radius)), gap);
      if (s < first) first = s;
    });
    return first;
  }

  /// Calls touch(normal, body) for each part that the sphere touches now and approaches.
  template <class Touch>
  SCREE_HD void touched(const Flight& f, double radius, Touch&& touch) const {
    visit(f, 0, radius, [&](const Flight& own, const auto& gap, const Quatd& turn, Index body) {
      Vec3d n;
      if (!(gap(own.x, n) <= simultaneous_gap(size_of(own, radius)))) return;
      const Vec3d normal = rotate(turn, n);
      if (dot(normal, f.v) < 0) touch(normal, body);
    });
  }

 private:
  SCREE_HD static double size_of(const Flight& f, double radius) {
    return std::abs(f.x.x) + std::abs(f.x.y) + std::abs(f.x.z) + radius;
  }

  template <class Meet>
  SCREE_HD void visit_solid(const Flight& f, double horizon, double radius, double reach,
                            const WallSolid& solid, Meet& meet) const {
    WallImages images;
    if (period.x > 0 || period.y > 0 || period.z > 0)
      images = WallImages(solid, period, f.x, reach);
    images.for_each(period, [&](std::uint32_t image) {
      const Vec3d d = image_of_wall(solid, period, f.x, image);
      if (!is_near_box(solid, d, reach)) return;
      const Flight own{rotate_back(solid.orientation, -d), rotate_back(solid.orientation, f.v),
                       rotate_back(solid.orientation, f.g)};
      if (solid.kind == shapes::Mesh::kind) {
        visit_mesh(own, horizon, radius, solid, meet);
        return;
      }
      ShapeList::visit(solid.kind, [&](auto shape) {
        using S = decltype(shape);
        if constexpr (kIsConvexWall<S>) {
          meet(own, ConvexGap<ClosestOnSolid<S>>{{solid}, radius}, solid.orientation, solid.body);
        }
      });
    });
  }

  template <class Meet>
  SCREE_HD void visit_mesh(const Flight& f, double horizon, double radius, const WallSolid& solid,
                           Meet& meet) const {
    const MeshView<double>& mesh = walls.meshes;
    const SphereWay past{f.x, f.place(horizon) - f.x, radius, 1.001 * radius + f.sag(horizon)};
    visit_near_way(mesh, mesh.meshes[solid.mesh], past, [&](Index t) {
      const MeshTriangle& triangle = mesh.triangles[t];
      meet(f,
           ConvexGap<ClosestOnTriangle>{
               {mesh.points[triangle.vertex[0]], mesh.points[triangle.vertex[1]],
                mesh.points[triangle.vertex[2]]},
               radius},
           solid.orientation, solid.body);
    });
  }
};

}  // namespace scree
