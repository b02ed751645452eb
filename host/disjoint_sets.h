#pragma once
// Elements that belong together because others say so, pair by pair.

#include <algorithm>
#include <numeric>
#include <vector>

namespace scree {

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }

  void join(std::size_t a, std::size_t b) {
    a = root(a), b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }
  /// The lowest element of the set.
  std::size_t root(std::size_t x) {
    while (parent_[x] != x) x = parent_[x] = parent_[parent_[x]];
    return x;
  }

 private:
  std::vector<std::size_t> parent_;
};

}  // namespace scree
