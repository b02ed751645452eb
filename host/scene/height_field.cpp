#include "host/scene/height_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <stdexcept>

#include "host/error.h"
#include "host/io/csv.h"
#include "host/io/png_file.h"
#include "kernels/bodies/range.h"

namespace scree {
namespace {

constexpr double kFlatCell = 1e-10;  // height over longest edge, as in mesh files

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& text) {
  throw InputError(file.string() + ": " + text);
}

/// Builds the surface. Corners of triangles are counter-clockwise seen from outside.
class Terrain {
 public:
  Terrain(const HeightGrid& grid, const std::array<double, 2>& extent, double thickness)
      : grid_(grid), extent_(extent) {
    base_ = *std::min_element(grid.heights.begin(), grid.heights.end()) - thickness;
  }

  void build(TriangleMesh& mesh) {
    mesh_ = &mesh;
    add_top();
    add_sides();
    add_base();
  }

 private:
  using Triangle = std::array<int, 3>;

  /// Of the points of a grid of n, the k-th along an edge: points at equal distances from the
  /// middle have the same number with the other sign.
  double place(std::size_t k, std::size_t n, double edge) const {
    const double steps = static_cast<double>(n - 1);
    return edge * ((2 * static_cast<double>(k) - steps) / (2 * steps));
  }
  int add(const Vec3d& v) {
    mesh_->vertices.push_back(v);
    return static_cast<int>(mesh_->vertices.size()) - 1;
  }
  const Vec3d& point(int v) const { return mesh_->vertices[static_cast<std::size_t>(v)]; }

  void add_top() {
    const std::size_t nx = grid_.columns, ny = grid_.rows;
    for (std::size_t j = 0; j < ny; ++j)
      for (std::size_t i = 0; i < nx; ++i)
        add({place(i, nx, extent_[0]), place(j, ny, extent_[1]), grid_.at(i, j)});
    for (std::size_t j = 0; j + 1 < ny; ++j)
      for (std::size_t i = 0; i + 1 < nx; ++i) {
        const int a = top(i, j), b = top(i + 1, j), c = top(i + 1, j + 1), d = top(i, j + 1);
        if (std::abs(point(c).z - point(a).z) <= std::abs(point(d).z - point(b).z)) {
          mesh_->triangles.push_back({a, b, c});
          mesh_->triangles.push_back({a, c, d});
        } else {
          mesh_->triangles.push_back({a, b, d});
          mesh_->triangles.push_back({b, c, d});
        }
      }
  }
  int top(std::size_t i, std::size_t j) const { return static_cast<int>(j * grid_.columns + i); }

  /// Goes around the rim, counter-clockwise seen from above.
  void add_sides() {
    const std::size_t nx = grid_.columns, ny = grid_.rows;
    std::vector<int> rim;
    for (std::size_t i = 0; i + 1 < nx; ++i) rim.push_back(top(i, 0));
    for (std::size_t j = 0; j + 1 < ny; ++j) rim.push_back(top(nx - 1, j));
    for (std::size_t i = nx - 1; i > 0; --i) rim.push_back(top(i, ny - 1));
    for (std::size_t j = ny - 1; j > 0; --j) rim.push_back(top(0, j));
    rim_count_ = rim.size();
    first_low_ = static_cast<int>(mesh_->vertices.size());
    for (const int v : rim) add({point(v).x, point(v).y, base_});
    for (std::size_t k = 0; k < rim.size(); ++k) {
      const std::size_t next = (k + 1) % rim.size();
      mesh_->triangles.push_back({low(k), low(next), rim[next]});
      mesh_->triangles.push_back({low(k), rim[next], rim[k]});
    }
  }
  int low(std::size_t k) const { return first_low_ + static_cast<int>(k % rim_count_); }

  /// Two triangles, and a narrow frame about them with the points of the rim: few triangles, and
  /// none of them long and across the terrain.
  void add_base() {
    const std::size_t nx = grid_.columns, ny = grid_.rows;
    const double frame = 0.25 * std::min(extent_[0] / static_cast<double>(nx - 1),
                                         extent_[1] / static_cast<double>(ny - 1));
    const double x = 0.5 * extent_[0] - frame, y = 0.5 * extent_[1] - frame;
    const std::array<int, 4> inner{add({-x, -y, base_}), add({x, -y, base_}), add({x, y, base_}),
                                   add({-x, y, base_})};
    std::size_t start = 0;
    for (std::size_t side = 0; side < 4; ++side) {
      const std::size_t count = (side % 2 == 0 ? nx : ny) - 1;
      const int a = inner[side], b = inner[(side + 1) % 4];
      for (std::size_t k = 0; k < count; ++k)
        mesh_->triangles.push_back({low(start + k + 1), low(start + k), k < count / 2 ? a : b});
      mesh_->triangles.push_back({low(start + count / 2), a, b});
      start += count;
    }
    mesh_->triangles.push_back({inner[0], inner[3], inner[2]});
    mesh_->triangles.push_back({inner[0], inner[2], inner[1]});
  }

  const HeightGrid& grid_;
  std::array<double, 2> extent_;
  double base_ = 0;
  TriangleMesh* mesh_ = nullptr;
  int first_low_ = 0;
  std::size_t rim_count_ = 0;
};

void check_triangles(const TriangleMesh& mesh, const HeightGrid& grid) {
  const std::size_t cells = (grid.rows - 1) * (grid.columns - 1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto corner = [&](std::size_t k) {
      return mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][k])];
    };
    const Vec3d a = corner(0), b = corner(1), c = corner(2);
    const double longest2 = std::max({norm2(b - a), norm2(c - b), norm2(a - c)});
    if (norm(cross(b - a, c - a)) > kFlatCell * longest2) continue;
    const std::size_t cell = t / 2;
    if (cell >= cells)
      throw std::invalid_argument(
          "the sides or the base have triangles without area: extent, heights and thickness "
          "differ too much");
    const std::size_t row = grid.rows - 1 - cell / (grid.columns - 1);  // counted from 1
    throw std::invalid_argument(
        fmt::format("the cell between rows {} and {} and columns {} and {} is too steep or too "
                    "narrow for triangles",
                    row, row + 1, cell % (grid.columns - 1) + 1, cell % (grid.columns - 1) + 2));
  }
}

}  // namespace

HeightGrid read_height_table(const std::filesystem::path& file, double scale, double offset) {
  CsvLines csv(file, kMostHeights);
  HeightGrid grid;
  while (csv.next()) {
    const std::size_t count = csv.cells().size();
    if (grid.rows == 0) grid.columns = count;
    if (count != grid.columns)
      csv.fail(fmt::format("{} values, but the rows before have {}", count, grid.columns));
    if (grid.heights.size() + count > kMostHeights)
      csv.fail(fmt::format("more than {} heights", kMostHeights));
    for (std::size_t k = 0; k < count; ++k) {
      const std::optional<double> value = csv.number(k);
      if (!value) csv.refuse(k, fmt::format("column {}", k + 1), "must be a finite number");
      grid.heights.push_back(offset + scale * *value);
    }
    ++grid.rows;
  }
  if (grid.rows < 2 || grid.columns < 2)
    fail(file, fmt::format("{} x {} heights, must be 2 x 2 or more", grid.rows, grid.columns));
  return grid;
}

HeightGrid read_height_picture(const std::filesystem::path& file, double low, double high) {
  const GrayImage image = read_gray_png(file, kMostHeights);
  if (image.width < 2 || image.height < 2)
    fail(file, fmt::format("{} x {} pixels, must be 2 x 2 or more", image.width, image.height));
  HeightGrid grid{image.height, image.width, {}};
  grid.heights.reserve(image.values.size());
  for (const std::uint16_t value : image.values)
    grid.heights.push_back(low + (high - low) * (static_cast<double>(value) / image.white));
  return grid;
}

TriangleMesh height_field_mesh(const std::string& name, const HeightGrid& grid,
                               const std::array<double, 2>& extent, double thickness) {
  TriangleMesh mesh;
  mesh.name = name;
  Terrain(grid, extent, thickness).build(mesh);
  for (const Vec3d& v : mesh.vertices)
    if (!is_in_range(v))
      throw std::invalid_argument(
          fmt::format("a point at ({}, {}, {}) m is too far out, must be within {:g} m", v.x, v.y,
                      v.z, kFarthest));
  check_triangles(mesh, grid);
  return mesh;
}

}  // namespace scree
