#include "host/io/frames.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <numeric>
#include <span>
#include <system_error>
#include <vector>

#include "host/bodies_by_id.h"
#include "host/error.h"
#include "host/io/atomic_file.h"
#include "host/io/h5.h"
#include "host/io/values.h"
#include "host/scene_summary.h"

namespace scree {
namespace {

constexpr std::array topologies{"Vertices", "Lines", "Polygons", "Strips"};  // the format's order
constexpr std::array constant_data{"id",    "radius", "half_extents", "mass",
                                   "group", "kind",   "shape"};
constexpr std::array moving_data{"velocity", "angular_velocity", "orientation", "speed"};

/// A dataset that grows, and the rows it has when the file is filled so far.
struct Growing {
  std::string name;
  std::uint64_t rows;
};

std::vector<Growing> growing_datasets(const FrameExtent& extent) {
  const auto frames = static_cast<std::uint64_t>(extent.frames);
  const auto parts = static_cast<std::uint64_t>(extent.parts);
  std::vector<Growing> all{
      {"Points", extent.points},       {"NumberOfPoints", parts},
      {"Steps/Values", frames},        {"Steps/PartOffsets", frames},
      {"Steps/NumberOfParts", frames}, {"Steps/PointOffsets", frames},
      {"Steps/CellOffsets", frames},   {"Steps/ConnectivityIdOffsets", frames}};
  for (const char* name : moving_data) {
    all.push_back({fmt::format("PointData/{}", name), extent.points});
    all.push_back({fmt::format("Steps/PointDataOffsets/{}", name), frames});
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
  return all;
}

std::vector<std::int64_t> counting(std::uint64_t count) {
  std::vector<std::int64_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), std::int64_t{0});
  return numbers;
}

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

/// Half edge lengths of boxes and containers; zero for other bodies.
std::vector<float> half_extents(const Scene& scene, std::size_t count) {
  std::vector<float> column(3 * count, 0.0f);
  for_each_by_id(
      scene,
      [&](std::size_t id, const BodyDescription& body) {
        const Shape& s = body.shape;
        if (s.kind != Shape::Kind::box && s.kind != Shape::Kind::container) return;
        for (std::size_t k = 0; k < 3; ++k)
          column[3 * id + k] = static_cast<float>(s.half_extents[static_cast<int>(k)]);
      },
      [](std::size_t, const ParticleSet&) {});
  return column;
}

void write_constants(h5::Group& data, const Scene& scene, const BodyConstants& bodies) {
  write_values(data, "id", counting(bodies.size()));
  write_constant<float>(data, "radius", bodies, [](const BodyConstant& b) {
    return b.shape == Shape::Kind::sphere ? b.radius : 0.0;
  });
  write_values(data, "half_extents", half_extents(scene, bodies.size()), 3);
  write_constant<double>(data, "mass", bodies, [](const BodyConstant& b) { return b.mass; });
  write_constant<std::int32_t>(data, "group", bodies,
                               [](const BodyConstant& b) { return b.group; });
  write_constant<std::uint8_t>(data, "kind", bodies, [](const BodyConstant& b) { return b.kind; });
  write_constant<std::uint8_t>(data, "shape", bodies,
                               [](const BodyConstant& b) { return b.shape; });
}

/// Everything of the file but frames.
void write_empty(h5::Group root, const Scene& scene) {
  const BodyConstants bodies(scene);
  const std::uint64_t count = bodies.size();
  // Chunks are at most one to two megabytes, and small runs get small files.
  const std::uint64_t point_chunk = std::clamp<std::uint64_t>(count, 64, 65536);
  constexpr std::uint64_t frame_chunk = 128;

  h5::Group vtk = root.create_group("VTKHDF");
  const std::array<std::int64_t, 2> version{2, 0};
  vtk.write_attribute("Version", std::span<const std::int64_t>(version));
  vtk.write_text_attribute("Type", "PolyData");

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
  write_constants(data, scene, bodies);
  data.create_growing<float>("velocity", 3, point_chunk);
  data.create_growing<float>("angular_velocity", 3, point_chunk);
  data.create_growing<float>("orientation", 4, point_chunk);
  data.create_growing<float>("speed", 0, point_chunk);

  h5::Group steps = vtk.create_group("Steps");
  steps.write_attribute<std::int64_t>("NSteps", 0);
  steps.create_growing<double>("Values", 0, frame_chunk);
  for (const char* name : {"PartOffsets", "NumberOfParts", "PointOffsets"})
    steps.create_growing<std::int64_t>(name, 0, frame_chunk);
  for (const char* name : {"CellOffsets", "ConnectivityIdOffsets"})
    steps.create_growing<std::int64_t>(name, topologies.size(), frame_chunk);
  h5::Group offsets = steps.create_group("PointDataOffsets");
  for (const char* name : constant_data) offsets.create_growing<std::int64_t>(name, 0, frame_chunk);
  for (const char* name : moving_data) offsets.create_growing<std::int64_t>(name, 0, frame_chunk);
}

void append_number(h5::Group& group, const std::string& name, std::int64_t value) {
  group.append(name, std::span<const std::int64_t>(&value, 1));
}

/// Three floats per vector, four per quaternion.
template <class T>
std::vector<float> to_float(const std::vector<T>& data) {
  const std::span<const double> from = values(data);
  std::vector<float> to(from.size());
  std::transform(from.begin(), from.end(), to.begin(),
                 [](double x) { return static_cast<float>(x); });
  return to;
}

std::vector<float> speeds(const std::vector<Vec3d>& velocity) {
  std::vector<float> to(velocity.size());
  std::transform(velocity.begin(), velocity.end(), to.begin(),
                 [](const Vec3d& v) { return static_cast<float>(norm(v)); });
  return to;
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

void write_frame(h5::Group vtk, const FrameExtent& before, double time, const BodyStates& states) {
  const FrameExtent after = extended(before, states.position.size());
  if (after.parts > before.parts) write_part(vtk, after.last_bodies);
  vtk.append("Points", values(states.position));
  h5::Group data = vtk.open_group("PointData");
  data.append("velocity", std::span<const float>(to_float(states.velocity)));
  data.append("angular_velocity", std::span<const float>(to_float(states.angular_velocity)));
  data.append("orientation", std::span<const float>(to_float(states.orientation)));
  data.append("speed", std::span<const float>(speeds(states.velocity)));

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
  for (const char* name : moving_data) append_number(offsets, name, first_point);
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

std::string write_failure(const std::filesystem::path& path, const std::string& reason,
                          std::int64_t frames) {
  return fmt::format("cannot write frames {}: {}; the {} earlier frames are kept", path.string(),
                     reason, frames);
}

void remove_file(const std::filesystem::path& path) noexcept { ::unlink(path.c_str()); }

}  // namespace

FrameWriter::FrameWriter(std::filesystem::path path, const Scene& scene,
                         std::optional<double> resume_time)
    : path_(std::move(path)), spare_(path_), previous_(path_) {
  spare_ += ".next";
  previous_ += ".previous";
  remove_file(spare_);
  remove_file(previous_);
  if (resume_time) resume(scene, *resume_time);
  if (extent_.frames == 0) start(scene);
}

FrameWriter::~FrameWriter() { finish(); }

void FrameWriter::finish() noexcept {
  remove_file(spare_);
  remove_file(previous_);
}

void FrameWriter::start(const Scene& scene) {
  remove_file(path_);
  extent_ = FrameExtent{};
  extent_.body_capacity = count_bodies(scene).all();
  try {
    h5::File file = h5::File::create(spare_);
    write_empty(file.root(), scene);
    file.close();
  } catch (const h5::Error& error) {
    remove_file(spare_);
    throw RunError(write_failure(path_, error.what(), 0));
  }
}

void FrameWriter::resume(const Scene& scene, double time) {
  if (!std::filesystem::exists(path_)) return;
  const std::uint64_t bodies = count_bodies(scene).all();
  std::int64_t frames_found = 0;
  FrameExtent kept;
  try {
    const h5::File file = h5::File::open(path_);
    const h5::Group vtk = file.root().open_group("VTKHDF");
    kept = read_extent(vtk, path_, time, &frames_found, &last_time_);
    for (const Growing& dataset : growing_datasets(kept))
      if (vtk.shape(dataset.name).rows < dataset.rows)
        throw InputError(
            fmt::format("cannot continue {}: dataset {} has {} rows, expected {} or more",
                        path_.string(), dataset.name, vtk.shape(dataset.name).rows, dataset.rows));
  } catch (const h5::Error& error) {
    throw InputError(fmt::format("cannot continue {}", error.what()));
  }
  if (kept.body_capacity != bodies)
    throw InputError(fmt::format("cannot continue {}: its scene has {} bodies, this one {}",
                                 path_.string(), kept.body_capacity, bodies));
  extent_ = kept;
  if (kept.frames > 0 && kept.frames < frames_found) drop_frames_beyond(kept);
}

void FrameWriter::drop_frames_beyond(const FrameExtent& kept) {
  try {
    prepare_spare();
    h5::File file = h5::File::open_for_append(spare_);
    {
      h5::Group vtk = file.root().open_group("VTKHDF");
      for (const Growing& dataset : growing_datasets(kept))
        vtk.truncate(dataset.name, dataset.rows);
      vtk.open_group("Steps").write_attribute<std::int64_t>("NSteps", kept.frames);
    }
    file.close();
  } catch (const h5::Error& error) {
    remove_file(spare_);
    throw RunError(write_failure(path_, error.what(), kept.frames));
  }
  publish(/*keep_previous=*/false);
}

void FrameWriter::append(double time, const BodyStates& states) {
  if (last_time_ && time == *last_time_) return;
  if (last_time_ && time < *last_time_)
    throw RunError(fmt::format("frame at {} s comes after the one at {} s", time, *last_time_));
  const std::size_t bodies = states.position.size();
  if (bodies == 0) return;  // readers have trouble with empty parts
  if (bodies > extent_.body_capacity || bodies < extent_.last_bodies ||
      states.orientation.size() != bodies || states.velocity.size() != bodies ||
      states.angular_velocity.size() != bodies)
    throw RunError(
        fmt::format("a frame of {} bodies does not fit the {} of the last frame and the {} "
                    "of the scene",
                    bodies, extent_.last_bodies, extent_.body_capacity));
  try {
    prepare_spare();
    h5::File file = h5::File::open_for_append(spare_);
    write_frame(file.root().open_group("VTKHDF"), extent_, time, states);
    file.close();
  } catch (const h5::Error& error) {
    remove_file(spare_);
    throw RunError(write_failure(path_, error.what(), extent_.frames));
  }
  publish(/*keep_previous=*/true);
  extent_ = extended(extent_, bodies);
  last_time_ = time;
}

/// Makes the spare a complete copy of the published file, by what it lacks where it can.
void FrameWriter::prepare_spare() {
  if (extent_.frames == 0) return;  // start() wrote it
  if (std::filesystem::exists(spare_)) {
    try {
      h5::File spare = h5::File::open_for_append(spare_);
      {
        const h5::File published = h5::File::open(path_);
        const h5::Group from = published.root().open_group("VTKHDF");
        h5::Group to = spare.root().open_group("VTKHDF");
        for (const Growing& dataset : growing_datasets(extent_))
          to.append_missing_rows(from, dataset.name);
      }
      spare.close();
      return;
    } catch (const h5::Error&) {
      // Somebody still reads this copy, which was the published one (HDF5 locks it), or it is
      // damaged. It stays theirs; a new one is made.
      remove_file(spare_);
    }
  }
  try {
    copy_file_atomically(path_, spare_);
  } catch (const RunError& error) {
    throw RunError(write_failure(path_, error.what(), extent_.frames));
  }
}

/// Gives the spare the published name, and the published file the spare's when it is kept.
void FrameWriter::publish(bool keep_previous) {
  sync_file(spare_);
  // A second name keeps the old file. Where links do not exist, the next append copies the file.
  const bool kept = keep_previous && ::link(path_.c_str(), previous_.c_str()) == 0;
  if (::rename(spare_.c_str(), path_.c_str()) != 0) {
    const int reason = errno;
    finish();
    throw RunError(io_message("cannot replace frames", path_, reason));
  }
  sync_directory_of(path_);
  if (kept && ::rename(previous_.c_str(), spare_.c_str()) != 0) remove_file(previous_);
}

}  // namespace scree
