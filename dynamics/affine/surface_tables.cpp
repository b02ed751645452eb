#include "dynamics/affine/surface_tables.h"

#include <algorithm>
#include <numeric>

namespace scree::affine {
namespace {

/// Features of a leaf at most.
constexpr std::size_t kLeaf = 4;

/// Sorts features by a tree of their boxes, halving them along the longest side of their centers.
class TreeBuilder {
 public:
  TreeBuilder(std::vector<TreeNode>& nodes, const std::vector<Bounds>& boxes, Index first)
      : nodes_(nodes), boxes_(boxes), first_(first), order_(boxes.size()) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    root_ = static_cast<Index>(nodes_.size());
    nodes_.emplace_back();
    split(static_cast<std::size_t>(root_), 0, boxes.size());
  }
  Index root() const { return root_; }
  const std::vector<std::size_t>& order() const { return order_; }

 private:
  void split(std::size_t node, std::size_t begin, std::size_t end) {
    Bounds all, centers;
    for (std::size_t k = begin; k < end; ++k) {
      const Bounds& box = boxes_[order_[k]];
      all.add(box);
      centers.add(0.5 * (box.low + box.high));
    }
    nodes_[node].center = 0.5 * (all.low + all.high);
    nodes_[node].half = 0.5 * (all.high - all.low);
    if (end - begin <= kLeaf) {
      nodes_[node].first = first_ + static_cast<Index>(begin);
      nodes_[node].count = static_cast<Index>(end - begin);
      return;
    }
    const Vec3d size = centers.high - centers.low;
    int axis = 0;
    for (int k = 1; k < 3; ++k) axis = size[k] > size[axis] ? k : axis;
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::size_t k) { return boxes_[k].low[axis] + boxes_[k].high[axis]; };
    const auto place = [&](std::size_t k) {
      return order_.begin() + static_cast<std::ptrdiff_t>(k);
    };
    std::nth_element(place(begin), place(middle), place(end), [&](std::size_t a, std::size_t b) {
      return at(a) < at(b) || (at(a) == at(b) && a < b);
    });
    const std::size_t children = nodes_.size();
    nodes_.resize(children + 2);
    nodes_[node].first = static_cast<Index>(children);
    split(children, begin, middle);
    split(children + 1, middle, end);
  }

  std::vector<TreeNode>& nodes_;
  const std::vector<Bounds>& boxes_;
  Index first_;
  Index root_ = 0;
  std::vector<std::size_t> order_;
};

template <class Features>
std::vector<Bounds> boxes_of(const Surface& surface, const Features& features) {
  std::vector<Bounds> boxes;
  for (const auto& feature : features) {
    Bounds box;
    for (const int v : feature) box.add(surface.vertices[static_cast<std::size_t>(v)]);
    boxes.push_back(box);
  }
  return boxes;
}

}  // namespace

HostTables tables_of(const std::vector<std::shared_ptr<const Surface>>& surfaces) {
  HostTables t;
  for (const auto& each : surfaces) {
    const Surface& surface = *each;
    SurfaceRecord r;
    r.first_corner = static_cast<Index>(t.corners.size());
    r.corner_count = static_cast<Index>(surface.vertices.size());
    Bounds box;
    for (const Vec3d& v : surface.vertices) box.add(v);
    r.center = 0.5 * (box.low + box.high), r.half = 0.5 * (box.high - box.low);
    t.corners.insert(t.corners.end(), surface.vertices.begin(), surface.vertices.end());
    r.first_edge = static_cast<Index>(t.edges.size());
    r.edge_count = static_cast<Index>(surface.edges.size());
    const std::vector<Bounds> edge_boxes = boxes_of(surface, surface.edges);
    const TreeBuilder edges(t.nodes, edge_boxes, r.first_edge);
    r.edge_root = edges.root();
    for (const std::size_t k : edges.order())
      t.edges.push_back(
          {{r.first_corner + surface.edges[k][0], r.first_corner + surface.edges[k][1]}});
    r.first_triangle = static_cast<Index>(t.triangles.size());
    r.triangle_count = static_cast<Index>(surface.triangles.size());
    const std::vector<Bounds> triangle_boxes = boxes_of(surface, surface.triangles);
    const TreeBuilder triangles(t.nodes, triangle_boxes, r.first_triangle);
    r.triangle_root = triangles.root();
    for (const std::size_t k : triangles.order()) {
      const auto& v = surface.triangles[k];
      t.triangles.push_back(
          {{r.first_corner + v[0], r.first_corner + v[1], r.first_corner + v[2]}});
    }
    t.surfaces.push_back(r);
  }
  return t;
}

}  // namespace scree::affine
