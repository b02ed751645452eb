#pragma once
// Shape records of all bodies that are not spheres, and the meshes, for collision and for pictures.

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "collision/hull_buffers.h"
#include "collision/obstacles.h"
#include "dynamics/rigid/wall_periods.h"
#include "host/scene.h"
#include "host/scene/bodies_by_id.h"
#include "host/scene/compound.h"
#include "host/scene/particle_shapes.h"
#include "host/scene/scene_summary.h"
#include "kernels/backend/backend.h"
#include "kernels/bodies/body_view.h"
#include "shapes/shape_card.h"

namespace scree {

template <class B, class Real>
class Obstacles {
 public:
  /// @param fixed_begin       storage index of the first fixed or kinematic body
  /// @param fixed_part_begin  that of its first part; none: there is room for all parts of free bodies before it
  Obstacles(B& b, const Scene& scene, Index fixed_begin,
            std::optional<Index> fixed_part_begin = std::nullopt)
      : fixed_part_begin_(fixed_part_begin.value_or(fixed_begin + more_free_parts(scene))),
        shapes_(b),
        vertices_(b),
        triangles_(b),
        ranges_(b) {
    Index fixed = fixed_begin;
    Index fixed_part = fixed_part_begin_;
    const auto add = [&](std::size_t body_id, const BodyDescription& body) {
      const auto id = static_cast<Index>(body_id);
      const bool is_free = body.kind == BodyKind::free;
      if (!shape_card(body.shape.kind).is_ball)
        add_described(scene, id, body, is_free ? -1 : fixed, is_free ? -1 : fixed_part);
      if (is_free) return;
      ++fixed;
      fixed_part += part_count(scene, body.shape);
    };
    const auto add_set = [&](std::size_t first, const ParticleSet& set) {
      if (are_spheres(set)) return;
      for (std::size_t i = 0; i < set.position.size(); ++i) {
        if (!shape_card(particle_kind(set, i)).is_ball)
          add_shape(scene, static_cast<Index>(first + i), particle_shape(set, i), -1, -1, {});
      }
    };
    for_each_by_id(scene, add, add_set);
    hulls_.emplace(b, data_.hulls);
    upload(b, data_.shapes, shapes_);
    upload_meshes(b);
  }

  const ObstacleData<Real>& data() const { return data_; }
  Span<const ShapeRecord<Real>> shapes() const {
    return shapes_.view(static_cast<Offset>(data_.shapes.size()));
  }
  MeshSetView<Real> mesh_set() const {
    return {vertices_.view(vertex_count_), triangles_.view(triangle_count_),
            ranges_.view(range_count_), hulls_->view()};
  }

  /// Place of the first part of a fixed body, which is that of the first fixed body where there are no compounds.
  Index fixed_part_begin() const { return fixed_part_begin_; }

  /// Fixed bodies move back in storage by so many places. Where there are compounds, walls are known by the places of parts.
  void follow_fixed_bodies(B& b, Index shift) {
    const bool has_compounds = !data_.parts.empty();
    shift_records(b, shift, [&](bool is_compound) { return is_compound == has_compounds; });
  }
  /// The same of parts of fixed bodies, in runs with compounds.
  void follow_fixed_parts(B& b, Index shift) {
    fixed_part_begin_ += shift;
    shift_records(b, shift, [](bool is_compound) { return !is_compound; });
  }

  /// [parts] id of the body of each.
  std::vector<Index> part_owners() const {
    std::vector<Index> owner(data_.parts.size(), -1);
    for (const auto& [id, shape] : shape_of_id_) {
      const ShapeRecord<Real>& record = data_.shapes[static_cast<std::size_t>(shape)];
      if (!shape_card(record.kind).is_compound) continue;
      const auto k = static_cast<std::size_t>(record.mesh);
      std::fill(owner.begin() + data_.first_part[k], owner.begin() + data_.first_part[k + 1], id);
    }
    return owner;
  }

  /// Vertices of the mesh of a body, which others with that mesh share.
  Span<Vec3<Real>> vertices_of(Index id) {
    const Index mesh = data_.shapes[static_cast<std::size_t>(shape(id))].mesh;
    Offset first = 0;
    for (Index k = 0; k < mesh; ++k)
      first += std::ssize(data_.meshes[static_cast<std::size_t>(k)].vertices);
    const auto count = std::ssize(data_.meshes[static_cast<std::size_t>(mesh)].vertices);
    return {vertices_.data() + first, count};
  }

  /// Shape record of a body by id, -1 for a sphere.
  Index shape(Index id) const {
    const auto found = shape_of_id_.find(id);
    return found == shape_of_id_.end() ? -1 : found->second;
  }

 private:
  /// A mesh by its index in Scene::meshes, and the periods over which it goes on.
  using MeshName = std::pair<int, std::vector<std::array<double, 3>>>;
  using MeshPlaces = std::map<MeshName, Index>;

  void add_described(const Scene& scene, Index id, const BodyDescription& body, Index place,
                     Index part) {
    const auto wall = static_cast<Index>(data_.shapes.size());
    add_shape(scene, id, body.shape, place, part, wall_periods(scene, body));
    if (const auto endless = endless_wall(scene, body)) data_.endless[wall] = *endless;
  }

  /// @param body  storage index of a fixed or kinematic body; -1: it is free
  /// @param part     that of its first part
  /// @param periods  see wall_periods()
  void add_shape(const Scene& scene, Index id, const Shape& shape, Index body, Index part,
                 const std::vector<Vec3d>& periods) {
    shape_of_id_[id] = static_cast<Index>(data_.shapes.size());
    const bool is_compound = shape_card(shape.kind).is_compound;
    ShapeRecord<Real> own = record(scene, shape, is_compound ? body : part, periods);
    if (is_compound) own.mesh = static_cast<Index>(data_.first_part.size()) - 1;
    data_.shapes.push_back(own);
    if (is_compound) {
      add_parts(scene, shape, part);
    } else if (body >= 0) {
      data_.walls.push_back(shape_of_id_[id]);
    }
  }

  void add_parts(const Scene& scene, const Shape& shape, Index place) {
    for (const ShapePart& part : parts_of(scene, shape)) {
      const ShapeCard& card = shape_card(part.shape.kind);
      PartRecord<Real> r;
      r.radius = static_cast<Real>(bounding_radius(scene, part.shape));
      r.position = part.position;
      r.orientation = part.orientation;
      if (!card.is_ball) {
        r.shape = static_cast<Index>(data_.shapes.size());
        if (place >= 0) data_.walls.push_back(r.shape);
        data_.shapes.push_back(record(scene, part.shape, place, {}));
      }
      if (place >= 0) ++place;
      data_.parts.push_back(r);
    }
    data_.first_part.push_back(static_cast<Index>(data_.parts.size()));
  }

  /// Changes the places in storage of fixed bodies, or of their parts. @param moves  moves(is it one of a compound)
  template <class F>
  void shift_records(B& b, Index shift, F&& moves) {
    for (ShapeRecord<Real>& record : data_.shapes)
      if (record.body >= 0 && moves(shape_card(record.kind).is_compound)) record.body += shift;
    upload(b, data_.shapes, shapes_);
  }

  /// How many more parts free bodies have than there are of them.
  static Index more_free_parts(const Scene& scene) {
    Index more = 0;
    for_each_by_id(
        scene,
        [&](std::size_t, const BodyDescription& body) {
          if (body.kind == BodyKind::free) more += part_count(scene, body.shape) - 1;
        },
        [&](std::size_t, const ParticleSet& set) {
          if (are_spheres(set)) return;
          for (std::size_t i = 0; i < set.position.size(); ++i)
            more += part_count(scene, set.shape[i]) - 1;
        });
    return more;
  }
  static Index part_count(const Scene& scene, const Shape& shape) {
    return static_cast<Index>(part_count_of(scene, shape));
  }

  ShapeRecord<Real> record(const Scene& scene, const Shape& shape, Index body,
                           const std::vector<Vec3d>& periods) {
    ShapeRecord<Real> r;
    const ShapeCard& card = shape_card(shape.kind);
    r.kind = shape.kind;
    r.rounding = card.rounding == nullptr ? Real(0) : static_cast<Real>(card.rounding(shape));
    r.open_faces = static_cast<std::uint8_t>(shape.open_faces);
    if (has_hull(shape)) r.mesh = place_of(scene, shape, {}, hull_of_mesh_, data_.hulls);
    if (card.has_mesh && !card.is_hull && !card.is_compound)
      r.mesh = place_of(scene, shape, periods, place_of_mesh_, data_.meshes);
    r.body = body;
    r.half_extents = Vec3<Real>(core_half_extents(shape));
    r.rounded = {shape.rounded.core, static_cast<Real>(shape.rounded.radius),
                 static_cast<Real>(shape.rounded.shift)};
    r.normal = Vec3<Real>(shape.normal);
    return r;
  }

  /// Where the mesh of a shape is among those of its sort.
  static Index place_of(const Scene& scene, const Shape& shape, const std::vector<Vec3d>& periods,
                        MeshPlaces& places, std::vector<MeshSource>& meshes) {
    MeshName name{shape.mesh, {}};
    for (const Vec3d& period : periods) name.second.push_back({period.x, period.y, period.z});
    const auto [place, is_new] = places.emplace(name, static_cast<Index>(meshes.size()));
    const TriangleMesh& mesh = scene.meshes[static_cast<std::size_t>(shape.mesh)];
    if (is_new) meshes.push_back({mesh.vertices, mesh.triangles, mesh.closed, periods});
    return place->second;
  }

  void upload_meshes(B& b) {
    std::vector<Vec3<Real>> vertices;
    std::vector<TriangleIndices> triangles;
    std::vector<MeshRange> ranges;
    for (const MeshSource& mesh : data_.meshes) {
      const auto first_vertex = static_cast<Index>(vertices.size());
      ranges.push_back(
          {static_cast<Index>(triangles.size()), static_cast<Index>(mesh.triangles.size())});
      for (const Vec3d& v : mesh.vertices) vertices.emplace_back(v);
      for (const auto& t : mesh.triangles) {
        triangles.push_back({{first_vertex + t[0], first_vertex + t[1], first_vertex + t[2]}});
      }
    }
    vertex_count_ = static_cast<Offset>(vertices.size());
    triangle_count_ = static_cast<Offset>(triangles.size());
    range_count_ = static_cast<Offset>(ranges.size());
    upload(b, vertices, vertices_);
    upload(b, triangles, triangles_);
    upload(b, ranges, ranges_);
  }

  Index fixed_part_begin_;
  ObstacleData<Real> data_;
  std::unordered_map<Index, Index> shape_of_id_;
  MeshPlaces place_of_mesh_, hull_of_mesh_;
  std::optional<HullBuffers<B>> hulls_;
  Buffer<B, ShapeRecord<Real>> shapes_;
  Buffer<B, Vec3<Real>> vertices_;
  Buffer<B, TriangleIndices> triangles_;
  Buffer<B, MeshRange> ranges_;
  Offset vertex_count_ = 0, triangle_count_ = 0, range_count_ = 0;
};

}  // namespace scree
