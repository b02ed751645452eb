#include "host/scene/mesh_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "host/error.h"
#include "host/io/printable.h"
#include "host/scene/mesh_crossings.h"
#include "host/scene/mesh_shells.h"
#include "host/scene/mesh_text.h"
#include "host/scene/tetrahedra_reader.h"
#include "kernels/bodies/range.h"

namespace scree {
namespace {

using mesh_text::fail;
using mesh_text::Lines;
using mesh_text::parsed;
using mesh_text::parsed_vector;
using mesh_text::read_bytes;

constexpr double kWeldTolerance = 1e-9;         // of the bounding box's diagonal
constexpr double kDegenerateTolerance = 1e-10;  // height over longest edge

std::string text(const Vec3d& v) { return fmt::format("({}, {}, {})", v.x, v.y, v.z); }

/// Adds a corner to a list of separate triangles; welding makes the mesh of it.
void add_corner(TriangleMesh& mesh, const Vec3d& v) {
  mesh.vertices.push_back(v);
  if (mesh.vertices.size() % 3 == 0) {
    const int last = static_cast<int>(mesh.vertices.size()) - 1;
    mesh.triangles.push_back({last - 2, last - 1, last});
  }
}

void read_binary_stl(const std::string& bytes, TriangleMesh& mesh) {
  constexpr std::size_t header = 84;
  constexpr std::size_t record = 50;
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof(count));
  const std::size_t needed = header + record * static_cast<std::size_t>(count);
  if (bytes.size() < needed)
    fail(mesh.name, fmt::format("truncated: {} triangles need {} bytes, the file has {}", count,
                                needed, bytes.size()));
  for (std::uint32_t t = 0; t < count; ++t) {
    float corners[9];
    std::memcpy(corners, bytes.data() + header + record * t + 12, sizeof(corners));
    for (int c = 0; c < 3; ++c) {
      const Vec3d v{corners[3 * c], corners[3 * c + 1], corners[3 * c + 2]};
      if (!is_finite(v)) fail(mesh.name, fmt::format("triangle {}: a coordinate is not finite", t));
      add_corner(mesh, v);
    }
  }
}

void read_ascii_stl(const std::string& bytes, TriangleMesh& mesh) {
  Lines lines(bytes);
  std::size_t corners = 0;  // of the open facet
  bool ended = false;
  while (lines.next()) {
    if (lines.words.empty()) continue;
    const std::string_view word = lines.words[0];
    if (word == "vertex") {
      add_corner(mesh, parsed_vector(mesh.name, lines, 1));
      ++corners;
    } else if (word == "endloop") {
      if (corners != 3)
        fail(mesh.name,
             fmt::format("line {}: a facet has {} vertices, must be 3", lines.number, corners));
      corners = 0;
    }
    ended = word == "endsolid";
  }
  if (!ended || corners != 0)
    fail(mesh.name, fmt::format("truncated: no \"endsolid\" at the end (line {})", lines.number));
}

void read_stl(const std::string& bytes, TriangleMesh& mesh) {
  // Binary files may start with "solid" too: what decides is whether the size fits the count.
  if (bytes.size() >= 84) {
    std::uint32_t count = 0;
    std::memcpy(&count, bytes.data() + 80, sizeof(count));
    if (bytes.size() == 84 + 50 * static_cast<std::size_t>(count)) {
      read_binary_stl(bytes, mesh);
      return;
    }
  }
  if (bytes.compare(0, 5, "solid") == 0) {
    read_ascii_stl(bytes, mesh);
  } else if (bytes.size() < 84) {
    fail(mesh.name, fmt::format("truncated: {} bytes are too few for an STL file", bytes.size()));
  } else {
    read_binary_stl(bytes, mesh);
  }
}

/// A face of some corners as triangles.
void add_polygon(TriangleMesh& mesh, const std::vector<int>& corners) {
  for (std::size_t i = 2; i < corners.size(); ++i)
    mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
}

void read_obj(const std::string& bytes, TriangleMesh& mesh) {
  Lines lines(bytes);
  while (lines.next()) {
    if (lines.words.empty()) continue;
    if (lines.words[0] == "v") {
      mesh.vertices.push_back(parsed_vector(mesh.name, lines, 1));
    } else if (lines.words[0] == "f") {
      const std::size_t count = lines.words.size() - 1;
      if (count < 3)
        fail(mesh.name, fmt::format("line {}: a face needs three vertices or more", lines.number));
      std::vector<int> polygon;
      for (std::size_t i = 1; i <= count; ++i) {
        const std::string_view word = lines.words[i];  // v, v/vt, v//vn or v/vt/vn
        const long long index = parsed<long long>(mesh.name, lines, word.substr(0, word.find('/')));
        const auto size = static_cast<long long>(mesh.vertices.size());
        const long long v = index < 0 ? size + index : index - 1;  // negative: counted from the end
        if (v < 0 || v >= size)
          fail(mesh.name, fmt::format("line {}: vertex {} is out of range, {} vertices so far",
                                      lines.number, index, size));
        polygon.push_back(static_cast<int>(v));
      }
      add_polygon(mesh, polygon);
    }
  }
}

void read_off(const std::string& bytes, TriangleMesh& mesh) {
  Lines lines(bytes);
  const auto require = [&](const char* what) { lines.require(mesh.name, what); };
  require("\"OFF\"");
  // OFF, COFF, NOFF...: what is beside positions and corners stands after them. Counts may follow in the same line.
  if (lines.words[0].size() < 3 || !lines.words[0].ends_with("OFF"))
    fail(mesh.name, fmt::format("line {}: \"{}\" is not \"OFF\"", lines.number,
                                printable(lines.words[0], 40)));
  lines.words.erase(lines.words.begin());
  if (lines.words.empty()) require("numbers of vertices and faces");
  if (lines.words.size() < 2)
    fail(mesh.name, fmt::format("line {}: numbers of vertices and faces expected", lines.number));
  const auto vertices = parsed<long long>(mesh.name, lines, lines.words[0]);
  const auto faces = parsed<long long>(mesh.name, lines, lines.words[1]);
  for (long long v = 0; v < vertices; ++v) {
    require("a vertex");
    mesh.vertices.push_back(parsed_vector(mesh.name, lines, 0));
  }
  for (long long f = 0; f < faces; ++f) {
    require("a face");
    const auto count = parsed<long long>(mesh.name, lines, lines.words[0]);
    if (count < 3 || static_cast<long long>(lines.words.size()) < 1 + count)
      fail(mesh.name, fmt::format("line {}: a face needs three vertices or more", lines.number));
    std::vector<int> polygon;
    for (long long i = 1; i <= count; ++i) {
      const auto v = parsed<long long>(mesh.name, lines, lines.words[static_cast<std::size_t>(i)]);
      if (v < 0 || v >= vertices)
        fail(mesh.name, fmt::format("line {}: vertex {} is out of range, must be below {}",
                                    lines.number, v, vertices));
      polygon.push_back(static_cast<int>(v));
    }
    add_polygon(mesh, polygon);
  }
}

/// Makes one vertex of those nearer than the tolerance, and drops vertices that no triangle uses.
void weld(TriangleMesh& mesh) {
  const auto at = [&](int v) -> const Vec3d& { return mesh.vertices[static_cast<std::size_t>(v)]; };
  Vec3d low = at(mesh.triangles[0][0]);
  Vec3d high = low;
  for (const auto& triangle : mesh.triangles)
    for (const int v : triangle)
      for (int k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], at(v)[k]);
        high[k] = std::max(high[k], at(v)[k]);
      }
  const double tolerance = kWeldTolerance * norm(high - low);
  const double cell = std::max(2 * tolerance, 1e-300);
  const auto key = [](std::int64_t x, std::int64_t y, std::int64_t z) {
    return static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15ull ^
           static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4full ^
           static_cast<std::uint64_t>(z) * 0x165667b19e3779f9ull;
  };
  // Cells are wider than the tolerance: a close vertex lies in the same cell or one beside it.
  std::unordered_multimap<std::uint64_t, int> kept;
  std::vector<int> number(mesh.vertices.size(), -1);
  std::vector<Vec3d> vertices;
  const auto welded = [&](int v) {
    const Vec3d offset = at(v) - low;
    std::int64_t c[3];
    for (int k = 0; k < 3; ++k) c[k] = static_cast<std::int64_t>(std::floor(offset[k] / cell));
    for (std::int64_t i = -1; i <= 1; ++i)
      for (std::int64_t j = -1; j <= 1; ++j)
        for (std::int64_t k = -1; k <= 1; ++k) {
          const auto [first, last] = kept.equal_range(key(c[0] + i, c[1] + j, c[2] + k));
          for (auto it = first; it != last; ++it)
            if (norm(vertices[static_cast<std::size_t>(it->second)] - at(v)) <= tolerance)
              return it->second;
        }
    const int n = static_cast<int>(vertices.size());
    vertices.push_back(at(v));
    kept.emplace(key(c[0], c[1], c[2]), n);
    return n;
  };
  for (auto& triangle : mesh.triangles)
    for (int& v : triangle) {
      int& n = number[static_cast<std::size_t>(v)];
      if (n < 0) n = welded(v);
      v = n;
    }
  mesh.vertices = std::move(vertices);
}

void check_triangles(const TriangleMesh& mesh) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [i, j, k] = mesh.triangles[t];
    const Vec3d& a = mesh.vertices[static_cast<std::size_t>(i)];
    const Vec3d& b = mesh.vertices[static_cast<std::size_t>(j)];
    const Vec3d& c = mesh.vertices[static_cast<std::size_t>(k)];
    const double longest2 = std::max({norm2(b - a), norm2(c - b), norm2(a - c)});
    if (!(norm(cross(b - a, c - a)) > kDegenerateTolerance * longest2))
      fail(mesh.name,
           fmt::format("triangle {} is degenerate: its corners {}, {} and {} lie on a line", t,
                       text(a), text(b), text(c)));
  }
}

/// Every edge must be used once in each direction; in a mesh declared open, at most so.
void check_edges(const TriangleMesh& mesh) {
  struct Use {
    int low, high;  // vertices of the edge
    bool forward;   // used from low to high
    std::size_t triangle;
  };
  std::vector<Use> uses;
  uses.reserve(3 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t e = 0; e < 3; ++e) {
      const int a = mesh.triangles[t][e];
      const int b = mesh.triangles[t][(e + 1) % 3];
      uses.push_back({std::min(a, b), std::max(a, b), a < b, t});
    }
  std::sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) {
    return std::array{a.low, a.high} != std::array{b.low, b.high}
               ? std::array{a.low, a.high} < std::array{b.low, b.high}
               : a.triangle < b.triangle;
  });
  const auto name = [&](const Use& use) {
    return fmt::format("edge {} - {}", text(mesh.vertices[static_cast<std::size_t>(use.low)]),
                       text(mesh.vertices[static_cast<std::size_t>(use.high)]));
  };
  for (std::size_t first = 0; first < uses.size();) {
    std::size_t end = first;
    while (end < uses.size() && uses[end].low == uses[first].low &&
           uses[end].high == uses[first].high)
      ++end;
    const std::size_t count = end - first;
    if (count == 1 && mesh.closed)
      fail(mesh.name,
           fmt::format("{} of triangle {} is open: the surface must be closed, or the scene "
                       "must say \"closed\": false",
                       name(uses[first]), uses[first].triangle));
    if (count > 2 && mesh.closed)
      fail(mesh.name,
           fmt::format("{} is shared by {} triangles, must be 2", name(uses[first]), count));
    if (count == 2 && uses[first].forward == uses[first + 1].forward)
      fail(mesh.name,
           fmt::format("triangles {} and {} have opposite orientations at their common {}",
                       uses[first].triangle, uses[first + 1].triangle, name(uses[first])));
    first = end;
  }
}

/// Six times the enclosed volume, positive when the normals point outward.
double volume6(const TriangleMesh& mesh) {
  const Vec3d& origin = mesh.vertices[0];
  double sum = 0;
  for (const auto& [i, j, k] : mesh.triangles)
    sum += dot(mesh.vertices[static_cast<std::size_t>(i)] - origin,
               cross(mesh.vertices[static_cast<std::size_t>(j)] - origin,
                     mesh.vertices[static_cast<std::size_t>(k)] - origin));
  return sum;
}

/// A closed surface is that of a solid.
void check_solid(const TriangleMesh& mesh) {
  constexpr double kFlat = 1e-9;  // of the size of the mesh, where vertices are taken for equal
  Vec3d low = mesh.vertices[0], high = low;
  for (const Vec3d& v : mesh.vertices)
    for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], v[k]), high[k] = std::max(high[k], v[k]);
  double area2 = 0;
  for (const auto& [i, j, k] : mesh.triangles)
    area2 += norm(cross(
        mesh.vertices[static_cast<std::size_t>(j)] - mesh.vertices[static_cast<std::size_t>(i)],
        mesh.vertices[static_cast<std::size_t>(k)] - mesh.vertices[static_cast<std::size_t>(i)]));
  if (!(std::abs(volume6(mesh)) > kFlat * area2 * norm(high - low)))
    fail(mesh.name,
         "encloses no volume: the surface must be that of a solid, or the scene must say "
         "\"closed\": false");
  if (const auto pair = crossing_triangles(mesh))
    fail(mesh.name,
         fmt::format("triangles {} and {} cross each other: a closed surface must not cross "
                     "itself, or the scene must say \"closed\": false",
                     pair->first, pair->second));
  if (const auto shell = wrong_shell(mesh))
    fail(mesh.name,
         fmt::format("the closed part with triangle {} {}, or the scene must say "
                     "\"closed\": false",
                     shell->triangle,
                     shell->is_outward
                         ? "is inside of another one and turned like it, so that what is in it "
                           "would count twice: a cavity must have its triangles the other way round"
                         : "is in no other one and turned inside out, so that what is in it would "
                           "count as less than nothing: parts must be turned alike"));
}

/// Welding squares distances.
void check_range(const TriangleMesh& mesh) {
  for (const std::vector<Vec3d>* points : {&mesh.vertices, &mesh.inner})
    for (const Vec3d& v : *points)
      if (!is_in_range(v))
        fail(mesh.name, fmt::format("a vertex at {} m is too far out, must be within {:g} m",
                                    text(v), kFarthest));
}

/// Lower-case ending of the name of a file.
std::string kind_of(const std::filesystem::path& file) {
  std::string kind = file.extension().string();
  std::transform(kind.begin(), kind.end(), kind.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return kind;
}

}  // namespace

TriangleMesh read_surface(const std::filesystem::path& file) {
  TriangleMesh mesh;
  mesh.name = file.string();
  mesh.closed = false;
  const std::string kind = kind_of(file);
  if (kind != ".stl" && kind != ".obj" && kind != ".off")
    fail(mesh.name, "unknown kind of mesh file: the name must end in .stl, .obj or .off");
  const std::string bytes = read_bytes(file);
  if (kind == ".obj") read_obj(bytes, mesh);
  if (kind == ".off") read_off(bytes, mesh);
  if (kind == ".stl") read_stl(bytes, mesh);
  check_range(mesh);
  if (kind == ".stl" && !mesh.triangles.empty()) weld(mesh);  // its corners have no numbers
  return mesh;
}

bool is_closed(const TriangleMesh& mesh) {
  std::vector<std::array<int, 2>> there, back;
  for (const auto& triangle : mesh.triangles)
    for (std::size_t e = 0; e < 3; ++e) {
      there.push_back({triangle[e], triangle[(e + 1) % 3]});
      back.push_back({triangle[(e + 1) % 3], triangle[e]});
    }
  std::sort(there.begin(), there.end());
  std::sort(back.begin(), back.end());
  return there == back && std::adjacent_find(there.begin(), there.end()) == there.end();
}

TriangleMesh read_mesh(const std::filesystem::path& file, const MeshOptions& options) {
  TriangleMesh mesh;
  mesh.name = file.string();
  const std::string kind = kind_of(file);
  const bool has_tetrahedra = is_tetrahedra_file(kind);
  if (kind != ".stl" && kind != ".obj" && !has_tetrahedra)
    fail(mesh.name, "unknown kind of mesh file: the name must end in .stl, .obj, .msh or .vtk");
  const std::string bytes = read_bytes(file);
  if (kind == ".stl") read_stl(bytes, mesh);
  if (kind == ".obj") read_obj(bytes, mesh);
  if (has_tetrahedra) mesh = read_tetrahedra(bytes, kind, mesh.name);
  mesh.closed = options.closed;
  if (mesh.triangles.empty()) fail(mesh.name, "holds no triangles");
  for (std::vector<Vec3d>* points : {&mesh.vertices, &mesh.inner})
    for (Vec3d& v : *points) v *= options.scale;
  check_range(mesh);
  if (!has_tetrahedra) weld(mesh);
  check_triangles(mesh);
  check_edges(mesh);
  if (!mesh.closed) return mesh;
  check_solid(mesh);
  if (volume6(mesh) < 0)
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

}  // namespace scree
