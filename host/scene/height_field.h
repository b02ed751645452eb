#pragma once
// Terrain from grids of heights: tables, pictures, and the mesh of the solid below.

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "shapes/shape.h"

namespace scree {

/// Heights at the corners of the cells of a rectangle.
struct HeightGrid {
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::vector<double>
      heights;  ///< [rows * columns] row by row along x, the row of largest y first [m]

  /// The height at a column along x and a row along y, both counted from the lower end.
  double at(std::size_t column, std::size_t row) const {
    return heights[(rows - 1 - row) * columns + column];
  }
};

/// Heights of one grid; their mesh has twice as many triangles.
inline constexpr std::size_t kMostHeights = 4'000'000;

/// Reads rows of numbers with commas between them; spaces around numbers, empty lines and lines that start with # are
/// skipped. Heights are offset + scale * number.
/// @throws InputError naming the file: missing, unreadable, a value that is not a finite number, rows that differ in
///         length, fewer than 2 x 2 values or more than kMostHeights
HeightGrid read_height_table(const std::filesystem::path& file, double scale, double offset);

/// Reads a gray PNG of 8 or 16 bits: black is low, white is high, and the top of the picture is the row of largest y.
/// @throws InputError naming the file: what read_gray_png() refuses, fewer than 2 x 2 pixels
HeightGrid read_height_picture(const std::filesystem::path& file, double low, double high);

/// The closed surface of the solid below the heights: two triangles a cell, along its shorter diagonal, sides, and a
/// base below the lowest height. The rectangle is centered at the origin; heights are along z.
/// @param extent     edge lengths along x and y [m]
/// @param thickness  from the lowest height to the base [m]
/// @throws std::invalid_argument for points too far out and for cells too steep to have triangles
TriangleMesh height_field_mesh(const std::string& name, const HeightGrid& grid,
                               const std::array<double, 2>& extent, double thickness);

}  // namespace scree
