#include "collision/mesh_topology.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>

#include "collision/mesh_seams.h"

namespace scree {
namespace {

using Vec = Vec3<double>;
constexpr Index kLeafTriangles = 4;
/// Width of edges relative to the size of the mesh: well above rounding, well below
/// anything that matters.
constexpr double kFeatureTolerance = 1e-11;

/// Appends one mesh to a topology.
template <class Real>
class MeshBuilder {
 public:
  MeshBuilder(const MeshSource& source, MeshTopology<Real>& out) : source_(source), out_(out) {}

  void build() {
    check();
    first_vertex_ = static_cast<Index>(out_.points.size());
    MeshInfo info;
    info.first_node = static_cast<Index>(out_.nodes.size());
    info.first_triangle = static_cast<Index>(out_.triangles.size());
    info.closed = source_.closed;
    first_triangle_ = info.first_triangle;
    weld();
    cut_at_seams();
    info.triangle_count = static_cast<Index>(triangles_.size());
    order_.resize(triangles_.size());
    std::iota(order_.begin(), order_.end(), 0);
    if (!order_.empty()) add_nodes(0, info.triangle_count);
    info.end_node = static_cast<Index>(out_.nodes.size());
    info.tolerance = kFeatureTolerance * diagonal_;
    for (const Index t : order_) add_triangle(triangles_[static_cast<std::size_t>(t)]);
    add_edges();
    add_vertices();
    out_.meshes.push_back(info);
  }

 private:
  /// Edges that wait for their second triangle, by their vertices.
  using OpenEdges = std::map<std::pair<Index, Index>, Index>;

  void check() const {
    for (const auto& t : source_.triangles) {
      for (const Index v : t) {
        if (v < 0 || v >= static_cast<Index>(source_.vertices.size())) {
          throw std::runtime_error("mesh triangle names vertex " + std::to_string(v) + " of " +
                                   std::to_string(source_.vertices.size()));
        }
      }
    }
  }

  /// Vertices at the same point become one, so that triangles listed with vertices of their own
  /// still have neighbors; triangles that lose a corner by that are left out.
  void weld() {
    std::map<std::array<Real, 3>, Index> known;
    std::vector<Index> welded;
    for (const Vec& v : source_.vertices) {
      const Vec3<Real> rounded(v);
      const auto [entry, is_new] = known.try_emplace({rounded.x, rounded.y, rounded.z},
                                                     static_cast<Index>(out_.points.size()));
      if (is_new) out_.points.push_back(rounded);
      welded.push_back(entry->second);
    }
    for (const auto& t : source_.triangles) {
      const std::array<Index, 3> w{welded[static_cast<std::size_t>(t[0])],
                                   welded[static_cast<std::size_t>(t[1])],
                                   welded[static_cast<std::size_t>(t[2])]};
      if (w[0] != w[1] && w[1] != w[2] && w[2] != w[0]) triangles_.push_back(w);
    }
  }

  /// Triangles inside of what the mesh and its images make together are left out.
  void cut_at_seams() {
    std::vector<Vec> points;
    for (auto v = static_cast<std::size_t>(first_vertex_); v < out_.points.size(); ++v)
      points.emplace_back(out_.points[v]);
    diagonal_ = diagonal_of(points);
    for (auto& t : triangles_)
      for (Index& v : t) v -= first_vertex_;
    seams_ = take_seams(points, triangles_, source_.closed, source_.periods);
    for (auto& t : triangles_)
      for (Index& v : t) v += first_vertex_;
  }

  Vec point(Index v) const { return Vec(out_.points[static_cast<std::size_t>(v)]); }

  // The rounded vertices, as the contact functions see them.
  Vec source_point(Index t, int k) const {
    return point(triangles_[static_cast<std::size_t>(t)][static_cast<std::size_t>(k)]);
  }
  double centroid(Index t, int axis) const {
    return source_point(t, 0)[axis] + source_point(t, 1)[axis] + source_point(t, 2)[axis];
  }

  /// Nodes for triangles order_[begin, end), depth first, split at the median.
  void add_nodes(Index begin, Index end) {
    const auto self = out_.nodes.size();
    MeshNode node;
    for (int k = 0; k < 3; ++k) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (Index i = begin; i < end; ++i) {
        for (int v = 0; v < 3; ++v) {
          const double x = source_point(order_[static_cast<std::size_t>(i)], v)[k];
          low = std::min(low, x), high = std::max(high, x);
        }
      }
      constexpr float kInfinity = std::numeric_limits<float>::infinity();
      node.lower[k] = std::nextafter(static_cast<float>(low), -kInfinity);
      node.upper[k] = std::nextafter(static_cast<float>(high), kInfinity);
    }
    node.leaf = end - begin <= kLeafTriangles ? begin * 8 + (end - begin) : -1;
    out_.nodes.push_back(node);
    if (node.leaf < 0) {
      split(begin, end);
      const Index middle = begin + (end - begin) / 2;
      add_nodes(begin, middle);
      add_nodes(middle, end);
    }
    out_.nodes[self].skip = static_cast<Index>(out_.nodes.size());
  }

  void split(Index begin, Index end) {
    int axis = 0;
    double widest = -1;
    for (int k = 0; k < 3; ++k) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (Index i = begin; i < end; ++i) {
        const double x = centroid(order_[static_cast<std::size_t>(i)], k);
        low = std::min(low, x), high = std::max(high, x);
      }
      if (high - low > widest) widest = high - low, axis = k;
    }
    std::nth_element(order_.begin() + begin, order_.begin() + begin + (end - begin) / 2,
                     order_.begin() + end, [&](Index s, Index t) {
                       const double x = centroid(s, axis), y = centroid(t, axis);
                       return x < y || (x == y && s < t);
                     });
  }

  void add_triangle(const std::array<Index, 3>& t) {
    MeshTriangle out;
    for (int k = 0; k < 3; ++k) {
      out.vertex[k] = t[static_cast<std::size_t>(k)];
      out.edge[k] = -1;
    }
    out_.triangles.push_back(out);
  }

  /// Not of unit length: twice the area.
  Vec triangle_normal(const MeshTriangle& t) const {
    return cross(point(t.vertex[1]) - point(t.vertex[0]), point(t.vertex[2]) - point(t.vertex[0]));
  }

  void add_edges() {
    OpenEdges open;
    const auto end = static_cast<Index>(out_.triangles.size());
    for (Index t = first_triangle_; t < end; ++t) {
      MeshTriangle& triangle = out_.triangles[static_cast<std::size_t>(t)];
      for (int k = 0; k < 3; ++k) {
        const Index u = triangle.vertex[k], v = triangle.vertex[(k + 1) % 3];
        const Index opposite = triangle.vertex[(k + 2) % 3];
        const auto ends = std::minmax(u, v);
        const auto known = open.find(ends);
        if (known == open.end()) {
          triangle.edge[k] = static_cast<Index>(out_.edges.size());
          open.emplace(ends, triangle.edge[k]);
          out_.edges.push_back({{ends.first, ends.second}, {opposite, -1}, {t, -1}, 0});
        } else {
          triangle.edge[k] = known->second;
          MeshEdge& edge = out_.edges[static_cast<std::size_t>(known->second)];
          edge.opposite[1] = opposite;
          edge.triangle[1] = t;
          open.erase(known);
        }
      }
    }
    for (const MeshSeam& seam : seams_) join_edges(seam, open);
    for (const auto& [ends, e] : open) {
      MeshEdge& edge = out_.edges[static_cast<std::size_t>(e)];
      if (edge.triangle[1] >= 0) edge.slack = slack();
    }
    for (std::size_t e = out_.edge_normal.size(); e < out_.edges.size(); ++e) {
      Vec sum;
      for (const Index t : out_.edges[e].triangle) {
        if (t >= 0) sum += normalized(triangle_normal(out_.triangles[static_cast<std::size_t>(t)]));
      }
      out_.edge_normal.emplace_back(normalized(sum));
    }
  }

  /// Joins edges that wait at the upper end with those at the lower: each gets the triangle of the other.
  void join_edges(const MeshSeam& seam, const OpenEdges& open) {
    for (const auto& [ends, upper] : open) {
      const Index u = other_end(seam.before, ends.first), v = other_end(seam.before, ends.second);
      if (u < 0 || v < 0) continue;
      const auto found = open.find(std::minmax(u, v));
      if (found == open.end()) continue;
      MeshEdge& above = out_.edges[static_cast<std::size_t>(upper)];
      MeshEdge& below = out_.edges[static_cast<std::size_t>(found->second)];
      const Index t = above.triangle[0], s = below.triangle[0];
      if (t == s || above.triangle[1] >= 0 || below.triangle[1] >= 0) continue;
      const Index of_above = above.opposite[0], of_below = below.opposite[0];
      join(above, s, image(of_below, seam.period));
      join(below, t, image(of_above, -seam.period));
    }
  }
  static void join(MeshEdge& edge, Index triangle, Index opposite) {
    const int place = triangle < edge.triangle[0] ? 0 : 1;
    if (place == 0) {
      edge.triangle[1] = edge.triangle[0];
      edge.opposite[1] = edge.opposite[0];
    }
    edge.triangle[place] = triangle;
    edge.opposite[place] = opposite;
  }
  /// The vertex at the other end, or -1.
  Index other_end(const std::vector<Index>& ends, Index v) const {
    const auto local = static_cast<std::size_t>(v - first_vertex_);
    const Index other = local < ends.size() ? ends[local] : -1;
    return other < 0 ? -1 : first_vertex_ + other;
  }
  /// A point of an image of the mesh.
  Index image(Index v, const Vec& shift) {
    const Vec exact = point(v) + shift;
    out_.points.emplace_back(exact);
    const auto made = static_cast<Index>(out_.points.size()) - 1;
    image_rounding_ = std::max(image_rounding_, norm(point(made) - exact));
    return made;
  }
  /// Directions to the points of an image are off by their rounding over the length of an edge; centers of bodies are a
  /// few of these away.
  float slack() const {
    double mismatch = 0;
    for (const MeshSeam& seam : seams_) mismatch = std::max(mismatch, seam.mismatch);
    return static_cast<float>(2 * mismatch + 16 * image_rounding_);
  }

  void add_vertices() {
    const std::size_t count = out_.points.size() - static_cast<std::size_t>(first_vertex_);
    std::vector<std::set<Index>> neighbors(count);
    std::vector<Vec> normal(count);
    std::vector<Index> owner(count, -1);
    const auto end = static_cast<Index>(out_.triangles.size());
    for (Index t = first_triangle_; t < end; ++t) {
      const MeshTriangle& triangle = out_.triangles[static_cast<std::size_t>(t)];
      const Vec unit = normalized(triangle_normal(triangle));
      for (int k = 0; k < 3; ++k) {
        const Index v = triangle.vertex[k], u = triangle.vertex[(k + 1) % 3],
                    w = triangle.vertex[(k + 2) % 3];
        const auto local = static_cast<std::size_t>(v - first_vertex_);
        neighbors[local].insert({u, w});
        const Vec e = normalized(point(u) - point(v)), f = normalized(point(w) - point(v));
        normal[local] += std::acos(std::clamp(dot(e, f), -1.0, 1.0)) * unit;
        if (owner[local] < 0) owner[local] = t;
      }
    }
    std::vector<bool> is_joined(count);
    for (const MeshSeam& seam : seams_) {
      for (std::size_t v = 0; v < seam.before.size(); ++v) {
        if (seam.before[v] < 0) continue;
        const auto u = static_cast<std::size_t>(seam.before[v]);
        normal[v] = normal[u] = normal[v] + normal[u];
        owner[v] = owner[u] = lowest(owner[v], owner[u]);
        const std::set<Index> above = neighbors[v], below = neighbors[u];
        add_images(below, seam.after, seam.period, neighbors[v]);
        add_images(above, seam.before, -seam.period, neighbors[u]);
        is_joined[v] = is_joined[u] = true;
      }
    }
    for (std::size_t v = 0; v < count; ++v) {
      out_.vertices.push_back({static_cast<Index>(out_.neighbors.size()),
                               static_cast<Index>(neighbors[v].size()), owner[v],
                               is_joined[v] ? slack() : 0});
      out_.neighbors.insert(out_.neighbors.end(), neighbors[v].begin(), neighbors[v].end());
      out_.vertex_normal.emplace_back(normalized(normal[v]));
    }
    // Images have no neighbors of their own.
    out_.vertices.resize(out_.points.size(), {0, 0, -1, 0});
    out_.vertex_normal.resize(out_.points.size());
  }
  static Index lowest(Index s, Index t) {
    if (s < 0 || t < 0) return std::max(s, t);
    return std::min(s, t);
  }
  /// Adds the neighbors of a vertex at the other end, but for those that this end has, too.
  void add_images(const std::set<Index>& others, const std::vector<Index>& ends, const Vec& shift,
                  std::set<Index>& neighbors) {
    for (const Index n : others)
      if (other_end(ends, n) < 0) neighbors.insert(image(n, shift));
  }

  const MeshSource& source_;
  MeshTopology<Real>& out_;
  std::vector<std::array<Index, 3>> triangles_;  ///< of welded vertices, global indices
  double diagonal_ = 0;                          ///< of the box around all vertices [m]
  std::vector<MeshSeam> seams_;
  double image_rounding_ = 0;  ///< most of the points of images [m]
  std::vector<Index> order_;   ///< triangles along the hierarchy
  Index first_vertex_ = 0;
  Index first_triangle_ = 0;
};

}  // namespace

template <class Real>
MeshTopology<Real> build_mesh_topology(const std::vector<MeshSource>& meshes) {
  MeshTopology<Real> out;
  for (const MeshSource& source : meshes) MeshBuilder<Real>(source, out).build();
  return out;
}

template MeshTopology<float> build_mesh_topology<float>(const std::vector<MeshSource>&);
template MeshTopology<double> build_mesh_topology<double>(const std::vector<MeshSource>&);

}  // namespace scree
