#pragma once
// Sizes of particles in the order in which they are drawn; what all of them share is not stored.

#include <algorithm>
#include <functional>
#include <numeric>
#include <utility>
#include <vector>

#include "host/layouts/layouts.h"

namespace scree {

class DrawnSizes {
 public:
  DrawnSizes(const SizeLaw& law, std::size_t count) : law_(law), same_(law.largest()) {
    if (law_.is_constant()) return;
    radii_.reserve(count);
    if (!law_.has_shapes()) return;
    scales_.reserve(count);
    shapes_.reserve(count);
  }

  /// @return radius of the particle [m]
  double draw(RandomNumbers& random) {
    const SizeLaw::Size size = law_.draw(random);
    if (law_.is_constant()) return size.radius;
    radii_.push_back(size.radius);
    if (!law_.has_shapes()) return size.radius;
    scales_.push_back(size.scale);
    shapes_.push_back(size.shape);
    return size.radius;
  }

  void sort_largest_first() {
    if (scales_.empty()) {
      std::sort(radii_.begin(), radii_.end(), std::greater<>());
      return;
    }
    std::vector<std::size_t> order(radii_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    // Stable: shapes of the same radius have one order on all platforms.
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return radii_[a] > radii_[b]; });
    put_in_order(order, radii_);
    put_in_order(order, scales_);
    put_in_order(order, shapes_);
  }

  double radius(std::size_t i) const { return radii_.empty() ? same_ : radii_[i]; }

  /// Hands the sizes over.
  void move_to(PlacedSpheres& placed) {
    if (law_.is_constant()) {
      placed.radius = same_;
      if (law_.has_shapes()) placed.scale = law_.scale.largest();
      return;
    }
    placed.radius = PerParticle<double>(std::move(radii_));
    if (!law_.has_shapes()) return;
    placed.scale = PerParticle<double>(std::move(scales_));
    placed.shape = PerParticle<int>(std::move(shapes_));
  }

 private:
  template <class T>
  static void put_in_order(const std::vector<std::size_t>& order, std::vector<T>& values) {
    std::vector<T> sorted;
    sorted.reserve(order.size());
    for (const std::size_t i : order) sorted.push_back(values[i]);
    values = std::move(sorted);
  }

  const SizeLaw& law_;
  double same_;  ///< radius of all of them [m]
  std::vector<double> radii_;
  std::vector<double> scales_;
  std::vector<int> shapes_;
};

}  // namespace scree
