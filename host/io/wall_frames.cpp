#include "host/io/wall_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "host/error.h"
#include "host/io/body_points.h"
#include "host/io/values.h"
#include "host/io/vtkhdf.h"

namespace scree {
namespace {

using vtkhdf::append_number;
using vtkhdf::polygons;
using vtkhdf::topologies;
constexpr std::array wall_cell_data{"id", "group", "kind"};
constexpr std::array step_numbers{"PartOffsets", "NumberOfParts", "PointOffsets"};

template <class T>
void write_values(h5::Group& group, const std::string& name, const std::vector<T>& data) {
  group.write(name, std::span<const T>(data));
}

void write_count(h5::Group& group, const std::string& name, std::uint64_t count) {
  write_values(group, name, std::vector<std::int64_t>{static_cast<std::int64_t>(count)});
}

/// Where each face ends in the list of corners of all faces, and that list.
struct Faces {
  std::vector<std::int64_t> offsets{0};
  std::vector<std::int64_t> corners;
};

Faces faces_of(const std::vector<WallSurface>& walls) {
  Faces all;
  std::int64_t first = 0;
  for (const WallSurface& wall : walls) {
    for (const std::vector<int>& face : wall.surface.faces) {
      for (const int corner : face) all.corners.push_back(first + corner);
      all.offsets.push_back(std::ssize(all.corners));
    }
    first += std::ssize(wall.surface.vertices);
  }
  return all;
}

/// One value of its body for each face.
template <class T, class F>
std::vector<T> per_face(const std::vector<WallSurface>& walls, F value) {
  std::vector<T> all;
  for (const WallSurface& wall : walls)
    all.insert(all.end(), wall.surface.faces.size(), static_cast<T>(value(wall.body)));
  return all;
}

bool same(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b) {
  const std::span<const double> x = values(a), y = values(b);
  return std::equal(x.begin(), x.end(), y.begin(), y.end());
}

}  // namespace

WallFrameWriter::WallFrameWriter(std::filesystem::path path, const Scene& scene,
                                 std::optional<double> resume_time)
    : walls_(wall_surfaces(scene)) {
  for (const WallSurface& wall : walls_) {
    corner_count_ += wall.surface.vertices.size();
    face_count_ += wall.surface.faces.size();
    for (const std::vector<int>& face : wall.surface.faces) face_corner_count_ += face.size();
  }
  if (corner_count_ == 0) return;
  file_ = std::make_unique<TwinFile>(std::move(path));
  if (resume_time) resume(*resume_time);
  if (extent_.frames == 0) start(scene);
  for (WallSurface& wall : walls_) wall.surface.faces = {};  // they are on disk
}

std::size_t WallFrameWriter::body_end() const {
  std::size_t end = 0;
  for (const WallSurface& wall : walls_) end = std::max(end, wall.body + 1);
  return end;
}

Filled WallFrameWriter::filled() const {
  const auto frames = static_cast<std::uint64_t>(extent_.frames);
  std::vector<Growing> all{{"Points", extent_.poses * corner_count_},
                           {"Steps/Values", frames},
                           {"Steps/CellOffsets", frames},
                           {"Steps/ConnectivityIdOffsets", frames}};
  for (const char* name : step_numbers) all.push_back({fmt::format("Steps/{}", name), frames});
  for (const char* name : wall_cell_data)
    all.push_back({fmt::format("Steps/CellDataOffsets/{}", name), frames});
  for (Growing& dataset : all) dataset.name = "VTKHDF/" + dataset.name;
  return {extent_.frames, std::move(all)};
}

void WallFrameWriter::start(const Scene& scene) {
  extent_ = {};
  last_corners_.clear();
  file_->start([&](h5::Group root) {
    const std::uint64_t point_chunk = std::clamp<std::uint64_t>(corner_count_, 64, 65536);
    h5::Group vtk = vtkhdf::create_poly_data(root);
    write_count(vtk, "NumberOfPoints", corner_count_);
    vtk.create_growing<double>("Points", 3, point_chunk);
    const Faces faces = faces_of(walls_);
    for (std::size_t k = 0; k < topologies.size(); ++k) {
      h5::Group topology = vtk.create_group(topologies[k]);
      const bool used = k == polygons;
      write_count(topology, "NumberOfCells", used ? face_count_ : 0);
      write_count(topology, "NumberOfConnectivityIds", used ? face_corner_count_ : 0);
      write_values(topology, "Offsets", used ? faces.offsets : std::vector<std::int64_t>{0});
      write_values(topology, "Connectivity", used ? faces.corners : std::vector<std::int64_t>{});
    }
    h5::Group data = vtk.create_group("CellData");
    const auto body = [&](std::size_t id) -> const BodyDescription& { return scene.bodies[id]; };
    write_values(data, "id", per_face<std::int64_t>(walls_, [](std::size_t id) { return id; }));
    write_values(data, "group",
                 per_face<std::int32_t>(walls_, [&](std::size_t id) { return body(id).group; }));
    write_values(data, "kind",
                 per_face<std::uint8_t>(walls_, [&](std::size_t id) { return body(id).kind; }));

    vtkhdf::create_steps(vtk, "CellData", {wall_cell_data.begin(), wall_cell_data.end()});
  });
}

void WallFrameWriter::resume(double time) {
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
    const auto stored = [&](const char* name) { return vtk.shape(name).rows; };
    if (vtk.read<std::int64_t>("NumberOfPoints") !=
            std::vector{static_cast<std::int64_t>(corner_count_)} ||
        stored("Polygons/Offsets") != face_count_ + 1 ||
        stored("Polygons/Connectivity") != face_corner_count_)
      refuse("it holds other walls than the scene");
    frames_found = vtk.open_group("Steps").attribute<std::int64_t>("NSteps");
    const auto times = vtk.read<double>("Steps/Values");
    const auto first_points = vtk.read<std::int64_t>("Steps/PointOffsets");
    if (std::ssize(times) != frames_found || times.size() != first_points.size())
      refuse(fmt::format("it has {} frames, but {} times and {} offsets of points", frames_found,
                         times.size(), first_points.size()));
    for (std::size_t frame = 0; frame < times.size() && times[frame] <= time; ++frame) {
      const auto first = static_cast<std::uint64_t>(first_points[frame]);
      const bool moved = first == extent_.poses * corner_count_;
      if (!moved && (extent_.poses == 0 || first != (extent_.poses - 1) * corner_count_))
        refuse(fmt::format("frame {} has the offset {} of points", frame, first_points[frame]));
      extent_.poses += moved ? 1 : 0;
      extent_.frames += 1;
      last_time_ = times[frame];
    }
    for (const Growing& dataset : filled().datasets)
      if (root.shape(dataset.name).rows < dataset.rows)
        refuse(fmt::format("dataset {} has {} rows, expected {} or more", dataset.name,
                           root.shape(dataset.name).rows, dataset.rows));
    if (extent_.frames == 0) return;
    last_corners_.resize(corner_count_);
    vtk.read("Points", values(last_corners_), (extent_.poses - 1) * corner_count_);
  } catch (const h5::Error& error) {
    throw InputError(fmt::format("cannot continue {}", error.what()));
  }
  if (extent_.frames == frames_found) return;
  file_->cut(filled(), [&](h5::Group root) {
    root.open_group("VTKHDF/Steps").write_attribute<std::int64_t>("NSteps", extent_.frames);
  });
}

std::vector<Vec3d> WallFrameWriter::corners(const BodyStates& states) const {
  std::vector<Vec3d> all;
  all.reserve(corner_count_);
  for (const WallSurface& wall : walls_) {
    const BodyPoints place(states, wall.body);
    for (const Vec3d& corner : wall.surface.vertices) all.push_back(place(corner));
  }
  return all;
}

void WallFrameWriter::append(double time, const BodyStates& states) {
  if (!file_ || (last_time_ && time == *last_time_)) return;
  if (last_time_ && time < *last_time_)
    throw RunError(fmt::format("frame at {} s comes after the one at {} s", time, *last_time_));
  std::vector<Vec3d> now = corners(states);
  const bool moved = extent_.poses == 0 || !same(now, last_corners_);
  const WallExtent after{extent_.frames + 1, extent_.poses + (moved ? 1 : 0)};
  file_->append(filled(), [&](h5::Group root) {
    h5::Group vtk = root.open_group("VTKHDF");
    if (moved) vtk.append("Points", values(std::as_const(now)));
    h5::Group steps = vtk.open_group("Steps");
    steps.append("Values", std::span<const double>(&time, 1));
    append_number(steps, "PartOffsets", 0);
    append_number(steps, "NumberOfParts", 1);
    append_number(steps, "PointOffsets",
                  static_cast<std::int64_t>((after.poses - 1) * corner_count_));
    const std::array<std::int64_t, topologies.size()> none{};
    for (const char* name : {"CellOffsets", "ConnectivityIdOffsets"})
      steps.append(name, std::span<const std::int64_t>(none));
    h5::Group offsets = steps.open_group("CellDataOffsets");
    for (const char* name : wall_cell_data) append_number(offsets, name, 0);
    steps.write_attribute<std::int64_t>("NSteps", after.frames);
  });
  extent_ = after;
  last_corners_ = std::move(now);
  last_time_ = time;
}

}  // namespace scree
