#pragma once
// Element programs that order bodies along the Morton curve and tell when the order has decayed.

#include "kernels/backend/backend.h"
#include "kernels/math/morton.h"
#include "kernels/math/vec3.h"

namespace scree {

/// Sum of positions [m], and their number. Positions that are not finite do not count.
struct SumPositions {
  static constexpr const char* name = "sum_positions";
  Span<const Vec3<double>> position;
  SCREE_HD Sums<4> operator()(Index i) const {
    Sums<4> s;
    if (!is_finite(position[i])) return s;
    for (int k = 0; k < 3; ++k) s.value[k] = position[i][k];
    s.value[3] = 1;
    return s;
  }
};

/// Center of the positions that were summed.
SCREE_HD inline Vec3<double> mean_position(const Sums<4>& sums) {
  if (!(sums.value[3] > 0)) return {};
  return (1 / sums.value[3]) * Vec3<double>{sums.value[0], sums.value[1], sums.value[2]};
}

/// Sum of the distances from the center [m]: a measure of size that a few bodies far
/// away do not ruin.
struct SumDeviations {
  static constexpr const char* name = "sum_deviations";
  Span<const Vec3<double>> position;
  const Sums<4>* positions;
  SCREE_HD Sums<1> operator()(Index i) const {
    Sums<1> s;
    if (is_finite(position[i])) s.value[0] = norm(position[i] - mean_position(*positions));
    return s;
  }
};

/// Bodies that come behind all others in storage, wherever they are: those others then keep the order that they have without
/// them.
struct LateBodies {
  Span<const Index> id = {};  ///< by place; empty: none is late
  Index first_id = 0;         ///< those of late ones begin here
  Index count = 0;
};

/// Morton code of each position, behind all others for late bodies, and the index that is sorted with it. The 2^20 cells of
/// an axis cover 64 mean distances from the center; farther out they repeat.
struct MortonKeys {
  static constexpr const char* name = "morton_keys";
  static constexpr double kSpan = 64;
  static constexpr int kLateBit = 3 * kMortonBits;
  Span<const Vec3<double>> position;
  const Sums<4>* positions;
  const Sums<1>* deviations;
  LateBodies late;
  Span<std::uint64_t> key;
  Span<Index> order;

  SCREE_HD void operator()(Index i) const {
    order[i] = i;
    const double size = deviations->value[0] > 0 ? deviations->value[0] / positions->value[3] : 1;
    const Vec3<double> offset = position[i] - mean_position(*positions);
    std::uint32_t c[3];
    for (int k = 0; k < 3; ++k) {
      double x = offset[k] / (kSpan * size) + 0.5;
      x -= std::floor(x);
      c[k] = x >= 0 && x < 1 ? static_cast<std::uint32_t>(x * (1u << kMortonBits)) : 0;
    }
    const bool is_late = late.id.size > 0 && late.id[i] >= late.first_id;
    key[i] = morton_code(c[0], c[1], c[2]) | static_cast<std::uint64_t>(is_late) << kLateBit;
  }
};

/// Distance from each body to the next one in storage. Bytes per body: 24 read.
struct StorageDistance {
  static constexpr const char* name = "storage_distance";
  Span<const Vec3<double>> position;
  SCREE_HD Sums<1> operator()(Index i) const {
    Sums<1> s;
    s.value[0] = norm(position[i + 1] - position[i]);
    return s;
  }
};

}  // namespace scree
