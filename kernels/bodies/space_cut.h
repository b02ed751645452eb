#pragma once
// Space in parts, one for each rank.

#include "kernels/backend/backend.h"
#include "kernels/math/vec3.h"

namespace scree {

/// A cut of space: places below it go to the ranks of one side, the others to those of the other.
struct SpaceCut {
  int axis = 0;
  double position = 0;
  int lower = 0;  ///< number of the cut on either side, or -1 - rank
  int upper = 0;
};

/// The rank that owns a place. @param cuts  the first one divides all space; none: there is one rank
SCREE_HD inline int owner_of(Span<const SpaceCut> cuts, const Vec3<double>& x) {
  if (cuts.empty()) return 0;
  int next = 0;
  do {
    const SpaceCut& cut = cuts[next];
    next = x[cut.axis] < cut.position ? cut.lower : cut.upper;
  } while (next >= 0);
  return -1 - next;
}

/// Counts bodies that are in the space of another rank. Bytes a body: 24.
struct CountStrays {
  static constexpr const char* name = "count_strays";
  Span<const SpaceCut> cuts;
  Span<const Vec3<double>> position;
  int rank;
  SCREE_HD Sums<1> operator()(Index i) const {
    return {{owner_of(cuts, position[i]) == rank ? 0.0 : 1.0}};
  }
};

}  // namespace scree
