// Machines: a plate that a motor presses on grains, and a blade that a program stops when it feels too much.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "host/scene_reader.h"
#include "tests/physics/scene_builder.h"

namespace scree::physics {
namespace {

TEST(PressedPlate, KeepsTheForceOfItsMotor) {
  Scene scene = read_scene(std::string(SCREE_SCENE_DIR) + "/press.json",
                           {"particles.0.count=200", "joints.0.motor.speed=0.4",
                            "bodies.1.position.2=0.12", "joints.0.anchor.2=0.12"});
  World world(scene, cpu_options(2, Precision::single_precision));
  world.track_forces();
  world.run(1);
  world.take_forces();
  const auto place = static_cast<std::size_t>(world.body("plate"));
  const double before = world.states().position[place].z;
  world.run(0.1);
  const MeanForces mean = world.take_forces();
  const double plate = 2 * kGravity;
  double grains = 0;
  for (std::size_t k = 0; k < 200; ++k) grains += particle_mass(scene.particles[0], k) * kGravity;
  EXPECT_NEAR(mean.on_joints[0].force.z, -400, 0.1);
  EXPECT_NEAR(mean.on_groups[static_cast<std::size_t>(scene.bodies[1].group)].force.z, 400 + plate,
              4);
  EXPECT_NEAR(mean.on_bodies[0].force.z, -400 - plate - grains, 4);
  // Its mean velocity: from step to step it trembles on its grains by as much.
  EXPECT_LT(std::abs(world.states().position[place].z - before), 1e-3 * 0.1);
}

/// Blocks that slide on a floor, one behind the other with gaps between them, and a blade behind the first.
TEST(Bulldozer, AProgramStopsTheBladeWhenItFeelsTooMuch) {
  constexpr double kMass = 2, kFriction = 0.4, kHalf = 0.05, kGap = 0.03, kSpeed = 0.1;
  constexpr double kOne = kFriction * kMass * kGravity;  // to push one block [N]
  Scene scene = empty_scene(1e-3, kFriction, Model::exact);
  solve_to(scene, 1e-8);
  scene.materials.push_back({.name = "smooth", .friction = 0});
  add_plane(scene);
  BodyDescription& blade =
      add_wall_box(scene, {-0.01, 0, kHalf}, {0.01, kHalf, kHalf}, BodyKind::kinematic);
  blade.motion = Motion{};
  blade.material = 1;
  scene.body_names = {{"blade", 1}};
  for (int k = 0; k < 4; ++k)
    add_box(scene, {kGap + kHalf + k * (2 * kHalf + kGap), 0, kHalf}, {kHalf, kHalf, kHalf}, kMass);
  World world = reference_world(scene);
  world.track_forces();
  const int id = world.body("blade");
  const auto feels = [&] { return -world.force_on(id).force.x; };

  world.set_velocity(id, {kSpeed, 0, 0});
  world.run(kGap / kSpeed + 0.1);  // pushes the first one
  EXPECT_NEAR(feels(), kOne, 1e-3 * kOne);

  // The second block is met after two gaps. The step that sets it in motion takes far more.
  world.run(10, [&](const StepReport&) { return feels() < 1.5 * kOne; });
  EXPECT_NEAR(world.time(), 2 * kGap / kSpeed, 2e-3);
  EXPECT_GT(feels(), 10 * kOne);
  world.set_velocity(id, {0.2 * kSpeed, 0, 0});
  world.run(0.2);
  EXPECT_NEAR(feels(), 2 * kOne, 1e-3 * kOne);
  world.set_velocity(id, {});
  world.run(0.2);
  EXPECT_NEAR(feels(), 0, 1e-3 * kOne);
  const BodyStates rest = world.states();
  for (std::size_t k = 2; k < 6; ++k) EXPECT_NEAR(norm(rest.velocity[k]), 0, 1e-5);
  EXPECT_EQ(rest.position[5].x, scene.bodies[5].position.x);
}

}  // namespace
}  // namespace scree::physics
