#include "dynamics/affine/start_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "host/error.h"
#include "kernels/affine/surface_tree.h"

namespace scree::affine {
namespace {

const Surface& surface_of(const AffineSetup& setup, Index body) {
  return *setup.surfaces[static_cast<std::size_t>(
      setup.surface_of_body[static_cast<std::size_t>(body)])];
}

const AffineVec& place_of(const AffineSetup& setup, Index body) {
  return setup.position[static_cast<std::size_t>(body)];
}

std::vector<Vec3d> corners_at(const Surface& surface, const AffineVec& q) {
  std::vector<Vec3d> at;
  for (const Vec3d& v : surface.vertices) at.push_back(point_of(q, v));
  return at;
}

/// Whether the segment from a to b passes through the inside of a triangle.
bool passes(const Vec3d& a, const Vec3d& b, const Vec3d& p, const Vec3d& q, const Vec3d& r) {
  const auto volume = [](const Vec3d& d, const Vec3d& e, const Vec3d& f, const Vec3d& g) {
    return dot(cross(e - d, f - d), g - d);
  };
  const double from = volume(p, q, r, a), to = volume(p, q, r, b);
  if (!(from * to < 0)) return false;
  const double s = volume(a, b, p, q), t = volume(a, b, q, r), u = volume(a, b, r, p);
  return (s > 0 && t > 0 && u > 0) || (s < 0 && t < 0 && u < 0);
}

/// An edge of one body that passes through a triangle of another, by their numbers in the surfaces.
struct EdgeThrough {
  std::size_t edge = 0, triangle = 0;
};

/// First edge of `a` that passes through a triangle of `b`. @param at_a, at_b  where their corners are
std::optional<EdgeThrough> edge_through(const Surface& a, const std::vector<Vec3d>& at_a,
                                        const Surface& b, const std::vector<Vec3d>& at_b) {
  const auto box_of = [](const auto& corners, const std::vector<Vec3d>& at) {
    Bounds box;
    for (const int v : corners) box.add(at[static_cast<std::size_t>(v)]);
    return box;
  };
  Bounds all_a;
  for (const Vec3d& x : at_a) all_a.add(x);
  std::vector<std::pair<std::size_t, Bounds>> triangles;
  Bounds all_b;
  for (std::size_t t = 0; t < b.triangles.size(); ++t) {
    const Bounds box = box_of(b.triangles[t], at_b);
    all_b.add(box);
    if (box.near(all_a, 0)) triangles.emplace_back(t, box);
  }
  for (std::size_t e = 0; e < a.edges.size(); ++e) {
    const Bounds box = box_of(a.edges[e], at_a);
    if (!box.near(all_b, 0)) continue;
    const Vec3d &from = at_a[static_cast<std::size_t>(a.edges[e][0])],
                &to = at_a[static_cast<std::size_t>(a.edges[e][1])];
    for (const auto& [t, other] : triangles) {
      if (!box.near(other, 0)) continue;
      const auto& corner = b.triangles[t];
      if (passes(from, to, at_b[static_cast<std::size_t>(corner[0])],
                 at_b[static_cast<std::size_t>(corner[1])],
                 at_b[static_cast<std::size_t>(corner[2])]))
        return EdgeThrough{e, t};
    }
  }
  return std::nullopt;
}

/// Corners of a body as its mesh numbers them: those of a tetrahedron are some of the mesh of its elastic body.
/// @param corners  of its surface
std::vector<int> mesh_corners(const AffineSetup& setup, Index body,
                              const std::vector<int>& corners) {
  const auto first = static_cast<Index>(setup.scene_bodies);
  if (body < first) return corners;
  const Tetrahedron& t = setup.solid.tetrahedra[static_cast<std::size_t>(body - first)];
  const Solid& solid =
      *std::find_if(setup.solid.solids.begin(), setup.solid.solids.end(),
                    [&](const Solid& each) { return body - first < each.tetrahedra_end; });
  std::vector<int> numbers;
  for (const int v : corners) {
    const Vec3d x = point_of(place_of(setup, body),
                             surface_of(setup, body).vertices[static_cast<std::size_t>(v)]);
    const auto off = [&](Index corner) {
      const SolidCorner& c = setup.solid.corners[static_cast<std::size_t>(corner)];
      return norm(x - (c.body < 0 ? c.rest : point_of(place_of(setup, c.body), c.rest)));
    };
    numbers.push_back(*std::min_element(std::begin(t.corner), std::end(t.corner),
                                        [&](Index a, Index b) { return off(a) < off(b); }) -
                      solid.corners_begin);
  }
  return numbers;
}

/// First triangle of a body that has some corners, as its mesh numbers both.
std::size_t triangle_with(const AffineSetup& setup, Index body, const std::vector<int>& corners) {
  const auto solid =
      std::find_if(setup.solid.solids.begin(), setup.solid.solids.end(), [&](const Solid& each) {
        return each.id == setup.id_of_body[static_cast<std::size_t>(body)];
      });
  const std::vector<std::array<int, 3>>& triangles =
      solid == setup.solid.solids.end()
          ? surface_of(setup, body).triangles
          : setup.solid.triangles[static_cast<std::size_t>(solid - setup.solid.solids.begin())];
  const auto found = std::find_if(triangles.begin(), triangles.end(), [&](const auto& triangle) {
    return std::all_of(corners.begin(), corners.end(), [&](int corner) {
      return std::find(triangle.begin(), triangle.end(), corner) != triangle.end();
    });
  });
  return static_cast<std::size_t>(found - triangles.begin());
}

/// @param a  whose edge passes through b
[[noreturn]] void throw_crossing(const AffineSetup& setup, Index a, Index b, EdgeThrough which,
                                 const BodyNames& name) {
  const auto& edge = surface_of(setup, a).edges[which.edge];
  const auto& triangle = surface_of(setup, b).triangles[which.triangle];
  const std::vector<int> ends = mesh_corners(setup, a, {edge[0], edge[1]});
  const auto id = [&](Index body) { return setup.id_of_body[static_cast<std::size_t>(body)]; };
  throw InputError(fmt::format(
      "{} and {} intersect at the start: triangle {} of the first, with its edge between corners "
      "{} and {}, passes through triangle {} of the second; bodies of the dynamics \"affine\" must "
      "be apart",
      name(id(a)), name(id(b)), triangle_with(setup, a, ends), ends[0], ends[1],
      triangle_with(setup, b, mesh_corners(setup, b, {triangle[0], triangle[1], triangle[2]}))));
}

}  // namespace

void require_no_crossing(const AffineSetup& setup, const BodyNames& name) {
  std::vector<Bounds> boxes;
  std::vector<Index> order;  // along x
  for (Index body = 0; body < std::ssize(setup.bodies); ++body) {
    Bounds box;
    for (const Vec3d& x : corners_at(surface_of(setup, body), place_of(setup, body))) box.add(x);
    boxes.push_back(box);
    order.push_back(body);
  }
  const auto box_of = [&](Index body) -> const Bounds& {
    return boxes[static_cast<std::size_t>(body)];
  };
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return box_of(a).low.x < box_of(b).low.x; });
  for (auto i = order.begin(); i != order.end(); ++i) {
    for (auto k = i + 1; k != order.end() && box_of(*k).low.x <= box_of(*i).high.x; ++k) {
      const auto [a, b] = std::minmax(*i, *k);
      if (!box_of(a).near(box_of(b), 0) || !may_touch(setup, a, b)) continue;
      const Surface &of_a = surface_of(setup, a), &of_b = surface_of(setup, b);
      const std::vector<Vec3d> at_a = corners_at(of_a, place_of(setup, a)),
                               at_b = corners_at(of_b, place_of(setup, b));
      if (const auto found = edge_through(of_a, at_a, of_b, at_b))
        throw_crossing(setup, a, b, *found, name);
      if (const auto found = edge_through(of_b, at_b, of_a, at_a))
        throw_crossing(setup, b, a, *found, name);
    }
  }
}

double touching_gap(const AffineSetup& setup) {
  return 1e-12 * std::max(setup.size, setup.farthest);
}

void throw_touching(const AffineSetup& setup, const NearPair& near, const BodyPair& bodies,
                    double separation, const BodyNames& name) {
  NearPair alone = near;
  alone.bodies = 0;
  const NearPairsView view{{&alone, 1}, {&bodies, 1}, {}};
  std::array<std::string, 2> names;
  std::array<std::size_t, 2> triangle{};
  Four x;
  for (int side = 0, i = 0; side < 2; ++side) {
    const Index body = view.body_of(alone, side);
    const int number = setup.surface_of_body[static_cast<std::size_t>(body)];
    Index before = 0;  // corners of all surfaces are in one table
    for (int k = 0; k < number; ++k)
      before += static_cast<Index>(setup.surfaces[static_cast<std::size_t>(k)]->vertices.size());
    std::vector<int> corners;
    for (const int end = side == 0 ? first_points(near.kind) : 4; i < end; ++i) {
      corners.push_back(near.vertex[i] - before);
      x[i] = point_of(place_of(setup, body),
                      surface_of(setup, body).vertices[static_cast<std::size_t>(corners.back())]);
    }
    const auto which = static_cast<std::size_t>(side);
    names[which] = name(setup.id_of_body[static_cast<std::size_t>(body)]);
    triangle[which] = triangle_with(setup, body, mesh_corners(setup, body, corners));
  }
  throw InputError(fmt::format(
      "{} and {} touch at the start: triangle {} of the first and triangle {} of the second are "
      "{:.3g} m apart, and must be more than {:.3g} m apart (the \"separation\" of {:g} m, "
      "and 1e-12 of the scene for rounding)",
      names[0], names[1], triangle[0], triangle[1], std::sqrt(squared_distance(near.kind, x)),
      separation + touching_gap(setup), separation));
}

std::string throw_warning(const std::string& first, const std::string& second, double gap,
                          double reach, double speed) {
  return fmt::format(
      "{} and {} start {:.3g} m apart, within the reach of {:.3g} m: the barrier throws "
      "them off at up to {:.2g} m/s; start "
      "them farther apart, or take a smaller \"reach\" or a larger time step",
      first, second, gap, reach, speed);
}

}  // namespace scree::affine
