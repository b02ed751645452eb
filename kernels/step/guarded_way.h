#pragma once
// The way of a free body in one step, as the solved velocities lead it, but not through
// solid walls.
//
// Contacts hold a sphere off what it would meet on the way it had before they acted. One that
// bounces, or is pushed aside by another body, may meet more, and a wall that turns far is not
// where its planes were. So whoever moves fast beside a wall is followed once more. Where the
// center would come nearer to a part of the wall than most of the radius, the sphere stops as it
// touches that part, and slides along it for the rest of the step. Its velocity stays, and is for
// the contacts of the next step.
// Of other convex bodies that is the ball of MiddleContact: whatever else of a body that spins is behind a wall, its center, by which
// the side that it belongs to is told, stays before it.

#include "kernels/narrow_phase/ignored_pairs.h"
#include "kernels/narrow_phase/mesh_way.h"
#include "kernels/narrow_phase/pairs/middle_contact.h"
#include "kernels/narrow_phase/wall_contacts.h"
#include "shapes/shape_list.h"

namespace scree {

/// How near to a wall a center may come, over its radius, or over its distance before the step
/// where that is less.
inline constexpr double kNearestPass = 0.9;
/// Ways past a wall that are not followed, over the radius.
inline constexpr double kUnguardedWay = 0.5;

/// First part of a straight way at which a point is within `reach` of a convex body; 2: it is not.
/// The distance is a convex function of the way, so Newton's method comes from before and never
/// passes the first root.
/// @param closest  closest(x): point of the body nearest to x [m]
template <class Closest>
SCREE_HD double first_within(const Vec3d& start, const Vec3d& way, double reach,
                             Closest&& closest) {
  double at = 0;
  for (int k = 0; k < 40; ++k) {
    const Vec3d x = start + at * way;
    const Vec3d offset = x - closest(x);
    const double distance = norm(offset), rate = dot(offset, way);
    if (distance <= (1 + 1e-6) * reach) return at;
    if (!(rate < 0)) return 2;
    at += (distance - reach) * distance / -rate;
    if (at > 1) return 2;
  }
  return at;
}

template <class Real>
struct GuardedWay {
  BodyView<Real> bodies;
  WallView<Real> walls;
  Vec3d period;                           ///< [m]; zero: not periodic
  double time_step;                       ///< h [s]
  IgnoredPairs held;                      ///< bodies that do not touch each other
  BodyView<Real> parts;                   ///< that `walls` names
  Span<const ShapeRecord<Real>> records;  ///< of bodies that are no spheres

  /// Where body i is after the step.
  /// @param v        its velocity [m/s]
  /// @param stopped  out: it did not go all its way
  SCREE_HD Vec3d end(Index i, const Vec3<Real>& v, bool& stopped) const {
    const Vec3d straight = time_step * Vec3d(v);
    const double radius = guarded_radius(i);
    if (!(radius > 0)) return bodies.position[i] + straight;
    Leg leg;
    leg.start = bodies.position[i];
    leg.way = straight;
    HoldingPlanes planes;
    for (int k = 0; k < kMostLegs; ++k) {
      Hit hit;
      for (Index s = 0; s < static_cast<Index>(walls.solids.size); ++s)
        find(i, leg, s, radius, hit);
      if (hit.time > 1) break;
      stopped = true;
      if (!is_same(leg.frame, hit.frame, radius)) planes = HoldingPlanes();
      HoldingPlane plane;
      plane.normal = hit.normal;
      plane.height = radius;
      planes.add(plane, 0, 0);
      leg.frame = hit.frame;
      leg.from = hit.time;
      leg.start = hit.place;
      leg.way = k + 1 < kMostLegs ? planes.allowed(hit.way, radius) : Vec3d{};
    }
    if (!stopped) return bodies.position[i] + straight;
    return place(leg, 1);
  }

 private:
  /// Radius of the ball about the center of a body that is followed [m]; 0: there is none.
  SCREE_HD double guarded_radius(Index i) const {
    if (bodies.shape[i] < 0) return static_cast<double>(bodies.radius[i]);
    const ShapeRecord<Real>& shape = records[bodies.shape[i]];
    if (shape.kind == shapes::Compound::kind) return 0;
    const Vec3d half(shape.half_extents);
    const double least = half.x < half.y ? half.x : half.y;
    return MiddleContact::kBall *
           ((least < half.z ? least : half.z) + static_cast<double>(shape.rounded.radius));
  }

  /// Straight parts of a way.
  static constexpr int kMostLegs = 6;
  /// Straight parts by which the way past a turning wall is followed.
  static constexpr int kMostChords = 64;
  /// How far they may lie beside it, over the radius.
  static constexpr double kChordError = 0.02;

  /// A wall in one image, and how it moves. Times are parts of the step.
  struct Frame {
    Index solid = -1;  ///< -1: the world
    Vec3d center;      ///< at the start of the step [m]
    Vec3d way;         ///< of the center in the step [m]
    Vec3d turn;        ///< in the step [rad]
    Quatd orientation;
  };
  /// A straight way in a frame, to the end of the step.
  struct Leg {
    Frame frame;
    double from = 0;
    Vec3d start;  ///< in the frame [m]
    Vec3d way;    ///< in a whole step, in the frame [m]
  };
  /// The first wall on a leg.
  struct Hit {
    double time = 2;  ///< above 1: none
    Frame frame;
    Vec3d place;   ///< of the center, in the frame of the wall [m]
    Vec3d way;     ///< in a whole step, there [m]
    Vec3d normal;  ///< of the wall toward the center, there
  };

  SCREE_HD static Quatd turned(const Frame& f, double time) {
    return norm2(f.turn) > 0 ? exp_map(time * f.turn) * f.orientation : f.orientation;
  }
  /// Images of a wall are a period apart, which is more than a radius; the only one along an endless axis goes with the sphere.
  SCREE_HD bool is_same(const Frame& a, const Frame& b, double radius) const {
    if (a.solid != b.solid) return false;
    Vec3d apart = a.center - b.center;
    for (int k = 0; k < 3 && a.solid >= 0; ++k)
      if (is_endless(walls.solids[a.solid], k)) apart[k] = 0;
    return norm(apart) < radius;
  }
  SCREE_HD static Vec3d to_world(const Frame& f, double time, const Vec3d& x) {
    if (f.solid < 0) return x;
    return f.center + time * f.way + rotate(turned(f, time), x);
  }
  SCREE_HD static Vec3d to_frame(const Frame& f, double time, const Vec3d& x) {
    return rotate_back(turned(f, time), x - f.center - time * f.way);
  }
  SCREE_HD static Vec3d place(const Leg& leg, double time) {
    return to_world(leg.frame, time, leg.start + (time - leg.from) * leg.way);
  }

  /// Takes what the leg meets of one wall if it is earlier.
  SCREE_HD void find(Index i, const Leg& leg, Index s, double radius, Hit& hit) const {
    const WallSolid& solid = walls.solids[s];
    const Vec3d wall_way = time_step * Vec3d(parts.velocity[solid.body]);
    const Vec3d wall_turn = time_step * Vec3d(parts.angular_velocity[solid.body]);
    const double rest = 1 - leg.from;
    const double most = rest * most_way(leg, solid, wall_way, wall_turn);
    if (!(most > kUnguardedWay * radius)) return;
    if (held.pair.size > 0 && held.contains(bodies.id[i], parts.id[solid.body])) return;
    const Frame frame{s, {}, wall_way, wall_turn, solid.orientation};
    find_near(leg, solid, frame, radius, radius + most, hit);
  }

  /// How far the center moves relative to a wall in a whole step, at most [m].
  SCREE_HD double most_way(const Leg& leg, const WallSolid& solid, const Vec3d& wall_way,
                           const Vec3d& wall_turn) const {
    const bool is_first = leg.frame.solid < 0;
    const Vec3d way = leg.way - wall_way;
    const double speed = is_first ? norm(way) : norm(leg.frame.way - wall_way) + norm(leg.way);
    const double turn = norm(wall_turn) + (is_first ? 0 : norm(leg.frame.turn));
    if (!(turn > 0)) return speed;
    const Vec3d arm = nearest_wall(solid, period, place(leg, leg.from));
    const double far = norm(arm) + speed;
    if (!is_first) return speed + turn * (far + norm(leg.start));
    return norm(way + cross(wall_turn, arm)) + turn * (turn * far + speed);
  }

  /// The same as find() for a wall that the leg may reach.
  SCREE_HD void find_near(const Leg& leg, const WallSolid& solid, Frame frame, double radius,
                          double reach, Hit& hit) const {
    const Vec3d x = place(leg, leg.from);
    WallImages images;
    if (period.x > 0 || period.y > 0 || period.z > 0) images = WallImages(solid, period, x, reach);
    images.for_each(period, [&](std::uint32_t image) {
      frame.center = x + image_of_wall(solid, period, x, image);
      follow(leg, frame, solid, radius, hit);
    });
  }

  /// The same of one of its images, along chords of the way in its frame.
  SCREE_HD void follow(const Leg& leg, const Frame& frame, const WallSolid& solid, double radius,
                       Hit& hit) const {
    const double rest = 1 - leg.from;
    const int chords = chord_count(leg, frame, radius);
    const Vec3d first = to_frame(frame, leg.from, place(leg, leg.from));
    Vec3d start = first;
    for (int k = 0; k < chords; ++k) {
      const double from = leg.from + rest * k / chords, to = leg.from + rest * (k + 1) / chords;
      if (from >= hit.time) return;
      const Vec3d end = to_frame(frame, to, place(leg, to));
      const Chord chord{frame, from, to, first, start, end - start, radius};
      if (solid.kind == shapes::Mesh::kind) {
        pass_mesh(chord, walls.meshes.meshes[solid.mesh], hit);
      } else {
        pass_solid(chord, solid, hit);
      }
      start = end;
    }
  }

  SCREE_HD int chord_count(const Leg& leg, const Frame& frame, double radius) const {
    const double rest = 1 - leg.from;
    const double turn = rest * (norm(frame.turn) + norm(leg.frame.turn));
    if (is_same(leg.frame, frame, radius) || !(turn > 0)) return 1;
    const Vec3d x = place(leg, leg.from);
    const double arm = norm(x - frame.center) + (leg.frame.solid < 0 ? 0 : norm(leg.start));
    const double way = rest * (norm(leg.way) + norm(leg.frame.way) + norm(frame.way));
    const double aside = turn * (turn * (arm + way) / 8 + way / 4);
    const double chords = std::sqrt(aside / (kChordError * radius)) + 1;
    return chords < kMostChords ? static_cast<int>(chords) : kMostChords;
  }

  /// A straight part of the way in the frame of a wall.
  struct Chord {
    const Frame& frame;
    double from, to;  ///< times
    Vec3d first;      ///< where the leg starts [m]
    Vec3d start;      ///< [m]
    Vec3d way;        ///< [m]
    double radius;    ///< of the sphere [m]
  };

  /// Takes what a chord meets of a convex part of the wall if it is earlier.
  template <class Closest>
  SCREE_HD static void pass(const Chord& c, Hit& hit, Closest&& closest) {
    if (first_within(c.start, c.way, kNearestPass * c.radius, closest) > 1) return;
    const double distance = norm(c.first - closest(c.first));
    const double touch = distance < c.radius ? distance : c.radius;
    if (!(touch > 0)) return;
    double at = first_within(c.start, c.way, kNearestPass * touch, closest);
    if (at > 1 || !(c.from + at * (c.to - c.from) < hit.time)) return;
    const double touched = first_within(c.start, c.way, touch, closest);
    at = touched < at ? touched : at;
    const Vec3d place = c.start + at * c.way, offset = place - closest(place);
    hit.time = c.from + at * (c.to - c.from);
    hit.frame = c.frame;
    hit.place = place;
    hit.way = (1 / (c.to - c.from)) * c.way;
    hit.normal = normalized(offset);
  }

  SCREE_HD static void pass_solid(const Chord& c, const WallSolid& solid, Hit& hit) {
    ShapeList::visit(solid.kind, [&](auto shape) {
      using S = decltype(shape);
      if constexpr (requires { S::nearest(solid.half_extents, c.start); }) {
        pass(c, hit, [&](const Vec3d& x) { return S::nearest(solid.half_extents, x); });
      } else if constexpr (requires { S::nearest(solid, c.start); }) {
        pass(c, hit, [&](const Vec3d& x) { return S::nearest(solid, x); });
      }
    });
  }

  SCREE_HD void pass_mesh(const Chord& c, const MeshInfo& info, Hit& hit) const {
    const MeshView<Real>& mesh = walls.meshes;
    const SphereWay past{c.start, c.way, c.radius, kNearestPass * c.radius};
    visit_near_way(mesh, info, past, [&](Index t) {
      const MeshTriangle& triangle = mesh.triangles[t];
      Vec3d p[3];
      for (int k = 0; k < 3; ++k) p[k] = Vec3d(mesh.points[triangle.vertex[k]]);
      if (info.closed && dot(c.start - p[0], cross(p[1] - p[0], p[2] - p[0])) < 0) return;
      pass(c, hit, [&](const Vec3d& x) { return closest_on_triangle(x, p[0], p[1], p[2]).point; });
    });
  }
};

/// All of the way: where no wall is a box or a mesh.
template <class Real>
struct StraightWay {
  BodyView<Real> bodies;
  double time_step;  ///< h [s]

  SCREE_HD Vec3d end(Index i, const Vec3<Real>& v, bool&) const {
    return bodies.position[i] + time_step * Vec3d(v);
  }
};

}  // namespace scree
