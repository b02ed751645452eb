#pragma once
// What drives a joint along its way, the turn of a hinge or the path of a slider, as terms of the potential: a motor or a spring,
// friction, limits. The way is linear in the coordinates of the two bodies within a step, about where the step begins.
// docs/theory.md, "Barrier contact".

#include "kernels/affine/affine_state.h"
#include "kernels/types.h"

namespace scree::affine {

/// A force that grows with the way from where there is none, up to a bound: the slope of a convex energy.
struct BoundedSpring {
  double rest = 0;       ///< [m or rad]
  double stiffness = 0;  ///< [N/m or N m/rad]
  double most = 0;       ///< [N or N m]; zero: there is none

  SCREE_HD bool is_bound(double way) const { return stiffness * std::abs(way - rest) >= most; }
  /// How much of the way from rest to the bound a Newton step is that comes to the bound or leaves it; zero where it does not, since
  /// the force is linear there.
  SCREE_HD double undecided(double way, double change) const {
    if (!(most > 0) || !(most < INFINITY)) return 0;
    const double end = way + change;
    if (is_bound(way) == is_bound(end) && (!is_bound(way) || (way < rest) == (end < rest)))
      return 0;
    return std::abs(change) * stiffness / most;
  }
  SCREE_HD double energy(double way) const {
    const double off = std::abs(way - rest);
    if (!(most > 0)) return 0;
    return is_bound(way) ? most * (off - 0.5 * most / stiffness) : 0.5 * stiffness * off * off;
  }
  /// Slope of the energy: minus what it gives.
  SCREE_HD double slope(double way) const {
    if (!(most > 0)) return 0;
    return is_bound(way) ? (way < rest ? -most : most) : stiffness * (way - rest);
  }
  SCREE_HD double curvature(double way) const { return most > 0 && !is_bound(way) ? stiffness : 0; }
};

/// What drives a joint. Ways and speeds are those of the second body against the first.
struct DriveLaw {
  double lower = -INFINITY, upper = INFINITY;  ///< limits of its position [m or rad]
  double speed = 0;                            ///< that a motor keeps [m/s or rad/s]
  double rest = 0;                             ///< where a spring has its rest [m or rad]
  double stiffness = 0;                        ///< of that spring [N/m or N m/rad]
  double damping = 0;   ///< [N s/m or N m s/rad]; without it and stiffness a motor keeps its speed
  double most = 0;      ///< that motor or spring give [N or N m]; zero: there is none
  double force = 0;     ///< that a motor gives beside them whatever the speed [N or N m]
  double friction = 0;  ///< [N or N m]
  double slip = 0;      ///< speed off by which a motor gives most, and friction [m/s or rad/s]
  double inertia = 0;   ///< about that of the way [kg or kg m^2]

  SCREE_HD bool is_used() const {
    return lower > -INFINITY || upper < INFINITY || most > 0 || force != 0 || friction > 0;
  }
};

/// A joint that is driven, in coordinates of its bodies.
struct DrivenJoint {
  Index body[2] = {-1, -1};  ///< as they are stored; -1: the world
  bool slides = false;
  Vec3d axis;      ///< of a slider, which does not turn: unit, world
  Vec3d point[2];  ///< of a slider, of each body, about its center of mass; of the world: there [m]
  /// Of a hinge, of each body: two directions that the joint turns, at right angles to its axis and each other, the second a
  /// quarter turn after the first; those of both bodies are the same at time zero. Of the world: there.
  Vec3d across[2][2];
  DriveLaw law;
};

/// A driven joint in a step.
struct DriveTerm {
  /// By how much stiffer than inertia in a step that is which nothing gives way to: limits, and motors without a bound.
  static constexpr double kHard = 1e6;
  /// By how much stiffer a limit is than a spring of its joint.
  static constexpr double kBeside = 1e4;

  Index body[2] = {};  ///< one that is twice there has slopes of the first alone
  AffineVec slope[2];  ///< of the way since the start of the step
  BoundedSpring motor, friction;
  double force = 0;                            ///< on the way whatever it is [N or N m]
  double lower = -INFINITY, upper = INFINITY;  ///< limits of the way
  double hard = 0;                             ///< [N/m or N m/rad]

  SCREE_HD double way(Span<const AffineVec> start, Span<const AffineVec> q) const {
    double sum = 0;
    for (int side = 0; side < 2; ++side) sum += dot(slope[side], q[body[side]] - start[body[side]]);
    return sum;
  }
  /// What rounding of places makes of the energy [J], nearly.
  SCREE_HD double rounding(Span<const AffineVec> q, double way) const {
    double size = 0;
    for (int side = 0; side < 2; ++side)
      for (int k = 0; k < 4; ++k)
        for (int i = 0; i < 3; ++i)
          size += std::abs(slope[side].node[k][i] * q[body[side]].node[k][i]);
    const double miss = kPlaceRounding * size;
    return miss * (std::abs(first(way)) + miss * second(way));
  }
  SCREE_HD double energy(double way) const {
    const double off = beyond(way);
    return motor.energy(way) + friction.energy(way) - force * way +
           (off != 0 ? 0.5 * hard * off * off : 0);
  }
  SCREE_HD double first(double way) const {
    const double off = beyond(way);
    return motor.slope(way) + friction.slope(way) - force + (off != 0 ? hard * off : 0);
  }
  SCREE_HD double second(double way) const {
    return motor.curvature(way) + friction.curvature(way) + (beyond(way) != 0 ? hard : 0);
  }

 private:
  /// How far a way is beyond a limit.
  SCREE_HD double beyond(double way) const {
    return way > upper ? way - upper : way < lower ? way - lower : 0;
  }
};

/// Driven joints as a step begins. Bytes a joint: 500 read, 320 written.
struct SetDrives {
  static constexpr const char* name = "affine_set_drives";
  Span<const DrivenJoint> joints;
  Span<const AffineVec> start;  ///< by body
  double h = 0;                 ///< [s]
  Span<double> position;  ///< of each joint: a turn from about where it is, and out [m or rad]
  Span<DriveTerm> terms;  ///< out

  SCREE_HD void operator()(Index j) const {
    const DrivenJoint& joint = joints[j];
    const DriveLaw& law = joint.law;
    DriveTerm t;
    const int known = joint.body[0] < 0 ? 1 : 0;
    for (int side = 0; side < 2; ++side)
      t.body[side] = joint.body[side] < 0 ? joint.body[known] : joint.body[side];
    const double at = joint.slides ? slide(joint, t) : turn(joint, position[j], t);
    position[j] = at;
    const double hard = DriveTerm::kHard * law.inertia / (h * h);
    t.hard = hard;
    t.lower = law.lower - at, t.upper = law.upper - at;
    t.motor.most = law.most;
    t.force = law.force;
    if (law.stiffness > 0 || law.damping > 0) {
      t.motor.stiffness = law.stiffness + law.damping / h;
      t.motor.rest = law.stiffness * (law.rest - at) / t.motor.stiffness;
      const double beside = DriveTerm::kBeside * t.motor.stiffness;
      t.hard = hard > beside ? hard : beside;
    } else {
      const double smoothed = law.most / (law.slip * h);
      // A bound that nothing reaches is as good as none, and stiffer ones end in rounding.
      t.motor.stiffness = smoothed < hard ? smoothed : hard;
      t.motor.rest = within(law.speed * h, t.lower, t.upper);
    }
    t.friction = {0, law.friction / (law.slip * h), law.friction};
    terms[j] = t;
  }

 private:
  /// @return  where the point of the second body is along the axis from that of the first
  SCREE_HD double slide(const DrivenJoint& joint, DriveTerm& t) const {
    double at = 0;
    for (int side = 0; side < 2; ++side) {
      const double sign = side == 0 ? -1 : 1;
      const Index b = joint.body[side];
      at +=
          sign * dot(joint.axis, b < 0 ? joint.point[side] : point_of(start[b], joint.point[side]));
      if (b >= 0) add_force(t.slope[side], joint.point[side], sign * joint.axis);
    }
    return at;
  }
  /// A turn by a small angle about the axis moves a direction across by that angle times the direction a quarter turn after it;
  /// the mean of two does not tell stretching for turning.
  /// @return  the angle from the first body to the second, the one of its turns that is nearest to `last`
  SCREE_HD double turn(const DrivenJoint& joint, double last, DriveTerm& t) const {
    Vec3d across[2][2];
    for (int side = 0; side < 2; ++side) {
      const Index b = joint.body[side];
      for (int k = 0; k < 2; ++k) {
        const Vec3d& own = joint.across[side][k];
        across[side][k] = b < 0 ? own : turned(start[b], own);
      }
      if (b < 0) continue;
      const Vec3d axis = normalized(cross(across[side][0], across[side][1]));
      for (int k = 0; k < 2; ++k) {
        const Vec3d& own = joint.across[side][k];
        const Vec3d toward = (side == 0 ? -0.5 : 0.5) * cross(axis, across[side][k]);
        for (int node = 1; node < 4; ++node) t.slope[side].node[node] += own[node - 1] * toward;
      }
    }
    const Vec3d(&a)[2] = across[0], (&b)[2] = across[1];
    const double angle =
        std::atan2(dot(b[0], a[1]) - dot(b[1], a[0]), dot(b[0], a[0]) + dot(b[1], a[1]));
    constexpr double kTurn = 6.283185307179586476925;
    return angle + kTurn * std::floor((last - angle) / kTurn + 0.5);
  }
  /// A motor to a speed goes no farther than the limits: as stiff as they are it would hold a joint in the middle.
  SCREE_HD static double within(double way, double lower, double upper) {
    return way > upper ? upper : way < lower ? lower : way;
  }
  /// A direction of a body in the world.
  SCREE_HD static Vec3d turned(const AffineVec& q, const Vec3d& own) {
    return own.x * q.node[1] + own.y * q.node[2] + own.z * q.node[3];
  }
};

}  // namespace scree::affine
