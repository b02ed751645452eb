#pragma once
// The first and the last pass of a step over all bodies: free flight, and what a report sums up.

#include "kernels/backend/backend.h"
#include "kernels/bodies/range.h"
#include "kernels/step/integrate.h"
#include "kernels/variational/stage.h"

namespace scree {

struct FlightSums {
  double min_gap = kNever;  ///< of bodies to neighbors and walls at the start of the step [m]
  Index deepest = -1;       ///< the body with that gap
  Index active = 0;         ///< bodies that meet something
  Index left = 0;           ///< bodies whose neighbors are not all listed
  SCREE_HD void combine(const FlightSums& o) {
    if (o.min_gap < min_gap || (o.min_gap == min_gap && o.deepest < deepest)) {
      min_gap = o.min_gap;
      deepest = o.deepest;
    }
    active += o.active;
    left += o.left;
  }
};

/// Moves each body by a step as if it met nothing, and notes what it meets first.
/// Bytes per body: 48 for its state, 24 where neighbors were listed and 16 of lists read, 4 + 48 per neighbor, mostly
/// from the caches; 48 of the new state and 12 of notes written.
template <bool kSolids>
struct FlyFreely {
  static constexpr const char* name = "fly_freely";
  Stage<kSolids> stage;
  Span<Vec3d> x, v;       ///< out: [owned] at the end of the step
  Span<Index> partner;    ///< [owned] out
  Span<Index> is_active;  ///< [owned] out
  Span<Index> place;      ///< [owned] out: none

  SCREE_HD FlightSums operator()(Index i) const {
    const Node a = stage.start(i);
    const Flight f{a.x, a.v, stage.gravity};
    FlightSums sums;
    sums.deepest = i;
    const auto node_of = [&](Index k) {
      const Node b = stage.start(k);
      const double gap = norm(stage.between(a.x, b.x)) - stage.sum_of_radii(i, k);
      if (gap < sums.min_gap) sums.min_gap = gap;
      return b;
    };
    const Event first = stage.next(i, a, node_of, sums.min_gap);
    x[i] = f.place(stage.h);
    v[i] = f.velocity(stage.h);
    partner[i] = first.partner;
    sums.active = is_active[i] = first.partner == kNobody ? 0 : 1;
    place[i] = -1;
    if (first.partner == kNobody && !stage.is_covered(i, x[i])) sums.left = 1;
    return sums;
  }
};

/// Sums over bodies after a step.
struct MotionSums {
  double kinetic = 0;    ///< [J]
  double potential = 0;  ///< of uniform gravity, zero at the origin [J]
  Vec3d momentum;        ///< [kg m/s]
  Vec3d angular;         ///< of the centers, about the origin [kg m^2/s]
  Index bad_body =
      -1;  ///< lowest storage index with a state that is not finite, too far out or too fast
  SCREE_HD void combine(const MotionSums& o) {
    kinetic += o.kinetic;
    potential += o.potential;
    momentum += o.momentum;
    angular += o.angular;
    if (o.bad_body >= 0 && (bad_body < 0 || o.bad_body < bad_body)) bad_body = o.bad_body;
  }
};

/// Takes the state after a step over, brings bodies back into the periodic box and sums up.
/// Bytes per body: 48 read, 48 written.
struct TakeMotion {
  static constexpr const char* name = "take_motion";
  Span<const Vec3d> x, v;  ///< [owned]
  BodyView<double> bodies;
  PeriodicBox box;
  Vec3d gravity;
  double h;

  SCREE_HD MotionSums operator()(Index i) const {
    Vec3d place = x[i];
    const Vec3d speed = v[i];
    if (!(is_in_range(place) && is_speed_in_range(norm(speed), h))) {
      MotionSums bad;
      bad.bad_body = i;
      return bad;
    }
    for (int axis = 0; axis < 3; ++axis)
      place[axis] = wrap_coordinate(place[axis], box.lower[axis], box.length[axis]);
    bodies.position[i] = place;
    bodies.velocity[i] = speed;
    const double m = 1 / bodies.inv_mass[i];
    return {0.5 * m * norm2(speed), -m * dot(gravity, place), m * speed, m * cross(place, speed),
            -1};
  }
};

/// Fastest body. Bytes per body: 24.
struct FastestBody {
  static constexpr const char* name = "fastest_body";
  Span<const Vec3d> v;
  SCREE_HD Largest<double> operator()(Index i) const { return {norm(v[i])}; }
};

}  // namespace scree
