#pragma once
// Reads parts of the arrays of a VTKHDF file, as its frames use them.

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "host/io/h5.h"

namespace scree::test {

/// `count` rows of an array, from row `first` on.
template <class T>
std::vector<T> rows(const h5::Group& vtk, const std::string& name, std::int64_t first,
                    std::int64_t count) {
  std::vector<T> out(static_cast<std::size_t>(count) * vtk.shape(name).values_per_row());
  vtk.read(name, std::span<T>(out), static_cast<std::uint64_t>(first));
  return out;
}

/// One number of an array.
inline std::int64_t number(const h5::Group& vtk, const std::string& name, std::int64_t row) {
  return rows<std::int64_t>(vtk, name, row, 1)[0];
}

/// Follows the offsets of the specification (VTKHDF 2.0, PolyData with steps): calls
/// read(vtk, step, part) for every frame.
/// @param cells  the only kind of cells that frames have: Vertices, Lines, Polygons or Strips
template <class Read>
void for_each_frame(const std::filesystem::path& path, const std::string& cells, const Read& read) {
  const h5::File file = h5::File::open(path);
  const h5::Group vtk = file.root().open_group("VTKHDF");
  EXPECT_EQ(vtk.text_attribute("Type"), "PolyData");
  const auto count = vtk.open_group("Steps").attribute<std::int64_t>("NSteps");
  for (std::int64_t step = 0; step < count; ++step) {
    EXPECT_EQ(number(vtk, "Steps/NumberOfParts", step), 1);
    const std::int64_t part = number(vtk, "Steps/PartOffsets", step);
    for (const std::string topology : {"Vertices", "Lines", "Polygons", "Strips"}) {
      if (topology == cells) continue;
      EXPECT_EQ(number(vtk, topology + "/NumberOfCells", part), 0);
      EXPECT_EQ(number(vtk, topology + "/NumberOfConnectivityIds", part), 0);
      EXPECT_EQ(number(vtk, topology + "/Offsets", part), 0);
    }
    read(vtk, step, part);
  }
}

}  // namespace scree::test
