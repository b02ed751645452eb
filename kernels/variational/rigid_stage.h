#pragma once
// What the programs of a step read when free bodies are convex and turn, and what of it a body meets first.

#include "kernels/bodies/parts.h"
#include "kernels/variational/impact_points.h"
#include "kernels/variational/rigid_walls.h"
#include "kernels/variational/stage.h"
#include "shapes/compound.h"

namespace scree {

/// How near bodies touch, as a part of their radii; and how much of that is left when an impact was found that
/// does not approach yet.
inline constexpr double kTouchPart = 1e-7, kSinkPart = 0.4;
/// How often in a row.
inline constexpr Index kMostSinks = 3;

struct RigidStage : Stage<true> {
  ShapeSet<double> shapes;
  PartSet<double> parts;                ///< of compounds
  PerBody<std::uint8_t> wall_material;  ///< of what walls name as their bodies
  Span<const RigidPath> ways;           ///< [owned] of the step, as if bodies met nothing

  SCREE_HD double restitution_of_wall(Index i, Index wall) const {
    return restitution[static_cast<Offset>(bodies.material[i]) * materials + wall_material[wall]];
  }

  SCREE_HD Index part_count(Index i) const {
    if (bodies.shape[i] < 0) return 1;
    const ShapeRecord<double>& record = shapes.records[bodies.shape[i]];
    if (record.kind != scree::shapes::Compound::kind) return 1;
    return parts.first[record.mesh + 1] - parts.first[record.mesh];
  }
  /// A part of a compound, or any other body.
  SCREE_HD SweptShape shape_of(Index i, Index part) const {
    SweptShape s;
    s.radius = bodies.radius[i];
    Index shape = bodies.shape[i];
    if (shape >= 0 && shapes.records[shape].kind == scree::shapes::Compound::kind) {
      const PartRecord<double>& own = parts.records[parts.first[shapes.records[shape].mesh] + part];
      shape = own.shape;
      s.radius = own.radius;
      s.offset = own.position;
      s.tilt = own.orientation;
    }
    s.side.radius = s.radius;
    s.side.kind = scree::shapes::Sphere::kind;
    if (shape < 0) return s;
    const ShapeRecord<double>& record = shapes.records[shape];
    s.side.kind = record.kind;
    s.side.half_extents = record.half_extents;
    s.side.rounded = record.rounded;
    if (scree::shapes::has_hull(record))
      s.side.hull = shapes.hulls.hull(record.mesh, record.half_extents.x);
    return s;
  }
  SCREE_HD RigidPath way_of(Index i) const {
    return is_free(i) ? ways[i] : RigidPath::fixed(bodies.position[i], bodies.orientation[i]);
  }

  SCREE_HD static double touch(double size, Index sinks) {
    double gap = kTouchPart * size;
    for (Index k = 0; k < sinks; ++k) gap *= kSinkPart;
    return gap;
  }
  SCREE_HD static double touch(const ConvexApproach& pair, Index sinks) {
    return touch(pair.a.radius + pair.b.radius, sinks);
  }
  SCREE_HD static double touch(const PlaneApproach& fall, Index sinks) {
    return touch(fall.a.radius, sinks);
  }

  /// Calls meet(approach) for each part of one body with each of the other; the lower place in storage is A, so that
  /// both sides see the same.
  template <class Meet>
  SCREE_HD void visit_parts(Index i, const RigidPath& a, Index k, const RigidPath& b,
                            Meet&& meet) const {
    const Index lower = k < i ? k : i, upper = k < i ? i : k;
    const RigidPath& path_a = k < i ? b : a;
    RigidPath path_b = k < i ? a : b;
    const double from = a.start > b.start ? a.start : b.start;
    const Vec3d x = path_a.position(from), y = path_b.position(from);
    path_b.node.position += x + between(x, y) - y;
    const Index parts_a = part_count(lower), parts_b = part_count(upper);
    for (Index p = 0; p < parts_a; ++p) {
      ConvexApproach pair{shape_of(lower, p), {}, path_a, path_b};
      for (Index q = 0; q < parts_b; ++q) {
        pair.b = shape_of(upper, q);
        meet(pair);
      }
    }
  }
  /// Calls meet(approach, wall body, begin) for each part of a body with each part of a wall that it may touch from
  /// `begin` to `end`.
  template <class Meet>
  SCREE_HD void visit_walls(Index i, const RigidPath& a, double begin, double end,
                            Meet&& meet) const {
    const Index count = part_count(i);
    for (Index p = 0; p < count; ++p) RigidWalls{walls}.visit(shape_of(i, p), a, begin, end, meet);
  }

  /// Whether a neighbor is a body that others meet; walls that have shapes are met as walls.
  SCREE_HD bool is_partner(Index k) const { return is_free(k) || bodies.shape[k] < 0; }

  /// When body i meets a wall; kNever. @param least_gap  lowered to that to a wall now [m]
  SCREE_HD double wall_time(Index i, const RigidPath& a, Index sinks, double& least_gap) const {
    double first = kNever;
    visit_walls(i, a, a.start, h, [&](const auto& approach, Index, double begin) {
      const double time = meeting(approach, begin, first < h ? first : h, sinks, least_gap);
      if (time < first) first = time;
    });
    return first;
  }

  /// When two bodies meet, if that is in the step; the same bits from both sides.
  SCREE_HD double pair_time(Index i, const RigidPath& a, Index k, const RigidPath& b, Index sinks,
                            double& least_gap) const {
    if (!is_partner(k)) return kNever;
    if (k < i) return pair_time_of(k, b, i, a, sinks, least_gap);
    return pair_time_of(i, a, k, b, sinks, least_gap);
  }

  /// The next impact of body i. @param node_of  node_of(k): way and sinks of a neighbor
  template <class NodeOf>
  SCREE_HD Event next(Index i, const RigidPath& a, Index sinks, NodeOf&& node_of,
                      double& least_gap) const {
    Event first;
    const double wall = wall_time(i, a, sinks, least_gap);
    if (wall < kNever) first = {wall, kWall};
    for (Offset q = near.begin[i]; q < near.begin[i + 1]; ++q) {
      const Index k = near.other[q];
      if (!is_partner(k)) continue;
      Index own = 0;
      const RigidPath b = node_of(k, own);
      const double time = pair_time(i, a, k, b, sinks > own ? sinks : own, least_gap);
      if (time < kNever && comes_before(time, k, first)) first = {time, k};
    }
    return first;
  }

 private:
  SCREE_HD double pair_time_of(Index i, const RigidPath& a, Index k, const RigidPath& b,
                               Index sinks, double& least_gap) const {
    const double from = a.start > b.start ? a.start : b.start;
    const Vec3d d = between(a.position(from), b.position(from));
    const Vec3d u = b.velocity_at(from) - a.velocity_at(from);
    const Vec3d bend = b.acceleration - a.acceleration;
    const double may = balls_may_touch(d, u, bend, sum_of_radii(i, k), h - from);
    if (!(may < kNever)) return kNever;
    const double begin = from + may, left = h - begin;
    const double speed = norm(u) + norm(bend) * (h - from);
    double first = kNever;
    visit_parts(i, a, k, b, [&](const ConvexApproach& pair) {
      const double reach_a = norm(pair.a.offset), reach_b = norm(pair.b.offset);
      if (reach_a + reach_b > 0) {
        const Vec3d between_parts =
            pair.b.center_at(pair.path_b.pose(begin)) - pair.a.center_at(pair.path_a.pose(begin));
        const double way = speed + reach_a * a.most_rate + reach_b * b.most_rate;
        if (norm(between_parts) > 1.001 * (pair.a.radius + pair.b.radius) + way * left) return;
      }
      const double time = meeting(pair, begin, first < h ? first : h, sinks, least_gap);
      if (time < first) first = time;
    });
    return first;
  }

  template <class Approach>
  SCREE_HD static double meeting(const Approach& approach, double begin, double end, Index sinks,
                                 double& least_gap) {
    // One that takes too many steps goes on from where it came to. Where that does not help, bodies meet there.
    constexpr int kMostParts = 10;
    Sweep found;
    found.time = begin;
    for (int part = 0; part < kMostParts; ++part) {
      found = sweep(approach, found.time, end, touch(approach, sinks));
      if (part == 0 && found.first_gap < least_gap) least_gap = found.first_gap;
      if (found.outcome != SweepOutcome::undecided) break;
    }
    return found.outcome == SweepOutcome::apart ? kNever : found.time;
  }
};

}  // namespace scree
