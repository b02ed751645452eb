#pragma once
// Shapes, walls and meshes in backend memory.

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>

#include "collision/hull_buffers.h"
#include "collision/obstacles.h"
#include "kernels/backend/backend.h"
#include "kernels/narrow_phase/pair_table.h"
#include "kernels/narrow_phase/solid_walls.h"
#include "shapes/compound.h"
#include "shapes/shape_card.h"

namespace scree {

template <class B, class Real>
class ObstacleBuffers {
 public:
  /// @throws std::runtime_error for walls of an unknown kind, and for bodies that could meet but
  ///         have no pair function: their shapes are named
  /// @param period  of the domain, see CollisionSettings
  ObstacleBuffers(B& b, const ObstacleData<Real>& data, const Vec3d& period)
      : images_(static_cast<std::uint64_t>(image_count(period))),
        shapes_(b),
        hulls_(b, data.hulls),
        sources_(b),
        planes_(b),
        solids_(b),
        points_(b),
        vertex_normal_(b),
        edge_normal_(b),
        vertices_(b),
        neighbors_(b),
        edges_(b),
        triangles_(b),
        nodes_(b),
        meshes_(b) {
    const MeshTopology<Real> topology = build_mesh_topology<Real>(data.meshes);
    std::vector<PlaneSource> sources;
    std::vector<WallSolid> solids;
    count_free_shapes(data);
    check_pairs(data);
    for (const Index s : data.walls) {
      add_wall(s, data, topology, sources, solids);
    }
    const bool is_mixed = !free_.empty() || !data.parts.empty() ||
                          std::any_of(solids.begin(), solids.end(), [](const WallSolid& solid) {
                            return !is_solid_of_spheres(solid.kind);
                          });
    mix_ = is_mixed         ? ShapeMix::any
           : solids.empty() ? ShapeMix::spheres_and_planes
                            : ShapeMix::spheres;
    plane_count_ = static_cast<Index>(sources.size());
    solid_count_ = static_cast<Index>(solids.size());
    planes_.reserve_discard(plane_count_);
    upload(b, data.shapes, shapes_);
    upload(b, sources, sources_);
    upload(b, solids, solids_);
    upload(b, topology.points, points_);
    upload(b, topology.vertex_normal, vertex_normal_);
    upload(b, topology.edge_normal, edge_normal_);
    upload(b, topology.vertices, vertices_);
    upload(b, topology.neighbors, neighbors_);
    upload(b, topology.edges, edges_);
    upload(b, topology.triangles, triangles_);
    upload(b, topology.nodes, nodes_);
    upload(b, topology.meshes, meshes_);
  }

  ShapeMix mix() const { return mix_; }
  Index plane_count() const { return plane_count_; }
  /// Bits that contact keys need to tell the contacts of two free bodies apart.
  int feature_bits() const {
    int bits = 0;
    for (const auto& [a, count_a] : free_)
      for (const auto& [b, count_b] : free_)
        if (a != b || count_a > 1) bits = std::max(bits, bits_of(a, b));
    return bits;
  }
  /// Contact elements that solid walls take.
  std::uint64_t solid_elements() const { return solid_elements_; }
  ShapeSet<Real> shapes() const { return {whole(shapes_), hulls_.view()}; }

  /// Fixed bodies move back in storage by so many places.
  void follow_fixed_bodies(B& b, Index shift) {
    const auto shapes = static_cast<Index>(shapes_.capacity());
    for_each(b, shapes, FollowFixedBodies<ShapeRecord<Real>>{shapes_.view(), shift});
    for_each(b, solid_count_, FollowFixedBodies<WallSolid>{solids_.view(solid_count_), shift});
  }

  /// Takes over the poses and motions of the wall bodies.
  void refresh(B& b, const BodyView<Real>& bodies, const ContactRange& range,
               const ContactKeys& keys) {
    for_each(b, plane_count_,
             RefreshPlanes<Real>{bodies, range, whole(shapes_), whole(sources_),
                                 planes_.view(plane_count_)});
    for_each(b, solid_count_,
             RefreshSolids<Real>{bodies, range, hulls_.view(), keys.solid_begin,
                                 solids_.view(solid_count_)});
  }

  WallView<Real> walls() const {
    const MeshView<Real> meshes{whole(points_),    whole(vertex_normal_), whole(edge_normal_),
                                whole(vertices_),  whole(neighbors_),     whole(edges_),
                                whole(triangles_), whole(nodes_),         whole(meshes_)};
    return {planes_.view(plane_count_), solids_.view(solid_count_), meshes};
  }

 private:
  /// Bits that tell the contacts of two shapes apart.
  static int bits_of(ShapeKind a, ShapeKind b) {
    const PairEntry* pair = find_pair(a, b);
    return pair == nullptr ? 0 : pair->feature_bits;
  }

  void count_free_shapes(const ObstacleData<Real>& data) {
    std::vector<bool> is_wall(data.shapes.size(), false);
    for (const Index s : data.walls) is_wall[static_cast<std::size_t>(s)] = true;
    for (std::size_t s = 0; s < data.shapes.size(); ++s)
      if (!is_wall[s] && data.shapes[s].kind != shapes::Compound::kind)  // its parts count
        ++free_[data.shapes[s].kind];
  }

  /// Refuses bodies that could meet without a word. Spheres may come at any time, and have no
  /// records.
  void check_pairs(const ObstacleData<Real>& data) const {
    const auto require = [](ShapeKind a, ShapeKind b) {
      if (find_pair(a, b) != nullptr) return;
      throw std::runtime_error(std::string("contact of a ") + name_of(a) + " with a " + name_of(b) +
                               " is not available: there is no pair function");
    };
    for (const auto& [a, count] : free_) {
      require(shapes::Sphere::kind, a);
      for (const auto& [b, count_b] : free_)
        if (a != b || count > 1) require(a, b);
    }
    for (const Index s : data.walls) {
      const ShapeKind wall = data.shapes[static_cast<std::size_t>(s)].kind;
      if (!is_shape(wall) || shape_card(wall).is_ball) continue;  // refused by add_wall()
      const ShapeKind met = shape_card(wall).faces ? shapes::HalfSpace::kind : wall;
      require(shapes::Sphere::kind, met);
      for (const auto& [a, count] : free_) require(a, met);
    }
  }

  static const char* name_of(ShapeKind kind) {
    return is_shape(kind) ? shape_card(kind).name : "shape of an unknown kind";
  }

  void add_wall(Index s, const ObstacleData<Real>& data, const MeshTopology<Real>& topology,
                std::vector<PlaneSource>& sources, std::vector<WallSolid>& solids) {
    const ShapeRecord<Real>& shape = data.shapes[static_cast<std::size_t>(s)];
    if (!is_shape(shape.kind) || shape_card(shape.kind).is_ball) {
      throw std::runtime_error("shape " + std::to_string(s) + " is a " + name_of(shape.kind) +
                               " and cannot be a wall");
    }
    const ShapeCard& card = shape_card(shape.kind);
    if (card.faces != nullptr) {
      Shape described;
      described.half_extents = Vec3d(shape.half_extents);
      described.normal = Vec3d(shape.normal);
      described.open_faces = shape.open_faces;
      for (const WallFace& face : card.faces(described)) {
        sources.push_back({s, face.point, face.normal});
      }
      return;
    }
    WallSolid solid;
    solid.kind = shape.kind;
    solid.body = shape.body;
    solid.mesh = shape.mesh;
    solid.half_extents = Vec3d(shape.half_extents);
    solid.rounded = in_double(shape.rounded);
    if (const auto endless = data.endless.find(s); endless != data.endless.end()) {
      solid.endless = endless->second.axes;
      solid.half_extents = endless->second.half_extents;
    }
    solid.element_offset = static_cast<std::uint32_t>(solid_elements_);
    int bits = 0;
    for (const auto& [a, count] : free_) bits = std::max(bits, bits_of(a, shape.kind));
    solid.slots = 1u << bits;
    if (card.has_mesh && !card.is_hull) {
      if (shape.mesh < 0 || shape.mesh >= static_cast<Index>(topology.meshes.size())) {
        throw std::runtime_error("wall names mesh " + std::to_string(shape.mesh) + " of " +
                                 std::to_string(topology.meshes.size()));
      }
      add_mesh(topology, bits, solid);
    }
    solids.push_back(solid);
    solid_elements_ += images_ * solid.slots;
  }

  static void add_mesh(const MeshTopology<Real>& topology, int bits, WallSolid& solid) {
    const MeshInfo& info = topology.meshes[static_cast<std::size_t>(solid.mesh)];
    solid.slots = static_cast<std::uint32_t>(
        mesh_slots(static_cast<std::uint64_t>(info.triangle_count), bits));
    if (info.first_node == info.end_node) return;
    const MeshNode& all = topology.nodes[static_cast<std::size_t>(info.first_node)];
    for (int k = 0; k < 3; ++k) {
      const double low = all.lower[k], high = all.upper[k];
      solid.local_middle[k] = 0.5 * (low + high);
      solid.half_extents[k] = 0.5 * (high - low);
    }
  }

  template <class T>
  static Span<const T> whole(const Buffer<B, T>& buffer) {
    return buffer.view(buffer.capacity());
  }

  ShapeMix mix_ = ShapeMix::spheres_and_planes;
  Index plane_count_ = 0;
  Index solid_count_ = 0;
  std::map<ShapeKind, Index> free_;  ///< free bodies by shape, but for spheres without records
  std::uint64_t solid_elements_ = 0;
  std::uint64_t images_ = 1;  ///< of each solid wall
  Buffer<B, ShapeRecord<Real>> shapes_;
  HullBuffers<B> hulls_;
  Buffer<B, PlaneSource> sources_;
  Buffer<B, WallPlane> planes_;
  Buffer<B, WallSolid> solids_;
  Buffer<B, Vec3<Real>> points_;
  Buffer<B, Vec3<Real>> vertex_normal_;
  Buffer<B, Vec3<Real>> edge_normal_;
  Buffer<B, MeshVertex> vertices_;
  Buffer<B, Index> neighbors_;
  Buffer<B, MeshEdge> edges_;
  Buffer<B, MeshTriangle> triangles_;
  Buffer<B, MeshNode> nodes_;
  Buffer<B, MeshInfo> meshes_;
};

}  // namespace scree
