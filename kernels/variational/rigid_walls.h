#pragma once
// Fixed walls as convex bodies of any shape meet them: planes, convex solids, triangles of meshes.

#include "kernels/narrow_phase/solid_walls.h"
#include "kernels/variational/convex_sweep.h"
#include "kernels/variational/fixed_walls.h"

namespace scree {

/// When two balls whose distance d changes by the rate u and a steady acceleration may first touch, or before; kNever: not
/// until `horizon`.
/// @param sum  of the radii [m]
SCREE_HD inline double balls_may_touch(const Vec3d& d, const Vec3d& u, const Vec3d& acceleration,
                                       double sum, double horizon) {
  constexpr double kRoom = 1 + 1e-9;
  const double apart = norm(d) - kRoom * sum;
  if (!(apart > 0)) return 0;
  if (norm2(acceleration) == 0) {
    const double time = time_of_spheres(d, u, kRoom * sum);
    return time <= horizon ? time : kNever;
  }
  const double most = norm(u) + horizon * norm(acceleration);
  return apart <= most * horizon ? apart / (kRoom * most) : kNever;
}

/// The walls that a convex body may meet on its way.
struct RigidWalls {
  const FixedWalls<true>& all;

  /// Calls meet(approach, body, begin) for each part of a wall that the body may touch until `end`, not before `begin`.
  /// @param begin  since when the body is on its way [s]
  template <class Meet>
  SCREE_HD void visit(const SweptShape& shape, const RigidPath& path, double begin, double end,
                      Meet&& meet) const {
    const Vec3d x = path.position(begin), v = path.velocity_at(begin), g = path.acceleration;
    const double horizon = end - begin, radius = norm(shape.offset) + shape.radius;
    for (Offset k = 0; k < all.walls.planes.size; ++k) {
      const WallPlane& plane = all.walls.planes[k];
      const double height = dot(x - plane.point, plane.normal), rate = dot(v, plane.normal);
      const double fall = dot(g, plane.normal);
      const double down = (rate < 0 ? -rate : 0) + (fall < 0 ? -fall * horizon : 0);
      if (height - 1.001 * radius > down * horizon) continue;
      meet(PlaneApproach{shape, path, plane.point, plane.normal}, plane.body, begin);
    }
    const double reach = 1.001 * radius + horizon * (norm(v) + 0.5 * horizon * norm(g));
    for (Offset k = 0; k < all.walls.solids.size; ++k)
      visit_solid(all.walls.solids[k], shape, path, begin, end, x, reach, meet);
  }

 private:
  template <class Meet>
  SCREE_HD void visit_solid(const WallSolid& solid, const SweptShape& shape, const RigidPath& path,
                            double begin, double end, const Vec3d& x, double reach,
                            Meet& meet) const {
    WallImages images;
    if (all.period.x > 0 || all.period.y > 0 || all.period.z > 0)
      images = WallImages(solid, all.period, x, reach);
    images.for_each(all.period, [&](std::uint32_t image) {
      const Vec3d d = image_of_wall(solid, all.period, x, image);
      if (!is_near_box(solid, d, reach)) return;
      if (solid.kind == shapes::Mesh::kind) {
        visit_mesh(solid, d, shape, path, begin, end, x, reach, meet);
        return;
      }
      SweptShape wall;
      wall.side = {solid.half_extents.x, {},         solid.half_extents,
                   solid.kind,           solid.hull, solid.rounded};
      wall.radius = norm(solid.half_extents) + solid.rounded.reach();
      meet(ConvexApproach{shape, wall, path, RigidPath::fixed(x + d, solid.orientation)},
           solid.body, begin);
    });
  }

  template <class Meet>
  SCREE_HD void visit_mesh(const WallSolid& solid, const Vec3d& d, const SweptShape& shape,
                           const RigidPath& path, double begin, double end, const Vec3d& x,
                           double reach, Meet& meet) const {
    const MeshView<double>& mesh = all.walls.meshes;
    const Vec3d start = rotate_back(solid.orientation, -d);
    const Vec3d way = rotate_back(solid.orientation, path.position(end) - x);
    const double sag = 0.125 * (end - begin) * (end - begin) * norm(path.acceleration);
    const double radius = norm(shape.offset) + shape.radius;
    const SphereWay past{start, way, radius, 1.001 * radius + sag};
    visit_near_way(mesh, mesh.meshes[solid.mesh], past, [&](Index t) {
      const MeshTriangle& triangle = mesh.triangles[t];
      const auto corner = [&](int k) {
        return x + d + rotate(solid.orientation, Vec3d(mesh.points[triangle.vertex[k]]));
      };
      Vec3d center;
      const SweptShape wall = SweptShape::triangle(corner(0), corner(1), corner(2), center);
      const Vec3d n = cross(wall.corner[1] - wall.corner[0], wall.corner[2] - wall.corner[0]);
      if (std::abs(dot(x - center, n)) > reach * norm(n)) return;
      meet(ConvexApproach{shape, wall, path, RigidPath::fixed(center, {})}, solid.body, begin);
    });
  }
};

}  // namespace scree
