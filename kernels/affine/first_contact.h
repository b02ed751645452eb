#pragma once
// Continuous collision detection: how far four points may move along straight ways before their
// features come near. Additive: while a plane is between the features they are apart, and points on
// straight ways tell when they reach it; that way is taken, and another plane found, until little of
// the distance is left.
// Source: Li et al., Codimensional Incremental Potential Contact, ACM TOG 40(4), 2021, section 5.
// What is different here: a plane in place of the largest speed, so that features that slide along
// each other go far at once; and distances are bounded from below, rounding included, so that the
// answer is never late. docs/theory.md, "Barrier contact".

#include "kernels/affine/nearest.h"

namespace scree::affine {

/// Smallest coordinate along a direction of the points of A, less the largest of those of B: no more
/// than their distance, whichever unit direction it is.
SCREE_HD inline double apart_along(const Four& x, int split, const Vec3d& direction) {
  double lowest = HUGE_VAL, highest = -HUGE_VAL;
  for (int i = 0; i < 4; ++i) {
    const double at = dot(direction, x[i]);
    if (i < split)
      lowest = at < lowest ? at : lowest;
    else
      highest = at > highest ? at : highest;
  }
  return lowest - highest;
}

/// What may be wrong with the sum of a few coordinates, over their bound.
inline constexpr double kCoordinateErrors = 32 * 2.220446049250313e-16;

/// A direction along which features are apart.
struct ApartAlong {
  Vec3d direction;  ///< unit, from B to A
  double apart;     ///< [m], as computed: no more than the distance, but for rounding
};

/// The best of some directions: below the distance only where features are degenerate, and by rounding.
SCREE_HD inline ApartAlong apart_directions(PairKind kind, const Four& x) {
  const int split = first_points(kind);
  const Vec3d gap = nearest_place(kind, x).gap;
  ApartAlong best{normalized(gap), 0};
  best.apart = apart_along(x, split, best.direction);
  // The plane of the triangle or of both edges, whose direction does not depend on a small gap.
  const Vec3d plane = kind == PairKind::point_triangle ? cross(x[2] - x[1], x[3] - x[1])
                                                       : cross(x[1] - x[0], x[3] - x[2]);
  const Vec3d direction = normalized(dot(plane, gap) < 0 ? -plane : plane);
  const double across = apart_along(x, split, direction);
  return across > best.apart ? ApartAlong{direction, across} : best;
}

/// Share of straight ways that points may go, up to all of what is left, until less than this is between their features along
/// a direction.
SCREE_HD inline double share_along(PairKind kind, const Four& x, const Four& way,
                                   const Vec3d& direction, double keep, double left) {
  const int split = first_points(kind);
  double at[4], rate[4];
  for (int i = 0; i < 4; ++i) {
    at[i] = dot(direction, x[i]);
    rate[i] = dot(direction, way[i]);
  }
  for (int i = 0; i < split; ++i) {
    for (int j = split; j < 4; ++j) {
      const double apart = at[i] - at[j] - keep, closing = rate[j] - rate[i];
      if (closing * left > apart) left = apart / closing;
    }
  }
  return left;
}

/// Ways of the four points, less what is common to all of them.
/// @return the most that features can come nearer [m]
SCREE_HD inline double closing_ways(PairKind kind, const Four& from, const Four& to, Four& way,
                                    Vec3d& mean) {
  const int split = first_points(kind);
  mean = Vec3d{};
  for (int i = 0; i < 4; ++i) {
    way[i] = (to[i] - from[i]) - (to[0] - from[0]);
    mean += 0.25 * way[i];
  }
  double most[2] = {0, 0};
  for (int i = 0; i < 4; ++i) {
    way[i] -= mean;
    const double own = norm(way[i]);
    double& side = most[i < split ? 0 : 1];
    side = own > side ? own : side;
  }
  return most[0] + most[1];
}

/// Whether straight ways are so short that their features keep a distance, without looking at these: most pairs of a step.
/// @param squared  of the distance at the start [m^2]. Features that are nearly parallel may be nearer by 1e-8 of their size
SCREE_HD inline bool stays_apart(PairKind kind, const Four& from, const Four& to, double squared,
                                 double separation) {
  Four way;
  Vec3d mean;
  const double closing = closing_ways(kind, from, to, way, mean);
  double size = 0;
  for (int i = 1; i < 4; ++i) {
    const double far = norm2(from[i] - from[0]);
    size = far > size ? far : size;
  }
  return closing < 0.9 * (std::sqrt(squared) - separation) - 1e-8 * std::sqrt(size);
}

/// Whether a plane across a direction is between features at the start and at the end of straight ways: then it is all the time.
SCREE_HD inline bool stay_apart_along(PairKind kind, const Four& x, const Four& end,
                                      const Vec3d& direction, double least) {
  const int split = first_points(kind);
  return apart_along(x, split, direction) > least && apart_along(end, split, direction) > least;
}

struct FirstContactParameters {
  double separation = 0;  ///< distance that must not be reached [m], >= 0
  double remaining =
      0.1;                ///< share of the distance at the start, above the separation, that may be
                          ///< left at the answer: in (0, 1)
  int most_steps = 1000;  ///< of the search; the answer is then the way found free so far
};

struct FirstContact {
  double time = 1;   ///< share of the ways that is free, in [0, 1]
  bool hit = false;  ///< whether less than all of the ways is free
  int steps = 0;     ///< distances that were computed
};

/// Straight ways of four points from a common start, and where a search of their first contact is.
struct ContactSearch {
  PairKind kind;
  Four start, way;
  double least = 0;  ///< distance that must be kept, rounding included [m]
  double stop = 0;   ///< what may be left beyond that [m]
  double time = 0;
  Four x;           ///< points at that time
  ApartAlong best;  ///< there
  int steps = 0;    ///< distances that were computed

  SCREE_HD Four at(double when) const {
    Four p;
    for (int i = 0; i < 4; ++i) p[i] = start[i] + when * way[i];
    return p;
  }
  SCREE_HD void go(double to) {
    time = to;
    x = at(to);
    best = apart_directions(kind, x);
    ++steps;
  }
  /// Features that slide past an edge have many planes between them one after the other, and often one that is nearer to both and
  /// serves for longer: that between them later, or one half way. All of the way that is left is tried, half of it and so on.
  /// @param share  of the way that is free anyway. @return whether it went
  SCREE_HD bool go_far(double share) {
    const double rest = 1 - time;
    double ahead = rest;
    for (int k = 0; k < kFarTries && ahead > 2 * share; ++k, ahead *= 0.5) {
      ContactSearch later = *this;
      later.go(k == 0 ? 1 : time + ahead);
      steps = later.steps;
      if (later.best.apart - least > stop &&
          (stay_apart_along(kind, x, later.x, later.best.direction, least) ||
           stay_apart_along(kind, x, later.x, normalized(best.direction + later.best.direction),
                            least))) {
        *this = later;
        return true;
      }
    }
    return false;
  }

 private:
  static constexpr int kFarTries = 5;
};

/// @param from, to  the four points at the start and at the end of their straight ways [m]
/// @return a time up to which the features stay farther apart than the separation
SCREE_HD inline FirstContact first_contact(PairKind kind, const Four& from, const Four& to,
                                           const FirstContactParameters& parameters) {
  int plain = 3;  // steps before it tries to go far: enough for most
  ContactSearch s;
  s.kind = kind;
  Vec3d mean;
  closing_ways(kind, from, to, s.way, mean);
  double size = 0;
  for (int i = 0; i < 4; ++i) {
    s.start[i] = from[i] - from[0];
    const double far = norm(s.start[i]) + norm(s.way[i]) + norm(mean) + norm(to[i] - from[i]);
    size = far > size ? far : size;
  }
  s.least = parameters.separation + kCoordinateErrors * size;
  s.go(0);
  s.stop = parameters.remaining * (s.best.apart - s.least);
  bool is_free = false;
  while (!is_free) {
    const double left = s.best.apart - s.least, rest = 1 - s.time;
    if (!(left > s.stop) || s.steps >= parameters.most_steps) break;
    const auto share = [&](double keep) {
      return share_along(kind, s.x, s.way, s.best.direction, keep, rest);
    };
    is_free = !(rest > 0) || share(s.least) >= rest;
    if (is_free) break;
    // Less than all of it, so that the next distance is not lost to rounding.
    const double free = share(s.least + (s.steps == 1 ? parameters.remaining : 0.1) * left);
    if (s.steps >= plain) {
      const bool went = s.go_far(free);
      plain = 2 * s.steps;  // what does not go far seldom does later
      if (went) continue;
    }
    if (s.time + free <= s.time) break;
    s.go(s.time + free);
  }
  return {is_free ? 1 : s.time, !is_free, s.steps};
}

}  // namespace scree::affine
