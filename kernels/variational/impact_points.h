#pragma once
// The points at which two bodies touch at an impact: all of a face or an edge that are as near as the nearest ones.

#include "kernels/variational/convex_sweep.h"
#include "kernels/variational/rigid_impact.h"

namespace scree {

namespace variational_parts {

/// Lists contacts up to a gap [m].
struct IsTouching {
  double most;
  SCREE_HD bool operator()(const ContactGeometry& g) const { return g.gap <= most; }
};

}  // namespace variational_parts

/// Points of two bodies.
/// @param spread  how much farther apart than the nearest points those may be that meet with them [m]
[[gnu::noinline]] SCREE_HD inline ImpactPoints impact_points(const ConvexApproach& approach,
                                                             double time, const Nearness& near,
                                                             double spread) {
  const BodyPose pose_a = approach.path_a.pose(time), pose_b = approach.path_b.pose(time);
  const ConvexCore core_a = approach.a.core_at(pose_a, pose_a.position);
  const ConvexCore core_b = approach.b.core_at(pose_b, pose_a.position);
  const Vec3d between = pose_b.position - pose_a.position;
  CoreDistance distance = core_distance(core_a, core_b, 1e300);
  distance.normal = near.normal;
  ImpactPoints out;
  convex_contacts(CoreMeeting(core_a, core_b, distance), between, true, AllWanted{},
                  variational_parts::IsTouching{near.gap + spread},
                  [&](std::uint32_t, const ContactGeometry& g) {
                    // One point for both, so that no angular momentum is lost.
                    const Vec3d arm = g.arm_a + (0.5 * g.gap) * near.normal;
                    out.add({near.normal, arm, arm - between});
                  });
  if (out.count == 0) {
    const Vec3d arm = near.point - pose_a.position;
    out.add({near.normal, arm, arm - between});
  }
  return out;
}

/// Points of a body and a plane, whose arms are from a point on it.
[[gnu::noinline]] SCREE_HD inline ImpactPoints impact_points(const PlaneApproach& approach,
                                                             double time, const Nearness& near,
                                                             double spread) {
  const BodyPose pose = approach.path_a.pose(time);
  const Vec3d center = approach.a.center_at(pose), offset = center - pose.position;
  const PairSide side = approach.a.side_at(pose);
  const double height = dot(center - approach.origin, approach.up);
  ImpactPoints out;
  PairList::visit_plane(side.kind, [&](auto pair) {
    using P = decltype(pair);
    for (int corner = 0; corner < P::kCorners; ++corner) {
      const ContactGeometry g =
          P::contact(side, height, approach.up, approach.origin - center, corner);
      if (!(g.gap <= near.gap + spread)) continue;
      const Vec3d arm = offset + g.arm_a + (0.5 * g.gap) * near.normal;
      out.add({near.normal, arm, arm + pose.position - approach.origin});
    }
  });
  if (out.count == 0) {
    out.add({near.normal, near.point - pose.position, near.point - approach.origin});
  }
  return out;
}

}  // namespace scree
