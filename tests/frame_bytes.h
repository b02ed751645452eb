#pragma once
// Frames of bodies as a program finds them that follows the offsets of VTKHDF and knows nothing of pieces: virtual datasets
// are for the library HDF5.

#include <gtest/gtest.h>
#include <hdf5.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <numeric>
#include <string>
#include <vector>

namespace scree::test {

/// The point data of a frame and `Points`, row by row in the order of ids, as bytes.
struct FrameBytes {
  double time = 0;
  std::map<std::string, std::vector<std::string>> data;
  std::vector<std::int64_t> ids() const {
    std::vector<std::int64_t> all;
    for (const std::string& bytes : data.at("id"))
      all.push_back(*reinterpret_cast<const std::int64_t*>(bytes.data()));
    return all;
  }
  friend bool operator==(const FrameBytes&, const FrameBytes&) = default;
};

/// Rows of an array as bytes.
inline std::vector<std::string> rows_of(hid_t file, const std::string& name) {
  const hid_t dataset = H5Dopen2(file, name.c_str(), H5P_DEFAULT);
  EXPECT_GE(dataset, 0) << name;
  const hid_t stored = H5Dget_type(dataset), type = H5Tget_native_type(stored, H5T_DIR_ASCEND);
  const hid_t space = H5Dget_space(dataset);
  hsize_t size[2] = {0, 1};
  H5Sget_simple_extent_dims(space, size, nullptr);
  const std::size_t row = size[1] * H5Tget_size(type);
  std::string bytes(size[0] * row, '\0');
  EXPECT_GE(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()), 0) << name;
  H5Sclose(space), H5Tclose(type), H5Tclose(stored), H5Dclose(dataset);
  std::vector<std::string> rows;
  for (std::size_t i = 0; i < size[0]; ++i) rows.push_back(bytes.substr(i * row, row));
  return rows;
}

inline std::vector<std::int64_t> integers_of(hid_t file, const std::string& name) {
  std::vector<std::int64_t> all;
  for (const std::string& row : rows_of(file, name))
    all.push_back(*reinterpret_cast<const std::int64_t*>(row.data()));
  return all;
}

/// All frames of a file of rigid bodies. Checks that each part has a vertex for each of its points.
inline std::vector<FrameBytes> frame_bytes(const std::filesystem::path& path) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  EXPECT_GE(file, 0) << path;
  const auto integers = [&](const std::string& name) {
    return integers_of(file, "VTKHDF/" + name);
  };
  const auto first_part = integers("Steps/PartOffsets"), parts = integers("Steps/NumberOfParts");
  const auto bodies = integers("NumberOfPoints"), vertices = integers("Vertices/NumberOfCells");
  const auto connectivity = integers("Vertices/Connectivity");
  const auto offsets = integers("Vertices/Offsets");
  const std::vector<std::string> times = rows_of(file, "VTKHDF/Steps/Values");
  // Offsets of cells and connectivity have a column for each kind of cells.
  const auto first_cell = integers("Steps/CellOffsets");
  const auto first_id = integers("Steps/ConnectivityIdOffsets");
  std::vector<FrameBytes> frames(times.size());
  const auto at = [](std::int64_t i) { return static_cast<std::size_t>(i); };
  std::vector<std::int64_t> count(times.size());
  for (std::size_t k = 0; k < times.size(); ++k) {
    frames[k].time = *reinterpret_cast<const double*>(times[k].data());
    std::int64_t cell = first_cell[k] + first_part[k], id = first_id[k];
    for (std::int64_t part = first_part[k]; part < first_part[k] + parts[k]; ++part) {
      const std::int64_t n = bodies[at(part)];
      EXPECT_EQ(vertices[at(part)], n);
      for (std::int64_t i = 0; i <= n; ++i) EXPECT_EQ(offsets[at(cell + i)], i);
      for (std::int64_t i = 0; i < n; ++i) EXPECT_EQ(connectivity[at(id + i)], i);
      cell += n + 1, id += n, count[k] += n;
    }
  }
  for (const std::string name : {"Points", "id", "radius", "half_extents", "mass", "group", "kind",
                                 "shape", "velocity", "angular_velocity", "orientation", "speed"}) {
    const bool is_points = name == "Points";
    const std::vector<std::string> rows =
        rows_of(file, "VTKHDF/" + (is_points ? name : "PointData/" + name));
    const auto first =
        integers(is_points ? "Steps/PointOffsets" : "Steps/PointDataOffsets/" + name);
    for (std::size_t k = 0; k < times.size(); ++k)
      frames[k].data[name] = {rows.begin() + first[k], rows.begin() + first[k] + count[k]};
  }
  H5Fclose(file);
  for (FrameBytes& frame : frames) {
    const std::vector<std::int64_t> ids = frame.ids();
    std::vector<std::size_t> order(ids.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](auto a, auto b) { return ids[a] < ids[b]; });
    for (auto& [name, rows] : frame.data) {
      std::vector<std::string> sorted;
      for (const std::size_t i : order) sorted.push_back(rows[i]);
      rows = std::move(sorted);
    }
  }
  return frames;
}

/// Frame by frame and id by id, bit for bit.
inline void expect_same_frames(const std::filesystem::path& a, const std::filesystem::path& b) {
  const std::vector<FrameBytes> x = frame_bytes(a), y = frame_bytes(b);
  ASSERT_EQ(x.size(), y.size());
  for (std::size_t k = 0; k < x.size(); ++k) {
    EXPECT_EQ(x[k].time, y[k].time);
    for (const auto& [name, rows] : x[k].data)
      EXPECT_TRUE(rows == y[k].data.at(name)) << name << " of frame " << k;
  }
}

}  // namespace scree::test
