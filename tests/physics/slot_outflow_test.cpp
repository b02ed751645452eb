// Beads run out of a slot at a constant rate, W = 1.03 rho_bulk sqrt(g) (w - k d)(L - k d)^(3/2).

#include <gtest/gtest.h>

#include "tests/physics/scene_builder.h"

namespace scree::physics {
namespace {

constexpr int kBeads = 1500;
constexpr double kGrain = 2e-3;
constexpr double kSlotLength = 10e-3;  // L, along x
constexpr double kWidth = 20e-3;       // w, along y: from wall to wall

/// A silo of 25 x 20 mm with a slot across the middle of its floor, closed by a gate
/// that drops at `open`.
Scene silo(double open) {
  Scene scene = empty_scene(5e-4, 0.3);
  solve_to(scene, 1e-4);
  scene.solver.max_iterations = 1000;
  scene.materials[0].name = "beads";
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].name = "walls";
  scene.material_pairs.push_back({0, 1, Material{"walls", 0.4, 0, 0, 0, 0}});
  const double side = 12.5e-3, thick = 2e-3;
  add_lattice(scene, kBeads, 11, 9, {-10.75e-3, -8.6e-3, 1.2e-3}, 2.15e-3, kGrain / 2, 2500, 5);
  const auto wall = [](BodyDescription& body) -> BodyDescription& {
    body.material = 1;
    return body;
  };
  wall(add_plane(scene, {1, 0, 0}, {-side, 0, 0}));
  wall(add_plane(scene, {-1, 0, 0}, {side, 0, 0}));
  wall(add_plane(scene, {0, 1, 0}, {0, -kWidth / 2, 0}));
  wall(add_plane(scene, {0, -1, 0}, {0, kWidth / 2, 0}));
  const double shelf = (side - kSlotLength / 2) / 2;
  for (const double sign : {-1.0, 1.0})
    wall(add_wall_box(scene, {sign * (kSlotLength / 2 + shelf), 0, -thick},
                      {shelf, kWidth / 2, thick}));
  BodyDescription& gate = wall(add_wall_box(
      scene, {0, 0, -thick}, {kSlotLength / 2, kWidth / 2, thick}, BodyKind::kinematic));
  Motion drop;
  drop.kind = Motion::Kind::linear;
  drop.velocity = {0, 0, -2};
  drop.start = open;
  gate.motion = drop;
  return scene;
}

TEST(SlotOutflow, C12_ConstantRateOfTheSlotLaw) {
  const double open = 0.25;
  const Scene scene = silo(open);
  World world(scene, cpu_options(0));
  run_for(world, scene, open);
  double top = 0;
  for (int i = 0; i < kBeads; ++i) top = std::max(top, world.states().position[i].z + kGrain / 2);
  EXPECT_LT(world.states().position.size() ? top : 1, 0.04);

  // Beads below the shelf, over time; the law holds while the silo is well filled.
  std::vector<double> times, out;
  for (int k = 0; k < 600; ++k) {
    world.step();
    const BodyStates s = world.states();
    int passed = 0;
    for (int i = 0; i < kBeads; ++i) passed += s.position[i].z < 0;
    if (passed < 0.05 * kBeads) continue;
    if (passed > 0.5 * kBeads) break;
    times.push_back(world.time());
    out.push_back(passed);
  }
  ASSERT_GT(times.size(), 50u);
  const double n = static_cast<double>(times.size());
  double t = 0, y = 0, tt = 0, ty = 0, yy = 0;
  for (std::size_t k = 0; k < times.size(); ++k) {
    t += times[k] / n;
    y += out[k] / n;
  }
  for (std::size_t k = 0; k < times.size(); ++k) {
    tt += (times[k] - t) * (times[k] - t);
    ty += (times[k] - t) * (out[k] - y);
    yy += (out[k] - y) * (out[k] - y);
  }
  const double bead = 2500 * kPi / 6 * std::pow(kGrain, 3);
  const double rate = bead * ty / tt;
  const double linearity = ty * ty / (tt * yy);
  const auto law = [](double k) {
    return 1.03 * 1500 * std::sqrt(kGravity) * (kWidth - k * kGrain) *
           std::pow(kSlotLength - k * kGrain, 1.5);
  };
  RecordProperty("rate_over_law_k1.0", std::to_string(rate / law(1.0)));
  RecordProperty("rate_over_law_k1.4", std::to_string(rate / law(1.4)));
  RecordProperty("linearity", std::to_string(linearity));
  EXPECT_GT(linearity, 0.995);
  EXPECT_NEAR(rate / law(1.0), 1, 0.3);
}

}  // namespace
}  // namespace scree::physics
