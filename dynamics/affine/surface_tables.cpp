#include "dynamics/affine/surface_tables.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "collision/numbering.h"
#include "solvers/solver.h"

namespace scree::affine {
namespace {

void require(bool ok, const std::string& what) {
  if (!ok) throw InvalidParameter(what);
}

/// Center and half extents in float, so that the box holds the one given.
TreeNode node_about(const Bounds& box) {
  TreeNode node;
  for (int k = 0; k < 3; ++k) {
    node.center[k] = static_cast<float>(0.5 * (box.low[k] + box.high[k]));
    const double half = std::max(box.high[k] - node.center[k], node.center[k] - box.low[k]);
    node.half[k] = static_cast<float>(half);
    if (node.half[k] < half)
      node.half[k] = std::nextafter(node.half[k], std::numeric_limits<float>::infinity());
  }
  return node;
}

/// Sorts features by a tree of their boxes, halving them along the longest side of their centers. Leaves are full but for the
/// last one. The order depends on the features alone: equal places are taken by number.
class TreeBuilder {
 public:
  TreeBuilder(HostTables& tables, const std::vector<Bounds>& boxes)
      : tables_(tables),
        boxes_(boxes),
        first_(static_cast<Index>(tables.features.size())),
        order_(boxes.size()) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    if (!order_.empty()) add(0, order_.size(), std::numeric_limits<std::size_t>::max());
  }
  const std::vector<std::size_t>& order() const { return order_; }

  /// Boxes that hold all features: those of nodes with no more than a part of them.
  std::vector<TreeNode> outline() const {
    std::vector<TreeNode> found;
    const std::size_t most =
        std::max<std::size_t>(kLeafFeatures, (2 * order_.size()) / kOutlineBoxes);
    for (std::size_t node = 0; node < size_.size();) {
      const TreeNode& n = tables_.nodes[begin_ + node];
      if (size_[node] > most) {
        ++node;
        continue;
      }
      found.push_back(n);
      node = static_cast<std::size_t>(n.after(static_cast<Index>(begin_ + node))) - begin_;
    }
    return found;
  }

 private:
  void add(std::size_t begin, std::size_t end, std::size_t parent_size) {
    const std::size_t own = tables_.nodes.size(), size = end - begin;
    Bounds all, centers;
    for (std::size_t k = begin; k < end; ++k) {
      const Bounds& box = boxes_[order_[k]];
      all.add(box);
      centers.add(0.5 * (box.low + box.high));
    }
    tables_.nodes.push_back(node_about(all));
    tables_.nodes[own].begin = first_ + static_cast<Index>(begin);
    size_.push_back(size);
    constexpr std::size_t kLeaf = kLeafFeatures, kBlock = kBlockFeatures;
    if (size <= kBlock && parent_size > kBlock) tables_.blocks.push_back(static_cast<Index>(own));
    if (size <= kLeaf) {
      std::sort(at(begin), at(end));
      tables_.nodes[own].skip = -static_cast<Index>(size);
      return;
    }
    const Vec3d extent = centers.high - centers.low;
    int axis = 0;
    for (int k = 1; k < 3; ++k) axis = extent[k] > extent[axis] ? k : axis;
    const std::size_t leaves = (size + kLeaf - 1) / kLeaf;
    const std::size_t middle = begin + (leaves + 1) / 2 * kLeaf;
    const auto place = [&](std::size_t k) { return boxes_[k].low[axis] + boxes_[k].high[axis]; };
    std::nth_element(at(begin), at(middle), at(end), [&](std::size_t a, std::size_t b) {
      return place(a) < place(b) || (place(a) == place(b) && a < b);
    });
    add(begin, middle, size);
    add(middle, end, size);
    tables_.nodes[own].skip = static_cast<Index>(tables_.nodes.size());
  }
  std::vector<std::size_t>::iterator at(std::size_t k) {
    return order_.begin() + static_cast<std::ptrdiff_t>(k);
  }

  HostTables& tables_;
  const std::vector<Bounds>& boxes_;
  Index first_;
  std::size_t begin_ = tables_.nodes.size();
  std::vector<std::size_t> order_, size_;
};

/// Adds the tree of features of one kind. @param corners  of each feature, in the surface. @return its outline
template <class Corners>
std::vector<TreeNode> add_tree(HostTables& tables, const Surface& surface, Index first_corner,
                               const Corners& corners) {
  std::vector<Bounds> boxes;
  for (const auto& feature : corners) {
    Bounds box;
    for (const int v : feature) box.add(surface.vertices[static_cast<std::size_t>(v)]);
    boxes.push_back(box);
  }
  const TreeBuilder tree(tables, boxes);
  for (const std::size_t k : tree.order()) {
    Feature f;
    for (const int v : corners[k]) f.corner[f.count++] = first_corner + v;
    tables.features.push_back(f);
  }
  return tree.outline();
}

}  // namespace

HostTables tables_of(const std::vector<std::shared_ptr<const Surface>>& surfaces) {
  std::size_t features = 0;
  for (const auto& s : surfaces)
    features += s->points.size() + s->edges.size() + s->triangles.size();
  require(can_number(static_cast<Offset>(2 * features)),
          "affine bodies: " + std::to_string(features) +
              " corners, edges and triangles of different shapes, at most 2^30 can be numbered");
  HostTables t;
  for (const auto& each : surfaces) {
    const Surface& surface = *each;
    SurfaceRecord r;
    const auto first_corner = static_cast<Index>(t.corners.size());
    t.corners.insert(t.corners.end(), surface.vertices.begin(), surface.vertices.end());
    for (const Vec3d& v : surface.vertices) r.radius = std::max(r.radius, norm(v));
    std::vector<std::array<int, 1>> points;
    for (const int v : surface.points) points.push_back({v});
    r.outline_begin = static_cast<Index>(t.outline.size());
    const auto begin_tree = [&](int k) {
      r.tree[k] = static_cast<Index>(t.nodes.size());
      r.block[k] = static_cast<Index>(t.blocks.size());
    };
    begin_tree(0);
    const std::vector<TreeNode> outline = add_tree(t, surface, first_corner, points);
    if (surface.vertices.size() <= static_cast<std::size_t>(kOutlineBoxes)) {
      for (const Vec3d& v : surface.vertices) t.outline.push_back(node_about({v, v}));
    } else {
      t.outline.insert(t.outline.end(), outline.begin(), outline.end());
    }
    begin_tree(1);
    add_tree(t, surface, first_corner, surface.edges);
    begin_tree(2);
    add_tree(t, surface, first_corner, surface.triangles);
    begin_tree(3);
    r.outline_end = static_cast<Index>(t.outline.size());
    t.surfaces.push_back(r);
  }
  TreeNode behind;
  behind.begin = static_cast<Index>(t.features.size());
  t.blocks.push_back(static_cast<Index>(t.nodes.size()));
  t.nodes.push_back(behind);
  return t;
}

void check_bodies(std::size_t surface_count, const std::vector<int>& surface_of_body,
                  const std::vector<int>& group,
                  const std::vector<std::array<int, 2>>& held_pairs) {
  const auto bodies = static_cast<int>(surface_of_body.size());
  require(group.size() == surface_of_body.size(), "affine bodies: " + std::to_string(group.size()) +
                                                      " collision groups of " +
                                                      std::to_string(bodies) + " bodies");
  for (const int s : surface_of_body)
    require(s >= 0 && static_cast<std::size_t>(s) < surface_count,
            "affine bodies: surface " + std::to_string(s) + " of a body, but there are " +
                std::to_string(surface_count));
  for (const std::array<int, 2>& pair : held_pairs)
    for (const int body : pair)
      require(body >= 0 && body < bodies, "affine bodies: pair with body " + std::to_string(body) +
                                              ", but there are " + std::to_string(bodies));
}

}  // namespace scree::affine
