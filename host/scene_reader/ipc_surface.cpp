#include "host/scene_reader/ipc_surface.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <system_error>

#include "host/disjoint_sets.h"

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
  DisjointSets sets(mesh.vertices.size());
  const auto root = [&](int v) { return sets.root(static_cast<std::size_t>(v)); };
  for (const auto& triangle : mesh.triangles)
    for (const int v : triangle)
      sets.join(static_cast<std::size_t>(v), static_cast<std::size_t>(triangle[0]));
  std::vector<bool> is_used(mesh.vertices.size(), false);
  for (const auto& triangle : mesh.triangles)
    for (const int v : triangle) is_used[static_cast<std::size_t>(v)] = true;
  std::vector<TriangleMesh> parts;
  std::vector<int> part_of(mesh.vertices.size(), -1), number(mesh.vertices.size(), -1);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (!is_used[v]) continue;
    int& part = part_of[sets.root(v)];
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
    const int part = part_of[root(triangle[0])];
    parts[static_cast<std::size_t>(part)].triangles.push_back(corners);
  }
  return parts;
}

}  // namespace scree::ipc
