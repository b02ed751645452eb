// What a program does to a running World, and reads from it, on every backend there is: closed forms.

#include <gmock/gmock.h>

#include <limits>

#include "host/error.h"
#include "host/io/checkpoint.h"
#include "host/state_hash.h"
#include "tests/host/input_files.h"
#include "tests/host/io/output_fixtures.h"
#include "tests/parity/parity.h"

namespace scree::parity {
namespace {

using test::refusal;
using ::testing::HasSubstr;

constexpr double kControlStep = 1e-3;

class Control : public ::testing::TestWithParam<std::tuple<BackendKind, Precision>> {
 protected:
  void SetUp() override {
    std::string reason;
    if (!backend_available(backend(), &reason)) GTEST_SKIP() << "no such backend: " << reason;
  }
  static BackendKind backend() { return std::get<0>(GetParam()); }
  static Precision precision() { return std::get<1>(GetParam()); }
  static World world_of(const Scene& scene) { return world_on(backend(), scene, precision()); }
  /// Rounding of numbers about one after some hundred steps.
  static double tolerance() { return precision() == Precision::double_precision ? 1e-10 : 1e-4; }

  static void expect_near(const Vec3d& a, const Vec3d& b, double scale = 1) {
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], tolerance() * scale) << "axis " << k;
  }
};
INSTANTIATE_TEST_SUITE_P(All, Control,
                         ::testing::Combine(::testing::ValuesIn(kBackends),
                                            ::testing::ValuesIn(kPrecisions)),
                         [](const auto& info) {
                           return std::string(name_of(std::get<0>(info.param))) + "_" +
                                  name_of(std::get<1>(info.param));
                         });

/// Two spheres and a box in free flight, far from each other.
Scene flying_bodies() {
  Scene scene = empty_scene(kControlStep, 0.3);
  scene.precision = "float";
  solve_to(scene, 1e-6);
  add_sphere(scene, {0, 0, 0}, 0.1, 2);
  add_sphere(scene, {5, 0, 0}, 0.1, 4).velocity = {0, 0, 1};
  add_box(scene, {0, 5, 0}, {0.1, 0.2, 0.3}, 3);
  scene.bodies[1].locks = lock_y | lock_rx;
  return scene;
}

TEST_P(Control, VelocitiesOfFreeBodies) {
  World world = world_of(flying_bodies());
  world.run(0.1);
  const BodyStates before = world.states();
  world.set_velocity(1, {1, 2, 3}, {4, 5, 6});
  const BodyStates after = world.states();
  expect_near(after.velocity[1], {1, 0, 3});
  expect_near(after.angular_velocity[1], {0, 5, 6});
  for (const std::size_t other : {0u, 2u}) {
    EXPECT_EQ(after.velocity[other], before.velocity[other]);
    EXPECT_EQ(after.position[other], before.position[other]);
  }
  world.step();
  expect_near(world.states().velocity[1], {1, 0, 3 - kGravity * kControlStep});
}

TEST_P(Control, ForcesActInOneStep) {
  Scene scene = flying_bodies();
  scene.gravity = {};
  World world = world_of(scene);
  world.apply_force(0, {200, 0, 0});
  world.apply_force(0, {0, 400, 0}, {0, 0, 1});
  world.apply_force(1, {0, 100, 40}, {7, 0, 0});  // y and rx are locked
  world.apply_force(2, {}, {0, 0, 5});
  world.run(0.01);
  const BodyStates s = world.states();
  const double moment = 0.4 * 2 * 0.1 * 0.1, box = 3 * (0.04 + 0.16) / 12;
  expect_near(s.velocity[0], {0.1, 0.2, 0});
  expect_near(s.angular_velocity[0], {0, 0, kControlStep / moment});
  expect_near(s.velocity[1], {0, 0, 1 + 0.01});
  expect_near(s.angular_velocity[1], {});
  expect_near(s.angular_velocity[2], {0, 0, kControlStep * 5 / box});
}

TEST_P(Control, ForcesOfTheNextStepBelongToTheState) {
  Scene scene = flying_bodies();
  scene.gravity = {};
  World world = world_of(scene);
  const WorldState without = world.save();
  world.apply_force(0, {200, 0, 0}, {0, 0, 1});
  const WorldState with = world.save();
  world.restore(without);
  world.step();
  expect_near(world.states().velocity[0], {});
  expect_near(world.states().angular_velocity[0], {});
  World other = world_of(scene);
  other.apply_force(0, {0, 999, 0});  // of another state
  other.restore(with);
  other.step();
  expect_near(other.states().velocity[0], {0.1, 0, 0});
  other.step();
  expect_near(other.states().velocity[0], {0.1, 0, 0});
}

TEST_P(Control, AppliedForcesAddToArrays) {
  if (backend() != BackendKind::cpu) GTEST_SKIP() << "writes the array from the host";
  Scene scene = flying_bodies();
  scene.gravity = {};
  World world = world_of(scene);
  const ArrayView force = world.array("force");
  const auto set = [&](auto* rows) { rows[3 * 0 + 2] = 20; };
  if (precision() == Precision::double_precision)
    set(static_cast<double*>(force.data));
  else
    set(static_cast<float*>(force.data));
  world.apply_force(0, {0, 0, 100});
  world.step();
  expect_near(world.states().velocity[0], {0, 0, 0.06});
  world.run(0.009);
  expect_near(world.states().velocity[0], {0, 0, 0.15});
}

TEST_P(Control, GravityAndTheForceOnAFloor) {
  Scene scene = empty_scene(kControlStep, 0.3);
  solve_to(scene, 1e-6);
  scene.groups = {"ground", "grain"};
  add_plane(scene);
  add_sphere(scene, {0, 0, 0.1}, 0.1, 2).group = 1;
  scene.body_names = {{"floor", 0}, {"ball", 1}};
  World world = world_of(scene);
  world.track_forces();
  expect_near(world.force_on(0).force, {});
  world.run(0.01);
  EXPECT_NEAR(world.force_on(world.body("floor")).force.z, -2 * kGravity, 1e-2);
  world.set_gravity({0, 0, -3});
  world.run(0.01);
  EXPECT_NEAR(world.force_on(0).force.z, -6, 1e-2);
  EXPECT_NEAR(world.force_on_group("grain").force.z, 6, 1e-2);
  // Of the last step, whatever the mean is over.
  EXPECT_NEAR(world.take_forces().on_bodies[0].force.z, -kGravity - 3, 1e-1);
  world.set_gravity({0, 0, 3});
  world.run(0.1);
  expect_near(world.force_on(0).force, {});
  EXPECT_NEAR(world.states().velocity[1].z, 0.3, 1e-3);
}

/// A paddle that a program drives, with a mixture of motions. It is turned first.
Scene paddle_scene(Motion::Kind kind) {
  Scene scene = flying_bodies();
  BodyDescription& paddle = add_wall_box(scene, {1, 2, -3}, {0.1, 0.2, 0.3}, BodyKind::kinematic);
  Motion motion;
  motion.kind = kind;
  motion.center = {1, 1, -3};
  motion.rate = 0.5 * kPi;
  motion.velocity = {1, 0, 0};
  motion.times = {0, 1};
  motion.positions = {{0, 0, 0}, {0, 0, 1}};
  paddle.motion = motion;
  scene.body_names = {{"paddle", 3}};
  return scene;
}

TEST_P(Control, MotionsFollowEachOther) {
  World world = world_of(paddle_scene(Motion::Kind::rotating));
  const int paddle = world.body("paddle");
  const auto at = [&] { return world.states().position[static_cast<std::size_t>(paddle)]; };
  const auto facing = [&] {
    return rotate(world.states().orientation[static_cast<std::size_t>(paddle)], Vec3d{1, 0, 0});
  };
  world.run(1);  // a quarter turn about z through (1, 1)
  expect_near(at(), {0, 1, -3}, 10);
  expect_near(facing(), {0, 1, 0}, 10);
  world.set_velocity(paddle, {0, 0, 2}, {0, 0, 0.5 * kPi});
  expect_near(world.states().velocity[3], {0, 0, 2}, 10);
  world.run(0.5);  // an eighth about its own center
  expect_near(at(), {0, 1, -2}, 10);
  expect_near(facing(), {-std::sqrt(0.5), std::sqrt(0.5), 0}, 10);
  Motion swing;
  swing.kind = Motion::Kind::oscillating;
  swing.axis = {1, 0, 0};
  swing.amplitude = 0.3;
  swing.frequency = 1;
  swing.start = 0.1;
  world.set_motion(paddle, swing);
  world.run(0.35);  // 0.25 s of the motion: its crest
  expect_near(at(), {0.3, 1, -2}, 10);
  expect_near(facing(), {-std::sqrt(0.5), std::sqrt(0.5), 0}, 10);
  world.set_velocity(paddle, {});
  world.run(0.2);
  expect_near(at(), {0.3, 1, -2}, 10);
}

TEST_P(Control, PushesWhatIsInItsWay) {
  Scene scene = empty_scene(kControlStep, 0);
  solve_to(scene, 1e-6);
  add_plane(scene);
  add_wall_box(scene, {-0.2, 0, 0.1}, {0.1, 0.1, 0.1}, BodyKind::kinematic).motion = Motion{};
  add_sphere(scene, {0, 0, 0.1}, 0.1, 2);
  World world = world_of(scene);
  world.run(0.1);
  expect_near(world.states().velocity[2], {});
  world.set_velocity(1, {0.7, 0, 0});
  world.run(0.1);
  EXPECT_NEAR(world.states().velocity[2].x, 0.7, 1e-3);
  EXPECT_NEAR(world.states().position[2].x, 0.07, 2e-3);
}

/// A state holds what programs set: it goes on bit for bit in another World, and through a file.
TEST_P(Control, IsPartOfASavedState) {
  for (const Motion::Kind kind : {Motion::Kind::rotating, Motion::Kind::linear,
                                  Motion::Kind::oscillating, Motion::Kind::sampled}) {
    const Scene scene = paddle_scene(Motion::Kind::rotating);
    World world = world_of(scene);
    world.run(0.05);
    const WorldState untouched = world.save();
    Motion motion = *paddle_scene(kind).bodies[3].motion;
    motion.amplitude = 0.1;
    motion.frequency = 2;
    motion.angular_velocity = {0, 1, 0};
    motion.orientations = {Quatd{}, exp_map(Vec3d{0, 0, 1})};
    world.set_motion(3, motion);
    world.set_gravity({1, 2, 3});
    world.run(0.05);

    const test::ScratchDirectory scratch;
    const std::filesystem::path file = scratch / "checkpoint.h5";
    write_checkpoint(file, world.save(), world.constants(), "", backend(), precision());
    World resumed = world_of(scene);
    restore_from(file, read_checkpoint(file), resumed);
    EXPECT_EQ(state_hash(resumed.states()), state_hash(world.states()));
    world.run(0.05), resumed.run(0.05);
    EXPECT_EQ(state_hash(resumed.states()), state_hash(world.states()));

    // And a state without them takes a World back to what the scene says.
    World scripted = world_of(scene);
    scripted.run(0.2);
    world.restore(untouched);
    world.run(0.15);
    EXPECT_EQ(state_hash(world.states()), state_hash(scripted.states()));
  }
}

TEST_P(Control, AStateOfAnotherSceneIsRefusedAndChangesNothing) {
  Scene scene = paddle_scene(Motion::Kind::rotating);
  World other = world_of(scene);
  other.set_motion(3, *paddle_scene(Motion::Kind::linear).bodies[3].motion);
  other.run(0.05);
  const WorldState state = other.save();
  scene.bodies[3].kind = BodyKind::fixed;
  scene.bodies[3].motion = Motion{};
  World world = world_of(scene);
  world.run(0.01);
  const std::uint64_t before = state_hash(world.states());
  EXPECT_THAT(refusal([&] { world.restore(state); }), HasSubstr("body 3 is not kinematic"));
  EXPECT_EQ(state_hash(world.states()), before);
}

TEST_P(Control, RunCallsBackAndEndsWhenAskedTo) {
  World world = world_of(flying_bodies());
  int calls = 0;
  const StepReport last = world.run(0.02, [&](const StepReport& report) {
    ++calls;
    EXPECT_EQ(report.step, calls);
    EXPECT_EQ(world.steps_done(), calls);  // the World may be read, and told what to do
    world.set_velocity(0, {0, 0, 0});
    return calls < 7;
  });
  EXPECT_EQ(calls, 7);
  EXPECT_EQ(last.step, 7);
  expect_near(world.states().velocity[0], {});
  world.run(0);
  EXPECT_EQ(world.steps_done(), 7);
  EXPECT_THAT(refusal([&] { world.run(-1); }), HasSubstr("run(): -1"));
}

TEST_P(Control, RefusesWhatCannotBe) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Scene scene = flying_bodies();
  scene.bodies.erase(scene.bodies.begin() + 2);  // whole spheres only
  scene.bodies[1].locks = 0;
  add_plane(scene);
  add_wall_box(scene, {0, 0, -9}, {1, 1, 1}, BodyKind::kinematic).motion = Motion{};
  scene.body_names = {{"plate", 3}};
  World world = world_of(scene);
  EXPECT_THAT(refusal([&] { world.body("plat"); }),
              HasSubstr("no body is called \"plat\"; there are \"plate\""));
  EXPECT_THAT(refusal([&] { world.set_velocity(4, {}); }),
              HasSubstr("body 4 is not in the simulation"));
  EXPECT_THAT(refusal([&] { world.set_velocity(-1, {}); }), HasSubstr("body -1 is not in"));
  PictureSettings picture;
  picture.width = -5;
  EXPECT_THAT(refusal([&] { world.render(picture); }),
              HasSubstr("output.picture.width: -5 is not allowed: must be from 16 to 16384"));
  EXPECT_THAT(refusal([&] {
                world.set_velocity(2, {1, 0, 0});
              }),
              HasSubstr("body 2 is fixed: only free and kinematic bodies have a velocity"));
  EXPECT_THAT(refusal([&] {
                world.set_velocity(0, {nan, 0, 0});
              }),
              HasSubstr("of body 0 are not allowed"));
  EXPECT_THAT(refusal([&] {
                world.set_velocity(3, {1e300, 0, 0});
              }),
              HasSubstr("body 3: motion.velocity"));
  EXPECT_THAT(refusal([&] {
                world.set_velocity(3, {}, {0, 0, 1});
              }),
              HasSubstr("body 3: a motion that turns"));
  EXPECT_THAT(refusal([&] {
                world.set_gravity({0, nan, 0});
              }),
              HasSubstr("set_gravity(): (0, nan, 0)"));
  EXPECT_THAT(refusal([&] { world.apply_force(3, {1, 0, 0}); }), HasSubstr("body 3 is not free"));
  EXPECT_THAT(refusal([&] { world.apply_force(0, {nan, 0, 0}); }), HasSubstr("must be finite"));
  EXPECT_THAT(refusal([&] { world.force_on(2); }), HasSubstr("force_on() needs track_forces()"));
  world.track_forces();
  EXPECT_THAT(refusal([&] { world.force_on(0); }), HasSubstr("body 0 is free"));
  EXPECT_THAT(refusal([&] { world.force_on_group("x"); }),
              HasSubstr("no group is called \"x\"; there are \"bodies\""));
  Motion bad;
  bad.kind = Motion::Kind::oscillating;
  bad.axis = {1, 1, 0};
  EXPECT_THAT(refusal([&] { world.set_motion(3, bad); }), HasSubstr("body 3: motion.axis"));
  EXPECT_TRUE(world.step().converged);  // nothing of it was taken over
  world.apply_force(0, {1e300, 0, 0});
  EXPECT_THROW(world.step(), RunError);
}

}  // namespace
}  // namespace scree::parity
