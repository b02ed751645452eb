#include "host/scene/overlaps.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "dynamics/dynamics_card.h"
#include "host/error.h"
#include "host/scene/body_name.h"
#include "host/scene/particle_shapes.h"
#include "shapes/shape_card.h"

namespace scree {
namespace {

constexpr double kTolerated = 1e-3;  // of the thinner body
/// Bodies in a cell so small that all of them overlap: so many that listing their
/// pairs could take hours.
constexpr std::size_t kCrowd = 2000;

/// A free sphere at the start.
struct Ball {
  Vec3d center;
  double radius;
  int id;
};

/// Free spheres that are there at time zero, by id.
std::vector<Ball> balls_at_start(const Scene& scene) {
  std::vector<Ball> balls;
  int id = 0;
  const auto pass = [&](const auto& batch, bool is_there) {
    for (const BodyDescription& body : batch.bodies) {
      const bool is_ball = body.kind == BodyKind::free && shape_card(body.shape.kind).is_ball;
      if (is_there && is_ball) balls.push_back({body.position, body.shape.radius, id});
      ++id;
    }
    for (const ParticleSet& set : batch.particles) {
      const bool spheres = are_spheres(set);
      for (std::size_t i = 0; i < set.position.size(); ++i, ++id) {
        const bool is_ball = spheres || shape_card(particle_kind(set, i)).is_ball;
        if (is_there && is_ball) balls.push_back({set.position[i], set.radius[i], id});
      }
    }
  };
  pass(scene, true);
  for (const Insertion& insertion : scene.insertions) pass(insertion, insertion.time <= 0);
  return balls;
}

/// The first crowd in the order of cells: bodies whose centers share a cell no wider than the
/// smallest diameter.
Overlaps overlaps_in_crowd(const Scene& scene) {
  std::vector<Ball> balls = balls_at_start(scene);
  Overlaps found;
  if (balls.size() < kCrowd) return found;
  double smallest = balls[0].radius;
  for (const Ball& ball : balls) smallest = std::min(smallest, ball.radius);
  const double cell = 2 * smallest / std::sqrt(3.0);
  const auto cell_of = [&](const Ball& ball) {
    return std::array{std::floor(ball.center.x / cell), std::floor(ball.center.y / cell),
                      std::floor(ball.center.z / cell)};
  };
  std::sort(balls.begin(), balls.end(), [&](const Ball& a, const Ball& b) {
    const auto cell_a = cell_of(a);
    const auto cell_b = cell_of(b);
    return cell_a != cell_b ? cell_a < cell_b : a.id < b.id;
  });
  for (std::size_t first = 0; first + kCrowd <= balls.size(); ++first) {
    if (cell_of(balls[first]) != cell_of(balls[first + kCrowd - 1])) continue;
    const Ball& a = balls[first];
    const Ball& b = balls[first + 1];
    found.pairs = static_cast<std::int64_t>(kCrowd * (kCrowd - 1) / 2);
    found.has_more = true;
    found.body_a = a.id;
    found.body_b = b.id;
    found.depth = a.radius + b.radius - norm(b.center - a.center);
    found.fraction = found.depth / (2 * std::min(a.radius, b.radius));
    break;
  }
  return found;
}

}  // namespace

namespace {

/// Least extent of a body [m]: of a box about it, or the diameter. 0: unbounded.
double thickness(const BodyConstants& body, int id) {
  const auto k = static_cast<std::size_t>(id);
  const Vec3d half = body.half_extents(k);
  const double least = std::min({half.x, half.y, half.z});
  return 2 * (least > 0 ? least : body[k].radius);
}

}  // namespace

Overlaps overlaps_among(const std::vector<ContactRecord>& contacts, const BodyConstants& body) {
  Overlaps found;
  std::pair<int, int> last{-1, -1};
  for (const ContactRecord& contact : contacts) {
    if (!(contact.gap < 0)) continue;
    const double of_a = thickness(body, contact.body_a), of_b = thickness(body, contact.body_b);
    const double fraction = -contact.gap / (of_b > 0 ? std::min(of_a, of_b) : of_a);
    if (!(fraction > kTolerated)) continue;
    const std::pair<int, int> pair{contact.body_a, contact.body_b};
    if (std::exchange(last, pair) != pair) ++found.pairs;
    if (-contact.gap <= found.depth) continue;
    found.body_a = contact.body_a;
    found.body_b = contact.body_b;
    found.depth = -contact.gap;
    found.fraction = fraction;
  }
  return found;
}

Overlaps find_overlaps(Scene scene, const WorldOptions& options) {
  Overlaps found = overlaps_in_crowd(scene);
  if (found.pairs > 0) return found;
  const bool has_contacts = dynamics_card(scene.dynamics.type).has_contacts;
  try {
    require_memory(scene, options);
  } catch (const std::runtime_error& error) {
    found.not_looked_for = error.what();
    return found;
  }
  try {
    const World world(scene, options);  // what it refuses, a run would
    if (has_contacts) return overlaps_among(world.overlaps(), world.constants());
    found.warnings = world.warnings();
  } catch (const InputError&) {
    throw;
  } catch (const std::runtime_error& error) {  // no room, or more pairs than can be numbered
    found.not_looked_for = error.what();
    return found;
  }
  Overlaps of_rigid = overlaps_as_rigid(std::move(scene), options);
  of_rigid.warnings = std::move(found.warnings);
  return of_rigid;
}

Overlaps overlaps_as_rigid(Scene scene, const WorldOptions& options) {
  scene.dynamics = {};
  try {
    require_memory(scene, options);
    const World world(std::move(scene), options);
    return overlaps_among(world.overlaps(), world.constants());
  } catch (const std::runtime_error& error) {  // also what rigid bodies cannot do
    Overlaps found;
    found.not_looked_for = error.what();
    return found;
  }
}

std::string overlap_warning(const Overlaps& o, const BodyConstants& body) {
  if (o.pairs == 0) return "";
  return fmt::format(
      "{}{} pair{} of bodies overlap{} at the start; deepest: {} and {} by {:.3g} "
      "m, {:.3g} % of the thickness of the thinner one",
      o.has_more ? "more than " : "", o.pairs, o.pairs == 1 ? "" : "s", o.pairs == 1 ? "s" : "",
      body_with_id(body, o.body_a), body_with_id(body, o.body_b), o.depth, 100 * o.fraction);
}

}  // namespace scree
