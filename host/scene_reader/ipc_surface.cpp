#include "host/scene_reader/ipc_surface.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <system_error>

namespace scree::ipc {
namespace {

constexpr int kMostFolders = 32;  // around a scene
constexpr double kFlat = 1e-12;   // area over the square of the longest edge

std::array<Vec3d, 3> corners_of(const TriangleMesh& mesh, const std::array<int, 3>& triangle) {
  const auto at = [&](int v) { return mesh.vertices[static_cast<std::size_t>(v)]; };
  return {at(triangle[0]), at(triangle[1]), at(triangle[2])};
}

}  // namespace

std::optional<std::filesystem::path> find_mesh(const std::filesystem::path& scene_folder,
                                               const std::string& name) {
  std::string path = name;
  std::replace(path.begin(), path.end(), '\\', '/');
  std::error_code error;
  const auto is_there = [&](const std::filesystem::path& file) {
    return std::filesystem::is_regular_file(file, error);
  };
  if (is_there(scene_folder / path)) return scene_folder / path;
  std::filesystem::path folder = std::filesystem::absolute(scene_folder, error).lexically_normal();
  for (int k = 0; k < kMostFolders; ++k) {
    if (is_there(folder / "meshes" / path)) return folder / "meshes" / path;
    if (folder == folder.parent_path()) break;
    folder = folder.parent_path();
  }
  return std::nullopt;
}

Box box_of(const std::vector<Vec3d>& vertices) {
  Box box{vertices.at(0), vertices.at(0)};
  for (const Vec3d& v : vertices)
    for (int k = 0; k < 3; ++k) {
      box.low[k] = std::min(box.low[k], v[k]);
      box.high[k] = std::max(box.high[k], v[k]);
    }
  return box;
}

int drop_flat_triangles(TriangleMesh& mesh) {
  const auto is_flat = [&](const std::array<int, 3>& triangle) {
    const auto [a, b, c] = corners_of(mesh, triangle);
    const double longest2 = std::max({norm2(b - a), norm2(c - b), norm2(a - c)});
    return !(norm(cross(b - a, c - a)) > kFlat * longest2);
  };
  const std::size_t before = mesh.triangles.size();
  std::erase_if(mesh.triangles, is_flat);
  return static_cast<int>(before - mesh.triangles.size());
}

std::vector<TriangleMesh> components(const TriangleMesh& mesh) {
  std::vector<int> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int v) {
    while (parent[static_cast<std::size_t>(v)] != v) {
      int& up = parent[static_cast<std::size_t>(v)];
      up = parent[static_cast<std::size_t>(up)];
      v = up;
    }
    return v;
  };
  for (const auto& triangle : mesh.triangles)
    for (const int v : triangle) {
      const int a = root(v), b = root(triangle[0]);
      parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  std::vector<bool> is_used(mesh.vertices.size(), false);
  for (const auto& triangle : mesh.triangles)
    for (const int v : triangle) is_used[static_cast<std::size_t>(v)] = true;
  std::vector<TriangleMesh> parts;
  std::vector<int> part_of(mesh.vertices.size(), -1), number(mesh.vertices.size(), -1);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (!is_used[v]) continue;
    int& part = part_of[static_cast<std::size_t>(root(static_cast<int>(v)))];
    if (part < 0) {
      part = static_cast<int>(parts.size());
      parts.emplace_back().name = mesh.name;
    }
    auto& vertices = parts[static_cast<std::size_t>(part)].vertices;
    number[v] = static_cast<int>(vertices.size());
    vertices.push_back(mesh.vertices[v]);
  }
  for (const auto& triangle : mesh.triangles) {
    std::array<int, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) corners[k] = number[static_cast<std::size_t>(triangle[k])];
    const int part = part_of[static_cast<std::size_t>(root(triangle[0]))];
    parts[static_cast<std::size_t>(part)].triangles.push_back(corners);
  }
  return parts;
}

Vec3d center_of_surface(const TriangleMesh& mesh) {
  const Vec3d origin = mesh.vertices.at(0);
  double whole = 0;
  Vec3d sum;
  for (const auto& triangle : mesh.triangles) {
    const std::array<Vec3d, 3> x = corners_of(mesh, triangle);
    const double area = norm(cross(x[1] - x[0], x[2] - x[0])) / 2;
    if (!(area > 0)) continue;
    std::array<double, 3> cosine{}, share{};  // dot of the edges at a corner
    for (std::size_t k = 0; k < 3; ++k)
      cosine[k] = dot(x[(k + 1) % 3] - x[k], x[(k + 2) % 3] - x[k]);
    const auto obtuse = std::find_if(cosine.begin(), cosine.end(), [](double c) { return c < 0; });
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
      if (obtuse != cosine.end())
        share[k] = (&cosine[k] == &*obtuse ? 0.5 : 0.25) * area;
      else  // cot = dot over twice the area; each edge counts with the angle across
        share[k] = (norm2(x[i] - x[k]) * cosine[j] + norm2(x[j] - x[k]) * cosine[i]) / (16 * area);
      sum += share[k] * (x[k] - origin);
      whole += share[k];
    }
  }
  return whole > 0 ? origin + (1 / whole) * sum : origin;
}

}  // namespace scree::ipc
