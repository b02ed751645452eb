#pragma once
// Lays out the bins of one step from the extent of the bodies and their number per level.

#include "kernels/broad_phase/bin_grid.h"

namespace scree {

/// Most cells along an axis: float coordinates then resolve 1/64 of a cell.
inline constexpr Index kMaxAxisCells = 1 << 17;

/// Most cells of all levels before padding, which takes at most 9 / 16 more; below 2^31 with it.
inline constexpr double kMaxCells = 1.2e9;

/// Blocks of rows along y or z.
SCREE_HD inline Index axis_blocks(const BinLevel& l, int axis) {
  return (l.cells[axis] + (1 << l.block_bits) - 1) >> l.block_bits;
}

/// Most cells of a level before padding. A level of few bodies still gets some, since
/// all others search it.
/// @param body_count  bodies of the level
/// @param total       bodies of all levels
SCREE_HD inline double cell_limit(Index body_count, double total) {
  constexpr double kShare = 1.0 / 64;  // for all kMaxLevels together a quarter
  double per_body = 2 * kCellsPerEdge;
  if ((per_body + kMaxLevels * kShare) * total > kMaxCells)
    per_body = kMaxCells / total - kMaxLevels * kShare;
  const double limit = per_body * body_count;
  const double least = kShare * total > 64 ? kShare * total : 64;
  return limit > least ? limit : least;
}

/// Cells of one level along the three axes.
/// @param limit   most cells before padding; where more would be needed, the longest axes wrap
///                earlier
/// @param period  [m]; zero: not periodic
/// @param edge    of a cell along y and z [m]
SCREE_HD inline void plan_level(const BodyExtent& extent, const Vec3<double>& period, double limit,
                                double edge, BinLevel& l) {
  const double edges[3] = {edge / kCellsPerEdge, edge, edge};
  double full[3];  // cells that would hold everything without wrapping early
  double cells[3];
  for (int k = 0; k < 3; ++k) {
    full[k] = period[k] > 0 ? std::floor(period[k] / edges[k])
                            : std::floor((extent.upper[k] - extent.lower[k]) / edges[k]) + 1;
    if (!(full[k] >= 1)) full[k] = 1;
    cells[k] = full[k] < kMaxAxisCells ? full[k] : kMaxAxisCells;
  }
  for (double product = cells[0] * cells[1] * cells[2]; product > limit;
       product = cells[0] * cells[1] * cells[2]) {
    int longest = 0;
    for (int k = 1; k < 3; ++k) {
      if (cells[k] * edges[k] > cells[longest] * edges[longest]) longest = k;
    }
    // As much shorter as is needed, but at most to one half, so that the three axes
    // shrink together.
    double shorter = std::floor(cells[longest] * limit / product);
    const double half = std::floor(cells[longest] / 2);
    if (shorter < half) shorter = half;
    cells[longest] = shorter < 1 ? 1 : shorter;
  }
  float largest = 0;
  Index smallest = kMaxAxisCells;
  for (int k = 0; k < 3; ++k) {
    l.cells[k] = static_cast<Index>(cells[k]);
    // A period is a whole number of wraps.
    l.edge[k] = period[k] > 0 ? period[k] / (std::floor(full[k] / cells[k]) * cells[k]) : edges[k];
    l.edge_f[k] = static_cast<float>(l.edge[k]);
    l.wrap[k] = l.edge[k] * cells[k];
    l.wrap_f[k] = static_cast<float>(l.wrap[k]);
    l.inv_wrap[k] = 1 / l.wrap_f[k];
    l.inv_edge[k] = static_cast<float>(1 / l.edge[k]);
    if (l.wrap_f[k] > largest) largest = l.wrap_f[k];
    if (k > 0 && l.cells[k] < smallest) smallest = l.cells[k];
  }
  l.slack = largest * (1.0f / (1 << 21));
  // Blocks at most a quarter of the shorter axis: rounding axes up to whole blocks wastes little.
  l.block_bits = 0;
  while (l.block_bits < 6 && (8 << l.block_bits) <= smallest) ++l.block_bits;
  // The shorter axis runs faster, so that rows of neighboring blocks stay close in a flat bed too.
  const bool is_flat = l.cells[2] < l.cells[1];
  l.stride[1] = is_flat ? axis_blocks(l, 2) : 1;
  l.stride[2] = is_flat ? 1 : axis_blocks(l, 1);
}

/// Number of cells of a level, padding of its blocks included.
SCREE_HD inline Index level_cells(const BinLevel& l) {
  return ((axis_blocks(l, 1) * axis_blocks(l, 2)) << (2 * l.block_bits)) * l.cells[0];
}

/// Whether pairs of two levels are found from the bodies of the coarser one, each of which searches
/// many rows, and not from those of the finer one, which search few.
SCREE_HD inline bool searches_finer(const BinLevel& coarse, const BinLevel& fine) {
  constexpr double kRowsInCoarser = 5;
  constexpr double kMostRows = 12;  // along an axis: the work for one body stays small
  const double rows = coarse.max_diameter / fine.edge.z + 2;
  return rows <= kMostRows && rows * rows * coarse.body_count <= kRowsInCoarser * fine.body_count;
}

/// Cuts the search of coarser levels in finer ones into slices.
SCREE_HD inline void plan_slices(BinGrid& g) {
  g.slice_count = 0;
  for (Index c = 0; c < g.level_count; ++c) {
    BinLevel& coarse = g.level[c];
    coarse.searched = 0;
    coarse.first_slice = g.slice_count;
    for (Index f = 0; f < c; ++f) {
      if (!searches_finer(coarse, g.level[f])) continue;
      coarse.searched |= 1u << f;
      g.slice_count += coarse.body_count * slices_of_body(coarse, g.level[f]);
    }
  }
}

/// Picks the edge of the finest level when the extent is known.
struct StoreExtent {
  BodyExtent* extent;
  double* edge;
  SCREE_HD void operator()(const BodyExtent& total) const {
    *extent = total;
    *edge = finest_edge(total);
  }
};

/// Lays out all levels when their numbers of bodies are known.
struct PlanBins {
  const BodyExtent* extent;
  const double* edge;
  Vec3<double> period;  ///< [m]; zero: not periodic
  BinGrid* grid;

  SCREE_HD void operator()(const LevelCounts& counts) const {
    BinGrid& g = *grid;
    g.level_count = 0;
    g.cell_count = 0;
    g.lower = {extent->lower[0], extent->lower[1], extent->lower[2]};
    double total = 0;
    for (const Index count : counts.count) total += count;
    double level_edge = *edge;
    for (int k = 0; k < kMaxLevels; ++k, level_edge *= 2) {
      if (counts.count[k] == 0) continue;
      BinLevel& l = g.level[g.level_count++];
      l.max_diameter = level_edge < extent->max_diameter ? level_edge : extent->max_diameter;
      plan_level(*extent, period, cell_limit(counts.count[k], total), l.max_diameter, l);
      l.first_cell = g.cell_count;
      l.body_count = counts.count[k];
      g.cell_count += level_cells(l);
    }
    plan_slices(g);
  }
};

}  // namespace scree
