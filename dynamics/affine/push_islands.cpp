#include "dynamics/affine/push_islands.h"

#include "host/disjoint_sets.h"

namespace scree::affine {

std::vector<bool> reached_by_push(const AffineSetup& setup, const std::vector<BodyPair>& near,
                                  const std::function<bool(std::size_t body)>& begins,
                                  const std::function<bool(std::size_t body)>& passes) {
  const std::size_t count = setup.bodies.size();
  std::vector<bool> can_pass(count);
  for (std::size_t body = 0; body < count; ++body)
    can_pass[body] = setup.bodies[body].row >= 0 && passes(body);
  DisjointSets sets(count);
  const auto join = [&](std::size_t a, std::size_t b) {
    if (can_pass[a] && can_pass[b]) sets.join(a, b);
  };
  for (const BodyPair& pair : near)
    join(static_cast<std::size_t>(pair.body[0]), static_cast<std::size_t>(pair.body[1]));
  for (const auto& [a, b] : setup.held_pairs)
    if (a >= 0 && b >= 0) join(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
  // Elastic bodies count as one.
  for (std::size_t body = setup.scene_bodies + 1; body < count; ++body) join(body - 1, body);
  std::vector<bool> is_pushed(count), reached(count);
  for (std::size_t body = 0; body < count; ++body)
    if (can_pass[body] && begins(body)) is_pushed[sets.root(body)] = true;
  for (std::size_t body = 0; body < count; ++body)
    reached[body] = can_pass[body] && is_pushed[sets.root(body)];
  return reached;
}

std::vector<bool> bodies_near_led(const AffineSetup& setup, const std::vector<BodyPair>& near) {
  return reached_by_push(
      setup, near, [&](std::size_t body) { return setup.bodies[body].is_led; },
      [](std::size_t) { return true; });
}

std::vector<bool> bodies_near_hit(const AffineSetup& setup, const std::vector<BodyPair>& near,
                                  const std::vector<Index>& is_hit) {
  return reached_by_push(
      setup, near,
      [&](std::size_t body) {
        return is_hit[static_cast<std::size_t>(setup.bodies[body].row)] > 0;
      },
      [&](std::size_t body) {
        return !setup.bodies[body].is_led && !setup.bodies[body].lame.is_elastic();
      });
}

}  // namespace scree::affine
