#pragma once
// What transient VTKHDF files of PolyData have in common.

#include <array>
#include <cstdint>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "host/io/h5.h"

namespace scree::vtkhdf {

constexpr std::array topologies{"Vertices", "Lines", "Polygons", "Strips"};  // the format's order
constexpr std::size_t polygons = 2;         ///< the place of "Polygons" among them
constexpr std::uint64_t frame_chunk = 128;  ///< rows of data sets that grow by one a frame

inline std::vector<std::int64_t> counting(std::uint64_t first, std::uint64_t end) {
  std::vector<std::int64_t> numbers(end - first);
  std::iota(numbers.begin(), numbers.end(), static_cast<std::int64_t>(first));
  return numbers;
}

inline void append_number(h5::Group& group, const std::string& name, std::int64_t value) {
  group.append(name, std::span<const std::int64_t>(&value, 1));
}

/// The group that all is in.
inline h5::Group create_poly_data(h5::Group& root) {
  h5::Group vtk = root.create_group("VTKHDF");
  const std::array<std::int64_t, 2> version{2, 0};
  vtk.write_attribute("Version", std::span<const std::int64_t>(version));
  vtk.write_text_attribute("Type", "PolyData");
  return vtk;
}

/// Steps/, without one. @param kind  "PointData" or "CellData"  @param data  names of the arrays there
inline void create_steps(h5::Group& vtk, const char* kind, const std::vector<std::string>& data) {
  h5::Group steps = vtk.create_group("Steps");
  steps.write_attribute<std::int64_t>("NSteps", 0);
  steps.create_growing<double>("Values", 0, frame_chunk);
  for (const char* name : {"PartOffsets", "NumberOfParts", "PointOffsets"})
    steps.create_growing<std::int64_t>(name, 0, frame_chunk);
  for (const char* name : {"CellOffsets", "ConnectivityIdOffsets"})
    steps.create_growing<std::int64_t>(name, topologies.size(), frame_chunk);
  h5::Group offsets = steps.create_group(std::string(kind) + "Offsets");
  for (const std::string& name : data) offsets.create_growing<std::int64_t>(name, 0, frame_chunk);
}

}  // namespace scree::vtkhdf
