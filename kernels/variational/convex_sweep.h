#pragma once
// When two convex bodies meet on their ways, or a body and a plane, without ever passing it.
//
// A direction n(t) that separates two bodies bounds their distance from below: the least of the separations s = (y - x) . n
// of a point x of A and a point y of B. Each of them is a smooth function of time whose second derivative is below a bound
// K. So it lies above its chord between two times, less K w^2 / 2 times u (1 - u), w the length of the window and u the part of it;
// and with it the least of all:
//
//     (V3) s(t + u w) >= (1 - u) s(t) + u s(t + w) - K w^2 u (1 - u) / 2
//
// Until the first root of that nothing meets. There a new direction is found, which is that of the nearest points (GJK). The
// direction may stay, or turn with A or with B, as the normal of a face does, or be across an edge of A and one of B: what
// of these is free longest counts. Where two edges cross no other direction would let them leave each other.
// Close to an impact a step leaves an error of second order, so few are needed. This is conservative advancement (Mirtich,
// Impulse-based dynamic simulation, 1996) with a bound of second order in place of that by the largest speed, which also lets
// bodies that touch leave each other.
//
// A hit is where the distance is between half the tolerance and the whole. Bodies that begin nearer may leave; they are
// not nearer on their way than they were, but for a thousandth of the tolerance.

#include "kernels/narrow_phase/body_pairs.h"
#include "kernels/variational/rigid_path.h"

namespace scree {

/// A convex body, or a convex part of one, as a sweep sees it; or a triangle of a wall.
struct SweptShape {
  PairSide side;      ///< with the shape's kind; its orientation is not used
  double radius = 0;  ///< of a ball about its center, rounding included [m]
  Vec3d offset;       ///< of a part from the center of its body, in the frame of that [m]
  Quatd tilt;         ///< of a part to its body
  bool is_triangle = false;
  Vec3d corner[3];  ///< of a triangle, from its center, which is the mean [m]

  /// @param center  out: of the path that goes with it [m]
  SCREE_HD static SweptShape triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c,
                                      Vec3d& center) {
    SweptShape s;
    s.is_triangle = true;
    center = (1.0 / 3) * (a + b + c);
    const Vec3d x[3] = {a, b, c};
    for (int k = 0; k < 3; ++k) {
      s.corner[k] = x[k] - center;
      s.radius = norm(s.corner[k]) > s.radius ? norm(s.corner[k]) : s.radius;
    }
    return s;
  }

  SCREE_HD PairSide side_at(const BodyPose& pose) const {
    PairSide s = side;
    s.orientation = pose.orientation * tilt;
    return s;
  }
  SCREE_HD Vec3d center_at(const BodyPose& pose) const {
    return pose.position + rotate(pose.orientation, offset);
  }
  SCREE_HD ConvexCore core_at(const BodyPose& pose, const Vec3d& origin) const {
    const Vec3d center = center_at(pose) - origin;
    if (is_triangle) {
      const Vec3d n = normalized(cross(corner[1] - corner[0], corner[2] - corner[0]));
      return ConvexCore::triangle(center + corner[0], center + corner[1], center + corner[2], n);
    }
    if (side.kind == shapes::Sphere::kind) return core_of<shapes::Sphere>(side, center);
    return CoresOfAny::core(side_at(pose), center);
  }
  /// How far the farthest point that turns is from the center of its body [m]: what rounds a core does not turn.
  SCREE_HD double reach() const {
    const double rounding = side.kind == shapes::Sphere::kind    ? side.radius
                            : side.kind == shapes::Capsule::kind ? side.half_extents.x
                                                                 : side.rounded.radius;
    const double own = radius - rounding;
    return norm(offset) + (own > 0 ? own : 0);
  }
};

/// How two bodies lie at a time.
struct Nearness {
  double gap = 0;  ///< along the normal [m]; not more than the distance
  Vec3d normal;    ///< unit, from A to B
  Vec3d point;     ///< in the middle of the nearest points [m]
};

/// One direction in several frames, and what is measured along it in each.
struct FrameDirections {
  static constexpr int kMost = 4;  ///< that of the world, those of A and B, across two edges
  int count = 1;
  Vec3d direction[3];
  Vec3d edge_a, edge_b;  ///< unit, each in the frame of its body; the direction is across them
  double across = 0;     ///< length of their product
};
struct FrameValues {
  double value[FrameDirections::kMost] = {};
};

/// Two convex bodies on their ways. B may be a wall, which stays.
struct ConvexApproach {
  SweptShape a, b;
  RigidPath path_a, path_b;

  /// @param known  a direction that may be the normal, if it is not zero
  SCREE_HD Nearness nearest(double time, const Vec3d& known = {}) const {
    const BodyPose pose_a = path_a.pose(time);
    return nearness(a.core_at(pose_a, pose_a.position),
                    b.core_at(path_b.pose(time), pose_a.position), pose_a.position, known);
  }
  /// Where a direction of some frame is at a time.
  SCREE_HD Vec3d direction(double time, const FrameDirections& n, int frame) const {
    if (frame == 0) return n.direction[0];
    if (frame == 3)
      return normalized(cross(rotate(path_a.pose(time).orientation, n.edge_a),
                              rotate(path_b.pose(time).orientation, n.edge_b)));
    return rotate((frame == 1 ? path_a : path_b).pose(time).orientation, n.direction[frame]);
  }
  SCREE_HD FrameDirections directions(double time, const Vec3d& n) const {
    FrameDirections d;
    d.direction[0] = n;
    if (!path_a.turns() && !path_b.turns()) return d;
    const BodyPose pose_a = path_a.pose(time), pose_b = path_b.pose(time);
    d.direction[1] = rotate_back(pose_a.orientation, n);
    d.direction[2] = rotate_back(pose_b.orientation, n);
    d.count = 3;
    const ConvexCore core_a = a.core_at(pose_a, pose_a.position);
    const ConvexCore core_b = b.core_at(pose_b, pose_a.position);
    const CoreEdge p = core_a.edge_toward(n, kEdgeSlope), q = core_b.edge_toward(-n, kEdgeSlope);
    if (p.count != 2 || q.count != 2) return d;
    const Vec3d u = normalized(p.to - p.from), v = normalized(q.to - q.from);
    const Vec3d m = cross(u, v);
    const double length = norm(m), along = dot(m, n);
    if (!(length > 1e-2 && std::abs(along) > (1 - 1e-8) * length)) return d;
    d.edge_a = rotate_back(pose_a.orientation, along < 0 ? -u : u);
    d.edge_b = rotate_back(pose_b.orientation, v);
    d.across = length;
    d.count = 4;
    return d;
  }
  /// Of the surfaces along a direction [m].
  SCREE_HD FrameValues separations(double time, const FrameDirections& n) const {
    const BodyPose pose_a = path_a.pose(time), pose_b = path_b.pose(time);
    const ConvexCore core_a = a.core_at(pose_a, pose_a.position);
    const ConvexCore core_b = b.core_at(pose_b, pose_a.position);
    FrameValues s;
    s.value[0] = separation_of(core_a, core_b, n.direction[0]);
    if (n.count == 1) return s;
    s.value[1] = separation_of(core_a, core_b, rotate(pose_a.orientation, n.direction[1]));
    s.value[2] = separation_of(core_a, core_b, rotate(pose_b.orientation, n.direction[2]));
    if (n.count == 3) return s;
    const Vec3d m =
        cross(rotate(pose_a.orientation, n.edge_a), rotate(pose_b.orientation, n.edge_b));
    const double length = norm(m);
    // Of the product itself, over its length at first: this is what has a second derivative.
    if (length > 0)
      s.value[3] = length / n.across * separation_of(core_a, core_b, (1 / length) * m);
    return s;
  }
  /// How much longer the product of two edges may become in a window, as a part.
  SCREE_HD double stretch(double window, const FrameDirections& n, int frame) const {
    return frame < 3 ? 0 : window * (path_a.most_rate + path_b.most_rate) / n.across;
  }
  /// K in a window [m/s^2].
  SCREE_HD FrameValues bends(double time, double window, const FrameDirections& n) const {
    const double reach_a = a.reach(), reach_b = b.reach();
    const double own_a = path_a.change_of_turn(), own_b = path_b.change_of_turn();
    const double rate_a = path_a.most_rate, rate_b = path_b.most_rate;
    const Vec3d bend = path_b.acceleration - path_a.acceleration;
    FrameValues k;
    k.value[0] = std::abs(dot(bend, n.direction[0])) + reach_a * own_a + reach_b * own_b;
    if (n.count == 1) return k;
    const double most = norm(bend);
    const double speed = norm(path_b.velocity_at(time) - path_a.velocity_at(time)) + most * window;
    const double distance = norm(path_b.position(time) - path_a.position(time)) + speed * window;
    // Seen from a frame that turns with a body, that body stays, and the points of the other have all of it.
    k.value[1] = most + reach_b * own_b + 2 * (speed + reach_b * rate_b) * rate_a +
                 (distance + reach_b) * own_a;
    k.value[2] = most + reach_a * own_a + 2 * (speed + reach_a * rate_a) * rate_b +
                 (distance + reach_a) * own_b;
    if (n.count == 3) return k;
    // Of (y - x) . (u x v), u and v being edges.
    const double reach = distance + reach_a + a.radius + reach_b + b.radius;
    k.value[3] = (most + reach_a * own_a + reach_b * own_b +
                  2 * (speed + reach_a * rate_a + reach_b * rate_b) * (rate_a + rate_b) +
                  reach * (own_a + own_b + 2 * rate_a * rate_b)) /
                 n.across;
    return k;
  }

  SCREE_HD static double separation_of(const ConvexCore& a, const ConvexCore& b, const Vec3d& n) {
    return separation_along(a, b, n) - a.rounding - b.rounding;
  }
  SCREE_HD static Nearness nearness(const ConvexCore& a, const ConvexCore& b, const Vec3d& origin,
                                    const Vec3d& known) {
    const CoreDistance found = core_distance(a, b, 1e300);
    Nearness near;
    near.normal = found.normal;
    near.gap = separation_of(a, b, found.normal);
    if (near.gap < 1e-3 * (a.size() + b.size())) sharpen(a, b, found.separation, known, near);
    const Vec3d on_a = found.is_apart ? found.on_a : a.center + a.support(near.normal);
    near.point = origin + on_a + (a.rounding + 0.5 * near.gap) * near.normal;
    return near;
  }

 private:
  /// Up to which edges count as across a direction.
  static constexpr double kEdgeSlope = 1e-5;
  /// Of what GJK only comes near the nearest points.
  SCREE_HD static bool is_bent(const ConvexCore& core) {
    return core.is_curved() || core.is_round();
  }
  /// The direction of nearest points that all but touch is lost in rounding; that across the edges which they are on is not.
  /// @param length  of the nearest points of cores [m]
  /// @param known   another direction, if it is not zero
  SCREE_HD static void sharpen(const ConvexCore& a, const ConvexCore& b, double length,
                               const Vec3d& known, Nearness& near) {
    const Vec3d n = near.normal;
    const auto offer = [&](const Vec3d& across) {
      const double length = norm(across);
      if (!(length > 1e-6)) return;
      const Vec3d way = ((dot(across, n) < 0 ? -1 : 1) / length) * across;
      const double found = separation_of(a, b, way);
      if (!(found > near.gap)) return;
      near.gap = found;
      near.normal = way;
    };
    if (dot(known, n) > 0) offer(known);
    const CoreEdge p = a.edge_toward(n, kEdgeSlope), q = b.edge_toward(-n, kEdgeSlope);
    Vec3d along_a, along_b;
    if (p.count == 2) along_a = normalized(p.to - p.from);
    if (q.count == 2) along_b = normalized(q.to - q.from);
    if (p.count == 2 && q.count == 2) offer(cross(along_a, along_b));
    if (p.count == 2) offer(n - dot(n, along_a) * along_a);
    if (q.count == 2) offer(n - dot(n, along_b) * along_b);
    // On rims and round sides GJK may end before: the distance is the largest separation of all directions.
    const double distance = length - a.rounding - b.rounding;
    if (!(is_bent(a) || is_bent(b)) || near.gap >= distance - 0.01 * std::abs(distance)) return;
    constexpr double kDiagonal = 0.70710678118654752440;
    for (double step = 1e-3; step > 1e-10; step *= 0.5) {
      const Vec3d middle = near.normal, u = any_orthogonal(middle), v = cross(middle, u);
      for (int k = 0; k < 8; ++k) {
        const double x = k % 4 == 0 ? 1 : k % 4 == 2 ? 0 : kDiagonal;
        const double y = k % 4 == 0 ? 0 : k % 4 == 1 ? kDiagonal : k % 4 == 2 ? 1 : -kDiagonal;
        offer(middle + (k < 4 ? step : -step) * (x * u + y * v));
      }
    }
  }
};

/// A convex body and a plane that stays.
struct PlaneApproach {
  SweptShape a;
  RigidPath path_a;
  Vec3d origin;  ///< on the plane [m]
  Vec3d up;      ///< unit; bodies are on this side

  SCREE_HD Nearness nearest(double time, const Vec3d& /*known*/ = {}) const {
    const ConvexCore core = core_at(time);
    const Vec3d lowest = core.center + core.support(-up) - core.rounding * up;
    Nearness near;
    near.normal = -up;
    near.gap = dot(lowest, up);
    near.point = origin + lowest - (0.5 * near.gap) * up;
    return near;
  }
  SCREE_HD FrameDirections directions(double /*time*/, const Vec3d& n) const {
    FrameDirections d;
    d.direction[0] = n;
    return d;
  }
  SCREE_HD Vec3d direction(double /*time*/, const FrameDirections& n, int /*frame*/) const {
    return n.direction[0];
  }
  SCREE_HD FrameValues separations(double time, const FrameDirections& /*n*/) const {
    const ConvexCore core = core_at(time);
    return {{dot(core.center + core.support(-up), up) - core.rounding}};
  }
  SCREE_HD static double stretch(double /*window*/, const FrameDirections& /*n*/, int /*frame*/) {
    return 0;
  }
  SCREE_HD FrameValues bends(double /*time*/, double /*window*/, const FrameDirections& n) const {
    return {
        {std::abs(dot(path_a.acceleration, n.direction[0])) + a.reach() * path_a.change_of_turn()}};
  }

 private:
  SCREE_HD ConvexCore core_at(double time) const { return a.core_at(path_a.pose(time), origin); }
};

enum class SweepOutcome : std::uint8_t {
  apart,     ///< they do not meet
  hit,       ///< they meet at `time`
  undecided  ///< there were too many steps; until `time` they do not meet
};

struct Sweep {
  SweepOutcome outcome = SweepOutcome::apart;
  double time = 0;       ///< [s]
  Nearness near;         ///< then
  int steps = 0;         ///< searches for nearest points
  double first_gap = 0;  ///< at the beginning [m]
};

namespace variational_parts {

inline constexpr int kMostSweepSteps = 200;

/// How much of a window is free by (V3), as a part of it.
/// @param before, after  separations at its ends, before >= 0 [m]
/// @param bend           K w^2 / 2 [m]
SCREE_HD inline double free_part(double before, double after, double bend) {
  if (after >= 0 && std::sqrt(before) + std::sqrt(after) >= std::sqrt(bend)) return 1;
  const double b = before - after + bend, inside = b * b - 4 * bend * before;
  // Not above the root but for rounding, which the lower end of the tolerance has room for.
  return 2 * before / (b + std::sqrt(inside > 0 ? inside : 0));
}

}  // namespace variational_parts

/// The first impact from one time to another.
/// @tparam Approach   ConvexApproach or PlaneApproach, its paths with bounds up to `end`
/// @param tolerance   length within which bodies touch [m]
template <class Approach>
[[gnu::noinline]] SCREE_HD Sweep sweep(const Approach& approach, double begin, double end,
                                       double tolerance) {
  Sweep out;
  out.time = begin;
  out.near = approach.nearest(begin);
  out.first_gap = out.near.gap;
  // Where (V3) may come to; bodies that begin nearer stay about as far apart as they are.
  double floor = 0.5 * tolerance;
  if (out.near.gap - 1e-3 * tolerance < floor) floor = out.near.gap - 1e-3 * tolerance;
  double last = end - begin;
  for (out.steps = 1; out.steps < variational_parts::kMostSweepSteps; ++out.steps) {
    const double remaining = end - out.time;
    if (!(remaining > 0)) return out;
    const FrameDirections n = approach.directions(out.time, out.near.normal);
    const bool touches = out.near.gap <= tolerance;
    double window = touches || 8 * last > remaining ? remaining : 8 * last;
    double advance = 0;
    int best = 0;
    bool leaves = false;
    for (int k = 0; k < 40 && !leaves; ++k) {
      // The last window ends where the sweep does, without rounding.
      const double until = window == remaining ? end : out.time + window;
      const FrameValues after = approach.separations(until, n);
      const FrameValues bend = approach.bends(out.time, window, n);
      double part = 0;
      for (int frame = 0; frame < n.count; ++frame) {
        const double more = approach.stretch(window, n, frame);
        const double own_floor = floor * (floor > 0 ? 1 + more : more < 1 ? 1 - more : 0);
        const double own_before = out.near.gap - own_floor;
        if (frame > 0 && !(own_before >= 0)) continue;
        const double own_after = after.value[frame] - own_floor;
        const double own = variational_parts::free_part(own_before > 0 ? own_before : 0, own_after,
                                                        0.5 * bend.value[frame] * window * window);
        part = own > part ? own : part;
        const bool is_free = own >= 1 && (!touches || after.value[frame] >= out.near.gap);
        if (!(is_free || own * window > advance)) continue;
        best = frame;
        advance = is_free ? until - out.time : own * window;
        leaves = is_free;
        if (leaves) break;
      }
      if (leaves) break;
      if (touches ? window <= 1e-9 * remaining : part >= 0.5 || window <= 2 * advance) break;
      const double twice = 2 * advance;
      window = !touches && twice > 0.125 * window ? twice : (touches ? 0.25 : 0.125) * window;
    }
    if (touches && !leaves) {
      out.outcome = SweepOutcome::hit;
      return out;
    }
    if (!(advance > 0)) break;
    const bool ends = leaves && window == remaining;
    out.time = ends ? end : out.time + advance;
    last = advance;
    out.near = approach.nearest(out.time, approach.direction(out.time, n, best));
    if (ends) return out;
  }
  out.outcome = SweepOutcome::undecided;
  return out;
}

}  // namespace scree
