#pragma once
// Islands of convex bodies that turn: as those of spheres (islands.h), with impacts at one or several points.
//
// An impact carries the discrete energy of each of its bodies. That of the part of the step which it ends is E_d of the part if it began
// with the step; a part that began with an impact has the energy which that impact left to the body, for the whole rest of
// the step. So the energy of all is the same before and after each impact, however many there are in a step.

#include "kernels/variational/islands.h"
#include "kernels/variational/rigid_fly.h"

namespace scree {

/// A body of an island, on its way through the step.
struct RigidMember {
  RigidPath node;
  Event next;
  Vec3d normal;       ///< of its last impact
  double energy = 0;  ///< of its last impact, with the potential [J]
  double way =
      -1;  ///< farthest from where it started, when the island is done [m]; negative: it is not
  Index body = 0;  ///< in storage
  Index island = 0;
  Index impacts = 0;
  Index of_walls = 0;
  Index grazing = 0;
  Index sinks = 0;  ///< impacts since the last one at which nothing approached
};

/// Works through islands of bodies that turn.
struct RunRigidIslands : WorkThroughIslands<RunRigidIslands, RigidStage, RigidMember> {
  static constexpr const char* name = "run_rigid_islands";

  SCREE_HD void set_out(RigidMember& m) const {
    m.node = stage.ways[m.body];
    m.next = {};
    m.normal = {};
    m.energy = 0;
    m.way = -1;
    m.impacts = m.of_walls = m.grazing = m.sinks = 0;
  }
  SCREE_HD void find(Index p) const {
    RigidMember& m = member[p];
    const Index island = m.island;
    double least_gap = kNever;
    const auto node_of = [&](Index k, Index& sinks) {
      const Index at = member_of(k, island);
      if (at < 0) return stage.way_of(k);
      sinks = member[at].sinks;
      return member[at].node;
    };
    m.next = stage.next(m.body, m.node, m.sinks, node_of, least_gap);
  }
  SCREE_HD bool is_stuck(Index p) const { return member[p].sinks > kMostSinks; }

  /// After an impact of member p: what it, and those it may meet now, meet next.
  SCREE_HD void find_again(Index p) const {
    find(p);
    const RigidMember& m = member[p];
    for (Offset q = stage.near.begin[m.body]; q < stage.near.begin[m.body + 1]; ++q) {
      const Index k = stage.near.other[q];
      const Index at = member_of(k, m.island);
      if (at < 0) continue;
      RigidMember& other = member[at];
      if (other.next.partner == m.body) {
        find(at);
        continue;
      }
      double least_gap = kNever;
      const Index sinks = m.sinks > other.sinks ? m.sinks : other.sinks;
      const double time = stage.pair_time(k, other.node, m.body, m.node, sinks, least_gap);
      if (time < kNever && stage.comes_before(time, m.body, other.next))
        other.next = {time, m.body};
    }
  }

  /// What an impact sees of a body, at the time of the impact.
  SCREE_HD ImpactBody body_at(const RigidMember& m, double t) const {
    const BodyPose pose = m.node.pose(t);
    ImpactBody b;
    b.mass = 1 / stage.bodies.inv_mass[m.body];
    b.moments = m.node.moments;
    b.orientation = pose.orientation;
    b.momentum = b.mass * m.node.velocity_at(t);
    b.spin = rotate(m.node.node.orientation, m.node.momentum);
    b.gravity = m.node.acceleration;
    return b;
  }
  SCREE_HD double potential(const RigidMember& m, const ImpactBody& b, double t) const {
    return -b.mass * dot(b.gravity, m.node.position(t));
  }
  /// The discrete energy of the part of the step that ends, with the potential [J].
  SCREE_HD double energy_before(const RigidMember& m, const ImpactBody& b, double t) const {
    return m.impacts > 0 ? m.energy : b.energy(t - m.node.start) + potential(m, b, t);
  }

  /// The node after an impact. @param b  as the impact left it
  SCREE_HD void go_on(RigidMember& m, const ImpactBody& b, double t) const {
    RigidPath next = m.node;
    next.start = t;
    next.node = m.node.pose(t);
    next.velocity = b.velocity();
    next.momentum = b.turned_spin();
    m.energy = b.energy(stage.h - t) + potential(m, b, t);
    m.node = next;
    m.node.bound_rotation(stage.h);
    pass(m, m.node.node.position);
    ++m.impacts;
    m.sinks = 0;
  }

  /// Adds the points at which two parts touch. @return  whether they do
  template <class Approach>
  SCREE_HD static bool touch(const Approach& approach, double t, Index sinks, RigidImpact& impact,
                             Vec3d& normal) {
    const Nearness near = approach.nearest(t);
    const double most = RigidStage::touch(approach, sinks);
    if (near.gap > 2 * most) return false;
    const ImpactPoints found = impact_points(approach, t, near, most);
    for (int k = 0; k < found.count; ++k) impact.points.add(found.point[k]);
    normal = near.normal;
    return true;
  }

  /// Two free bodies.
  SCREE_HD void meet(Index one, Index other, double t) const {
    const bool is_swapped = member[other].body < member[one].body;
    const Index p = is_swapped ? other : one, q = is_swapped ? one : other;
    RigidMember &a = member[p], &b = member[q];
    const Index sinks = a.sinks > b.sinks ? a.sinks : b.sinks;
    RigidImpact impact;
    impact.a = body_at(a, t);
    impact.b = body_at(b, t);
    Vec3d normal{0, 0, 1};
    stage.visit_parts(a.body, a.node, b.body, b.node,
                      [&](const ConvexApproach& pair) { touch(pair, t, sinks, impact, normal); });
    const double at_a = potential(a, impact.a, t), at_b = potential(b, impact.b, t);
    const double energy =
        energy_before(a, impact.a, t) + energy_before(b, impact.b, t) - at_a - at_b;
    const ImpactResult done =
        impact.collide(energy, stage.h - t, stage.restitution_of(a.body, b.body));
    if (done.outcome == ImpactOutcome::none) {
      ++a.sinks, ++b.sinks;
    } else {
      go_on(a, impact.a, t), go_on(b, impact.b, t);
      a.normal = b.normal = normalized(done.impulse, normal);
      a.grazing += done.outcome == ImpactOutcome::grazing ? 1 : 0;
    }
    find_again(p);
    find_again(q);
  }

  /// One body and all walls that it touches at the time, or a fixed sphere.
  SCREE_HD void meet_walls(Index p, const Event& event) const {
    RigidMember& m = member[p];
    const double t = event.time;
    RigidImpact impact;
    impact.a = body_at(m, t);
    double restitution = 1;
    // A wall is B: its place in storage is behind those of free bodies.
    Vec3d normal{0, 0, 1};
    if (event.partner == kWall) {
      stage.visit_walls(m.body, m.node, t, t, [&](const auto& approach, Index wall, double) {
        if (!touch(approach, t, m.sinks, impact, normal)) return;
        const double own = stage.restitution_of_wall(m.body, wall);
        if (own < restitution) restitution = own;
      });
    } else {
      restitution = stage.restitution_of(m.body, event.partner);
      stage.visit_parts(
          m.body, m.node, event.partner, stage.way_of(event.partner),
          [&](const ConvexApproach& pair) { touch(pair, t, m.sinks, impact, normal); });
    }
    const double energy = energy_before(m, impact.a, t) - potential(m, impact.a, t);
    const ImpactResult done = impact.collide(energy, stage.h - t, restitution);
    if (done.outcome == ImpactOutcome::none) {
      ++m.sinks;
    } else {
      go_on(m, impact.a, t);
      m.normal = normalized(done.impulse, normal);
      m.grazing += done.outcome == ImpactOutcome::grazing ? 1 : 0;
      ++m.of_walls;
      // It would be back within the step, slower each time.
      if (restitution < 1 &&
          restitution * done.approach_speed < 0.5 * stage.h * dot(stage.gravity, m.normal)) {
        atomic_min(&faults->resting, id(p));
      }
    }
    find_again(p);
  }

  SCREE_HD Vec3d end_of(const RigidMember& m) const { return m.node.position(stage.h); }
};

template <>
struct RunOf<RigidStage> {
  using Type = RunRigidIslands;
};

/// Writes where members are after the step. Of a body with one impact it also checks the closest-point identity for its
/// center, see FinishIslands.
struct FinishRigidIslands {
  static constexpr const char* name = "finish_rigid_islands";
  RigidStage stage;
  Span<const RigidMember> member;
  RigidStates after;

  SCREE_HD IslandSums operator()(Index p) const {
    const RigidMember& m = member[p];
    after.take(m.body, m.node, stage.h);
    IslandSums sums;
    sums.half_impacts = m.impacts + m.of_walls;
    sums.grazing = m.grazing;
    if (m.impacts == 1) {
      const double h = stage.h, alpha = m.node.start / h;
      const Vec3d start = stage.bodies.position[m.body];
      const Vec3d chord = (1 - alpha) * start + alpha * after.x[m.body];
      const Vec3d d =
          m.node.node.position - chord + (0.5 * alpha * (1 - alpha) * h * h) * stage.gravity;
      sums.identity_error = norm(d - dot(d, m.normal) * m.normal);
    }
    return sums;
  }
};

}  // namespace scree
