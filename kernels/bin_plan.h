#pragma once
// Lays out the bins of one step from the extent of the bodies and their number per level.

#include "kernels/bin_grid.h"

namespace scree {

/// Most cells along an axis: float coordinates then resolve 1/64 of a cell.
inline constexpr Index kMaxAxisCells = 1 << 17;

/// Most cells of a level before padding: all levels together stay below 2^31.
inline constexpr double kMaxLevelCells = 5e8;

/// Blocks along an axis.
SCREE_HD inline Index axis_blocks(const BinLevel& l, int axis) {
  return (l.cells[axis] + (1 << l.block_bits) - 1) >> l.block_bits;
}

/// Cells of one level along the three axes.
/// @param body_count  bodies of the level; there are at most max(64, 2 body_count) cells, so beyond
/// that the
///                    longest axes wrap earlier
/// @param period      [m]; zero: not periodic
SCREE_HD inline void plan_level(const BodyExtent& extent, const Vec3<double>& period,
                                Index body_count, double edge, BinLevel& l) {
  double full[3];  // cells that would hold everything without wrapping early
  double cells[3];
  for (int k = 0; k < 3; ++k) {
    full[k] = period[k] > 0 ? std::floor(period[k] / edge)
                            : std::floor((extent.upper[k] - extent.lower[k]) / edge) + 1;
    if (!(full[k] >= 1)) full[k] = 1;
    cells[k] = full[k] < kMaxAxisCells ? full[k] : kMaxAxisCells;
  }
  double limit = body_count > 32 ? 2.0 * body_count : 64.0;
  if (limit > kMaxLevelCells) limit = kMaxLevelCells;
  for (double product = cells[0] * cells[1] * cells[2]; product > limit;
       product = cells[0] * cells[1] * cells[2]) {
    int longest = 0;
    for (int k = 1; k < 3; ++k) {
      if (cells[k] > cells[longest]) longest = k;
    }
    // As much shorter as is needed, but at most to one half, so that the three axes shrink
    // together.
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
    l.edge[k] = period[k] > 0 ? period[k] / (std::floor(full[k] / cells[k]) * cells[k]) : edge;
    l.wrap[k] = l.edge[k] * cells[k];
    l.wrap_f[k] = static_cast<float>(l.wrap[k]);
    l.inv_wrap[k] = 1 / l.wrap_f[k];
    l.inv_edge[k] = static_cast<float>(1 / l.edge[k]);
    if (l.wrap_f[k] > largest) largest = l.wrap_f[k];
    if (l.cells[k] < smallest) smallest = l.cells[k];
  }
  l.slack = largest * (1.0f / (1 << 21));
  // Blocks at most a quarter of the shortest axis: rounding axes up to whole blocks wastes little.
  l.block_bits = 0;
  while (l.block_bits < 6 && (8 << l.block_bits) <= smallest) ++l.block_bits;
  // The shortest axis runs fastest, so that cells of neighboring blocks stay close in a flat bed
  // too.
  for (int k = 0; k < 3; ++k) {
    l.stride[k] = 1;
    for (int o = 0; o < 3; ++o) {
      if (l.cells[o] < l.cells[k] || (l.cells[o] == l.cells[k] && o < k))
        l.stride[k] *= axis_blocks(l, o);
    }
  }
}

/// Number of cells of a level, padding of its blocks included.
SCREE_HD inline Index level_cells(const BinLevel& l) {
  return (axis_blocks(l, 0) * axis_blocks(l, 1) * axis_blocks(l, 2)) << (3 * l.block_bits);
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
    double level_edge = *edge;
    for (int k = 0; k < kMaxLevels; ++k, level_edge *= 2) {
      if (counts.count[k] == 0) continue;
      BinLevel& l = g.level[g.level_count++];
      l.max_diameter = level_edge < extent->max_diameter ? level_edge : extent->max_diameter;
      plan_level(*extent, period, counts.count[k], l.max_diameter, l);
      l.first_cell = g.cell_count;
      g.cell_count += level_cells(l);
    }
  }
};

}  // namespace scree
