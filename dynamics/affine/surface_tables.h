#pragma once
// The surfaces of a run in backend memory, with their trees.

#include <array>
#include <memory>
#include <vector>

#include "collision/pair_filter.h"
#include "dynamics/affine/surface.h"
#include "kernels/affine/body_tree.h"

namespace scree::affine {

/// Tables of surfaces on the host.
struct HostTables {
  std::vector<Vec3d> corners;
  std::vector<Feature> features;
  std::vector<TreeNode> nodes;
  std::vector<Index> blocks;
  std::vector<TreeNode> outline;
  std::vector<SurfaceRecord> surfaces;
};

/// @throws InvalidParameter when the tables have more elements than can be numbered
HostTables tables_of(const std::vector<std::shared_ptr<const Surface>>& surfaces);

/// @throws InvalidParameter for bodies without a surface or group, and pairs of bodies that there are not
void check_bodies(std::size_t surface_count, const std::vector<int>& surface_of_body,
                  const std::vector<int>& group, const std::vector<std::array<int, 2>>& held_pairs);

/// Memory: of a closed surface some 350 bytes a triangle, once for all bodies of that shape; 8 bytes a body.
template <class B>
class SurfaceTables {
 public:
  /// @param surfaces         that bodies share
  /// @param surface_of_body  which of them, by body
  /// @param group            by body: bodies of one group at or above zero do not touch
  /// @param held_pairs       of bodies that do not touch
  /// @throws InvalidParameter as tables_of() and check_bodies() do
  SurfaceTables(B& b, const std::vector<std::shared_ptr<const Surface>>& surfaces,
                const std::vector<int>& surface_of_body, const std::vector<int>& group,
                const std::vector<std::array<int, 2>>& held_pairs)
      : corners_(b),
        features_(b),
        nodes_(b),
        blocks_(b),
        outline_(b),
        surfaces_(b),
        surface_of_body_(b),
        group_(b),
        held_(b, held_pairs),
        body_count_(static_cast<Index>(surface_of_body.size())) {
    check_bodies(surfaces.size(), surface_of_body, group, held_pairs);
    const HostTables tables = tables_of(surfaces);
    upload(b, tables.corners, corners_);
    upload(b, tables.features, features_);
    upload(b, tables.nodes, nodes_);
    upload(b, tables.blocks, blocks_);
    upload(b, tables.outline, outline_);
    upload(b, tables.surfaces, surfaces_);
    upload(b, std::vector<Index>(surface_of_body.begin(), surface_of_body.end()), surface_of_body_);
    upload(b, std::vector<Index>(group.begin(), group.end()), group_);
  }

  Index body_count() const { return body_count_; }
  SurfacesView view() const {
    return {all(corners_), all(features_), all(nodes_),          all(blocks_),
            all(outline_), all(surfaces_), all(surface_of_body_)};
  }
  BodyFilter filter() const { return {all(group_), held_.pairs()}; }

 private:
  template <class T>
  static Span<const T> all(const Buffer<B, T>& buffer) {
    return buffer.view(buffer.capacity());
  }

  Buffer<B, Vec3d> corners_;
  Buffer<B, Feature> features_;
  Buffer<B, TreeNode> nodes_;
  Buffer<B, Index> blocks_;
  Buffer<B, TreeNode> outline_;
  Buffer<B, SurfaceRecord> surfaces_;
  Buffer<B, Index> surface_of_body_, group_;
  PairFilter<B> held_;
  Index body_count_;
};

}  // namespace scree::affine
