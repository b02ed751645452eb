#pragma once
// Element programs that sort bodies into bins.

#include "kernels/bin_plan.h"
#include "kernels/body_view.h"

namespace scree {

/// How far contacts are looked for.
struct ContactRange {
  double envelope = 0;  ///< contacts are listed up to this gap [m]
  double h = 0;         ///< time step [s]; approaching surfaces are listed when they meet within it
  Vec3<double> period;  ///< [m]; zero: not periodic
  Span<const float> margin;  ///< how far a free body may leave its course [m]; empty: not at all

  SCREE_HD double margin_of(Index i) const {
    return i < margin.size ? static_cast<double>(margin[i]) : 0;
  }
};

/// Bodies that are binned: free ones, and fixed or kinematic spheres. Other bodies in
/// [fixed_begin, count) are walls.
struct BinnedRange {
  Index free_count = 0;
  Index fixed_begin = 0;
  Index count = 0;

  SCREE_HD Index size() const { return free_count + count - fixed_begin; }
  SCREE_HD Index body(Index m) const { return m < free_count ? m : m - free_count + fixed_begin; }
  /// Inverse of body().
  SCREE_HD Index slot(Index i) const { return i < free_count ? i : i - fixed_begin + free_count; }
  bool operator==(const BinnedRange&) const = default;
};

/// Fastest that a point of the body can move [m/s]; for spheres that of the center, since turning
/// does not move their surface.
template <class Real>
SCREE_HD double surface_speed(const BodyView<Real>& bodies, Index i) {
  double speed = norm(Vec3<double>(bodies.velocity[i]));
  if (bodies.shape[i] >= 0) {
    speed += static_cast<double>(bodies.radius[i]) * norm(Vec3<double>(bodies.angular_velocity[i]));
  }
  return speed;
}

/// Radius of a binned body that covers all it may touch within the step: two bodies can have a
/// contact only when their centers are at most the sum of their inflated radii apart. Zero for
/// bodies that are not binned.
template <class Real>
SCREE_HD float inflated_radius(const BodyView<Real>& bodies, const ContactRange& range, Index i) {
  const bool is_sphere = bodies.shape[i] < 0;
  if (i >= bodies.fixed_begin && !is_sphere) return 0;
  const double inflated = static_cast<double>(bodies.radius[i]) + 0.5 * range.envelope +
                          range.h * surface_speed(bodies, i) + range.margin_of(i);
  // A state that is not finite has no contacts; the integration pass names it.
  if (!(inflated > 0 && inflated < 1e30) || !is_finite(bodies.position[i])) return 0;
  return static_cast<float>(inflated) * (1.0f + 2.4e-7f);
}

/// How much farther bodies reach in a list of pairs than the present step needs, so that the list
/// serves the steps to come as well.
struct SpareReach {
  double skin = 0;  ///< two bodies together [m]; 0: nothing is spared
  /// Steps that a body may go on at its present speed. Without it the few fast bodies would use up
  /// the skin of all.
  double steps_ahead = 4;

  /// The most that this adds, as a fraction of the radius: fast bodies shall not fill the list.
  static constexpr double kMostAhead = 0.5;

  template <class Real>
  SCREE_HD double operator()(const BodyView<Real>& bodies, double h, Index i) const {
    if (!(skin > 0)) return 0;
    const double ahead = steps_ahead * h * surface_speed(bodies, i);
    const double most = kMostAhead * static_cast<double>(bodies.radius[i]);
    return 0.5 * skin + (ahead < most ? ahead : most);
  }
};

/// Radius of the ball of a body in a list of pairs; zero for bodies that are not binned.
template <class Real>
SCREE_HD float kept_radius(const BodyView<Real>& bodies, const ContactRange& range,
                           const SpareReach& spare, Index i) {
  const float r = inflated_radius(bodies, range, i);
  if (!(r > 0)) return 0;
  return static_cast<float>(static_cast<double>(r) + spare(bodies, range.h, i)) * (1.0f + 1.2e-7f);
}

/// Inflated radii, with what is spared, and the extent they need. Bytes per body: 44 read, 4
/// written.
template <class Real>
struct MeasureBodies {
  static constexpr const char* name = "measure_bodies";
  BodyView<Real> bodies;
  BinnedRange binned;
  ContactRange range;
  SpareReach spare;
  Span<float> inflated;  ///< [binned.size()] out [m]

  SCREE_HD BodyExtent operator()(Index m) const {
    const Index i = binned.body(m);
    const float r = kept_radius(bodies, range, spare, i);
    inflated[m] = r;
    BodyExtent e;
    if (r > 0) {
      const Vec3<double> x = bodies.position[i];
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

/// Cell of each body, the sort key. Bytes per body: 28 read, 12 written.
template <class Real>
struct BinBodies {
  static constexpr const char* name = "bin_bodies";
  BodyView<Real> bodies;
  BinnedRange binned;
  Span<const float> inflated;
  const BinGrid* grid;
  Span<std::uint64_t>
      cell;          ///< [binned.size()] out; the number of cells for bodies that are not binned
  Span<Index> body;  ///< [binned.size()] out: storage index

  SCREE_HD void operator()(Index m) const {
    const Index i = binned.body(m);
    body[m] = i;
    const float r = inflated[m];
    Index c = grid->cell_count;
    if (r > 0) {
      const BinLevel& l = grid->level[find_level(*grid, 2.0 * r)];
      c = cell_of(l, wrapped(*grid, l, bodies.position[i]));
    }
    cell[m] = static_cast<std::uint64_t>(c);
  }
};

/// What the search reads of a candidate, in cell order: 16 bytes.
struct alignas(16) BinRecord {
  Vec3<float> position;  ///< wrapped, relative to the grid's origin [m]
  float radius = 0;  ///< inflated, with room for the rounding of the position [m]; 0: not binned
};

/// Bodies of one cell: positions [begin, end) in cell order.
struct CellRange {
  Index begin = 0;
  Index end = 0;
};

/// Records in cell order, and the range of each cell. Bytes per body: 40 read, 16 written, and 8
/// per cell.
template <class Real>
struct GatherBins {
  static constexpr const char* name = "gather_bins";
  BodyView<Real> bodies;
  BinnedRange binned;
  Span<const float> inflated;
  const BinGrid* grid;
  Span<const std::uint64_t> cell;  ///< [n] sorted
  Span<const Index> body;          ///< [n]
  Span<BinRecord> record;          ///< [n] out
  Span<CellRange> cells;           ///< [grid->cell_count] out, zero before

  SCREE_HD void operator()(Index p) const {
    const auto c = static_cast<Index>(cell[p]);
    BinRecord r;
    if (c < grid->cell_count) {
      const Index i = body[p];
      const BinLevel& l = grid->level[level_of_cell(*grid, c)];
      r.position = Vec3<float>(wrapped(*grid, l, bodies.position[i]));
      r.radius = inflated[binned.slot(i)] + l.slack;
      if (p == 0 || cell[p - 1] != cell[p]) cells[c].begin = p;
      if (p == cell.size - 1 || cell[p + 1] != cell[p]) cells[c].end = p + 1;
    }
    record[p] = r;
  }
};

}  // namespace scree
