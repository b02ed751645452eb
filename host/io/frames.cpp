#include "host/io/frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "host/error.h"
#include "host/io/values.h"
#include "host/io/vtkhdf.h"
#include "host/scene/bodies_by_id.h"
#include "host/scene/particle_shapes.h"
#include "host/scene/scene_summary.h"
#include "shapes/shape_card.h"

namespace scree {
namespace {

using vtkhdf::append_number;
using vtkhdf::topologies;
constexpr std::array constant_data{"id",    "radius", "half_extents", "mass",
                                   "group", "kind",   "shape"};
using Fields = std::span<const FrameField>;

Filled filled(const FrameExtent& extent, Fields fields) {
  const auto frames = static_cast<std::uint64_t>(extent.frames);
  const auto parts = static_cast<std::uint64_t>(extent.parts);
  std::vector<Growing> all{
      {"Points", extent.points},       {"NumberOfPoints", parts},
      {"Steps/Values", frames},        {"Steps/PartOffsets", frames},
      {"Steps/NumberOfParts", frames}, {"Steps/PointOffsets", frames},
      {"Steps/CellOffsets", frames},   {"Steps/ConnectivityIdOffsets", frames}};
  for (const FrameField& field : fields) {
    all.push_back({fmt::format("PointData/{}", field.name), extent.points});
    all.push_back({fmt::format("Steps/PointDataOffsets/{}", field.name), frames});
  }
  for (const char* name : constant_data)
    all.push_back({fmt::format("Steps/PointDataOffsets/{}", name), frames});
  for (const char* name : topologies) {
    const std::uint64_t cells = name == topologies[0] ? extent.cells : 0;
    all.push_back({fmt::format("{}/NumberOfCells", name), parts});
    all.push_back({fmt::format("{}/NumberOfConnectivityIds", name), parts});
    all.push_back(
        {fmt::format("{}/Offsets", name), cells + parts});  // one more than cells per part
  }
  for (Growing& dataset : all) dataset.name = "VTKHDF/" + dataset.name;
  return {extent.frames, std::move(all)};
}

std::vector<std::int64_t> counting(std::uint64_t count) { return vtkhdf::counting(0, count); }

template <class T>
void write_values(h5::Group& group, const std::string& name, const std::vector<T>& data,
                  std::uint64_t columns = 0) {
  group.write(name, std::span<const T>(data), columns);
}

/// Writes f(constants) of all bodies.
template <class T, class F>
void write_constant(h5::Group& data, const std::string& name, const BodyConstants& bodies, F f) {
  std::vector<T> column(bodies.size());
  for (std::size_t id = 0; id < column.size(); ++id) column[id] = static_cast<T>(f(bodies[id]));
  write_values(data, name, column);
}

/// Half edge lengths of the boxes about bodies; zero for spheres, half spaces and meshes.
template <class Real>
std::vector<Real> half_extents(const Scene& scene, std::size_t count) {
  std::vector<Real> column(3 * count, Real(0));
  const auto write = [&](std::size_t id, const Shape& shape) {
    for (std::size_t k = 0; k < 3; ++k)
      column[3 * id + k] = static_cast<Real>(shape.half_extents[static_cast<int>(k)]);
  };
  for_each_by_id(
      scene, [&](std::size_t id, const BodyDescription& body) { write(id, body.shape); },
      [&](std::size_t first, const ParticleSet& set) {
        if (are_spheres(set)) return;
        for (std::size_t i = 0; i < set.position.size(); ++i)
          write(first + i, particle_shape(set, i));
      });
  return column;
}

template <class Real>
void write_constants(h5::Group& data, const Scene& scene, const BodyConstants& bodies) {
  write_values(data, "id", counting(bodies.size()));
  write_constant<Real>(data, "radius", bodies, [](const BodyConstant& b) {
    return shape_card(b.shape).is_ball ? b.radius : 0.0;
  });
  write_values(data, "half_extents", half_extents<Real>(scene, bodies.size()), 3);
  write_constant<double>(data, "mass", bodies, [](const BodyConstant& b) { return b.mass; });
  write_constant<std::int32_t>(data, "group", bodies,
                               [](const BodyConstant& b) { return b.group; });
  write_constant<std::uint8_t>(data, "kind", bodies, [](const BodyConstant& b) { return b.kind; });
  write_constant<std::uint8_t>(data, "shape", bodies,
                               [](const BodyConstant& b) { return b.shape; });
}

/// Everything of the file but frames. @tparam Real  number type of the run
template <class Real>
void write_empty(h5::Group root, const Scene& scene, Fields fields) {
  const BodyConstants bodies(scene);
  const std::uint64_t count = bodies.size();
  // Chunks are at most one to two megabytes, and small runs get small files.
  const std::uint64_t point_chunk = std::clamp<std::uint64_t>(count, 64, 65536);
  constexpr std::uint64_t frame_chunk = vtkhdf::frame_chunk;
  h5::Group vtk = vtkhdf::create_poly_data(root);
  vtk.create_growing<std::int64_t>("NumberOfPoints", 0, frame_chunk);
  vtk.create_growing<double>("Points", 3, point_chunk);
  // Cell i of every frame is the vertex i: one connectivity serves all frames.
  for (const char* name : topologies) {
    h5::Group topology = vtk.create_group(name);
    const bool used = name == topologies[0];
    topology.create_growing<std::int64_t>("NumberOfCells", 0, frame_chunk);
    topology.create_growing<std::int64_t>("NumberOfConnectivityIds", 0, frame_chunk);
    topology.create_growing<std::int64_t>("Offsets", 0, used ? point_chunk : frame_chunk);
    write_values(topology, "Connectivity", counting(used ? count : 0));
  }

  h5::Group data = vtk.create_group("PointData");
  write_constants<Real>(data, scene, bodies);
  for (const FrameField& field : fields)
    data.create_growing<Real>(
        field.name, field.columns > 1 ? static_cast<std::uint64_t>(field.columns) : 0, point_chunk);

  std::vector<std::string> names(constant_data.begin(), constant_data.end());
  for (const FrameField& field : fields) names.emplace_back(field.name);
  vtkhdf::create_steps(vtk, "PointData", names);
}

/// Calls visit(rows) with the vector of what a field shows.
template <class Visit>
void with_rows_of(const FrameField& field, const BodyStates& states, Visit visit) {
  std::visit(
      [&](auto where) {
        if constexpr (std::is_same_v<decltype(where), Own>) {
          visit(states.own.at(where.place));
        } else {
          visit(states.*where);
        }
      },
      field.values);
}

/// Three numbers per vector, four per quaternion; or the length of each.
template <class Real, class T>
std::vector<Real> numbers(const std::vector<T>& rows, bool length) {
  std::vector<Real> to;
  if constexpr (std::is_same_v<T, Vec3d>) {
    if (length) {
      to.reserve(rows.size());
      for (const Vec3d& row : rows) to.push_back(static_cast<Real>(norm(row)));
      return to;
    }
  }
  const std::span<const double> from = values(rows);
  to.resize(from.size());
  std::transform(from.begin(), from.end(), to.begin(),
                 [](double x) { return static_cast<Real>(x); });
  return to;
}

template <class Real>
void append_states(h5::Group& data, const BodyStates& states, Fields fields) {
  for (const FrameField& field : fields)
    with_rows_of(field, states, [&](const auto& rows) {
      data.append(field.name, std::span<const Real>(numbers<Real>(rows, field.length)));
    });
}

/// Whether every field has a value for each body.
bool has_all_rows(const BodyStates& states, Fields fields) {
  const std::size_t bodies = states.position.size();
  return std::all_of(fields.begin(), fields.end(), [&](const FrameField& field) {
    bool has = false;
    with_rows_of(field, states, [&](const auto& rows) {
      using Row = typename std::decay_t<decltype(rows)>::value_type;
      const auto width =
          std::is_same_v<Row, double> ? static_cast<std::size_t>(field.columns) : std::size_t{1};
      has = rows.size() == bodies * width;
    });
    return has;
  });
}

/// Cells for a number of bodies that no earlier frame had. Readers find the offsets of a part
/// behind those of the parts before it, each one longer than its cells.
void write_part(h5::Group& vtk, std::uint64_t bodies) {
  append_number(vtk, "NumberOfPoints", static_cast<std::int64_t>(bodies));
  for (const char* name : topologies) {
    h5::Group topology = vtk.open_group(name);
    const std::uint64_t cells = name == topologies[0] ? bodies : 0;
    append_number(topology, "NumberOfCells", static_cast<std::int64_t>(cells));
    append_number(topology, "NumberOfConnectivityIds", static_cast<std::int64_t>(cells));
    topology.append("Offsets", std::span<const std::int64_t>(counting(cells + 1)));
  }
}

/// @param before  the file without this frame  @return the file with it
FrameExtent extended(const FrameExtent& before, std::uint64_t bodies) {
  FrameExtent after = before;
  after.frames += 1;
  after.points += bodies;
  if (before.parts == 0 || bodies != before.last_bodies) {
    after.parts += 1;
    after.cells += bodies;
    after.last_bodies = bodies;
  }
  return after;
}

void write_frame(h5::Group vtk, const FrameExtent& before, double time, const BodyStates& states,
                 Fields fields, Precision precision) {
  const FrameExtent after = extended(before, states.position.size());
  if (after.parts > before.parts) write_part(vtk, after.last_bodies);
  vtk.append("Points", values(states.position));
  h5::Group data = vtk.open_group("PointData");
  if (precision == Precision::double_precision)
    append_states<double>(data, states, fields);
  else
    append_states<float>(data, states, fields);

  h5::Group steps = vtk.open_group("Steps");
  const auto first_point = static_cast<std::int64_t>(before.points);
  steps.append("Values", std::span<const double>(&time, 1));
  append_number(steps, "PartOffsets", after.parts - 1);
  append_number(steps, "NumberOfParts", 1);
  append_number(steps, "PointOffsets", first_point);
  std::array<std::int64_t, topologies.size()> first_cell{};
  const std::array<std::int64_t, topologies.size()> first_connectivity{};
  first_cell[0] = static_cast<std::int64_t>(after.cells - after.last_bodies);
  steps.append("CellOffsets", std::span<const std::int64_t>(first_cell));
  steps.append("ConnectivityIdOffsets", std::span<const std::int64_t>(first_connectivity));
  h5::Group offsets = steps.open_group("PointDataOffsets");
  for (const char* name : constant_data) append_number(offsets, name, 0);
  for (const FrameField& field : fields) append_number(offsets, field.name, first_point);
  steps.write_attribute<std::int64_t>("NSteps", after.frames);
}

/// Reads how much of a file is filled by the frames up to the given time.
/// @param last_time  out: time of the last of them  @throws InputError when the numbers disagree
FrameExtent read_extent(const h5::Group& vtk, const std::filesystem::path& path, double time,
                        std::int64_t* frames_found, std::optional<double>* last_time) {
  const auto times = vtk.read<double>("Steps/Values");
  const auto part_of = vtk.read<std::int64_t>("Steps/PartOffsets");
  const auto bodies_of = vtk.read<std::int64_t>("NumberOfPoints");
  *frames_found = vtk.open_group("Steps").attribute<std::int64_t>("NSteps");
  if (std::ssize(times) != *frames_found || std::ssize(part_of) != *frames_found)
    throw InputError(fmt::format("cannot continue {}: it has {} frames, but {} times and {} parts",
                                 path.string(), *frames_found, times.size(), part_of.size()));
  FrameExtent extent;
  extent.body_capacity = vtk.shape("PointData/id").rows;
  for (std::size_t frame = 0; frame < times.size() && times[frame] <= time; ++frame) {
    const std::int64_t part = part_of[frame];
    if (part != extent.parts - 1 && part != extent.parts)
      throw InputError(fmt::format("cannot continue {}: frame {} refers to part {}, expected {}",
                                   path.string(), frame, part, extent.parts));
    if (part >= std::ssize(bodies_of))
      throw InputError(fmt::format("cannot continue {}: frame {} refers to part {} of {}",
                                   path.string(), frame, part, bodies_of.size()));
    extent =
        extended(extent, static_cast<std::uint64_t>(bodies_of[static_cast<std::size_t>(part)]));
    *last_time = times[frame];
  }
  return extent;
}

}  // namespace

FrameWriter::FrameWriter(std::filesystem::path path, const Scene& scene, Precision precision,
                         std::optional<double> resume_time)
    : file_(std::move(path)),
      fields_(dynamics_card(scene.dynamics.type).frame),
      precision_(precision) {
  if (resume_time) resume(scene, *resume_time);
  if (extent_.frames == 0) start(scene);
}

void FrameWriter::start(const Scene& scene) {
  extent_ = FrameExtent{};
  extent_.body_capacity = count_bodies(scene).all();
  file_.start([&](h5::Group root) {
    if (precision_ == Precision::double_precision)
      write_empty<double>(std::move(root), scene, fields_);
    else
      write_empty<float>(std::move(root), scene, fields_);
  });
}

void FrameWriter::resume(const Scene& scene, double time) {
  const std::filesystem::path& path = file_.path();
  if (!std::filesystem::exists(path)) return;
  const std::uint64_t bodies = count_bodies(scene).all();
  std::int64_t frames_found = 0;
  FrameExtent kept;
  try {
    const h5::File file = h5::File::open(path);
    const h5::Group root = file.root();
    const h5::Group vtk = root.open_group("VTKHDF");
    kept = read_extent(vtk, path, time, &frames_found, &last_time_);
    for (const Growing& dataset : filled(kept, fields_).datasets)
      if (root.shape(dataset.name).rows < dataset.rows)
        throw InputError(
            fmt::format("cannot continue {}: dataset {} has {} rows, expected {} or more",
                        path.string(), dataset.name, root.shape(dataset.name).rows, dataset.rows));
    // Reading nothing checks the type.
    for (const FrameField& field : fields_) {
      const std::string dataset = fmt::format("PointData/{}", field.name);
      if (precision_ == Precision::double_precision)
        vtk.read(dataset, std::span<double>());
      else
        vtk.read(dataset, std::span<float>());
    }
  } catch (const h5::Error& error) {
    throw InputError(fmt::format("cannot continue {}", error.what()));
  }
  if (kept.body_capacity != bodies)
    throw InputError(fmt::format("cannot continue {}: its scene has {} bodies, this one {}",
                                 path.string(), kept.body_capacity, bodies));
  extent_ = kept;
  if (kept.frames == 0 || kept.frames == frames_found) return;
  file_.cut(filled(kept, fields_), [&](h5::Group root) {
    root.open_group("VTKHDF/Steps").write_attribute<std::int64_t>("NSteps", kept.frames);
  });
}

void FrameWriter::append(double time, const BodyStates& states) {
  if (last_time_ && time == *last_time_) return;
  if (last_time_ && time < *last_time_)
    throw RunError(fmt::format("frame at {} s comes after the one at {} s", time, *last_time_));
  const std::size_t bodies = states.position.size();
  if (bodies == 0) return;  // readers have trouble with empty parts
  if (bodies > extent_.body_capacity || bodies < extent_.last_bodies ||
      !has_all_rows(states, fields_))
    throw RunError(
        fmt::format("a frame of {} bodies does not fit the {} of the last frame and the {} "
                    "of the scene",
                    bodies, extent_.last_bodies, extent_.body_capacity));
  file_.append(filled(extent_, fields_), [&](h5::Group root) {
    write_frame(root.open_group("VTKHDF"), extent_, time, states, fields_, precision_);
  });
  extent_ = extended(extent_, bodies);
  last_time_ = time;
}

}  // namespace scree
