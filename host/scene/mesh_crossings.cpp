#include "host/scene/mesh_crossings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace scree {
namespace {

constexpr double kTouching = 1e-9;  // of the size of the mesh
constexpr std::size_t kLeaf = 4;    // triangles

struct Bounds {
  Vec3d low, high;
  void add(const Bounds& other) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], other.low[k]);
      high[k] = std::max(high[k], other.high[k]);
    }
  }
  bool meets(const Bounds& other) const {
    for (int k = 0; k < 3; ++k)
      if (low[k] > other.high[k] || other.low[k] > high[k]) return false;
    return true;
  }
};
constexpr Bounds kNothing{
    {std::numeric_limits<double>::max(), std::numeric_limits<double>::max(),
     std::numeric_limits<double>::max()},
    {std::numeric_limits<double>::lowest(), std::numeric_limits<double>::lowest(),
     std::numeric_limits<double>::lowest()}};

using Corners = std::array<Vec3d, 3>;

/// Whether the edge from p to q passes through the inside of a triangle. @param least  distance that is not a touch
bool passes(const Vec3d& p, const Vec3d& q, const Corners& t, double least) {
  const Vec3d normal = cross(t[1] - t[0], t[2] - t[0]);
  const double size = norm(normal);
  if (!(size > 0)) return false;
  const double before = dot(normal, p - t[0]) / size, after = dot(normal, q - t[0]) / size;
  if (!((before > least && after < -least) || (before < -least && after > least))) return false;
  const Vec3d at = p + (before / (before - after)) * (q - p);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d edge = t[(k + 1) % 3] - t[k];
    const double inside = dot(cross(normal, edge), at - t[k]) / (size * norm(edge));
    if (!(inside > least)) return false;
  }
  return true;
}

class Search {
 public:
  explicit Search(const TriangleMesh& mesh) : mesh_(&mesh), order_(mesh.triangles.size()) {
    Bounds all = kNothing;
    for (std::size_t t = 0; t < order_.size(); ++t) {
      const Corners c = corners(static_cast<int>(t));
      Bounds b{c[0], c[0]};
      b.add({c[1], c[1]});
      b.add({c[2], c[2]});
      bounds_.push_back(b);
      all.add(b);
    }
    least_ = kTouching * norm(all.high - all.low);
    std::iota(order_.begin(), order_.end(), 0);
    if (!order_.empty()) build(0, order_.size());
  }

  std::optional<std::pair<int, int>> find() {
    if (!nodes_.empty()) within(0);
    return found_;
  }

 private:
  /// Triangles order_[begin, end); children at `left` and `right`, none in a leaf.
  struct Node {
    Bounds bounds;
    std::size_t begin, end;
    std::size_t left = 0, right = 0;
    bool is_leaf() const { return right == 0; }
  };

  Corners corners(int t) const {
    Corners c;
    for (std::size_t k = 0; k < 3; ++k)
      c[k] = mesh_->vertices[static_cast<std::size_t>(
          mesh_->triangles[static_cast<std::size_t>(t)][k])];
    return c;
  }

  std::size_t build(std::size_t begin, std::size_t end) {
    const std::size_t node = nodes_.size();
    Bounds bounds = kNothing;
    for (std::size_t i = begin; i < end; ++i) bounds.add(bounds_[index(i)]);
    nodes_.push_back({bounds, begin, end});
    if (end - begin <= kLeaf) return node;
    const Vec3d size = bounds.high - bounds.low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto middle = [&](int t) {
      const Bounds& b = bounds_[static_cast<std::size_t>(t)];
      return b.low[axis] + b.high[axis];
    };
    const std::size_t half = (begin + end) / 2;
    const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(half), at(end), [&](int a, int b) {
      return middle(a) < middle(b) || (middle(a) == middle(b) && a < b);
    });
    const std::size_t left = build(begin, half), right = build(half, end);
    nodes_[node].left = left;
    nodes_[node].right = right;
    return node;
  }

  void within(std::size_t node) {
    const Node& n = nodes_[node];
    if (n.is_leaf()) {
      for (std::size_t i = n.begin; i < n.end; ++i)
        for (std::size_t j = i + 1; j < n.end; ++j) test(order_[i], order_[j]);
      return;
    }
    within(n.left);
    within(n.right);
    between(n.left, n.right);
  }

  void between(std::size_t a, std::size_t b) {
    const Node &m = nodes_[a], &n = nodes_[b];
    if (found_ || !m.bounds.meets(n.bounds)) return;
    if (m.is_leaf() && n.is_leaf()) {
      for (std::size_t i = m.begin; i < m.end; ++i)
        for (std::size_t j = n.begin; j < n.end; ++j) test(order_[i], order_[j]);
    } else if (n.is_leaf() || (!m.is_leaf() && m.end - m.begin > n.end - n.begin)) {
      between(m.left, b);
      between(m.right, b);
    } else {
      between(a, n.left);
      between(a, n.right);
    }
  }

  void test(int a, int b) {
    if (found_ || !bounds_[static_cast<std::size_t>(a)].meets(bounds_[static_cast<std::size_t>(b)]))
      return;
    const auto& of_a = mesh_->triangles[static_cast<std::size_t>(a)];
    const auto& of_b = mesh_->triangles[static_cast<std::size_t>(b)];
    if (std::find_first_of(of_a.begin(), of_a.end(), of_b.begin(), of_b.end()) != of_a.end())
      return;
    const Corners s = corners(a), t = corners(b);
    for (std::size_t k = 0; k < 3; ++k)
      if (passes(s[k], s[(k + 1) % 3], t, least_) || passes(t[k], t[(k + 1) % 3], s, least_))
        found_ = std::minmax(a, b);
  }

  std::size_t index(std::size_t i) const { return static_cast<std::size_t>(order_[i]); }

  const TriangleMesh* mesh_;
  std::vector<int> order_;
  std::vector<Bounds> bounds_;
  std::vector<Node> nodes_;
  double least_ = 0;  ///< [m]
  std::optional<std::pair<int, int>> found_;
};

}  // namespace

std::optional<std::pair<int, int>> crossing_triangles(const TriangleMesh& mesh) {
  return Search(mesh).find();
}

}  // namespace scree
