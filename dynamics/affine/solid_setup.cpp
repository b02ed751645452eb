#include "dynamics/affine/solid_setup.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "dynamics/affine/affine_setup.h"
#include "host/scene/motion.h"
#include "kernels/affine/surface_tree.h"
#include "kernels/math/morton.h"

namespace scree::affine {
namespace {

using Face = std::array<int, 3>;

Face sorted(Face f) {
  std::sort(f.begin(), f.end());
  return f;
}

std::size_t at(int k) { return static_cast<std::size_t>(k); }

/// How a corner moves: with nodes of a row of unknowns, or not at all.
struct Carried {
  int row = -1;
  double weight[4] = {};
};

class SolidBuilder {
 public:
  SolidBuilder(const Scene& scene, const std::vector<int>& body_of_id, AffineSetup& setup)
      : scene_(scene), body_of_id_(body_of_id), setup_(setup), out_(setup.solid) {
    const auto rows = static_cast<Index>(setup.body_of_row.size());
    for (Index row = 0; row < rows; ++row) {  // other bodies follow themselves
      Link own{row, row, {}};
      for (int k = 0; k < 4; ++k) own.weight[k][k] = 1;
      out_.links.begin.push_back(row);
      out_.links.links.push_back(own);
      out_.links.used.push_back(4);
    }
    taken_groups_.insert(setup.collision_group.begin(), setup.collision_group.end());
    nothing_ = static_cast<int>(setup.surfaces.size());
    setup.surfaces.push_back(std::make_shared<Surface>());
  }

  void add(const ElasticBody& elastic) {
    const BodyDescription& body = *elastic.body;
    mesh_ = &scene_.meshes[at(body.shape.mesh)];
    rest_ = mesh_->vertices;
    rest_.insert(rest_.end(), mesh_->inner.begin(), mesh_->inner.end());
    Solid solid{elastic.storage, elastic.id, size_of(out_.tetrahedra), 0, size_of(out_.corners), 0};
    solid.surface_end = solid.corners_begin + size_of(mesh_->vertices);
    out_.corners.resize(out_.corners.size() + rest_.size());
    setup_.surface_of_body[at(elastic.storage)] = nothing_;
    if (setup_.collision_group[at(elastic.storage)] < 0)
      setup_.collision_group[at(elastic.storage)] = free_group();
    attach(elastic, solid);
    number_corners();
    add_tetrahedra(elastic, solid);
    solid.tetrahedra_end = size_of(out_.tetrahedra);
    out_.solids.push_back(solid);
    out_.triangles.push_back(mesh_->triangles);
  }

  void finish() { out_.links.begin.push_back(size_of(out_.links.links)); }

 private:
  template <class T>
  static Index size_of(const std::vector<T>& list) {
    return static_cast<Index>(list.size());
  }

  Vec3d place(const BodyDescription& body, std::size_t v) const {
    return body.position + rotate(body.orientation, rest_[v]);
  }

  /// Corners that other bodies carry.
  void attach(const ElasticBody& elastic, const Solid& solid) {
    carried_.assign(rest_.size(), {});
    holder_.assign(rest_.size(), kLoose);
    for (const Attachment& each : scene_.attachments) {
      if (each.body != elastic.id) continue;
      for (std::size_t v = 0; v < rest_.size(); ++v) {
        const Vec3d x = place(*elastic.body, v);
        if (holder_[v] == kLoose && each.holds(x)) hold(v, x, each.to, solid);
      }
    }
  }

  /// A collision group that no other body has.
  int free_group() {
    int group = 0;
    while (!taken_groups_.insert(group).second) ++group;
    return group;
  }

  void hold(std::size_t v, const Vec3d& x, int to, const Solid& solid) {
    SolidCorner& corner = out_.corners[at(solid.corners_begin) + v];
    holder_[v] = to == kWorldBody ? kWorldBody : body_of_id_[at(to)];
    corner = {holder_[v], x};
    if (to == kWorldBody) return;
    const Pose start = pose_at(scene_.bodies[at(to)], 0);
    corner.rest = rotate_back(start.orientation, x - start.position);
    carried_[v].row = setup_.bodies[at(corner.body)].row;
    for (int k = 0; k < 4; ++k) carried_[v].weight[k] = node_weight(corner.rest, k);
  }

  /// Corners that are loose become unknowns, four neighbors a row.
  void number_corners() {
    Bounds box;
    for (const Vec3d& x : rest_) box.add(x);
    constexpr double kCells = 1 << 16;
    const Vec3d size = box.high - box.low;
    const double scale = (kCells - 1) / std::max({size.x, size.y, size.z});
    std::vector<std::pair<std::uint64_t, std::size_t>> order;
    for (std::size_t v = 0; v < rest_.size(); ++v) {
      if (holder_[v] != kLoose) continue;
      const Vec3d cell = scale * (rest_[v] - box.low);
      order.emplace_back(
          morton_code(static_cast<std::uint32_t>(cell.x), static_cast<std::uint32_t>(cell.y),
                      static_cast<std::uint32_t>(cell.z)),
          v);
    }
    std::sort(order.begin(), order.end());
    for (std::size_t k = 0; k < order.size(); ++k) {
      if (k % 4 == 0) out_.links.used.push_back(0);
      Carried& own = carried_[order[k].second];
      own.row = size_of(out_.links.used) - 1;
      own.weight[k % 4] = 1;
      ++out_.links.used.back();
    }
  }

  void add_tetrahedra(const ElasticBody& elastic, const Solid& solid) {
    const std::vector<Surface> surfaces = share_out_surface();
    double volume = 0;
    for (const std::array<int, 4>& t : mesh_->tetrahedra) volume += volume_of(t);
    const double density = elastic.body->mass / volume;
    for (std::size_t t = 0; t < mesh_->tetrahedra.size(); ++t)
      add(elastic, solid, mesh_->tetrahedra[t], density, surfaces[t]);
  }

  double volume_of(const std::array<int, 4>& t) const {
    const auto edge = [&](std::size_t k) { return rest_[at(t[k])] - rest_[at(t[0])]; };
    return dot(edge(1), cross(edge(2), edge(3))) / 6;
  }

  void add(const ElasticBody& elastic, const Solid& solid, const std::array<int, 4>& corner,
           double density, Surface surface) {
    const BodyDescription& body = *elastic.body;
    Tetrahedron tet;
    tet.body = size_of(setup_.bodies);
    for (const int v : corner) tet.center += 0.25 * rest_[at(v)];
    set_weights(corner, tet);
    BodyConstant c;
    const double volume = volume_of(corner), mass = density * volume;
    c.mass.mass = mass;
    Sym3<double>& s = c.mass.second;
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec3d x = rest_[at(corner[k])] - tet.center;
      const double part = mass / 20;
      s.xx += part * x.x * x.x, s.yy += part * x.y * x.y, s.zz += part * x.z * x.z;
      s.xy += part * x.x * x.y, s.xz += part * x.x * x.z, s.yz += part * x.y * x.z;
      c.radius = std::max(c.radius, norm(x));
      const std::size_t v = at(solid.corners_begin + corner[k]);
      tet.corner[k] = static_cast<Index>(v);
      if (holder_[at(corner[k])] == kLoose && out_.corners[v].body < 0)
        out_.corners[v] = {tet.body, x};
    }
    const Elasticity& elasticity = *body.elastic;
    const double young = elasticity.young_modulus, poisson = elasticity.poisson_ratio;
    c.lame.shear = volume * young / (2 * (1 + poisson));
    c.lame.volume = volume * young * poisson / ((1 + poisson) * (1 - 2 * poisson));
    c.force = (mass / body.mass) * body.load->force;
    c.material = body.material;
    c.row = size_of(setup_.body_of_row);
    AffineVec q, v;
    for (int n = 0; n < 4; ++n) {
      for (std::size_t k = 0; k < 4; ++k) {
        const Vec3d x = place(body, at(corner[k]));
        q.node[n] += tet.weight[n][k] * x;
        v.node[n] +=
            tet.weight[n][k] * (body.velocity + cross(body.angular_velocity, x - body.position));
      }
    }
    setup_.body_of_row.push_back(tet.body);
    setup_.bodies.push_back(c);
    setup_.position.push_back(q);
    setup_.velocity.push_back(v);
    setup_.id_of_body.push_back(elastic.id);
    setup_.collision_group.push_back(setup_.collision_group[at(elastic.storage)]);
    setup_.surface_of_body.push_back(number_of(std::move(surface), tet.center));
    add_links(corner, tet, c.row);
    add_held_pairs(corner, tet.body);
    out_.tetrahedra.push_back(tet);
  }

  /// Center of mass: the mean of the corners. A: the sum of corners times gradients of their shape functions.
  void set_weights(const std::array<int, 4>& corner, Tetrahedron& tet) const {
    const auto edge = [&](std::size_t k) { return rest_[at(corner[k])] - rest_[at(corner[0])]; };
    const Vec3d a = edge(1), b = edge(2), c = edge(3);
    const double scale = 1 / dot(a, cross(b, c));
    const Vec3d gradient[4] = {-scale * (cross(b, c) + cross(c, a) + cross(a, b)),
                               scale * cross(b, c), scale * cross(c, a), scale * cross(a, b)};
    for (int v = 0; v < 4; ++v) {
      tet.weight[0][v] = 0.25;
      for (int k = 0; k < 3; ++k) tet.weight[k + 1][v] = gradient[v][k];
    }
  }

  void add_links(const std::array<int, 4>& corner, const Tetrahedron& tet, Index row) {
    std::map<int, Link> links;
    for (std::size_t v = 0; v < 4; ++v) {
      const Carried& by = carried_[at(corner[v])];
      if (by.row < 0) continue;
      Link& link = links[by.row];
      link.body = row, link.row = by.row;
      for (int j = 0; j < 4; ++j)
        for (int k = 0; k < 4; ++k) link.weight[j][k] += tet.weight[j][v] * by.weight[k];
    }
    out_.links.begin.push_back(size_of(out_.links.links));
    for (const auto& [unknowns, link] : links) out_.links.links.push_back(link);
  }

  /// What a corner is attached to touches its tetrahedra all the time.
  void add_held_pairs(const std::array<int, 4>& corner, Index tetrahedron) {
    std::vector<int> holders;
    for (const int v : corner)
      if (holder_[at(v)] >= 0) holders.push_back(holder_[at(v)]);
    std::sort(holders.begin(), holders.end());
    holders.erase(std::unique(holders.begin(), holders.end()), holders.end());
    for (const int holder : holders) setup_.held_pairs.push_back({holder, tetrahedron});
  }

  /// Corners, edges and triangles of the surface, each with the first tetrahedron that has a triangle with it. Vertices are
  /// numbers of corners in x, until number_of().
  std::vector<Surface> share_out_surface() const {
    std::map<Face, int> owner_of_face;
    for (std::size_t t = 0; t < mesh_->tetrahedra.size(); ++t) {
      const std::array<int, 4>& c = mesh_->tetrahedra[t];
      for (std::size_t out = 0; out < 4; ++out) {
        Face face{};
        for (std::size_t k = 0, n = 0; k < 4; ++k)
          if (k != out) face[n++] = c[k];
        owner_of_face.emplace(sorted(face), static_cast<int>(t));
      }
    }
    std::vector<std::vector<Face>> triangles(mesh_->tetrahedra.size());
    std::map<int, int> owner_of_corner;
    std::map<std::array<int, 2>, int> owner_of_edge;
    const auto keep_least = [](auto& owners, const auto& what, int t) {
      const auto [place, is_new] = owners.emplace(what, t);
      if (!is_new) place->second = std::min(place->second, t);
    };
    for (const Face& face : mesh_->triangles) {
      const int t = owner_of_face.at(sorted(face));
      triangles[at(t)].push_back(face);
      for (std::size_t k = 0; k < 3; ++k) {
        const int a = face[k], b = face[(k + 1) % 3];
        keep_least(owner_of_corner, a, t);
        keep_least(owner_of_edge, std::array{std::min(a, b), std::max(a, b)}, t);
      }
    }
    std::vector<Surface> surfaces(mesh_->tetrahedra.size());
    for (std::size_t t = 0; t < surfaces.size(); ++t) {
      Surface& s = surfaces[t];
      std::vector<int> known;
      const auto number = [&](int corner) {
        const auto found = std::find(known.begin(), known.end(), corner);
        if (found != known.end()) return static_cast<int>(found - known.begin());
        known.push_back(corner);
        s.vertices.push_back(rest_[at(corner)]);
        return static_cast<int>(known.size()) - 1;
      };
      for (const Face& face : triangles[t]) {
        s.triangles.push_back({number(face[0]), number(face[1]), number(face[2])});
        for (std::size_t k = 0; k < 3; ++k) {
          const int a = face[k], b = face[(k + 1) % 3];
          const auto edge = owner_of_edge.find({std::min(a, b), std::max(a, b)});
          if (edge != owner_of_edge.end() && edge->second == static_cast<int>(t)) {
            s.edges.push_back({number(a), number(b)});
            owner_of_edge.erase(edge);
          }
          const auto corner = owner_of_corner.find(a);
          if (corner != owner_of_corner.end() && corner->second == static_cast<int>(t)) {
            s.points.push_back(number(a));
            owner_of_corner.erase(corner);
          }
        }
      }
    }
    return surfaces;
  }

  /// Number of a surface of a tetrahedron, about its center. Those inside have none.
  int number_of(Surface surface, const Vec3d& center) {
    if (surface.triangles.empty()) return nothing_;
    for (Vec3d& v : surface.vertices) {
      v -= center;
      surface.radius = std::max(surface.radius, norm(v));
    }
    setup_.surfaces.push_back(std::make_shared<Surface>(std::move(surface)));
    return static_cast<int>(setup_.surfaces.size()) - 1;
  }

  static constexpr int kLoose = std::numeric_limits<int>::min();

  const Scene& scene_;
  const std::vector<int>& body_of_id_;
  AffineSetup& setup_;
  SolidSetup& out_;
  int nothing_ = 0;             ///< number of the surface of what has none
  std::set<int> taken_groups_;  ///< collision groups of bodies
  // Of the body that is added:
  const TriangleMesh* mesh_ = nullptr;
  std::vector<Vec3d> rest_;       ///< corners in its frame: of the surface, then inner ones [m]
  std::vector<Carried> carried_;  ///< by corner
  std::vector<int> holder_;       ///< by corner: kLoose, kWorldBody, or a body as it is stored
};

}  // namespace

void add_solids(const Scene& scene, const std::vector<ElasticBody>& bodies,
                const std::vector<int>& body_of_id, AffineSetup& setup) {
  if (bodies.empty()) return;
  SolidBuilder builder(scene, body_of_id, setup);
  for (const ElasticBody& each : bodies) builder.add(each);
  builder.finish();
}

}  // namespace scree::affine
