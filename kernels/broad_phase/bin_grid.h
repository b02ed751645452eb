#pragma once
// The hierarchy of bins of the broad phase: how many levels, how many cells, where a body belongs.
//
// A body of inflated radius r sits in the finest level whose cell edge is at least 2 r. The cells
// of a row along x follow each other, so that what is near a body in one row is one range of
// bodies. Cells are shorter along x, which costs memory, but does not make more ranges.
//
// Every axis of a level wraps: along a periodic axis after its whole number of cells,
// else after a number of cells chosen so that a table over all cells stays in proportion to
// the bodies of the level. Bodies that are a multiple of the wrap length apart share a cell,
// which costs candidates but loses none: distances are first compared modulo the wrap length,
// which never makes them larger.

#include "kernels/math/morton.h"
#include "kernels/math/vec3.h"

namespace scree {

/// Sizes up to 2^15 to 1; smaller bodies share the finest level.
inline constexpr int kMaxLevels = 16;
/// Cells along x in the length of an edge along y and z.
inline constexpr int kCellsPerEdge = 2;
/// Phases of the edge of the finest level within a factor of two.
inline constexpr int kEdgePhases = 16;

/// Extent and sizes of all binned bodies: the record of a reduction (128 bytes).
struct BodyExtent {
  double lower[3] = {1e300, 1e300, 1e300};  ///< [m]
  double upper[3] = {-1e300, -1e300, -1e300};
  double min_diameter = 1e300;  ///< inflated [m]
  double max_diameter = 0;
  Index phase_count[kEdgePhases] = {};  ///< bodies by the fractional part of log2 of their diameter

  SCREE_HD void combine(const BodyExtent& o) {
    for (int k = 0; k < 3; ++k) {
      if (o.lower[k] < lower[k]) lower[k] = o.lower[k];
      if (o.upper[k] > upper[k]) upper[k] = o.upper[k];
    }
    if (o.min_diameter < min_diameter) min_diameter = o.min_diameter;
    if (o.max_diameter > max_diameter) max_diameter = o.max_diameter;
    for (int k = 0; k < kEdgePhases; ++k) phase_count[k] += o.phase_count[k];
  }
};

/// Phase of a diameter: edge 2^(phase/16 + integer) is the smallest of its kind that holds it.
SCREE_HD inline int edge_phase(double diameter) {
  const int k = static_cast<int>(std::ceil(kEdgePhases * std::log2(diameter)));
  return ((k % kEdgePhases) + kEdgePhases) % kEdgePhases;
}

/// Edge of the finest level of a phase that holds the smallest body.
SCREE_HD inline double finest_edge_of_phase(const BodyExtent& e, int phase) {
  const double fraction = static_cast<double>(phase) / kEdgePhases;
  double edge = std::exp2(std::ceil(std::log2(e.min_diameter) - fraction) + fraction);
  while (edge < e.min_diameter) edge *= 2;  // rounding of the logarithm
  while (edge * (1 << (kMaxLevels - 1)) < e.max_diameter) edge *= 2;
  return edge;
}

/// Edge of the finest level: among the phases the one that costs the fewest candidates, a body
/// costing (edge of its level / diameter)^3, and about as much again for each coarser level that it
/// has to search too.
SCREE_HD inline double finest_edge(const BodyExtent& e) {
  if (!(e.max_diameter > 0)) return 1;
  constexpr double kStep = 1.1387886347566916;  // 2^(3/16): one phase more costs that much more
  double best = 1, best_cost = 1e300;
  for (int phase = 0; phase < kEdgePhases; ++phase) {
    const double edge = finest_edge_of_phase(e, phase);
    double level_count = 1;
    for (double coarsest = edge; coarsest < e.max_diameter; coarsest *= 2) ++level_count;
    double cost = 0, weight = 1;
    for (int excess = 0; excess < kEdgePhases; ++excess, weight *= kStep) {
      cost +=
          (weight + level_count - 1) * e.phase_count[(phase - excess + kEdgePhases) % kEdgePhases];
    }
    if (cost < best_cost) {
      best_cost = cost;
      best = edge;
    }
  }
  return best;
}

/// Bodies per level, levels being edge, 2 edge, 4 edge...
struct LevelCounts {
  Index count[kMaxLevels] = {};
  SCREE_HD void combine(const LevelCounts& o) {
    for (int k = 0; k < kMaxLevels; ++k) count[k] += o.count[k];
  }
};

SCREE_HD inline int level_of(double diameter, double edge) {
  int level = 0;
  while (level < kMaxLevels - 1 && diameter > edge) {
    edge *= 2;
    ++level;
  }
  return level;
}

/// One level that holds bodies.
struct BinLevel {
  double max_diameter = 0;  ///< largest inflated diameter of its bodies [m]
  Vec3<double> edge;        ///< cell edges [m], at least max_diameter; see kCellsPerEdge
  Vec3<double> wrap;        ///< cells * edge [m]
  Vec3<float> edge_f;
  Vec3<float> wrap_f;
  Vec3<float> inv_wrap;
  Vec3<float> inv_edge;
  float slack = 0;  ///< bound on the rounding of a coordinate in float [m]
  Index cells[3] = {1, 1, 1};
  int block_bits = 0;  ///< rows are in Morton order within blocks of 2^block_bits along y and z
  Index stride[3] = {0, 1, 1};  ///< of the blocks along y and z, the shorter axis first
  Index first_cell = 0;         ///< number of the level's first cell in the table of all levels
  Index body_count = 0;
  std::uint32_t searched = 0;  ///< bit k: pairs with level k, a finer one, are found from this one
  Index first_slice = 0;       ///< number of the level's first slice, see PairSearch
};

struct BinGrid {
  Vec3<double> lower;     ///< origin of all coordinates [m]
  Index level_count = 0;  ///< levels with bodies, finest first
  Index cell_count = 0;   ///< over all levels
  Index slice_count = 0;  ///< over all levels
  BinLevel level[kMaxLevels];
};

/// Contribution of one coordinate to the number of a row; those of y and z add up.
SCREE_HD inline Index row_part(const BinLevel& l, int axis, Index c) {
  const auto low = static_cast<std::uint32_t>(c) & ((1u << l.block_bits) - 1);
  return static_cast<Index>(spread_bits_plane(low) << (axis - 1)) +
         (((c >> l.block_bits) * l.stride[axis]) << (2 * l.block_bits));
}

/// Number of the first cell of a row: those of a row follow each other.
SCREE_HD inline Index first_of_row(const BinLevel& l, Index y, Index z) {
  return l.first_cell + (row_part(l, 1, y) + row_part(l, 2, z)) * l.cells[0];
}

/// How far from a body of radius r, slack included, the centers of bodies may be that it
/// touches in a level [m].
SCREE_HD inline float reach_in(const BinLevel& l, float radius) {
  return radius + (0.5f * static_cast<float>(l.max_diameter) * (1 + 2e-7f) + 2 * l.slack);
}

/// Most cells along z that a body of one level can reach in a finer one.
SCREE_HD inline Index slices_of_body(const BinLevel& coarse, const BinLevel& fine) {
  const float radius = 0.5f * static_cast<float>(coarse.max_diameter) * (1 + 2e-7f) + fine.slack;
  const auto most = static_cast<Index>(2 * reach_in(fine, radius) * fine.inv_edge.z +
                                       2.05f);  // as cells_around rounds
  return most < fine.cells[2] ? most : fine.cells[2];
}

/// Coordinate in [0, wrap).
SCREE_HD inline double wrapped(double x, double lower, double wrap) {
  x -= lower;
  x -= wrap * std::floor(x / wrap);
  return x >= 0 && x < wrap ? x : 0;  // rounding may land on the upper end, which is the lower one
}

SCREE_HD inline Vec3<double> wrapped(const BinGrid& grid, const BinLevel& l,
                                     const Vec3<double>& x) {
  return {wrapped(x.x, grid.lower.x, l.wrap.x), wrapped(x.y, grid.lower.y, l.wrap.y),
          wrapped(x.z, grid.lower.z, l.wrap.z)};
}

/// Number of the cell that holds a wrapped position.
SCREE_HD inline Index cell_of(const BinLevel& l, const Vec3<double>& x) {
  Index c[3];
  for (int axis = 0; axis < 3; ++axis) {
    c[axis] = static_cast<Index>(x[axis] / l.edge[axis]);
    if (c[axis] >= l.cells[axis]) c[axis] = l.cells[axis] - 1;
  }
  return first_of_row(l, c[1], c[2]) + c[0];
}

/// Index among the levels with bodies.
SCREE_HD inline Index find_level(const BinGrid& grid, double diameter) {
  Index l = 0;
  while (l < grid.level_count - 1 && diameter > grid.level[l].max_diameter) ++l;
  return l;
}

/// The level a cell number belongs to.
SCREE_HD inline Index level_of_cell(const BinGrid& grid, Index cell) {
  Index l = 0;
  while (l < grid.level_count - 1 && cell >= grid.level[l + 1].first_cell) ++l;
  return l;
}

}  // namespace scree
