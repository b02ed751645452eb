#include "dynamics/affine/push_islands.h"

#include "host/disjoint_sets.h"

namespace scree::affine {

PushIslands reached_by_push(const AffineSetup& setup, const std::vector<BodyPair>& near,
                            const std::function<bool(std::size_t body)>& begins,
                            const std::function<bool(std::size_t body)>& passes) {
  const std::size_t count = setup.bodies.size();
  std::vector<bool> can_pass(count);
  for (std::size_t body = 0; body < count; ++body)
    can_pass[body] = setup.bodies[body].row >= 0 && passes(body);
  DisjointSets sets(count);
  std::vector<bool> holds(
      count);  // bodies that something from outside of the sets touches or holds
  const auto join = [&](int a, int b) {
    const bool first = a >= 0 && can_pass[static_cast<std::size_t>(a)];
    const bool second = b >= 0 && can_pass[static_cast<std::size_t>(b)];
    if (first && second) sets.join(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
    if (first != second) holds[static_cast<std::size_t>(first ? a : b)] = true;
  };
  for (const BodyPair& pair : near) join(pair.body[0], pair.body[1]);
  for (const auto& [a, b] : setup.held_pairs) join(a, b);
  for (const NodeEquation& e : setup.equations)
    if (e.row[1] < 0) join(setup.body_of_row[static_cast<std::size_t>(e.row[0])], -1);
  for (const Solid& solid : setup.solid.solids)
    for (Index k = solid.tetrahedra_begin; k < solid.tetrahedra_end; ++k) {
      const Tetrahedron& tetrahedron = setup.solid.tetrahedra[static_cast<std::size_t>(k)];
      if (k > solid.tetrahedra_begin) join(tetrahedron.body - 1, tetrahedron.body);
      for (const Index corner : tetrahedron.corner)  // the world holds some
        if (setup.solid.corners[static_cast<std::size_t>(corner)].body < 0)
          join(tetrahedron.body, -1);
    }
  std::vector<bool> is_pushed(count);
  PushIslands r{std::vector<Index>(count, -1), std::vector<bool>(count)};
  for (std::size_t body = 0; body < count; ++body) {
    if (holds[body]) r.is_held[sets.root(body)] = true;
    if (can_pass[body] && begins(body)) is_pushed[sets.root(body)] = true;
  }
  for (std::size_t body = 0; body < count; ++body)
    if (can_pass[body] && is_pushed[sets.root(body)])
      r.island[body] = static_cast<Index>(sets.root(body));
  return r;
}

std::vector<bool> bodies_near_led(const AffineSetup& setup, const std::vector<BodyPair>& near) {
  const PushIslands pushed = reached_by_push(
      setup, near, [&](std::size_t body) { return setup.bodies[body].is_led; },
      [](std::size_t) { return true; });
  std::vector<bool> is_near;
  for (const Index island : pushed.island) is_near.push_back(island >= 0);
  return is_near;
}

PushIslands islands_of_hit(const AffineSetup& setup, const std::vector<BodyPair>& near,
                           const std::vector<Index>& is_hit) {
  return reached_by_push(
      setup, near,
      [&](std::size_t body) {
        return is_hit[static_cast<std::size_t>(setup.bodies[body].row)] > 0;
      },
      [&](std::size_t body) { return !setup.bodies[body].is_led; });
}

std::vector<Vec3d> shared_velocities(const AffineSetup& setup, const PushIslands& pushed,
                                     const std::vector<Vec3d>& momentum) {
  struct Sum {
    Vec3d momentum;
    double mass = 0;
  };
  std::vector<Sum> sums(setup.bodies.size());  // by the lowest body of a set
  const auto sum_of = [&](std::size_t row) -> Sum* {
    const Index island = pushed.island[static_cast<std::size_t>(setup.body_of_row[row])];
    const auto lowest = static_cast<std::size_t>(island);
    return island >= 0 && !pushed.is_held[lowest] ? &sums[lowest] : nullptr;
  };
  for (std::size_t row = 0; row < momentum.size(); ++row)
    if (Sum* const sum = sum_of(row)) {
      sum->momentum += momentum[row];
      sum->mass += setup.bodies[static_cast<std::size_t>(setup.body_of_row[row])].mass.mass;
    }
  std::vector<Vec3d> velocity(momentum.size());
  for (std::size_t row = 0; row < momentum.size(); ++row)
    if (const Sum* const sum = sum_of(row)) velocity[row] = (1 / sum->mass) * sum->momentum;
  return velocity;
}

}  // namespace scree::affine
