#pragma once
// Element programs that sort bodies into bins.

#include "kernels/backend/atomic.h"
#include "kernels/bodies/range.h"
#include "kernels/broad_phase/bin_plan.h"
#include "kernels/broad_phase/contact_range.h"

namespace scree {

/// How much farther bodies reach in a list of pairs than the present step needs, so that the list
/// serves the steps to come as well.
struct SpareReach {
  double skin = 0;  ///< two bodies together [m]; 0: nothing is spared
  /// Steps that a body may go on at its present speed. Without it the few fast bodies would use up
  /// the skin of all.
  double steps_ahead = 4;

  /// The longest way that is spared, as a fraction of the radius: fast bodies must
  /// not fill the list.
  static constexpr double kMostAhead = 1;

  /// Steps at its present speed for which a body is in its ball, the present one included.
  /// @param way  of the body in a step [m]
  SCREE_HD double steps(double way, double radius) const {
    if (!(skin > 0)) return 1;
    const double most = kMostAhead * radius;
    return 1 + (steps_ahead * way < most ? steps_ahead : most / way);
  }
};

/// The balls of binned bodies: two bodies can have a contact in a step only when their balls of
/// that step overlap.
///
/// The ball of one step is about the middle of the body's way, x + h v / 2, with v its course
/// velocity, see course_velocity(), and its radius is that of the body, half the envelope, the
/// margin, and half the way, h |v| / 2. Let D be what leads from one surface to the other at the
/// contact, gap times the normal n, u the relative velocity of the surfaces there, which is that of
/// their courses, and E the envelope with both margins. A contact is listed when gap <= E, or
/// when u_n < 0 and gap + h u_n <= E. Half a step on
///
///     |D + h u / 2|^2 = (gap + h u_n / 2)^2 + (h u_t / 2)^2,
///     |gap + h u_n / 2| <= E + h |u_n| / 2
///
/// in both cases, unless the bodies overlap by more than E, when the distance of their centers is
/// below the sum of their radii. So |D + h u / 2| <= E + h |u| / 2; u is at most the sum of the
/// speeds of both bodies and, for shapes that are not spheres, of radius times angular velocity. By
/// h / 2 of the latter, too, a surface point may have left the ball about the moved center. Spheres
/// may be taken as not turning: that changes neither gap nor u_n.
///
/// A ball for k steps is about the middle of the way through all of them, with half of that way. It
/// holds the ball of each of the steps, as long as the body keeps its velocity.
template <class Real>
struct BodyBalls {
  BodyView<Real> bodies;
  ContactRange range;
  SpareReach spare;  ///< {}: balls of the present step

  SCREE_HD Vec3<double> center(Index i) const {
    const Vec3<double> v = course_velocity(bodies, range, i);
    return bodies.position[i] + (0.5 * range.h * steps(i, norm(v))) * v;
  }
  /// Zero for bodies that are not binned [m].
  SCREE_HD float radius(Index i) const {
    if (bodies.is_fixed(i) && bodies.shape[i] >= 0) return 0;
    return radius(i, bodies.radius[i]);
  }
  /// The same of a body that reaches so far about its center [m].
  SCREE_HD float radius(Index i, double own) const {
    const bool is_sphere = bodies.shape[i] < 0;
    const double speed = norm(course_velocity(bodies, range, i));
    double radius = own + 0.5 * (range.envelope + spare.skin) + range.margin_of(i) +
                    range.fall_of(own) + 0.5 * range.h * steps(i, speed) * speed;
    if (!is_sphere) radius += range.h * own * norm(Vec3<double>(bodies.angular_velocity[i]));
    // A state that is out of range has no contacts; the integration pass names it.
    if (!(radius > 0 && radius < kMostReach) || !is_in_range(bodies.position[i])) return 0;
    return static_cast<float>(radius) * (1.0f + 2.4e-7f);
  }

 private:
  SCREE_HD double steps(Index i, double speed) const {
    return spare.steps(range.h * speed, bodies.radius[i]);
  }
};

/// Radii of balls, and the extent these need. Binned are free bodies and fixed or kinematic spheres;
/// other fixed ones are walls, and have none. Bytes per body: 44 read, 4 written.
template <class Real>
struct MeasureBodies {
  static constexpr const char* name = "measure_bodies";
  BodyBalls<Real> balls;
  BodyRanges binned;
  Span<float> inflated;  ///< [binned.present_count()] out [m]

  SCREE_HD BodyExtent operator()(Index m) const {
    const Index i = binned.present(m);
    const float r = balls.radius(i);
    inflated[m] = r;
    BodyExtent e;
    if (r > 0) {
      const Vec3<double> x = balls.center(i);
      for (int k = 0; k < 3; ++k) e.lower[k] = e.upper[k] = x[k];
      const double diameter = 2.0 * r;
      e.min_diameter = e.max_diameter = diameter;
      const int phase = edge_phase(diameter);
      for (int k = 0; k < kEdgePhases; ++k) e.phase_count[k] = k == phase;
    }
    return e;
  }
};

/// Bodies per level. Bytes per body: 4 read.
struct CountLevels {
  static constexpr const char* name = "count_levels";
  Span<const float> inflated;
  const double* edge;  ///< of the finest level [m]

  SCREE_HD LevelCounts operator()(Index m) const {
    LevelCounts counts;
    if (inflated[m] > 0) {
      const int level = level_of(2.0 * inflated[m], *edge);
      for (int k = 0; k < kMaxLevels; ++k) counts.count[k] = k == level;
    }
    return counts;
  }
};

/// Cell of each body, and its number among those of the cell, in any order.
/// Bytes per body: 44 read, 8 written, 4 of its cell added to.
template <class Real>
struct BinBodies {
  static constexpr const char* name = "bin_bodies";
  BodyBalls<Real> balls;
  BodyRanges binned;
  Span<const float> inflated;
  const BinGrid* grid;
  /// [binned.present_count()] out; the number of cells for bodies that are not binned
  Span<Index> cell;
  Span<Index> rank;   ///< [binned.present_count()] out
  Span<Index> count;  ///< [grid->cell_count + 1] in: zero; out: bodies of each cell

  SCREE_HD void operator()(Index m) const {
    const float r = inflated[m];
    Index c = grid->cell_count;
    if (r > 0) {
      const BinLevel& l = grid->level[find_level(*grid, 2.0 * r)];
      c = cell_of(l, wrapped(*grid, l, balls.center(binned.present(m))));
    }
    cell[m] = c;
    rank[m] = atomic_add(&count[c], 1);
  }
};

/// What the search reads of a candidate, in cell order: 16 bytes.
struct alignas(16) BinRecord {
  Vec3<float> position;  ///< wrapped, relative to the grid's origin [m]
  float radius = 0;  ///< inflated, with room for the rounding of the position [m]; 0: not binned
};

/// Puts bodies into cell order; within a cell in any order.
/// Bytes per body: 60 read, 24 written.
template <class Real>
struct PlaceBodies {
  static constexpr const char* name = "place_bodies";
  BodyBalls<Real> balls;
  BodyRanges binned;
  Span<const float> inflated;
  const BinGrid* grid;
  Span<const Index> cell;   ///< [binned.present_count()] by BinBodies
  Span<const Index> rank;   ///< [binned.present_count()] by BinBodies
  Span<const Index> begin;  ///< [grid->cell_count + 2] scan of the counts
  Span<Index> cell_at;      ///< [binned.present_count()] out: cell of each position
  Span<Index> body;         ///< [binned.present_count()] out: storage index
  Span<BinRecord> record;   ///< [binned.present_count()] out

  SCREE_HD void operator()(Index m) const {
    const Index c = cell[m], i = binned.present(m), p = begin[c] + rank[m];
    BinRecord r;
    if (c < grid->cell_count) {
      const BinLevel& l = grid->level[level_of_cell(*grid, c)];
      r.position = Vec3<float>(wrapped(*grid, l, balls.center(i)));
      r.radius = inflated[m] + l.slack;
    }
    cell_at[p] = c;
    body[p] = i;
    record[p] = r;
  }
};

}  // namespace scree
