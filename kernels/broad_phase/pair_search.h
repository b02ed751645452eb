#pragma once
// Finds the bodies near one body: a walk over the neighboring bins.

#include "kernels/broad_phase/binning.h"

namespace scree {

/// Bins as the search reads them, positions in cell order.
struct BinView {
  const BinGrid* grid = nullptr;
  Vec3<double> lower;          ///< origin of the grid [m]
  Index slice_count = 0;       ///< as the grid has it
  Span<const float> inflated;  ///< [binned.present_count()] [m]
  Span<const BinRecord> record;
  /// [binned.present_count()] of each position; the number of cells: not binned
  Span<const Index> cell;
  Span<const Index> body;   ///< [binned.present_count()] at each position
  Span<const Index> begin;  ///< [number of cells + 2] first position of each cell
};

/// Coordinates of the cells that overlap [x - reach, x + reach] along an axis, each once.
struct CellSpan {
  Index first;  ///< may be negative: coordinates wrap
  Index count;
  bool is_whole;  ///< all cells of the axis: a body's cell does not tell which image is near
};

SCREE_HD inline CellSpan cells_around(const BinLevel& l, int axis, float x, float reach) {
  const float inv = l.inv_edge[axis];
  const Index n = l.cells[axis];
  const auto low = static_cast<Index>(std::floor((x - reach) * inv));
  const auto high = static_cast<Index>(std::floor((x + reach) * inv));
  if (high - low + 1 >= n) return {0, n, true};
  return {low, high - low + 1, false};
}

/// Square of how far a coordinate is at least from those in the cell c of a span around it [m^2].
SCREE_HD inline float squared_distance(const BinLevel& l, int axis, const CellSpan& span, Index c,
                                       float x) {
  if (span.is_whole) return 0;  // it may be another image that is near
  const float low = static_cast<float>(c) * l.edge_f[axis];
  const float before = low - x, behind = x - (low + l.edge_f[axis]);
  const float d = (before > behind ? before : behind) - 2 * l.slack;
  return d > 0 ? d * d : 0;
}

/// A coordinate that wraps, and what to add to positions in its cell to bring them near.
struct WrappedCell {
  Index cell;
  float shift;
};

SCREE_HD inline WrappedCell wrapped_cell(Index c, Index n, float wrap) {
  if (c < 0) return {c + n, -wrap};
  if (c >= n) return {c - n, wrap};
  return {c, 0};
}

/// Shortest difference of two wrapped coordinates.
SCREE_HD inline float wrapped_difference(float d, float wrap, float inv_wrap) {
  return d - wrap * std::rint(d * inv_wrap);
}

/// Finds the pairs of binned bodies whose balls overlap, or nearly so; at least one of the two is
/// owned. Its elements are all positions in cell order, and then the slices of those of coarser
/// levels: a body searches one layer of cells of one finer level in each. So large bodies, which
/// have many neighbors, do not hold up small ones.
template <class Real>
struct PairSearch {
  BodyBalls<Real> balls;
  Index owned_count = 0;
  BinView bins;

  SCREE_HD Index size() const { return static_cast<Index>(bins.cell.size) + bins.slice_count; }

  /// Calls emit(other body) for each pair that an element finds. A position finds later bodies in
  /// the cells around it in its own level, and all bodies around it in coarser levels that do not
  /// find it themselves. Over all elements every pair is found once.
  template <class Emit>
  SCREE_HD void operator()(Index element, Emit&& emit) const {
    if (element < bins.cell.size) {
      search_from(element, emit);
    } else {
      search_slice(slice(element), emit);
    }
  }

  /// The body of an element.
  SCREE_HD Index body(Index element) const {
    return bins.body[element < bins.cell.size ? element : slice(element).position];
  }

 private:
  /// One layer of cells around a body in a finer level.
  struct Slice {
    Index position = 0;
    Index level = 0;  ///< of the body
    Index finer = 0;
    Index layer = 0;
  };

  SCREE_HD Slice slice(Index element) const {
    const BinGrid& grid = *bins.grid;
    Index left = element - static_cast<Index>(bins.cell.size);
    Slice s;
    for (s.level = grid.level_count - 1; grid.level[s.level].first_slice > left;) --s.level;
    const BinLevel& own = grid.level[s.level];
    left -= own.first_slice;
    // Bodies run faster than layers, and layers faster than levels: threads of a warp do the same.
    for (;; ++s.finer) {
      if ((own.searched >> s.finer & 1) == 0) continue;
      const Index count = own.body_count * slices_of_body(own, grid.level[s.finer]);
      if (left < count) break;
      left -= count;
    }
    s.layer = left / own.body_count;
    s.position = bins.begin[own.first_cell] + left % own.body_count;
    return s;
  }

  template <class Emit>
  SCREE_HD void search_from(Index p, Emit& emit) const {
    const Index own_cell = bins.cell[p];
    const BinGrid& grid = *bins.grid;
    if (own_cell >= grid.cell_count) return;
    const BinRecord own = bins.record[p];
    const Index i = bins.body[p];
    const Index own_level = level_of_cell(grid, own_cell);
    const float inflated = own.radius - grid.level[own_level].slack;

    search_level(grid.level[own_level], own.position, own.radius, {own_cell, p + 1}, i, emit);
    for (Index k = own_level + 1; k < grid.level_count; ++k) {
      const BinLevel& l = grid.level[k];
      if ((l.searched >> own_level & 1) != 0) continue;
      search_level(l, Vec3<float>(wrapped(grid, l, balls.center(i))), inflated + l.slack, {}, i,
                   emit);
    }
  }

  template <class Emit>
  SCREE_HD void search_slice(const Slice& s, Emit& emit) const {
    const BinGrid& grid = *bins.grid;
    const BinLevel& l = grid.level[s.finer];
    const Index i = bins.body[s.position];
    const float inflated = bins.record[s.position].radius - grid.level[s.level].slack;
    search_level(l, Vec3<float>(wrapped(grid, l, balls.center(i))), inflated + l.slack,
                 {0, 0, s.layer, 1}, i, emit);
  }

  /// What of a level is searched.
  struct Part {
    Index cell = 0;      ///< rows before that of this cell are left out
    Index position = 0;  ///< bodies at positions before this one are left out
    Index layer = 0;     ///< of the cells around the body along z, those from here
    Index layers = 0;    ///< so many of them; 0: all
  };

  /// @param x       position of the body, wrapped in this level
  /// @param radius  inflated, with slack
  /// @param i       the body
  template <class Emit>
  SCREE_HD void search_level(const BinLevel& l, const Vec3<float>& x, float radius,
                             const Part& part, Index i, Emit& emit) const {
    const float reach = reach_in(l, radius);
    const float reach2 = reach * reach * 1.00001f;
    const CellSpan sy = cells_around(l, 1, x.y, reach);
    const CellSpan sz = cells_around(l, 2, x.z, reach);
    const bool is_small = cells_around(l, 0, x.x, reach).is_whole || sy.is_whole || sz.is_whole;
    const Index end_z = part.layers > 0 && part.layer + part.layers < sz.count
                            ? part.layer + part.layers
                            : sz.count;
    for (Index kz = part.layer; kz < end_z; ++kz) {
      const float left_z = reach2 - squared_distance(l, 2, sz, sz.first + kz, x.z);
      const WrappedCell cz = wrapped_cell(sz.first + kz, l.cells[2], l.wrap_f.z);
      for (Index ky = 0; ky < sy.count; ++ky) {
        const float left = left_z - squared_distance(l, 1, sy, sy.first + ky, x.y);
        if (!(left > 0)) continue;
        const WrappedCell cy = wrapped_cell(sy.first + ky, l.cells[1], l.wrap_f.y);
        const Index row = first_of_row(l, cy.cell, cz.cell);
        if (row + l.cells[0] <= part.cell) continue;
        const CellSpan sx = cells_around(l, 0, x.x, std::sqrt(left));
        for (Index kx = 0; kx < sx.count;) {
          const WrappedCell cx = wrapped_cell(sx.first + kx, l.cells[0], l.wrap_f.x);
          const Index length =
              sx.count - kx < l.cells[0] - cx.cell ? sx.count - kx : l.cells[0] - cx.cell;
          kx += length;
          const Index begin = bins.begin[row + cx.cell], end = bins.begin[row + cx.cell + length];
          const Vec3<float> near{x.x - cx.shift, x.y - cy.shift, x.z - cz.shift};
          for (Index q = begin > part.position ? begin : part.position; q < end; ++q) {
            const BinRecord other = bins.record[q];
            Vec3<float> d = other.position - near;
            if (is_small) {
              d = {wrapped_difference(d.x, l.wrap_f.x, l.inv_wrap.x),
                   wrapped_difference(d.y, l.wrap_f.y, l.inv_wrap.y),
                   wrapped_difference(d.z, l.wrap_f.z, l.inv_wrap.z)};
            }
            const float sum = radius + other.radius;
            if (norm2(d) > sum * sum * 1.00001f) continue;
            const Index j = bins.body[q];
            if (i < owned_count || j < owned_count) emit(j);
          }
        }
      }
    }
  }
};

}  // namespace scree
