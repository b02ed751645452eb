#include "solvers/assembled/dissection.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace scree {
namespace {

/// Nodes of a part that is not split any further.
constexpr int few_nodes = 16;
/// Share of the nodes that must be on either side of a separator.
constexpr double least_share = 0.25;
/// Share of the nodes from which on a separator does not pay.
constexpr double largest_separator = 0.5;
constexpr int searches_for_an_end = 3;

class Dissection {
 public:
  Dissection(const std::vector<int>& row_start, const std::vector<int>& column)
      : row_start_(row_start),
        column_(column),
        set_(row_start.size() - 1, 0),
        level_(set_.size()) {}

  std::vector<DissectedPart> run() {
    std::vector<int> all(set_.size());
    for (std::size_t k = 0; k < all.size(); ++k) all[k] = static_cast<int>(k);
    split(all);
    return std::move(parts_);
  }

 private:
  /// Numbers a set of nodes, so that searches stay in it.
  void mark(const std::vector<int>& nodes) {
    ++set_count_;
    for (const int i : nodes) set_[i] = set_count_;
  }

  /// Nodes of the marked set that are reached from one, by ascending level.
  std::vector<int> search(int from) {
    std::vector<int> reached{from};
    const int here = set_[from];
    const int seen = ++set_count_;
    set_[from] = seen;
    level_[from] = 0;
    for (std::size_t k = 0; k < reached.size(); ++k) {
      const int i = reached[k];
      for (int e = row_start_[i]; e < row_start_[i + 1]; ++e) {
        const int j = column_[e];
        if (set_[j] != here) continue;
        set_[j] = seen;
        level_[j] = level_[i] + 1;
        reached.push_back(j);
      }
    }
    return reached;
  }

  /// Appends the parts of a set of nodes. @return its parts that have no parent yet
  std::vector<int> split(const std::vector<int>& nodes) {
    std::vector<int> roots;
    mark(nodes);
    const int whole = set_count_;
    std::vector<std::vector<int>> pieces;
    for (const int start : nodes)
      if (set_[start] == whole) pieces.push_back(search(start));
    for (std::vector<int>& piece : pieces)
      for (const int root : split_connected(std::move(piece))) roots.push_back(root);
    return roots;
  }

  std::vector<int> split_connected(std::vector<int> nodes) {
    const int count = static_cast<int>(nodes.size());
    if (count <= few_nodes) return {append(std::move(nodes), {})};
    for (int k = 0; k < searches_for_an_end; ++k) nodes = search(nodes.back());
    const int separator = best_level(nodes);
    if (separator < 0) return {append(std::move(nodes), {})};
    std::vector<int> before, behind, between;
    for (const int i : nodes) {
      if (level_[i] < separator || (level_[i] == separator && !touches_next(i))) {
        before.push_back(i);
      } else {
        (level_[i] == separator ? between : behind).push_back(i);
      }
    }
    std::vector<int> children = split(before);
    for (const int root : split(behind)) children.push_back(root);
    return {append(std::move(between), children)};
  }

  /// Whether a node has a neighbor in the level behind its own.
  bool touches_next(int i) const {
    for (int e = row_start_[i]; e < row_start_[i + 1]; ++e) {
      const int j = column_[e];
      if (set_[j] == set_[i] && level_[j] == level_[i] + 1) return true;
    }
    return false;
  }

  /// The smallest level with enough nodes on both sides, -1 when there is none that pays.
  /// @param nodes  by ascending level
  int best_level(const std::vector<int>& nodes) const {
    const double count = static_cast<double>(nodes.size());
    int best = -1;
    std::size_t best_size = 0;
    for (std::size_t first = 0; first < nodes.size();) {
      std::size_t last = first;
      while (last < nodes.size() && level_[nodes[last]] == level_[nodes[first]]) ++last;
      const double before = static_cast<double>(first), behind = count - static_cast<double>(last);
      const bool is_balanced = before >= least_share * count && behind >= least_share * count;
      // Where one level holds most of the nodes there may be no balance.
      const bool is_middle =
          first <= nodes.size() / 2 && last > nodes.size() / 2 && before > 0 && behind > 0;
      const std::size_t size = last - first;
      if ((is_balanced || (is_middle && best < 0)) && (best < 0 || size < best_size)) {
        best = level_[nodes[first]];
        best_size = size;
      }
      first = last;
    }
    return static_cast<double>(best_size) < largest_separator * count ? best : -1;
  }

  int append(std::vector<int> nodes, const std::vector<int>& children) {
    const int part = static_cast<int>(parts_.size());
    parts_.push_back({std::move(nodes), -1});
    for (const int child : children) parts_[child].parent = part;
    return part;
  }

  const std::vector<int>& row_start_;
  const std::vector<int>& column_;
  std::vector<int> set_;    ///< number of the set that a node was put into last
  std::vector<int> level_;  ///< of the last search
  int set_count_ = 0;
  std::vector<DissectedPart> parts_;
};

}  // namespace

std::vector<DissectedPart> dissect(const std::vector<int>& row_start,
                                   const std::vector<int>& column) {
  return Dissection(row_start, column).run();
}

}  // namespace scree
