#include "collision/hull_tables.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

namespace scree {
namespace {

using Edge = std::pair<Index, Index>;

/// By so much of the size of a hull a point may be off a plane that it is said to lie in.
constexpr double kFlat = 1e-8;

class HullBuilder {
 public:
  HullBuilder(const MeshSource& mesh, const std::string& name)
      : mesh_(mesh), name_(name), group_(mesh.triangles.size()) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) triangle_of_[edge(t, k)] = t;
    for (const Vec3d& x : mesh.vertices) size_ = std::max(size_, norm(x));
    std::iota(group_.begin(), group_.end(), std::size_t{0});
    join_flat();
  }

  void add_to(HullTables& out) const {
    HullInfo info;
    info.point = static_cast<std::uint32_t>(out.points.size());
    info.face = static_cast<std::uint32_t>(out.faces.size());
    const std::vector<std::vector<Index>> loops = boundaries();
    if (loops.size() < 4) throw std::runtime_error(name_ + " has fewer than four faces");
    std::map<Index, std::uint32_t> number;  // of the vertices that are corners
    for (const std::vector<Index>& loop : loops)
      for (const Index v : loop) number.emplace(v, 0);
    double half_x = 0;
    for (auto& [vertex, own] : number) {
      own = static_cast<std::uint32_t>(out.points.size()) - info.point;
      out.points.push_back(point(vertex));
      half_x = std::max(half_x, std::abs(point(vertex).x));
    }
    std::vector<std::vector<FaceAtPoint>> faces_at(number.size());
    for (const std::vector<Index>& loop : loops) {
      HullFace face = plane_of(loop);
      face.corner = static_cast<std::uint32_t>(out.corners.size());
      for (std::size_t k = 0; k < loop.size(); ++k) {
        const Index v = loop[k], next = loop[(k + 1) % loop.size()];
        out.corners.push_back(number.at(v));
        faces_at[number.at(v)].push_back({face.normal, normalized(point(next) - point(v)),
                                          static_cast<std::uint32_t>(out.faces.size()) - info.face,
                                          number.at(next)});
      }
      out.faces.push_back(face);
    }
    for (const std::vector<FaceAtPoint>& faces : faces_at) {
      out.first_face.push_back(static_cast<std::uint32_t>(out.face_at.size()));
      out.face_at.insert(out.face_at.end(), faces.begin(), faces.end());
    }
    out.first_face.push_back(static_cast<std::uint32_t>(out.face_at.size()));
    info.point_count = static_cast<std::uint32_t>(number.size());
    info.face_count = static_cast<std::uint32_t>(loops.size());
    info.inverse_half_x = 1 / half_x;
    out.hulls.push_back(info);
  }

 private:
  Vec3d point(Index v) const { return mesh_.vertices[static_cast<std::size_t>(v)]; }
  Edge edge(std::size_t t, std::size_t k) const {
    return {mesh_.triangles[t][k], mesh_.triangles[t][(k + 1) % 3]};
  }
  std::size_t twin_of(const Edge& e) const {
    const auto found = triangle_of_.find({e.second, e.first});
    if (found == triangle_of_.end()) throw std::runtime_error(name_ + " is not closed");
    return found->second;
  }
  std::size_t group_of(std::size_t t) const {
    while (group_[t] != t) t = group_[t];
    return t;
  }
  Vec3d normal(std::size_t t) const {
    const Vec3d a = point(mesh_.triangles[t][0]);
    return cross(point(mesh_.triangles[t][1]) - a, point(mesh_.triangles[t][2]) - a);
  }
  bool is_in_plane(std::size_t t, std::size_t other) const {
    const Vec3d n = normal(t);
    return std::all_of(mesh_.triangles[other].begin(), mesh_.triangles[other].end(), [&](Index v) {
      return std::abs(dot(point(v) - point(mesh_.triangles[t][0]), n)) <= kFlat * size_ * norm(n);
    });
  }
  void join_flat() {
    for (std::size_t t = 0; t < group_.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t other = twin_of(edge(t, k));
        // The larger of the two knows its plane better.
        const bool is_flat = norm2(normal(t)) >= norm2(normal(other)) ? is_in_plane(t, other)
                                                                      : is_in_plane(other, t);
        const std::size_t a = group_of(t), b = group_of(other);
        if (is_flat && a != b) group_[std::max(a, b)] = std::min(a, b);
      }
    }
  }

  /// Corners around each face, faces by their first triangle.
  std::vector<std::vector<Index>> boundaries() const {
    std::map<std::size_t, std::map<Index, Index>> next;
    for (std::size_t t = 0; t < group_.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        if (group_of(t) != group_of(twin_of(edge(t, k))))
          next[group_of(t)][edge(t, k).first] = edge(t, k).second;
    std::vector<std::vector<Index>> loops;
    for (const auto& [group, follows] : next) {
      std::vector<Index> loop{follows.begin()->first};
      while (loop.size() < follows.size()) loop.push_back(follows.at(loop.back()));
      loops.push_back(std::move(loop));
    }
    return loops;
  }

  HullFace plane_of(const std::vector<Index>& loop) const {
    HullFace face;
    Vec3d sum;
    for (std::size_t k = 1; k + 1 < loop.size(); ++k)
      sum += cross(point(loop[k]) - point(loop[0]), point(loop[k + 1]) - point(loop[0]));
    face.normal = normalized(sum);
    face.count = static_cast<std::uint32_t>(loop.size());
    face.height = dot(face.normal, point(loop[0]));
    for (const Index v : loop) face.height = std::max(face.height, dot(face.normal, point(v)));
    return face;
  }

  const MeshSource& mesh_;
  std::string name_;
  std::map<Edge, std::size_t> triangle_of_;
  double size_ = 0;
  std::vector<std::size_t> group_;
};

}  // namespace

HullTables build_hull_tables(const std::vector<MeshSource>& meshes) {
  HullTables tables;
  for (std::size_t m = 0; m < meshes.size(); ++m)
    HullBuilder(meshes[m], "hull " + std::to_string(m)).add_to(tables);
  return tables;
}

}  // namespace scree
