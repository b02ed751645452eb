#pragma once
// Sorts bodies into hierarchical Morton bins.

#include "kernels/backend/backend.h"
#include "kernels/pair_search.h"

namespace scree {

/// Bins and the memory they lie in.
template <class B>
struct Bins {
  Bins(B& b, Index bodies)
      : inflated(b, bodies),
        cell(b, bodies),
        body(b, bodies),
        record(b, bodies),
        cells(b),
        grid(b, 1) {}
  Buffer<B, float> inflated;
  Buffer<B, std::uint64_t> cell;
  Buffer<B, Index> body;
  Buffer<B, BinRecord> record;
  Buffer<B, CellRange> cells;
  Buffer<B, BinGrid> grid;
  BinView view;
};

/// Bins all free bodies and all fixed or kinematic spheres; one host read (the grid).
/// Bytes per body: 48 + 4 extent and levels, 56 keys, 24 per sorting pass of 8 bits (CUDA) or 11
/// (CPU) out of log2(cells), 72 records; 8 to clear and about 8 to fill per cell, at most 4 cells
/// a body. Memory: 32 a body and 8 a cell, and 12 a body more while it sorts.
template <class B, class Real>
Bins<B> sort_into_bins(B& b, const BodyBalls<Real>& balls) {
  const BodyView<Real>& bodies = balls.bodies;
  const BinnedRange binned{bodies.free_count, bodies.fixed_begin, bodies.count};
  const Index n = binned.size();
  Bins<B> bins(b, n);
  Buffer<B, BodyExtent> extent(b, 1);
  Buffer<B, double> edge(b, 1);
  const Span<float> inflated = bins.inflated.view();
  const Span<std::uint64_t> cell = bins.cell.view();
  const Span<Index> body = bins.body.view();
  BinGrid* const on_backend = bins.grid.data();

  reduce<BodyExtent>(b, n, MeasureBodies<Real>{balls, binned, inflated},
                     StoreExtent{extent.data(), edge.data()});
  reduce<LevelCounts>(b, n, CountLevels{inflated, edge.data()},
                      PlanBins{extent.data(), edge.data(), balls.range.period, on_backend});
  const BinGrid grid = fetch(b, on_backend);
  for_each(b, n, BinBodies<Real>{balls, binned, inflated, on_backend, cell, body});
  {
    SortSpace<B> sort(b);
    sort_pairs(b, sort, cell, body, bits_for(static_cast<std::uint64_t>(grid.cell_count) + 1));
  }
  const Span<CellRange> cells = bins.cells.resize_discard(grid.cell_count);
  fill(b, cells, CellRange{});
  for_each(
      b, n,
      GatherBins<Real>{balls, binned, inflated, on_backend, cell, body, bins.record.view(), cells});
  bins.view = {on_backend, grid.lower, inflated, bins.record.view(), cell, body, cells};
  return bins;
}

}  // namespace scree
