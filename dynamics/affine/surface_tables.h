#pragma once
// The surfaces of a run in backend memory, with their trees.

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "dynamics/affine/surface.h"
#include "kernels/affine/near_search.h"

namespace scree::affine {

/// Tables of surfaces on the host.
struct HostTables {
  std::vector<Vec3d> corners;
  std::vector<EdgeCorners> edges;
  std::vector<TriangleCorners> triangles;
  std::vector<TreeNode> nodes;
  std::vector<SurfaceRecord> surfaces;
};
HostTables tables_of(const std::vector<std::shared_ptr<const Surface>>& surfaces);

/// Bodies so much larger than the median are tested against all others.
inline constexpr double kLargeBody = 8;

template <class B>
class SurfaceTables {
 public:
  /// @param surfaces         that bodies share
  /// @param surface_of_body  which of them, by body
  /// @param group            by body: bodies of one group at or above zero do not touch
  /// @param held_pairs       of bodies that do not touch
  SurfaceTables(B& b, const std::vector<std::shared_ptr<const Surface>>& surfaces,
                const std::vector<int>& surface_of_body, const std::vector<int>& group,
                const std::vector<std::array<int, 2>>& held_pairs)
      : corners_(b),
        edges_(b),
        triangles_(b),
        nodes_(b),
        surfaces_(b),
        surface_of_body_(b),
        group_(b),
        held_(b),
        listed_(b) {
    const HostTables tables = tables_of(surfaces);
    upload(b, tables.corners, corners_);
    upload(b, tables.edges, edges_);
    upload(b, tables.triangles, triangles_);
    upload(b, tables.nodes, nodes_);
    upload(b, tables.surfaces, surfaces_);
    upload(b, std::vector<Index>(surface_of_body.begin(), surface_of_body.end()), surface_of_body_);
    upload(b, std::vector<Index>(group.begin(), group.end()), group_);
    std::vector<std::uint64_t> held;
    for (const std::array<int, 2>& pair : held_pairs) {
      const auto [low, high] = std::minmax(pair[0], pair[1]);
      held.push_back(make_key(low, static_cast<std::uint32_t>(high)));
    }
    std::sort(held.begin(), held.end());
    upload(b, held, held_);
    list_bodies(b, surfaces, surface_of_body);
  }

  Index body_count() const { return body_count_; }
  SurfacesView view() const {
    return {corners_.view(corners_.capacity()),     edges_.view(edges_.capacity()),
            triangles_.view(triangles_.capacity()), nodes_.view(nodes_.capacity()),
            surfaces_.view(surfaces_.capacity()),   surface_of_body_.view(body_count_)};
  }
  BodyFilter filter() const { return {group_.view(body_count_), {held_.view(held_.capacity())}}; }
  /// Bodies that a sweep is for, then large ones.
  Span<const Index> listed() const { return listed_.view(body_count_); }
  Index swept_count() const { return swept_count_; }

 private:
  void list_bodies(B& b, const std::vector<std::shared_ptr<const Surface>>& surfaces,
                   const std::vector<int>& surface_of_body) {
    body_count_ = static_cast<Index>(surface_of_body.size());
    std::vector<double> radius;
    for (const int surface : surface_of_body)
      radius.push_back(surfaces[static_cast<std::size_t>(surface)]->radius);
    std::vector<double> sorted = radius;
    std::sort(sorted.begin(), sorted.end());
    const double large = sorted.empty() ? 0 : kLargeBody * sorted[sorted.size() / 2];
    std::vector<Index> listed, last;
    for (std::size_t body = 0; body < radius.size(); ++body)
      (radius[body] > large ? last : listed).push_back(static_cast<Index>(body));
    swept_count_ = static_cast<Index>(listed.size());
    listed.insert(listed.end(), last.begin(), last.end());
    upload(b, listed, listed_);
  }

  Buffer<B, Vec3d> corners_;
  Buffer<B, EdgeCorners> edges_;
  Buffer<B, TriangleCorners> triangles_;
  Buffer<B, TreeNode> nodes_;
  Buffer<B, SurfaceRecord> surfaces_;
  Buffer<B, Index> surface_of_body_, group_;
  Buffer<B, std::uint64_t> held_;
  Buffer<B, Index> listed_;
  Index body_count_ = 0, swept_count_ = 0;
};

}  // namespace scree::affine
