#pragma once
// Shapes, walls and meshes in backend memory.

#include <stdexcept>
#include <string>

#include "collision/obstacles.h"
#include "kernels/backend/backend.h"
#include "kernels/narrow_phase/wall_contacts.h"

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
    free_boxes_ = check_pairs(data);
    for (const Index s : data.walls) {
      add_wall(s, data.shapes[static_cast<std::size_t>(s)], topology, sources, solids);
    }
    mix_ = free_boxes_ > 0  ? ShapeMix::any
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
  int feature_bits() const { return free_boxes_ > 1 ? BoxFeature::kBits : 0; }
  /// Contact elements that box and mesh walls take.
  std::uint64_t solid_elements() const { return solid_elements_; }
  Span<const ShapeRecord<Real>> shapes() const { return whole(shapes_); }

  /// Takes over the poses and motions of the wall bodies.
  void refresh(B& b, const BodyView<Real>& bodies, const ContactRange& range,
               const ContactKeys& keys) {
    for_each(
        b, plane_count_,
        RefreshPlanes<Real>{bodies, range, shapes(), whole(sources_), planes_.view(plane_count_)});
    for_each(b, solid_count_,
             RefreshSolids<Real>{bodies, range, keys.solid_begin, solids_.view(solid_count_)});
  }

  WallView<Real> walls() const {
    const MeshView<Real> meshes{whole(points_),    whole(vertex_normal_), whole(edge_normal_),
                                whole(vertices_),  whole(neighbors_),     whole(edges_),
                                whole(triangles_), whole(nodes_),         whole(meshes_)};
    return {planes_.view(plane_count_), solids_.view(solid_count_), meshes};
  }

 private:
  /// Refuses bodies that could meet without a word.
  /// @return  the number of free boxes
  static Index check_pairs(const ObstacleData<Real>& data) {
    std::vector<bool> is_wall(data.shapes.size(), false);
    bool has_mesh = false;
    for (const Index s : data.walls) {
      is_wall[static_cast<std::size_t>(s)] = true;
      has_mesh = has_mesh || data.shapes[static_cast<std::size_t>(s)].kind == ShapeKind::mesh;
    }
    Index free_boxes = 0;
    for (std::size_t s = 0; s < data.shapes.size(); ++s) {
      if (is_wall[s]) continue;
      const ShapeKind kind = data.shapes[s].kind;
      // Spheres may come at any time, and have no records.
      if (pair_kind(ShapeKind::sphere, kind) == PairKind::none ||
          pair_kind(kind, kind) == PairKind::none) {
        throw std::runtime_error("shape " + std::to_string(s) + " is a " + name_of(kind) +
                                 ", for whose contacts with other bodies there is no function");
      }
      free_boxes += kind == ShapeKind::box;
    }
    if (free_boxes > 0 && has_mesh) {
      throw std::runtime_error("contact of a box with a mesh is not available: " +
                               std::to_string(free_boxes) + " free boxes and a mesh wall");
    }
    return free_boxes;
  }

  static const char* name_of(ShapeKind kind) {
    switch (kind) {
      case ShapeKind::sphere:
        return "sphere";
      case ShapeKind::box:
        return "box";
      case ShapeKind::half_space:
        return "half_space";
      case ShapeKind::container:
        return "container";
      case ShapeKind::mesh:
        return "mesh";
    }
    return "shape of an unknown kind";
  }

  void add_wall(Index s, const ShapeRecord<Real>& shape, const MeshTopology<Real>& topology,
                std::vector<PlaneSource>& sources, std::vector<WallSolid>& solids) {
    WallSolid solid;
    solid.kind = shape.kind;
    solid.body = shape.body;
    solid.mesh = shape.mesh;
    solid.half_extents = Vec3d(shape.half_extents);
    solid.element_offset = static_cast<std::uint32_t>(solid_elements_);
    switch (shape.kind) {
      case ShapeKind::half_space:
        sources.push_back({s, -1});
        return;
      case ShapeKind::container:
        for (int face = 0; face < kContainerFaces; ++face) {
          if ((shape.open_faces >> face & 1) == 0) sources.push_back({s, face});
        }
        return;
      case ShapeKind::box:
        if (free_boxes_ > 0) solid.slots = 1u << BoxFeature::kBits;
        solids.push_back(solid);
        solid_elements_ += images_ * solid.slots;
        return;
      case ShapeKind::mesh:
        if (shape.mesh < 0 || shape.mesh >= static_cast<Index>(topology.meshes.size())) {
          throw std::runtime_error("wall names mesh " + std::to_string(shape.mesh) + " of " +
                                   std::to_string(topology.meshes.size()));
        }
        add_mesh(topology, solid);
        solids.push_back(solid);
        solid_elements_ += images_ * solid.slots;
        return;
      case ShapeKind::sphere:
        break;
    }
    throw std::runtime_error("shape " + std::to_string(s) + " is a sphere and cannot be a wall");
  }

  static void add_mesh(const MeshTopology<Real>& topology, WallSolid& solid) {
    const MeshInfo& info = topology.meshes[static_cast<std::size_t>(solid.mesh)];
    solid.slots = static_cast<std::uint32_t>(info.triangle_count);
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
  Index free_boxes_ = 0;
  std::uint64_t solid_elements_ = 0;
  std::uint64_t images_ = 1;  ///< of each box or mesh wall
  Buffer<B, ShapeRecord<Real>> shapes_;
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
