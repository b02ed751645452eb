// Grids of heights from tables and pictures, and the solid below them.

#include "host/scene/height_field.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "host/scene/mesh_reader.h"
#include "tests/host/gray_png.h"
#include "tests/host/input_files.h"
#include "tests/mesh_volume.h"

namespace scree {
namespace {

using test::refusal;
using test::volume;
using test::write_file;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

HeightGrid random_grid(std::size_t rows, std::size_t columns, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> height(-1, 2);
  HeightGrid grid{rows, columns, {}};
  for (std::size_t k = 0; k < rows * columns; ++k) grid.heights.push_back(height(random));
  return grid;
}

/// Of all triangles, one after the other.
std::vector<Vec3d> corner_list(const TriangleMesh& mesh) {
  std::vector<Vec3d> all;
  for (const auto& triangle : mesh.triangles)
    for (const int v : triangle) all.push_back(mesh.vertices.at(static_cast<std::size_t>(v)));
  return all;
}

std::string obj_text(const TriangleMesh& mesh) {
  std::string text;
  for (const Vec3d& v : mesh.vertices) text += fmt::format("v {} {} {}\n", v.x, v.y, v.z);
  for (const auto& t : mesh.triangles)
    text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return text;
}

// The reader of mesh files refuses open edges, edges of three triangles, neighbors of opposite
// orientation and triangles without area.
TEST(HeightFieldMesh, IsClosedForEveryNumberOfCells) {
  for (const std::size_t rows : {2u, 3u, 4u, 9u})
    for (const std::size_t columns : {2u, 3u, 5u, 8u}) {
      SCOPED_TRACE(fmt::format("{} x {}", rows, columns));
      const HeightGrid grid = random_grid(rows, columns, 7);
      const TriangleMesh mesh = height_field_mesh("heights", grid, {3, 0.7}, 0.4);
      EXPECT_TRUE(mesh.closed);
      const TriangleMesh read = read_mesh(write_file("field.obj", obj_text(mesh)));
      EXPECT_EQ(read.vertices.size(), mesh.vertices.size());
      EXPECT_EQ(corner_list(read), corner_list(mesh)) << "it was inside out";
    }
}

// Under flat triangles the volume is the area of each times the mean height of its corners. Of the
// two ways to cut a cell, that along its shorter diagonal is taken.
TEST(HeightFieldMesh, HasTheVolumeBelowTheHeights) {
  for (const auto& [rows, columns] : {std::pair{2u, 2u}, {3u, 6u}, {8u, 5u}}) {
    const HeightGrid grid = random_grid(rows, columns, 3);
    const double lx = 1.5, ly = 2.5, thickness = 0.3;
    const double lowest = *std::min_element(grid.heights.begin(), grid.heights.end());
    const double cell = lx / (columns - 1) * ly / (rows - 1);
    double expected = 0;
    for (std::size_t j = 0; j + 1 < rows; ++j)
      for (std::size_t i = 0; i + 1 < columns; ++i) {
        const double a = grid.at(i, j), b = grid.at(i + 1, j), c = grid.at(i + 1, j + 1),
                     d = grid.at(i, j + 1);
        const bool along_ac = std::abs(a - c) <= std::abs(b - d);
        const double twice = along_ac ? a + c : b + d;  // corners that both triangles have
        expected += cell / 6 * (a + b + c + d + twice);
      }
    expected -= (lowest - thickness) * lx * ly;
    EXPECT_NEAR(volume(height_field_mesh("heights", grid, {lx, ly}, thickness)), expected,
                1e-12 * expected);
  }
}

TEST(HeightFieldMesh, IsCenteredAndHasTheFirstRowAtTheLargestY) {
  const HeightGrid grid{2, 3, {10, 11, 12, 20, 21, 22}};
  const TriangleMesh mesh = height_field_mesh("heights", grid, {4, 2}, 5);
  const auto height_at = [&](double x, double y) {
    double highest = -INFINITY;
    for (const Vec3d& v : mesh.vertices)
      if (v.x == x && v.y == y) highest = std::max(highest, v.z);
    return highest;
  };
  EXPECT_EQ(height_at(-2, 1), 10);
  EXPECT_EQ(height_at(0, 1), 11);
  EXPECT_EQ(height_at(2, 1), 12);
  EXPECT_EQ(height_at(-2, -1), 20);
  EXPECT_EQ(height_at(0, -1), 21);
  EXPECT_EQ(height_at(2, -1), 22);
  double lowest = INFINITY;
  for (const Vec3d& v : mesh.vertices) lowest = std::min(lowest, v.z);
  EXPECT_EQ(lowest, 10 - 5);
}

TEST(HeightFieldMesh, WhatHasNoTrianglesIsNamed) {
  const auto fault = [](const HeightGrid& grid, const std::array<double, 2>& extent) {
    try {
      height_field_mesh("heights", grid, extent, 1);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_EQ(fault({3, 3, {0, 0, 0, 0, 0, 0, 0, 0, 1e14}}, {1, 1}),
            "the cell between rows 2 and 3 and columns 2 and 3 is too steep or too narrow for "
            "triangles");
  EXPECT_EQ(fault({2, 2, {0, 0, 0, 0}}, {1e14, 1e-3}),
            "the cell between rows 1 and 2 and columns 1 and 2 is too steep or too narrow for "
            "triangles");
  EXPECT_THAT(fault({2, 2, {0, 0, 0, 1e300}}, {1, 1}), HasSubstr("too far out"));
}

TEST(HeightTable, IsReadRowByRow) {
  const auto file = write_file("a.csv", "# heights in mm\n1, 2.5 ,-3e1\r\n\n+4,5,6\n");
  const HeightGrid grid = read_height_table(file, 0.5, 100);
  EXPECT_EQ(grid.rows, 2u);
  EXPECT_EQ(grid.columns, 3u);
  EXPECT_THAT(grid.heights, ElementsAre(100.5, 101.25, 85, 102, 102.5, 103));
}

TEST(HeightTable, WhatIsWrongIsNamed) {
  const auto refused = [](const std::string& text) {
    const auto file = write_file("a.csv", text);
    const std::string message = refusal([&] { read_height_table(file, 1, 0); });
    EXPECT_THAT(message, StartsWith(file.string() + ": "));
    return message;
  };
  EXPECT_THAT(refused("1,2,3\n4,5\n"), EndsWith(": line 2: 2 values, but the rows before have 3"));
  EXPECT_THAT(refused("1,2\n3,x\n"),
              EndsWith(": line 2, column 2: \"x\" is not allowed: must be a finite number"));
  EXPECT_THAT(refused("1,nan\n3,4\n"),
              EndsWith(": line 1, column 2: \"nan\" is not allowed: must be a finite number"));
  EXPECT_THAT(refused("1,2\n3,\n"),
              EndsWith(": line 2, column 2: \"\" is not allowed: must be a finite number"));
  EXPECT_THAT(refused("1,2,3\n"), EndsWith(": 1 x 3 heights, must be 2 x 2 or more"));
  EXPECT_THAT(refused("1\n2\n"), EndsWith(": 2 x 1 heights, must be 2 x 2 or more"));
  EXPECT_THAT(refused(""), EndsWith(": 0 x 0 heights, must be 2 x 2 or more"));
  std::string row = "0";
  for (int k = 1; k < 3000; ++k) row += ",0";
  std::string rows;
  for (int k = 0; k < 1400; ++k) rows += row + "\n";
  EXPECT_THAT(refused(rows), EndsWith(": line 1334: more than 4000000 heights"));
  EXPECT_THAT(refusal([] { read_height_table("/no/such.csv", 1, 0); }),
              EndsWith("such.csv: no such file"));
}

TEST(HeightPicture, GoesFromBlackToWhite) {
  const auto eight = write_file("8.png", test::png_bytes(3, 2, {0, 51, 102, 153, 204, 255}));
  EXPECT_THAT(read_height_picture(eight, -1, 4).heights, ElementsAre(-1, 0, 1, 2, 3, 4));
  const auto sixteen = write_file(
      "16.png", test::png_bytes(3, 2, {0, 13107, 26214, 39321, 52428, 65535}, {.depth = 16}));
  EXPECT_THAT(read_height_picture(sixteen, -1, 4).heights, ElementsAre(-1, 0, 1, 2, 3, 4));
}

TEST(HeightPicture, WhatIsWrongIsNamed) {
  const auto refused = [](const std::string& bytes) {
    const auto file = write_file("a.png", bytes);
    const std::string message = refusal([&] { read_height_picture(file, 0, 1); });
    EXPECT_THAT(message, StartsWith(file.string() + ": "));
    return message;
  };
  const std::string good = test::png_bytes(2, 2, {1, 2, 3, 4});
  EXPECT_THAT(refused("1,2\n3,4\n"), HasSubstr("no PNG picture that can be read: Not a PNG"));
  EXPECT_THAT(refused(""), HasSubstr("no PNG picture that can be read"));
  for (std::size_t length = 1; length < good.size(); ++length)
    EXPECT_THAT(refused(good.substr(0, length)), HasSubstr("no PNG picture that can be read"));
  std::string damaged = good;
  damaged[50] = static_cast<char>(damaged[50] ^ 1);
  EXPECT_THAT(refused(damaged), HasSubstr("no PNG picture that can be read"));
  EXPECT_THAT(refused(test::png_bytes(2, 2, std::vector<int>(12, 7), {.color_type = 2})),
              EndsWith("the picture is in color of 8 bits, must be gray of 8 or 16 bits without "
                       "alpha"));
  EXPECT_THAT(refused(test::png_bytes(2, 2, std::vector<int>(8, 7), {16, 4})),
              HasSubstr("gray with alpha of 16 bits"));
  EXPECT_THAT(refused(test::png_bytes(2, 2, {0, 0}, {.depth = 4})), HasSubstr("gray of 4 bits"));
  EXPECT_THAT(refused(test::png_bytes(1, 2, {0, 0})),
              EndsWith(": 1 x 2 pixels, must be 2 x 2 or more"));
  EXPECT_THAT(refused(test::png_bytes(100000, 100000, {})),
              EndsWith(": 100000 x 100000 pixels, must be 4000000 at most"));
  EXPECT_THAT(refusal([] { read_height_picture("/no/such.png", 0, 1); }),
              EndsWith("such.png: no such file"));
}

}  // namespace
}  // namespace scree
