// Bodies of several parts: they move as the bodies that their parts make up, on walls, between others and across periods.

#include "host/compounds.h"

#include <gtest/gtest.h>

#include <cmath>

#include "host/state_hash.h"
#include "tests/physics/compound_scenes.h"
#include "tests/physics/round_bodies.h"

namespace scree::physics {
namespace {

/// A brick of eight bricks.
std::vector<ShapePart> eighths(const Vec3d& half) {
  std::vector<ShapePart> parts;
  for (int k = 0; k < 8; ++k)
    parts.push_back(part(
        box_of(0.5 * half),
        0.5 * Vec3d{k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z}));
  return parts;
}

/// What is hit moves as a whole: its parts are stopped by solid walls farther off than a part alone could be pushed.
TEST(CompoundBodies, APartIsStoppedWhereItsBodyIsPushed) {
  constexpr double kGap = 5e-3, kPart = 1e-3;
  Scene scene = empty_scene(1e-3, 0);
  scene.gravity = {};
  add_box(scene, {0, 0, -0.5}, {0.5, 0.5, 0.5}, 1).kind = BodyKind::fixed;
  add_compound(scene, {0, 0, kPart + kGap},
               {part(ball_of(kPart), {-0.02, 0, 0}), part(ball_of(kPart), {0.02, 0, 0}),
                part(box_of({0.02, 0.0005, 0.0005}), {})});
  add_sphere(scene, {0, 0, kPart + kGap + 0.0005 + 0.02}, 0.02, 1).velocity = {0, 0, -10};
  World world = reference_world(scene);
  world.step();
  EXPECT_GT(world.states().position[1].z, kPart - 1e-6);
  EXPECT_LT(world.states().position[1].z, kPart + kGap - 1e-3) << "it was pushed";
}

TEST(CompoundBodies, PartsOfOneBodyDoNotTouchEachOther) {
  Scene scene = empty_scene(1e-3, 0.5);
  scene.gravity = {};
  BodyDescription& body = add_compound(scene, {}, three_balls(0.1, 0.05));
  body.velocity = {1, 0, 0};
  body.angular_velocity = {0, 0, 3};
  World world = reference_world(scene);
  for (int k = 0; k < 100; ++k) ASSERT_EQ(world.step().contact_count, 0) << k;
  EXPECT_NEAR(world.states().position[0].x, 0.1, 1e-12);
  EXPECT_NEAR(world.states().angular_velocity[0].z, 3, 1e-9);
}

// a = 5/7 g sin(theta): the contact knows the arm from the center of the body, and the point of contact moves over the ball.
TEST(CompoundBodies, ABallAsTheOnlyPartRollsDownASlope) {
  Scene scene = empty_scene(1e-3, 0.5, Model::exact);
  tilt(scene, 20);
  add_compound(scene, {0, 0, 0.1}, {part(ball_of(0.1), {})});
  add_plane(scene);
  World world = reference_world(scene);
  run_for(world, scene, 0.4);
  const double expected = 5.0 / 7 * kGravity * std::sin(radians(20)) * 0.4;
  EXPECT_NEAR(world.states().velocity[0].x, expected, 1e-6 * expected);
}

TEST(CompoundBodies, ABrickOfEightSlidesAsABlockDoes) {
  constexpr double kFriction = 0.3;
  Scene scene = empty_scene(1e-3, kFriction, Model::exact);
  tilt(scene, 25);
  add_compound(scene, {0, 0, 0.05}, eighths({0.2, 0.1, 0.05}));
  add_wall_box(scene, {0, 0, -1}, {3, 3, 1});
  World world = reference_world(scene);
  run_for(world, scene, 0.4);
  const double expected =
      kGravity * (std::sin(radians(25)) - kFriction * std::cos(radians(25))) * 0.4;
  EXPECT_NEAR(world.states().velocity[0].x, expected, 1e-6 * expected);
  EXPECT_NEAR(world.states().position[0].z, 0.05, 1e-6);
}

// A table of a plate and two feet stands where its center of mass is over them, and tips where it is not.
TEST(CompoundBodies, ATableStandsAndTips) {
  for (const double shift : {0.15, 0.25}) {
    SCOPED_TRACE(shift);
    Scene scene = empty_scene(2e-3, 0.5);
    solve_to(scene, 1e-8);
    // The center of mass of all is where that of the plate is, but for the light feet.
    add_compound(scene, {0, 0, 0},
                 {part(box_of({0.5, 0.3, 0.05}), {shift, 0, 0.45}),
                  part(box_of({1e-3, 0.3, 0.2}), {-0.199, 0, 0.2}),
                  part(box_of({1e-3, 0.3, 0.2}), {0.199, 0, 0.2})});
    add_plane(scene);
    World world = reference_world(scene);
    const double start = world.states().position[0].z;
    run_for(world, scene, 1);
    const double fallen = start - world.states().position[0].z;
    if (shift < 0.2)
      EXPECT_NEAR(fallen, 0, 1e-6);
    else
      EXPECT_GT(fallen, 0.05);
  }
}

// A ball that hits the end of a resting dumbbell: with e = 0 both move on as momentum and spin about the center of mass say.
TEST(CompoundBodies, AHitOnOnePartTurnsTheWholeBody) {
  Scene scene = empty_scene(1e-4, 0);
  scene.gravity = {};
  const double r = 0.1, arm = 0.4;
  BodyDescription dumbbell =
      add_compound(scene, {}, {part(ball_of(r), {-arm, 0, 0}), part(ball_of(r), {arm, 0, 0})});
  const double mass = dumbbell.mass / 2;
  add_sphere(scene, {arm, 0.2005, 0}, r, mass).velocity = {0, -1, 0};
  World world = reference_world(scene);
  run_for(world, scene, 0.01);
  // Effective mass of the point of contact: 1 / (1 / 2m + arm^2 / I).
  const double inertia = 2 * (0.4 * mass * r * r + mass * arm * arm);
  const double at_point = 1 / (1 / (2 * mass) + arm * arm / inertia);
  const double impulse = 1 / (1 / mass + 1 / at_point);
  EXPECT_NEAR(world.states().velocity[0].y, -impulse / (2 * mass), 1e-3);
  EXPECT_NEAR(world.states().angular_velocity[0].z, -impulse * arm / inertia, 4e-3);
  EXPECT_NEAR(world.states().velocity[1].y, -1 + impulse / mass, 1e-3);
}

TEST(CompoundBodies, HoldsOthersWithAllItsPartsWhenFixed) {
  // A trough of three boxes, turned, and a peg of two capsules, with a box and balls between them.
  Scene scene = empty_scene(2e-3, 0.4);
  solve_to(scene, 1e-9);
  add_box(scene, {0.02, 0, 0.1}, {0.1, 0.1, 0.1}, 1);
  add_sphere(scene, {0.02, 0.25, 0.06}, 0.05, 1);
  add_compound(scene, {0, 0, 0},
               {part(box_of({0.3, 0.5, 0.05}), {0, 0, -0.05}),
                part(box_of({0.05, 0.5, 0.2}), {-0.3, 0, 0.1}),
                part(box_of({0.05, 0.5, 0.2}), {0.3, 0, 0.1})},
               BodyKind::fixed)
      .orientation = exp_map(Vec3d{0, radians(15), 0});
  for (int k = 0; k < 2; ++k) {
    Vec3d& x = scene.bodies[static_cast<std::size_t>(k)].position;
    x = rotate(exp_map(Vec3d{0, radians(15), 0}), x);
    scene.bodies[static_cast<std::size_t>(k)].orientation = exp_map(Vec3d{0, radians(15), 0});
  }
  World world = reference_world(scene);
  run_for(world, scene, 2);
  // Both slid, or rolled, down to the wall on the right.
  const Quatd back = exp_map(Vec3d{0, -radians(15), 0});
  const Vec3d box = rotate(back, world.states().position[0]);
  const Vec3d ball = rotate(back, world.states().position[1]);
  EXPECT_NEAR(box.z, 0.1, 1e-4);
  EXPECT_LE(box.x, 0.15 + 1e-4);
  EXPECT_NEAR(ball.z, 0.05, 1e-4);
  EXPECT_NEAR(ball.x, 0.2, 1e-3);
}

TEST(CompoundBodies, PartsOfAKinematicOneMoveAlong) {
  // A turntable of an offset plate and ball: what lies on the plate is taken along, at the speed of its place.
  Scene scene = empty_scene(1e-3, 0.9);
  solve_to(scene, 1e-9);
  const double rate = 0.5, arm = 0.6;
  BodyDescription& box = add_box(scene, {arm, 0, 0.05}, {0.05, 0.05, 0.05}, 1);
  box.velocity = {0, rate * arm, 0};  // else it would slip first
  box.angular_velocity = {0, 0, rate};
  BodyDescription& table = add_compound(
      scene, {},
      {part(box_of({0.2, 0.2, 0.05}), {arm, 0, -0.05}), part(ball_of(0.1), {-arm, 0, 0})},
      BodyKind::kinematic);
  Motion motion;
  motion.kind = Motion::Kind::rotating;
  motion.rate = rate;
  table.motion = motion;
  add_sphere(scene, {-arm, 0, 0.2}, 0.1, 1).locks = lock_all & ~lock_z;  // on the ball as it starts
  World world = reference_world(scene);
  const double time = 0.4;
  run_for(world, scene, time);
  const Vec3d expected = arm * Vec3d{std::cos(rate * time), std::sin(rate * time), 0};
  EXPECT_LT(norm(world.states().position[0] - expected - Vec3d{0, 0, 0.05}), 2e-3);
  // The other ball sank along the one that moves away from under it: their distance stays that of touching.
  const Vec3d under = -expected;
  EXPECT_NEAR(norm(world.states().position[2] - under), 0.2, 1e-3);
}

TEST(CompoundBodies, LieAcrossAPeriodicSide) {
  Scene scene = empty_scene(2e-3, 0.5);
  solve_to(scene, 1e-9);
  scene.periodicity.periodic = {true, true, false};
  scene.periodicity.lower = {0, 0, 0};
  scene.periodicity.upper = {2, 2, 1};
  // Its left ball is on the other side of the domain; a ball rests on that one and the middle one.
  add_compound(scene, {0.1, 1, 0.1}, three_balls(0.1, 0.16));
  add_plane(scene);
  add_sphere(scene, {0.02, 1, 0.1 + std::sqrt(0.04 - 0.0064)}, 0.1, 0.1).locks = lock_all & ~lock_z;
  World world = reference_world(scene);
  for (int k = 0; k < 200; ++k) world.step();
  EXPECT_NEAR(world.states().position[0].z, 0.1, 1e-6);
  EXPECT_NEAR(world.states().position[2].z, 0.1 + std::sqrt(0.04 - 0.0064), 1e-4);
}

TEST(CompoundBodies, APileComesToRestWithTheSameBitsOnAnyNumberOfThreads) {
  const BodyStates states = expect_pile_rests(pile_of_compounds(), 1000, 1e-2);
  for (std::size_t i = 0; i < 36; ++i) EXPECT_GT(states.position[i].z, 0.01) << i;
}

TEST(CompoundBodies, ResumedRunsHaveTheSameBits) {
  const Scene scene = pile_of_compounds();
  World whole(scene, cpu_options(2));
  std::vector<std::uint64_t> hash;
  std::vector<WorldState> saved;
  for (int k = 0; k < 160; ++k) {
    if (k == 63 || k == 64 || k == 100) saved.push_back(whole.save());  // about a reordering
    whole.step();
    hash.push_back(state_hash(whole.states()));
  }
  for (const WorldState& state : saved) {
    World resumed(scene, cpu_options(1));
    resumed.restore(state);
    for (std::int64_t k = state.step; k < 160; ++k) {
      resumed.step();
      ASSERT_EQ(state_hash(resumed.states()), hash[static_cast<std::size_t>(k)]) << k;
    }
  }
}

TEST(CompoundBodies, MayJoinLater) {
  Scene scene = empty_scene(2e-3, 0.5);
  solve_to(scene, 1e-8);
  add_compound(scene, {0, 0, 0.1}, three_balls(0.1, 0.1));
  add_plane(scene);
  Insertion later;
  later.time = 0.1;
  BodyDescription body;
  body.position = {0, 0, 0.31};
  set_compound(scene, body, three_balls(0.1, 0.1));
  set_mass_from_density(body, 1000);
  body.locks = lock_all & ~lock_z;
  later.bodies.push_back(body);
  scene.insertions.push_back(later);
  World world = reference_world(scene);
  run_for(world, scene, 0.5);
  ASSERT_EQ(world.states().position.size(), 3u);
  EXPECT_NEAR(world.states().position[0].z, 0.1, 1e-5);
  EXPECT_NEAR(world.states().position[2].z, 0.3, 1e-4);
}

// It would cross the thin wall in one step.
TEST(CompoundBodies, DoNotTunnelThroughWallsAtHighSpeed) {
  for (const bool by_mesh : {false, true}) {
    SCOPED_TRACE(by_mesh);
    Scene scene = empty_scene(1e-3, 0.3);
    scene.gravity = {};
    solve_to(scene, 1e-8);
    BodyDescription& body = add_compound(scene, {-0.33, 0, 0}, cross_of_bars(0.05, 0.01));
    body.velocity = {100, 0, 0};
    body.orientation = exp_map(Vec3d{0.3, 0.2, 0.1});
    if (by_mesh) {
      TriangleMesh mesh;
      mesh.name = "plate";
      mesh.closed = false;
      mesh.vertices = {{0, -2, -2}, {0, 2, -2}, {0, 2, 2}, {0, -2, 2}};
      mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
      add_mesh(scene, mesh);
    } else {
      add_wall_box(scene, {0.005, 0, 0}, {0.005, 2, 2});
    }
    World world = reference_world(scene);
    for (int k = 0; k < 50; ++k) world.step();
    EXPECT_LT(world.states().position[0].x, 0);
  }
}

// The end of a bar whose center is held goes far in a step: it hits the ball on its way as momentum about the axis says.
TEST(CompoundBodies, FastEndsOfBodiesThatAreHeldHitWhatIsOnTheirWay) {
  for (const int held : {lock_x | lock_y | lock_z, lock_all & ~lock_rz}) {
    SCOPED_TRACE(held);
    Scene scene = empty_scene(1e-3, 0);
    solve_to(scene, 1e-10);
    const double arm = 0.5, r = 0.02, mass = 0.05, spin = 100;
    BodyDescription& bar =
        add_compound(scene, {}, {part(ball_of(r), {-arm, 0, 0}), part(ball_of(r), {arm, 0, 0})});
    bar.locks = static_cast<std::uint8_t>(held);
    bar.angular_velocity = {0, 0, spin};
    const double inertia = bar.inertia.z;
    add_sphere(scene, {arm, 0.045, 0}, 0.01, mass);
    World world = reference_world(scene);
    world.step();
    // In this step they may still come nearer by the gap.
    const double closing = arm * spin - 0.015 / scene.stepping.time_step;
    const double impulse = closing / (arm * arm / inertia + 1 / mass);
    EXPECT_NEAR(world.states().angular_velocity[0].z, spin - impulse * arm / inertia, 1e-3 * spin);
    EXPECT_NEAR(world.states().velocity[1].y, impulse / mass, 1e-3 * arm * spin);
  }
}

}  // namespace
}  // namespace scree::physics
