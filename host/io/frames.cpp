#include "host/io/frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "host/error.h"
#include "host/io/frame_columns.h"
#include "host/io/values.h"
#include "host/io/vtkhdf.h"
#include "host/scene/scene_summary.h"

namespace scree {
namespace {

using vtkhdf::append_number;
using vtkhdf::topologies;
using Fields = std::span<const FrameField>;

Filled filled(const FrameExtent& extent, const FrameFormat& format) {
  const auto frames = static_cast<std::uint64_t>(extent.frames);
  const auto parts = static_cast<std::uint64_t>(extent.parts);
  std::vector<Growing> all{
      {"Points", extent.points},       {"NumberOfPoints", parts},
      {"Steps/Values", frames},        {"Steps/PartOffsets", frames},
      {"Steps/NumberOfParts", frames}, {"Steps/PointOffsets", frames},
      {"Steps/CellOffsets", frames},   {"Steps/ConnectivityIdOffsets", frames}};
  const bool is_own = format.bodies == FrameBodies::own;
  for (const FrameField& field : format.fields) {
    all.push_back({fmt::format("PointData/{}", field.name), extent.points});
    all.push_back({fmt::format("Steps/PointDataOffsets/{}", field.name), frames});
  }
  for (const std::string& name : constant_names()) {
    if (is_own) all.push_back({fmt::format("PointData/{}", name), extent.points});
    all.push_back({fmt::format("Steps/PointDataOffsets/{}", name), frames});
  }
  if (is_own) all.push_back({"Vertices/Connectivity", extent.most_bodies});
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

/// Calls put(name, columns, numbers of all bodies) for what never changes.
/// @param id_of(i)  of body i of so many
template <class Real, class IdOf, class Put>
void for_each_constant_column(const BodyConstants& bodies, std::size_t count, IdOf id_of, Put put) {
  for_each_constant<Real>([&](const char* name, auto value) {
    using Row = NumbersOf<decltype(value)>;
    std::vector<typename Row::Type> column;
    column.reserve(count * std::max<std::size_t>(Row::columns, 1));
    for (std::size_t i = 0; i < count; ++i) Row::append(value(bodies, id_of(i)), column);
    put(name, Row::columns, column);
  });
}

template <class Real>
void write_constants(h5::Group& data, const BodyConstants& bodies) {
  for_each_constant_column<Real>(
      bodies, bodies.size(), [](std::size_t i) { return i; },
      [&](const char* name, std::uint64_t columns, const auto& column) {
        write_values(data, name, column, columns);
      });
}

template <class Real>
void append_constants(h5::Group& data, const BodyConstants& bodies,
                      const std::vector<std::int32_t>& ids) {
  for_each_constant_column<Real>(
      bodies, ids.size(), [&](std::size_t i) { return static_cast<std::size_t>(ids[i]); },
      [&]<class T>(const char* name, std::uint64_t, const std::vector<T>& column) {
        data.append(name, std::span<const T>(column));
      });
}

/// Everything of the file but frames.
/// @tparam Real  number type of the run  @param all  constants where they are stored once; null: in each frame
template <class Real>
void write_empty(h5::Group root, std::uint64_t body_capacity, const BodyConstants* all,
                 Fields fields) {
  // Chunks are at most one to two megabytes, and small runs get small files.
  const std::uint64_t point_chunk = std::clamp<std::uint64_t>(body_capacity, 64, 65536);
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
    if (used && all == nullptr)
      topology.create_growing<std::int64_t>("Connectivity", 0, point_chunk);
    else
      write_values(topology, "Connectivity", counting(used ? body_capacity : 0));
  }

  h5::Group data = vtk.create_group("PointData");
  if (all != nullptr) {
    write_constants<Real>(data, *all);
  } else {
    for_each_constant<Real>([&](const char* name, auto value) {
      using Row = NumbersOf<decltype(value)>;
      data.create_growing<typename Row::Type>(name, Row::columns, point_chunk);
    });
  }
  for (const FrameField& field : fields)
    data.create_growing<Real>(
        field.name, field.columns > 1 ? static_cast<std::uint64_t>(field.columns) : 0, point_chunk);

  std::vector<std::string> names = constant_names();
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

void write_frame(h5::Group vtk, const FrameExtent& before, double time, const BodyStates& states,
                 const FrameFormat& format) {
  const FrameExtent after = extended(before, states.position.size());
  const bool is_own = format.bodies == FrameBodies::own;
  if (after.parts > before.parts) write_part(vtk, after.last_bodies);
  if (is_own)
    vtk.append("Vertices/Connectivity", std::span<const std::int64_t>(vtkhdf::counting(
                                            before.most_bodies, after.most_bodies)));
  vtk.append("Points", values(states.position));
  h5::Group data = vtk.open_group("PointData");
  if (format.precision == Precision::double_precision)
    append_states<double>(data, states, format.fields);
  else
    append_states<float>(data, states, format.fields);

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
  for (const std::string& name : constant_names())
    append_number(offsets, name, is_own ? first_point : 0);
  for (const FrameField& field : format.fields) append_number(offsets, field.name, first_point);
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

FrameExtent extended(const FrameExtent& before, std::uint64_t bodies) {
  FrameExtent after = before;
  after.frames += 1;
  after.points += bodies;
  after.most_bodies = std::max(before.most_bodies, bodies);
  if (before.parts == 0 || bodies != before.last_bodies) {
    after.parts += 1;
    after.cells += bodies;
    after.last_bodies = bodies;
  }
  return after;
}

void require_filled(const h5::Group& root, const std::filesystem::path& path,
                    const FrameExtent& extent, const FrameFormat& format) {
  for (const Growing& dataset : filled(extent, format).datasets)
    if (root.shape(dataset.name).rows < dataset.rows)
      throw InputError(
          fmt::format("cannot continue {}: dataset {} has {} rows, expected {} or more",
                      path.string(), dataset.name, root.shape(dataset.name).rows, dataset.rows));
  // Reading nothing checks the type.
  for (const FrameField& field : format.fields) {
    const std::string dataset = fmt::format("VTKHDF/PointData/{}", field.name);
    if (format.precision == Precision::double_precision)
      root.read(dataset, std::span<double>());
    else
      root.read(dataset, std::span<float>());
  }
}

FrameWriter::FrameWriter(std::filesystem::path path, const Scene& scene, Precision precision,
                         std::optional<double> resume_time)
    : file_(std::move(path)),
      format_{dynamics_card(scene.dynamics.type).frame, precision, FrameBodies::all} {
  extent_.body_capacity = count_bodies(scene).all();
  if (resume_time) resume(*resume_time);
  if (extent_.frames > 0) return;
  start([&](h5::Group root) {
    const BodyConstants bodies(scene);
    if (precision == Precision::double_precision)
      write_empty<double>(std::move(root), bodies.size(), &bodies, format_.fields);
    else
      write_empty<float>(std::move(root), bodies.size(), &bodies, format_.fields);
  });
}

FrameWriter::FrameWriter(std::filesystem::path path, Fields fields, Precision precision,
                         std::uint64_t body_capacity, std::optional<double> resume_time)
    : file_(std::move(path)), format_{fields, precision, FrameBodies::own} {
  extent_.body_capacity = body_capacity;
  if (resume_time) resume(*resume_time);
  if (extent_.frames > 0) return;
  start([&](h5::Group root) {
    if (precision == Precision::double_precision)
      write_empty<double>(std::move(root), body_capacity, nullptr, fields);
    else
      write_empty<float>(std::move(root), body_capacity, nullptr, fields);
  });
}

void FrameWriter::start(const Write& write_empty) {
  const std::uint64_t body_capacity = extent_.body_capacity;
  extent_ = FrameExtent{};
  extent_.body_capacity = body_capacity;
  file_.start(write_empty);
}

void FrameWriter::resume(double time) {
  const std::filesystem::path& path = file_.path();
  if (!std::filesystem::exists(path)) return;
  const std::uint64_t bodies = extent_.body_capacity;
  std::int64_t frames_found = 0;
  FrameExtent kept;
  try {
    const h5::File file = h5::File::open(path);
    const h5::Group root = file.root();
    if (root.has(frame_pieces_group))
      throw InputError(
          fmt::format("cannot continue {}: it was written in pieces (output.frame_pieces true), "
                      "this run has false",
                      path.string()));
    const h5::Group vtk = root.open_group("VTKHDF");
    kept = read_extent(vtk, path, time, &frames_found, &last_time_);
    if (format_.bodies == FrameBodies::own) kept.body_capacity = bodies;
    require_filled(root, path, kept, format_);
  } catch (const h5::Error& error) {
    throw InputError(fmt::format("cannot continue {}", error.what()));
  }
  if (kept.body_capacity != bodies)
    throw InputError(fmt::format("cannot continue {}: its scene has {} bodies, this one {}",
                                 path.string(), kept.body_capacity, bodies));
  extent_ = kept;
  if (kept.frames == 0 || kept.frames == frames_found) return;
  file_.cut(filled(kept, format_), [&](h5::Group root) {
    root.open_group("VTKHDF/Steps").write_attribute<std::int64_t>("NSteps", kept.frames);
  });
}

void FrameWriter::append(double time, const BodyStates& states) {
  append(time, states, [](const h5::Group&) {});
}

void FrameWriter::append(double time, const OwnBodies& bodies, const BodyConstants& constants) {
  append(time, bodies.states, [&](h5::Group data) {
    if (format_.precision == Precision::double_precision)
      append_constants<double>(data, constants, bodies.id);
    else
      append_constants<float>(data, constants, bodies.id);
  });
}

void FrameWriter::append(double time, const BodyStates& states, const Write& write_constants) {
  if (last_time_ && time == *last_time_) return;
  if (last_time_ && time < *last_time_)
    throw RunError(fmt::format("frame at {} s comes after the one at {} s", time, *last_time_));
  const std::size_t bodies = states.position.size();
  if (bodies == 0) return;  // readers have trouble with empty parts
  const bool may_be_fewer = format_.bodies == FrameBodies::own;
  if (bodies > extent_.body_capacity || (bodies < extent_.last_bodies && !may_be_fewer) ||
      !has_all_rows(states, format_.fields))
    throw RunError(
        fmt::format("a frame of {} bodies does not fit the {} of the last frame and the {} "
                    "of the scene",
                    bodies, extent_.last_bodies, extent_.body_capacity));
  file_.append(filled(extent_, format_), [&](h5::Group root) {
    write_frame(root.open_group("VTKHDF"), extent_, time, states, format_);
    write_constants(root.open_group("VTKHDF/PointData"));
  });
  extent_ = extended(extent_, bodies);
  last_time_ = time;
}

}  // namespace scree
