#pragma once
// Sorts bodies into hierarchical Morton bins.

#include "collision/growth.h"
#include "kernels/pair_search.h"

namespace scree {

template <class B, class Real>
class BroadPhase {
 public:
  explicit BroadPhase(B& b)
      : inflated_(b),
        cell_(b),
        body_(b),
        record_(b),
        cells_(b),
        extent_(b, 1),
        edge_(b, 1),
        grid_(b, 1) {}

  /// Bins all free bodies and all fixed or kinematic spheres; one host read (the grid).
  /// Bytes per body: 48 + 4 extent and levels, 40 keys, 24 per sorting pass of 8 bits (CUDA) or 11
  /// (CPU) out of log2(cells), 56 records; 8 to clear and about 8 to fill per cell, at most 4 cells
  /// a body.
  BinView build(B& b, SortSpace<B>& sort, const BodyView<Real>& bodies, const ContactRange& range,
                const SpareReach& spare) {
    const BinnedRange binned{bodies.free_count, bodies.fixed_begin, bodies.count};
    const Index n = binned.size();
    const Span<float> inflated = sized(inflated_, n);
    reduce<BodyExtent>(b, n, MeasureBodies<Real>{bodies, binned, range, spare, inflated},
                       StoreExtent{extent_.data(), edge_.data()});
    reduce<LevelCounts>(b, n, CountLevels{inflated, edge_.data()},
                        PlanBins{extent_.data(), edge_.data(), range.period, grid_.data()});
    const BinGrid grid = fetch(b, grid_.data());
    const Index cell_count = grid.cell_count;

    const Span<std::uint64_t> cell = sized(cell_, n);
    const Span<Index> body = sized(body_, n);
    for_each(b, n, BinBodies<Real>{bodies, binned, inflated, grid_.data(), cell, body});
    sort_pairs(b, sort, cell, body, bits_for(static_cast<std::uint64_t>(cell_count) + 1));

    const Span<BinRecord> record = sized(record_, n);
    const Span<CellRange> cells = sized(cells_, cell_count);
    fill(b, cells, CellRange{});
    for_each(b, n,
             GatherBins<Real>{bodies, binned, inflated, grid_.data(), cell, body, record, cells});
    return {grid_.data(), grid.lower, inflated, record, cell, body, cells};
  }

 private:
  Buffer<B, float> inflated_;
  Buffer<B, std::uint64_t> cell_;
  Buffer<B, Index> body_;
  Buffer<B, BinRecord> record_;
  Buffer<B, CellRange> cells_;
  Buffer<B, BodyExtent> extent_;
  Buffer<B, double> edge_;
  Buffer<B, BinGrid> grid_;
};

}  // namespace scree
