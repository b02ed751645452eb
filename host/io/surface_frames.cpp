#include "host/io/surface_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "host/error.h"
#include "host/io/body_points.h"
#include "host/io/vtkhdf.h"
#include "host/scene/bodies_by_id.h"
#include "host/scene/scene_checks.h"
#include "shapes/shape_card.h"

namespace scree {
namespace {

using vtkhdf::append_number;
using vtkhdf::polygons;
using vtkhdf::topologies;
constexpr std::array surface_cell_data{"id", "group"};
constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();  // ids
constexpr std::size_t block_values = std::size_t{1} << 18;             // written at a time

/// The surface with one corner where it had several at the same point.
Surface welded(const Surface& surface) {
  Surface out;
  std::map<std::array<double, 3>, int> known;
  std::vector<int> number;
  for (const Vec3d& v : surface.vertices) {
    const auto [entry, is_new] = known.try_emplace(std::array<double, 3>{v.x, v.y, v.z},
                                                   static_cast<int>(out.vertices.size()));
    if (is_new) out.vertices.push_back(v);
    number.push_back(entry->second);
  }
  out.faces = surface.faces;
  for (std::vector<int>& face : out.faces)
    for (int& corner : face) corner = number[static_cast<std::size_t>(corner)];
  return out;
}

/// Rows of one array, written when there are many.
template <class T>
class Block {
 public:
  Block(h5::Group& group, std::string name) : group_(group), name_(std::move(name)) {}
  void add(T value) { values_.push_back(value); }
  /// To be called between rows. @param least  values that are worth writing
  void write(std::size_t least = block_values) {
    if (values_.size() < std::max<std::size_t>(least, 1)) return;
    group_.append(name_, std::span<const T>(values_));
    values_.clear();
  }

 private:
  h5::Group& group_;
  std::string name_;
  std::vector<T> values_;
};

Filled filled(const SurfaceExtent& extent) {
  const auto frames = static_cast<std::uint64_t>(extent.frames);
  const auto parts = static_cast<std::uint64_t>(extent.parts);
  std::vector<Growing> all{{"Points", extent.points},
                           {"PointData/speed", extent.points},
                           {"NumberOfPoints", parts},
                           {"Steps/PointDataOffsets/speed", frames}};
  for (const char* name : {"Values", "PartOffsets", "NumberOfParts", "PointOffsets", "CellOffsets",
                           "ConnectivityIdOffsets"})
    all.push_back({fmt::format("Steps/{}", name), frames});
  for (const char* name : surface_cell_data)
    all.push_back({fmt::format("Steps/CellDataOffsets/{}", name), frames});
  for (std::size_t k = 0; k < topologies.size(); ++k) {
    all.push_back({fmt::format("{}/NumberOfCells", topologies[k]), parts});
    all.push_back({fmt::format("{}/NumberOfConnectivityIds", topologies[k]), parts});
    all.push_back(  // one more than cells per part
        {fmt::format("{}/Offsets", topologies[k]), (k == polygons ? extent.cells : 0) + parts});
  }
  for (Growing& dataset : all) dataset.name = "VTKHDF/" + dataset.name;
  return {extent.frames, std::move(all)};
}

/// @param before  the file without this frame  @return the file with it
SurfaceExtent extended(const SurfaceExtent& before, const SurfaceSize& size) {
  SurfaceExtent after = before;
  after.frames += 1;
  after.points += size.corners;
  after.last = size;
  if (before.parts == 0 || size.corners != before.last.corners) {
    after.parts += 1;
    after.cells += size.faces;
  }
  return after;
}

}  // namespace

/// The free bodies of a scene by id, without all that has nothing to do with their shapes.
class ShapeSurfaces {
 public:
  explicit ShapeSurfaces(const Scene& scene) : meshes_(scene.meshes.size()) {
    for_each_by_id(
        scene,
        [&](std::size_t id, const BodyDescription& body) {
          if (body.kind != BodyKind::free) return;
          ParticleSet set;
          set.shape = body.shape;
          set.radius = body.shape.radius;
          set.group = body.group;
          add(scene, {id, 1, std::move(set)});
        },
        [&](std::size_t first, const ParticleSet& given) {
          ParticleSet set;
          set.shape = given.shape;
          set.radius = given.radius;
          set.group = given.group;
          add(scene, {first, given.position.size(), std::move(set)});
        });
  }

  /// Calls visit(id, shape, group) for those with ids below `end`.
  template <class Visit>
  void for_each(std::size_t end, Visit visit) const {
    for (const Batch& batch : batches_)
      for (std::size_t i = 0; i < batch.count && batch.first + i < end; ++i)
        visit(batch.first + i, particle_shape(batch.set, i), batch.set.group[i]);
  }

  /// The surface of a shape in its own frame, valid until the next call. Corners are to be
  /// multiplied by `scale`.
  const Surface& of(const Shape& shape, double& scale) {
    const ShapeCard& card = shape_card(shape.kind);
    Shape kept = shape;
    scale = 1;
    if (card.is_ball) {  // all balls are one
      scale = shape.radius;
      kept.radius = 1;
    }
    const Vec3d& e = kept.half_extents;
    const Key key{kept.kind,         kept.mesh,           kept.radius,       e.x, e.y, e.z,
                  kept.rounded.core, kept.rounded.radius, kept.rounded.shift};
    if (const auto known = surfaces_.find(key); known != surfaces_.end()) return known->second;
    if (surfaces_.size() >= kMostKept) surfaces_.clear();
    const TriangleMesh* mesh =
        card.has_mesh || has_hull(shape) ? &meshes_[static_cast<std::size_t>(shape.mesh)] : nullptr;
    return surfaces_.emplace(key, welded(card.surface(kept, mesh, /*scene_size=*/1))).first->second;
  }

  /// Of those with ids below `end`.
  SurfaceSize size(std::size_t end) {
    SurfaceSize size;
    for_each(end, [&](std::size_t, const Shape& shape, int) {
      double scale = 1;
      const Surface& surface = of(shape, scale);
      size.bodies += 1;
      size.corners += surface.vertices.size();
      size.faces += surface.faces.size();
      for (const std::vector<int>& face : surface.faces) size.face_corners += face.size();
    });
    return size;
  }

 private:
  struct Batch {
    std::size_t first = 0;  ///< id
    std::size_t count = 0;
    ParticleSet set;  ///< shapes and groups alone
  };

  void add(const Scene& scene, Batch batch) {
    const bool is_one = batch.set.shape.uniform();
    for (std::size_t i = 0; i < (is_one ? std::min<std::size_t>(batch.count, 1) : batch.count);
         ++i) {
      const Shape shape = particle_shape(batch.set, i);
      if (const TriangleMesh* mesh = mesh_of(scene, shape))
        if (TriangleMesh& kept = meshes_[static_cast<std::size_t>(shape.mesh)];
            kept.vertices.empty())
          kept = *mesh;
    }
    batches_.push_back(std::move(batch));
  }

  static constexpr std::size_t kMostKept = 64;
  using Key = std::tuple<ShapeKind, int, double, double, double, double, ShapeKind, double, double>;

  std::vector<Batch> batches_;
  std::vector<TriangleMesh> meshes_;  ///< as in the scene, those of free bodies only
  std::map<Key, Surface> surfaces_;   ///< the last ones: bodies often share a shape
};

SurfaceSize surface_size(const Scene& scene) { return ShapeSurfaces(scene).size(kAll); }

void require_surface_size(const SurfaceSize& size) {
  if (size.corners > kMostSurfaceCorners)
    throw InputError(
        fmt::format("output.surface_frames: true is not allowed: {} bodies have {} corners, must "
                    "be {} at most",
                    size.bodies, size.corners, kMostSurfaceCorners));
}

SurfaceFrameWriter::SurfaceFrameWriter(std::filesystem::path path, const Scene& scene,
                                       std::optional<double> resume_time)
    : surfaces_(std::make_unique<ShapeSurfaces>(scene)), whole_(surfaces_->size(kAll)) {
  if (whole_.bodies == 0) return;
  require_surface_size(whole_);
  file_ = std::make_unique<TwinFile>(std::move(path));
  if (resume_time) resume(*resume_time);
  if (extent_.frames == 0) start();
}

SurfaceFrameWriter::~SurfaceFrameWriter() = default;

void SurfaceFrameWriter::start() {
  extent_ = {};
  file_->start([&](h5::Group root) {
    const auto chunk = [](std::uint64_t rows) {
      return std::clamp<std::uint64_t>(rows, 64, 65536);
    };
    h5::Group vtk = vtkhdf::create_poly_data(root);
    vtk.create_growing<std::int64_t>("NumberOfPoints", 0, vtkhdf::frame_chunk);
    vtk.create_growing<float>("Points", 3, chunk(whole_.corners));
    for (std::size_t k = 0; k < topologies.size(); ++k) {
      const bool used = k == polygons;
      h5::Group topology = vtk.create_group(topologies[k]);
      for (const char* name : {"NumberOfCells", "NumberOfConnectivityIds"})
        topology.create_growing<std::int64_t>(name, 0, vtkhdf::frame_chunk);
      topology.create_growing<std::int64_t>("Offsets", 0,
                                            used ? chunk(whole_.faces) : vtkhdf::frame_chunk);
      topology.create_growing<std::int64_t>("Connectivity", 0,
                                            used ? chunk(whole_.face_corners) : 64);
    }
    h5::Group points = vtk.create_group("PointData");
    points.create_growing<float>("speed", 0, chunk(whole_.corners));
    h5::Group cells = vtk.create_group("CellData");
    cells.create_growing<std::int64_t>("id", 0, chunk(whole_.faces));
    cells.create_growing<std::int32_t>("group", 0, chunk(whole_.faces));
    write_faces(vtk);
    vtkhdf::create_steps(vtk, "CellData", {surface_cell_data.begin(), surface_cell_data.end()});
    h5::Group steps = vtk.open_group("Steps");
    steps.create_group("PointDataOffsets")
        .create_growing<std::int64_t>("speed", 0, vtkhdf::frame_chunk);
  });
}

void SurfaceFrameWriter::write_faces(h5::Group& vtk) {
  h5::Group topology = vtk.open_group(topologies[polygons]);
  h5::Group cells = vtk.open_group("CellData");
  Block<std::int64_t> connectivity(topology, "Connectivity"), ids(cells, "id");
  Block<std::int32_t> groups(cells, "group");
  std::int64_t first = 0;
  surfaces_->for_each(kAll, [&](std::size_t id, const Shape& shape, int group) {
    double scale = 1;
    const Surface& surface = surfaces_->of(shape, scale);
    for (const std::vector<int>& face : surface.faces) {
      for (const int corner : face) connectivity.add(first + corner);
      ids.add(static_cast<std::int64_t>(id));
      groups.add(group);
    }
    first += std::ssize(surface.vertices);
    connectivity.write(), ids.write(), groups.write();
  });
  connectivity.write(1), ids.write(1), groups.write(1);
}

/// Cells for a number of bodies that no earlier frame had. Readers find the offsets of a part
/// behind those of the parts before it, each one longer than its cells.
void SurfaceFrameWriter::write_part(h5::Group& vtk, const SurfaceSize& size, std::size_t end) {
  append_number(vtk, "NumberOfPoints", static_cast<std::int64_t>(size.corners));
  for (std::size_t k = 0; k < topologies.size(); ++k) {
    const bool used = k == polygons;
    h5::Group topology = vtk.open_group(topologies[k]);
    append_number(topology, "NumberOfCells", static_cast<std::int64_t>(used ? size.faces : 0));
    append_number(topology, "NumberOfConnectivityIds",
                  static_cast<std::int64_t>(used ? size.face_corners : 0));
    append_number(topology, "Offsets", 0);
  }
  h5::Group topology = vtk.open_group(topologies[polygons]);
  Block<std::int64_t> offsets(topology, "Offsets");
  std::int64_t corners = 0;
  surfaces_->for_each(end, [&](std::size_t, const Shape& shape, int) {
    double scale = 1;
    for (const std::vector<int>& face : surfaces_->of(shape, scale).faces)
      offsets.add(corners += std::ssize(face));
    offsets.write();
  });
  offsets.write(1);
}

void SurfaceFrameWriter::write_frame(h5::Group vtk, const SurfaceExtent& after, double time,
                                     const BodyStates& states) {
  const std::size_t end = states.position.size();
  if (after.parts > extent_.parts) write_part(vtk, after.last, end);
  h5::Group data = vtk.open_group("PointData");
  Block<float> points(vtk, "Points"), speeds(data, "speed");
  surfaces_->for_each(end, [&](std::size_t id, const Shape& shape, int) {
    double scale = 1;
    const Surface& surface = surfaces_->of(shape, scale);
    const BodyPoints place(states, id);
    const auto speed = static_cast<float>(norm(states.velocity[id]));
    const auto bent = states.bent.find(static_cast<int>(id));
    for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
      const Vec3d x =
          bent != states.bent.end() ? bent->second.at(v) : place(scale * surface.vertices[v]);
      for (int k = 0; k < 3; ++k) points.add(static_cast<float>(x[k]));
      speeds.add(speed);
    }
    points.write(), speeds.write();
  });
  points.write(1), speeds.write(1);

  h5::Group steps = vtk.open_group("Steps");
  const auto first_point = static_cast<std::int64_t>(extent_.points);
  steps.append("Values", std::span<const double>(&time, 1));
  append_number(steps, "PartOffsets", after.parts - 1);
  append_number(steps, "NumberOfParts", 1);
  append_number(steps, "PointOffsets", first_point);
  std::array<std::int64_t, topologies.size()> first_cell{};
  const std::array<std::int64_t, topologies.size()> first_connectivity{};
  first_cell[polygons] = static_cast<std::int64_t>(after.cells - after.last.faces);
  steps.append("CellOffsets", std::span<const std::int64_t>(first_cell));
  steps.append("ConnectivityIdOffsets", std::span<const std::int64_t>(first_connectivity));
  h5::Group cell_offsets = steps.open_group("CellDataOffsets");
  for (const char* name : surface_cell_data) append_number(cell_offsets, name, 0);
  h5::Group point_offsets = steps.open_group("PointDataOffsets");
  append_number(point_offsets, "speed", first_point);
  steps.write_attribute<std::int64_t>("NSteps", after.frames);
}

void SurfaceFrameWriter::append(double time, const BodyStates& states) {
  if (!file_ || (last_time_ && time == *last_time_)) return;
  if (last_time_ && time < *last_time_)
    throw RunError(fmt::format("frame at {} s comes after the one at {} s", time, *last_time_));
  const std::size_t bodies = states.position.size();
  const bool is_same = extent_.parts > 0 && bodies == last_states_;
  const SurfaceSize size = is_same ? extent_.last : surfaces_->size(bodies);
  if (size.bodies == 0) return;  // readers have trouble with empty parts
  if (size.bodies < extent_.last.bodies || size.bodies > whole_.bodies ||
      states.velocity.size() != bodies ||
      (!states.orientation.empty() && states.orientation.size() != bodies) ||
      (!states.axes.empty() && states.axes.size() != bodies))
    throw RunError(
        fmt::format("a frame of the surfaces of {} bodies does not fit the {} of the last frame "
                    "and the {} of the scene",
                    size.bodies, extent_.last.bodies, whole_.bodies));
  const SurfaceExtent after = extended(extent_, size);
  file_->append(filled(extent_), [&](h5::Group root) {
    write_frame(root.open_group("VTKHDF"), after, time, states);
  });
  extent_ = after;
  last_states_ = bodies;
  last_time_ = time;
}

void SurfaceFrameWriter::resume(double time) {
  const std::filesystem::path& path = file_->path();
  if (!std::filesystem::exists(path)) return;
  const auto refuse = [&](const std::string& what) {
    throw InputError(fmt::format("cannot continue {}: {}", path.string(), what));
  };
  std::int64_t frames_found = 0;
  try {
    const h5::File file = h5::File::open(path);
    const h5::Group root = file.root();
    const h5::Group vtk = root.open_group("VTKHDF");
    if (vtk.shape("CellData/id").rows != whole_.faces ||
        vtk.shape("Polygons/Connectivity").rows != whole_.face_corners)
      refuse("it holds other bodies than the scene");
    frames_found = vtk.open_group("Steps").attribute<std::int64_t>("NSteps");
    const auto times = vtk.read<double>("Steps/Values");
    const auto part_of = vtk.read<std::int64_t>("Steps/PartOffsets");
    const auto points_of = vtk.read<std::int64_t>("NumberOfPoints");
    const auto faces_of = vtk.read<std::int64_t>("Polygons/NumberOfCells");
    if (std::ssize(times) != frames_found || std::ssize(part_of) != frames_found ||
        points_of.size() != faces_of.size())
      refuse(fmt::format("it has {} frames, but {} times and {} parts", frames_found, times.size(),
                         part_of.size()));
    for (std::size_t frame = 0; frame < times.size() && times[frame] <= time; ++frame) {
      const std::int64_t part = part_of[frame];
      if (part < 0 || (part != extent_.parts - 1 && part != extent_.parts) ||
          part >= std::ssize(points_of))
        refuse(fmt::format("frame {} refers to part {} of {}", frame, part, points_of.size()));
      const auto at = static_cast<std::size_t>(part);
      if (points_of[at] <= 0 || faces_of[at] <= 0)
        refuse(
            fmt::format("part {} has {} corners and {} faces", part, points_of[at], faces_of[at]));
      SurfaceSize size;
      size.corners = static_cast<std::uint64_t>(points_of[at]);
      size.faces = static_cast<std::uint64_t>(faces_of[at]);
      extent_ = extended(extent_, size);
      last_time_ = times[frame];
    }
    for (const Growing& dataset : filled(extent_).datasets)
      if (root.shape(dataset.name).rows < dataset.rows)
        refuse(fmt::format("dataset {} has {} rows, expected {} or more", dataset.name,
                           root.shape(dataset.name).rows, dataset.rows));
    // Reading nothing checks the type.
    for (const char* dataset : {"Points", "PointData/speed"}) vtk.read(dataset, std::span<float>());
  } catch (const h5::Error& error) {
    throw InputError(fmt::format("cannot continue {}", error.what()));
  }
  if (extent_.frames == 0 || extent_.frames == frames_found) return;
  file_->cut(filled(extent_), [&](h5::Group root) {
    root.open_group("VTKHDF/Steps").write_attribute<std::int64_t>("NSteps", extent_.frames);
  });
}

}  // namespace scree
