#pragma once
// The sites of a lattice in a region, never listed one by one: what a packing costs follows the
// spheres it places, however wide the region is.

#include <algorithm>
#include <vector>

#include "host/layouts/layouts.h"

namespace scree {

/// Neighboring sites along x.
struct SiteRun {
  long long plane = 0;
  long long row = 0;
  long long begin = 0;  ///< number along x of the first site
  long long end = 0;    ///< behind the last one
};

/// The sites of a layout in horizontal planes from the bottom up, in a plane row by row.
class LatticeSites {
 public:
  /// @throws DoesNotFit when positions cannot be told apart so far out, see require_resolution()
  LatticeSites(const LatticeLayout& layout, const SizeLaw& size);

  /// Lattice cells of the box around the region.
  double cell_count() const;
  /// Cells along x, y and z.
  const long long* cells() const { return cells_; }
  bool is_box() const { return region_.kind == Region::Kind::box; }
  Vec3d position(long long plane, long long row, long long x) const;

  /// Calls f(run) for the runs of sites of the lowest planes, in order, until it returns false.
  /// @param wanted  sites that are needed, which bounds the search
  /// @throws DoesNotFit when very many rows had to be searched
  template <class F>
  void for_each_run(long long wanted, F f) const {
    if (cell_count() == 0) return;
    RowBudget budget(*this, wanted);
    for (long long plane = 0; plane < cells_[2]; ++plane) {
      const Range rows = rows_of(plane);
      budget.spend(1);
      for (long long row = rows.begin; row < rows.end; ++row) {
        budget.spend(1);
        const Range sites = sites_of(plane, row);
        if (sites.begin < sites.end && !f(SiteRun{plane, row, sites.begin, sites.end})) return;
      }
    }
  }

  /// Sites of the region, or so many as were wanted. Takes no time in a box.
  long long count_up_to(long long wanted) const;

 private:
  struct Range {
    long long begin = 0;
    long long end = 0;
  };
  /// Rows that may be searched.
  class RowBudget {
   public:
    RowBudget(const LatticeSites& sites, long long wanted);
    void spend(long long rows) {
      if ((left_ -= rows) < 0) refuse();
    }

   private:
    [[noreturn]] void refuse() const;
    const LatticeSites& sites_;
    long long most_;
    long long left_;
  };

  Range rows_of(long long plane) const;
  Range sites_of(long long plane, long long row) const;
  /// Numbers of the lattice coordinates in an interval of an axis [m], and some beside them.
  Range around(int axis, double low, double high) const;

  const Region& region_;
  double spacing_;
  double reach_;  ///< of the largest sphere from its site [m]
  long long cells_[3];
  Vec3d first_;
};

/// The sites of the lowest planes, of as many as hold the sites that are wanted:
/// numbered, not listed.
class LowestSites {
 public:
  /// @throws DoesNotFit when the region does not hold so many, or far too many in one plane
  LowestSites(const LatticeSites& sites, const LatticeLayout& layout, long long wanted);

  long long count() const { return count_; }
  long long planes() const { return planes_; }
  Vec3d position(long long number) const;

 private:
  void take_planes_of_box(long long wanted);
  void take_runs(long long wanted);
  void check_sum(double sites) const;

  const LatticeSites& sites_;
  double spacing_;
  long long count_ = 0;
  long long planes_ = 0;
  std::vector<SiteRun> runs_;     ///< none in a box
  std::vector<long long> first_;  ///< number of the first site of each run
};

}  // namespace scree
