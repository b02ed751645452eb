#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "host/layouts/drawn_sizes.h"

namespace scree {
namespace {

constexpr int kAttempts = 5000;  // failed places of one sphere before the region counts as full

/// Uniform grid; a sphere is listed in every cell that its bounding box touches, so two spheres
/// that overlap share a cell whatever their sizes.
class SphereGrid {
 public:
  SphereGrid(const Vec3d& low, const Vec3d& high, double cell, std::size_t most_cells) : low_(low) {
    for (;; cell *= 1.25) {
      double total = 1;
      for (int k = 0; k < 3; ++k) {
        cells_[k] = std::max(1.0, std::ceil((high[k] - low[k]) / cell));
        total *= cells_[k];
      }
      if (total <= static_cast<double>(most_cells)) break;
    }
    cell_ = cell;
    heads_.assign(static_cast<std::size_t>(cells_[0] * cells_[1] * cells_[2]), kNone);
  }

  /// @param centers, sizes  of the spheres inserted so far, and of more
  bool is_clear(const Vec3d& center, double radius, const std::vector<Vec3d>& centers,
                const DrawnSizes& sizes) const {
    bool clear = true;
    for_cells(center, radius, [&](std::size_t cell) {
      for (std::size_t e = heads_[cell]; clear && e != kNone; e = entries_[e].next) {
        const std::size_t other = entries_[e].sphere;
        const double reach = radius + sizes.radius(other);
        clear = norm2(center - centers[other]) >= reach * reach;
      }
    });
    return clear;
  }

  void insert(const Vec3d& center, double radius, std::size_t index) {
    for_cells(center, radius, [&](std::size_t cell) {
      entries_.push_back({static_cast<std::uint32_t>(index), heads_[cell]});
      heads_[cell] = static_cast<std::uint32_t>(entries_.size() - 1);
    });
  }

 private:
  template <class F>
  void for_cells(const Vec3d& center, double radius, F f) const {
    int from[3];
    int to[3];
    for (int k = 0; k < 3; ++k) {
      const double last = cells_[k] - 1;
      from[k] = static_cast<int>(
          std::clamp(std::floor((center[k] - radius - low_[k]) / cell_), 0.0, last));
      to[k] = static_cast<int>(
          std::clamp(std::floor((center[k] + radius - low_[k]) / cell_), 0.0, last));
    }
    for (int z = from[2]; z <= to[2]; ++z)
      for (int y = from[1]; y <= to[1]; ++y)
        for (int x = from[0]; x <= to[0]; ++x)
          f((static_cast<std::size_t>(z) * static_cast<std::size_t>(cells_[1]) +
             static_cast<std::size_t>(y)) *
                static_cast<std::size_t>(cells_[0]) +
            static_cast<std::size_t>(x));
  }

  static constexpr auto kNone = static_cast<std::uint32_t>(-1);
  /// One sphere in the list of one cell.
  struct Entry {
    std::uint32_t sphere;
    std::uint32_t next;  ///< entry, or kNone
  };

  Vec3d low_;
  double cell_ = 0;
  double cells_[3] = {1, 1, 1};
  std::vector<std::uint32_t> heads_;  ///< first entry of each cell, or kNone
  std::vector<Entry> entries_;
};

/// A uniformly distributed center for which the sphere lies inside, or false when one draw missed.
bool draw_center(const Region& region, const Vec3d& low, const Vec3d& high, double r,
                 RandomNumbers& random, Vec3d& center) {
  if (region.kind == Region::Kind::box) {
    for (int k = 0; k < 3; ++k) center[k] = random.uniform(low[k] + r, high[k] - r);
    return true;
  }
  const double a = random.uniform(-1, 1) * (region.radius - r);
  const double b = random.uniform(-1, 1) * (region.radius - r);
  const double along = random.uniform(-0.5, 0.5) * (region.length - 2 * r);
  const Vec3d e1 = any_orthogonal(region.axis);
  const Vec3d e2 = cross(region.axis, e1);
  for (int k = 0; k < 3; ++k)
    center[k] =
        std::fma(a, e1[k], std::fma(b, e2[k], std::fma(along, region.axis[k], region.center[k])));
  return region.contains(center, r);
}

bool can_hold(const Region& region, const Vec3d& low, const Vec3d& high, double r) {
  if (region.kind == Region::Kind::cylinder) return r <= region.radius && 2 * r <= region.length;
  for (int k = 0; k < 3; ++k)
    if (2 * r > high[k] - low[k]) return false;
  return true;
}

}  // namespace

PlacedSpheres place_at_random(const Region& region, const SizeLaw& size, long long count,
                              RandomNumbers& random) {
  require_resolution(region, size.smallest());
  require_host_memory(count, size);
  const auto wanted = static_cast<std::size_t>(count);
  DrawnSizes sizes(size, wanted);
  for (std::size_t i = 0; i < wanted; ++i) sizes.draw(random);
  sizes.sort_largest_first();
  PlacedSpheres spheres;
  if (wanted == 0) return spheres;
  std::vector<Vec3d>& centers = spheres.center;
  centers.reserve(wanted);

  Vec3d low;
  Vec3d high;
  region.bounds(low, high);
  const auto fail = [&](const char* why) {
    throw DoesNotFit(fmt::format("{} of {} spheres fit{}", centers.size(), count, why));
  };
  if (!can_hold(region, low, high, sizes.radius(0)))
    fail(": the largest sphere is wider than the region");
  SphereGrid grid(low, high, 2 * sizes.radius(wanted / 2), 4 * wanted + 64);
  for (std::size_t i = 0; i < wanted; ++i) {
    const double r = sizes.radius(i);
    Vec3d center;
    for (int attempt = 0;; ++attempt) {
      if (attempt == kAttempts)
        fail(
            " without overlap; random placement fills about a third of a region, use a larger one "
            "or the layout \"lattice\" or \"rain\"");
      if (draw_center(region, low, high, r, random, center) &&
          grid.is_clear(center, r, centers, sizes))
        break;
    }
    grid.insert(center, r, centers.size());
    centers.push_back(center);
  }
  sizes.move_to(spheres);
  return spheres;
}

}  // namespace scree
