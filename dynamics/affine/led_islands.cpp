#include "dynamics/affine/led_islands.h"

#include "host/disjoint_sets.h"

namespace scree::affine {

std::vector<bool> bodies_near_led(const AffineSetup& setup, const std::vector<BodyPair>& near) {
  const std::size_t count = setup.bodies.size();
  DisjointSets sets(count);
  const auto join = [&](std::size_t a, std::size_t b) {
    if (setup.bodies[a].row >= 0 && setup.bodies[b].row >= 0) sets.join(a, b);
  };
  for (const BodyPair& pair : near)
    join(static_cast<std::size_t>(pair.body[0]), static_cast<std::size_t>(pair.body[1]));
  for (const auto& [a, b] : setup.held_pairs)
    if (a >= 0 && b >= 0) join(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
  // Elastic bodies count as one.
  for (std::size_t body = setup.scene_bodies + 1; body < count; ++body) join(body - 1, body);
  std::vector<bool> has_led(count), reached(count);
  for (std::size_t body = 0; body < count; ++body)
    if (setup.bodies[body].is_led) has_led[sets.root(body)] = true;
  for (std::size_t body = 0; body < count; ++body)
    reached[body] = setup.bodies[body].row >= 0 && has_led[sets.root(body)];
  return reached;
}

}  // namespace scree::affine
