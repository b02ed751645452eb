#pragma once
// What the programs of a step of the variational model read, and what of it a body meets first.

#include "kernels/bodies/body_view.h"
#include "kernels/math/periodic.h"
#include "kernels/variational/fixed_walls.h"
#include "kernels/variational/near_bodies.h"

namespace scree {

/// Partner of no body, of one that meets a wall, and of one that others may meet.
inline constexpr Index kNobody = -1;
inline constexpr Index kWall = -2;
inline constexpr Index kDrawnIn = -3;

/// The next impact of a body.
struct Event {
  double time = kNever;     ///< since the start of the step [s]
  Index partner = kNobody;  ///< storage index of the other body, or kWall
};

/// The state at the start of the step, which no program of the step changes, and what is constant.
template <bool kSolids>
struct Stage {
  BodyView<double> bodies;  ///< position and velocity are those at the start
  NearBodies near;
  FixedWalls<kSolids> walls;
  Vec3d gravity;                   ///< [m/s^2]
  double h = 0;                    ///< [s]
  Span<const Vec3d> origin;        ///< [owned] where bodies were when neighbors were listed
  double room = kNever;            ///< how far from there they may be [m]
  double most_way = kNever;        ///< longest way in a step with one image of each neighbor [m]
  Span<const double> restitution;  ///< [materials^2]
  Index materials = 1;
  double most_impacts = 100;  ///< of a body in a step

  SCREE_HD Node start(Index i) const { return {bodies.position[i], bodies.velocity[i], 0}; }
  SCREE_HD bool is_free(Index i) const { return i < bodies.owned_count; }
  SCREE_HD double restitution_of(Index i, Index k) const {
    return restitution[static_cast<Offset>(bodies.material[i]) * materials + bodies.material[k]];
  }
  SCREE_HD double sum_of_radii(Index i, Index k) const {
    return bodies.radius[i] + bodies.radius[k];
  }
  /// From i to the nearest image of k [m].
  SCREE_HD Vec3d between(const Vec3d& i, const Vec3d& k) const {
    return minimum_image(k - i, walls.period);
  }

  /// Whether the neighbors that are listed are all that a body at x may touch, and none in two images.
  /// @param i  an owned body, which set out at bodies.position[i]
  SCREE_HD bool is_covered(Index i, const Vec3d& x) const {
    const double sag = 0.125 * h * h * norm(gravity);
    if (room < kNever && !(norm(minimum_image(x - origin[i], walls.period)) + sag <= room))
      return false;
    return !(most_way < kNever) || norm(x - bodies.position[i]) + sag <= most_way;
  }

  /// When body i meets a wall; kNever. @param a  its node  @param least_gap  lowered to that to a wall [m]
  SCREE_HD double wall_time(Index i, const Node& a, double& least_gap) const {
    const double s = walls.time({a.x, a.v, gravity}, h - a.t, bodies.radius[i], least_gap);
    return s < kNever ? a.t + s : kNever;
  }

  /// When two bodies meet, if that is in the step; the same bits from both sides. @param a, b  their nodes
  SCREE_HD double pair_time(Index i, const Node& a, Index k, const Node& b) const {
    const double sum = sum_of_radii(i, k);
    if (!is_free(k)) {
      const Flight f{-between(a.x, b.x), a.v, gravity};
      const auto gap = [sum](const Vec3d& x, Vec3d& n) {
        const double distance = norm(x);
        n = distance > 0 ? (1 / distance) * x : Vec3d{0, 0, 1};
        return distance - sum;
      };
      const double size = std::abs(f.x.x) + std::abs(f.x.y) + std::abs(f.x.z) + sum;
      const double s = time_to_touch(f, h - a.t, touching_gap(size), gap);
      return s < kNever ? a.t + s : kNever;
    }
    const double from = a.t > b.t ? a.t : b.t;
    const Node at_a = a.at(from, gravity), at_b = b.at(from, gravity);
    const double s = time_of_spheres(between(at_a.x, at_b.x), at_b.v - at_a.v, sum);
    const double t = from + s;
    return t <= h ? t : kNever;
  }

  /// Whether an impact with k at that time comes before another one of the same body; at the same time walls
  /// come first, then bodies by their ids.
  SCREE_HD bool comes_before(double time, Index k, const Event& other) const {
    if (time != other.time) return time < other.time;
    if (other.partner < 0) return false;
    return bodies.id[k] < bodies.id[other.partner];
  }

  /// The next impact of body i.
  /// @param node_of    node_of(k): node of a neighbor
  /// @param least_gap  lowered to that to a wall [m]
  template <class NodeOf>
  SCREE_HD Event next(Index i, const Node& a, NodeOf&& node_of, double& least_gap) const {
    Event first;
    const double wall = wall_time(i, a, least_gap);
    if (wall < kNever) first = {wall, kWall};
    for (Offset q = near.begin[i]; q < near.begin[i + 1]; ++q) {
      const Index k = near.other[q];
      const double time = pair_time(i, a, k, node_of(k));
      if (time < kNever && comes_before(time, k, first)) first = {time, k};
    }
    return first;
  }
};

}  // namespace scree
