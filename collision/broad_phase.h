#pragma once
// Sorts bodies into hierarchical Morton bins.

#include "kernels/backend/backend.h"
#include "kernels/broad_phase/pair_search.h"

namespace scree {

/// Bins and the memory they lie in.
template <class B>
struct Bins {
  Bins(B& b, Index bodies)
      : inflated(b, bodies),
        cell(b, bodies),
        body(b, bodies),
        record(b, bodies),
        begin(b),
        grid(b, 1) {}
  Buffer<B, float> inflated;
  Buffer<B, Index> cell;
  Buffer<B, Index> body;
  Buffer<B, BinRecord> record;
  Buffer<B, Index> begin;
  Buffer<B, BinGrid> grid;
  BinView view;
};

/// Bins all free bodies and all fixed or kinematic spheres; one host read (the grid). Within a cell
/// bodies are in any order, not the same on every run.
/// Bytes per body: 48 + 4 extent and levels, 56 cells, 84 records; 16 per cell, at most 6.5 cells a
/// body. Memory: 28 a body and 4 a cell, and 8 a body and 4 a cell more while it bins.
template <class B, class Real>
Bins<B> sort_into_bins(B& b, const BodyBalls<Real>& balls) {
  const BodyView<Real>& bodies = balls.bodies;
  const BodyRanges& binned = bodies.ranges();
  const Index n = binned.present_count();
  Bins<B> bins(b, n);
  Buffer<B, BodyExtent> extent(b, 1);
  Buffer<B, double> edge(b, 1);
  const Span<float> inflated = bins.inflated.view();
  BinGrid* const on_backend = bins.grid.data();

  reduce<BodyExtent>(b, n, MeasureBodies<Real>{balls, binned, inflated},
                     StoreExtent{extent.data(), edge.data()});
  reduce<LevelCounts>(b, n, CountLevels{inflated, edge.data()},
                      PlanBins{extent.data(), edge.data(), balls.range.period, on_backend});
  const BinGrid grid = fetch(b, on_backend);
  const Offset cells = static_cast<Offset>(grid.cell_count) + 1;  // the last: bodies not binned
  Buffer<B, Index> cell(b, n), rank(b, n), count(b, cells);
  fill(b, count.view(), Index(0));
  for_each(
      b, n,
      BinBodies<Real>{balls, binned, inflated, on_backend, cell.view(), rank.view(), count.view()});
  const Span<Index> begin = bins.begin.resize_discard(cells + 1);
  exclusive_scan(b, Span<const Index>(count.view()), begin);
  for_each(b, n,
           PlaceBodies<Real>{balls, binned, inflated, on_backend, cell.view(), rank.view(), begin,
                             bins.cell.view(), bins.body.view(), bins.record.view()});
  bins.view = {on_backend,         grid.lower,       grid.slice_count, inflated,
               bins.record.view(), bins.cell.view(), bins.body.view(), begin};
  return bins;
}

}  // namespace scree
