// Bodies that a program adds to a running World and takes out of it, on every backend there is.

#include <gmock/gmock.h>

#include <limits>

#include "host/compounds.h"
#include "host/error.h"
#include "host/hulls.h"
#include "host/io/checkpoint.h"
#include "host/state_hash.h"
#include "shapes/capsule.h"
#include "shapes/compound.h"
#include "shapes/rounded.h"
#include "tests/host/input_files.h"
#include "tests/host/io/output_fixtures.h"
#include "tests/parity/parity.h"

namespace scree::parity {
namespace {

using test::refusal;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kStep = 1e-3;

class ChangingBodies : public ::testing::TestWithParam<std::tuple<BackendKind, Precision>> {
 protected:
  void SetUp() override {
    std::string reason;
    if (!backend_available(backend(), &reason)) GTEST_SKIP() << "no such backend: " << reason;
  }
  static BackendKind backend() { return std::get<0>(GetParam()); }
  static Precision precision() { return std::get<1>(GetParam()); }
  static World world_of(const Scene& scene) { return world_on(backend(), scene, precision()); }
  /// Rounding of numbers about one after some hundred steps.
  static double tolerance() { return precision() == Precision::double_precision ? 1e-9 : 1e-4; }
  /// Writes a force along x into the row of a body [N]. Of a World on the CPU.
  static void push(World& world, int id, double force) {
    const ArrayView rows = world.array("force");
    if (precision() == Precision::double_precision)
      static_cast<double*>(rows.data)[3 * id] = force;
    else
      static_cast<float*>(rows.data)[3 * id] = static_cast<float>(force);
  }
};
INSTANTIATE_TEST_SUITE_P(All, ChangingBodies,
                         ::testing::Combine(::testing::ValuesIn(kBackends),
                                            ::testing::ValuesIn(kPrecisions)),
                         [](const auto& info) {
                           return std::string(name_of(std::get<0>(info.param))) + "_" +
                                  name_of(std::get<1>(info.param));
                         });

BodyDescription free_box(const Vec3d& position, const Vec3d& half_extents, double mass) {
  Scene scene;
  return add_box(scene, position, half_extents, mass);
}

/// Bodies 0 floor, 1 a sphere of 2 kg at rest on it, 2 one far away in free flight.
Scene two_spheres() {
  Scene scene = empty_scene(kStep, 0.3);
  scene.precision = "float";
  solve_to(scene, 1e-7);
  scene.groups = {"ground", "grain"};
  add_plane(scene);
  add_sphere(scene, {0, 0, 0.1}, 0.1, 2).group = 1;
  add_sphere(scene, {5, 0, 3}, 0.1, 1).velocity = {1, 0, 2};
  scene.body_names = {{"ball", 1}};
  return scene;
}

/// 36 spheres that fall into a box; they roll and touch for long.
Scene falling_heap() {
  Scene scene = empty_scene(2e-3, 0.4);
  scene.precision = "float";
  solve_to(scene, 1e-5);
  add_tank(scene, -0.2, 0.2, -0.2, 0.2);
  add_lattice(scene, 36, 3, 3, {-0.1, -0.1, 0.06}, 0.1, 0.045, 1000, 7);
  return scene;
}

/// State of a body, as bits.
std::uint64_t hash_of(const BodyStates& s, std::size_t begin, std::size_t end) {
  BodyStates part;
  const auto cut = [&](const auto& from, auto& to) {
    to.assign(from.begin() + static_cast<std::ptrdiff_t>(begin),
              from.begin() + static_cast<std::ptrdiff_t>(end));
  };
  cut(s.position, part.position);
  cut(s.orientation, part.orientation);
  cut(s.velocity, part.velocity);
  cut(s.angular_velocity, part.angular_velocity);
  return state_hash(part);
}

/// What a state has of contacts.
std::vector<StateArray> contacts_of(const WorldState& s) {
  std::vector<StateArray> found;
  for (const StateArray& array : s.arrays)
    if (array.name.starts_with("contact/")) found.push_back(array);
  return found;
}

TEST_P(ChangingBodies, AnAddedBodyFliesAsDescribed) {
  World world = world_of(two_spheres());
  world.run(0.1);
  BodyDescription body = free_box({-3, 1, 2}, {0.1, 0.2, 0.3}, 3);
  body.velocity = {0, 1, 4};
  body.angular_velocity = {0, 0, 2};
  body.group = world.group("grain");
  EXPECT_EQ(world.add(body, "crate"), 3);
  EXPECT_EQ(world.body("crate"), 3);
  EXPECT_EQ(world.body("ball"), 1);
  EXPECT_EQ(world.body_count(), 4);
  EXPECT_EQ(world.steps_done(), 100);
  EXPECT_EQ(world.states().position[3], body.position);
  EXPECT_EQ(world.constants()[3].mass, 3);
  EXPECT_EQ(world.constants()[3].group, 1);
  const int steps = 200;
  StepReport report;
  for (int k = 0; k < steps; ++k) report = world.step();
  EXPECT_EQ(report.body_count, 3);
  EXPECT_NEAR(world.time(), 0.3, 1e-12);
  const BodyStates s = world.states();
  // Velocity first: the sum over steps of h (v0 - k g h).
  const double t = steps * kStep;
  const auto height = [&](double z, double v, double steps_done) {
    const double time = steps_done * kStep;
    return z + v * time - 0.5 * kGravity * time * (time + kStep);
  };
  EXPECT_NEAR(s.position[3].z, height(2, 4, steps), tolerance());
  EXPECT_NEAR(s.position[3].y, 1 + t, tolerance());
  EXPECT_NEAR(rotation_angle(s.orientation[3]), 2 * t, tolerance());
  EXPECT_NEAR(s.position[2].z, height(3, 2, 300), tolerance());
  EXPECT_NEAR(s.position[2].x, 5.3, tolerance());
}

TEST_P(ChangingBodies, WeightComesAndGoes) {
  World world = world_of(two_spheres());
  world.track_forces();
  world.run(0.05);
  const auto weight = [&](double mass) {
    EXPECT_NEAR(world.force_on(0).force.z, -mass * kGravity, 1e-2);
  };
  weight(2);
  const std::vector<StateArray> before = contacts_of(world.save());
  const int box = world.add(free_box({1, 0, 0.05}, {0.1, 0.1, 0.05}, 3), "box");
  weight(2);  // the last step was before it came
  EXPECT_TRUE(world.contacts().empty());
  const std::vector<StateArray> after = contacts_of(world.save());
  ASSERT_EQ(after.size(), before.size());
  world.run(0.05);
  weight(5);
  const int ball = world.add(sphere({1, 0, 0.2}, 0.1, 4));
  EXPECT_EQ(ball, box + 1);
  world.run(0.05);
  weight(9);
  world.remove(box);
  EXPECT_FALSE(world.has_body(box));
  EXPECT_TRUE(world.has_body(ball));
  EXPECT_EQ(world.body_count(), 4);
  EXPECT_EQ(world.id_end(), 5);
  EXPECT_THAT(refusal([&] { world.body("box"); }), HasSubstr("no body is called \"box\""));
  world.step();
  weight(2);  // the ball falls
  for (const ContactRecord& c : world.contacts()) {
    EXPECT_NE(c.body_a, box);
    EXPECT_NE(c.body_b, box);
  }
  EXPECT_TRUE(std::isnan(world.states().position[static_cast<std::size_t>(box)].x));
  EXPECT_LT(world.states().velocity[static_cast<std::size_t>(ball)].z, -0.5 * kStep * kGravity);
  world.run(0.5);
  weight(6);
}

TEST_P(ChangingBodies, ImpulsesOfTheOthersStay) {
  World world = world_of(falling_heap());
  world.run(1);
  const WorldState before = world.save();
  const int id = world.add(sphere({0, 0, 5}, 0.045, 0.3));
  const WorldState with = world.save();
  EXPECT_EQ(with.at<Vec3d>("contact/impulse"), before.at<Vec3d>("contact/impulse"));
  EXPECT_EQ(with.at<std::int32_t>("contact/body_a"), before.at<std::int32_t>("contact/body_a"));
  EXPECT_EQ(with.at<std::int32_t>("contact/body_b"), before.at<std::int32_t>("contact/body_b"));
  EXPECT_EQ(with.at<std::uint64_t>("contact/feature"), before.at<std::uint64_t>("contact/feature"));
  EXPECT_GT(before.at<Vec3d>("contact/impulse").size(), 40u);
  // One that lies among others goes with its contacts alone.
  const int gone = before.at<std::int32_t>("contact/body_a")[10];
  world.remove_all(std::vector<int>{gone, id});
  const WorldState without = world.save();
  std::vector<Vec3d> expected;
  for (std::size_t c = 0; c < before.at<Vec3d>("contact/impulse").size(); ++c)
    if (before.at<std::int32_t>("contact/body_a")[c] != gone &&
        before.at<std::int32_t>("contact/body_b")[c] != gone)
      expected.push_back(before.at<Vec3d>("contact/impulse")[c]);
  EXPECT_LT(expected.size(), before.at<Vec3d>("contact/impulse").size());
  EXPECT_THAT(without.at<Vec3d>("contact/impulse"), ::testing::UnorderedElementsAreArray(expected));
}

TEST_P(ChangingBodies, OthersKeepTheirBits) {
  const Scene scene = falling_heap();
  World alone = world_of(scene);
  alone.run(1);
  for (int repeat = 0; repeat < 2; ++repeat) {
    World world = world_of(scene);
    world.run(0.1);
    BodyDescription visitor = sphere({0.1, 0, 9}, 0.06, 2);
    const int first = world.add(visitor, "visitor");
    world.run(0.3);
    visitor.position = {-0.1, 0.1, 40};
    const int second = world.add(visitor);
    world.run(0.2);
    world.remove(world.body("visitor"));
    world.run(0.2);
    world.remove(second);
    world.run(0.2);
    EXPECT_EQ(world.steps_done(), alone.steps_done());
    EXPECT_EQ(world.id_end(), second + 1);
    EXPECT_EQ(hash_of(world.states(), 0, static_cast<std::size_t>(first)),
              state_hash(alone.states()));
  }
}

TEST_P(ChangingBodies, TheSameCallsGiveTheSameBits) {
  const auto play = [&] {
    World world = world_of(falling_heap());
    world.run(0.3);
    std::vector<BodyDescription> more;
    for (int k = 0; k < 5; ++k) more.push_back(sphere({0.08 * k - 0.16, 0, 0.6}, 0.035, 0.2));
    const std::vector<int> ids = world.add_all(more);
    world.add(free_box({0, 0.1, 0.7}, {0.03, 0.04, 0.02}, 0.3));
    world.run(0.3);
    world.remove_all(std::vector<int>{7, ids[2]});
    world.run(0.3);
    return hash_of(world.states(), 0, 7);
  };
  EXPECT_EQ(play(), play());
}

TEST_P(ChangingBodies, AStateHoldsThem) {
  const Scene scene = falling_heap();
  World world = world_of(scene);
  world.run(0.2);
  const WorldState earlier = world.save();
  const int box = world.add(free_box({0, 0.1, 0.7}, {0.03, 0.04, 0.02}, 0.3), "box");
  const int ball = world.add(sphere({0, -0.1, 0.7}, 0.05, 0.4), "ball");
  world.remove(12);
  world.run(0.4);
  world.remove(ball);
  const test::ScratchDirectory scratch;
  const std::filesystem::path file = scratch / "checkpoint.h5";
  write_checkpoint(file, world.save(), world.constants(), "{}", backend(), precision());
  world.run(0.4);
  const BodyStates expected = world.states();

  World other = world_of(scene);
  other.add(sphere({3, 3, 3}, 0.1, 1), "of another life");
  other.run(0.1);
  restore_from(file, read_checkpoint(file), other);
  EXPECT_EQ(other.body("box"), box);
  EXPECT_EQ(other.id_end(), ball + 1);
  EXPECT_FALSE(other.has_body(12));
  EXPECT_FALSE(other.has_body(ball));
  EXPECT_THAT(refusal([&] { other.body("of another life"); }), HasSubstr("there are \"box\""));
  other.run(0.4);
  const auto same = [&](int begin, int end) {
    EXPECT_EQ(
        hash_of(other.states(), static_cast<std::size_t>(begin), static_cast<std::size_t>(end)),
        hash_of(expected, static_cast<std::size_t>(begin), static_cast<std::size_t>(end)));
  };
  same(0, 12);
  same(13, ball);
  // Back to where nothing had come or gone.
  other.restore(earlier);
  EXPECT_TRUE(other.has_body(12));
  EXPECT_EQ(other.id_end(), box);
  World fresh = world_of(scene);
  fresh.run(0.5);
  other.run(0.3);
  EXPECT_EQ(state_hash(other.states()), state_hash(fresh.states()));
}

TEST_P(ChangingBodies, AStateThatIsNoneIsRefusedAndChangesNothing) {
  const Scene scene = two_spheres();
  World world = world_of(scene);
  world.add(sphere({0, 0, 5}, 0.1, 1), "guest");
  world.remove(1);
  const WorldState good = world.save();
  world.run(0.01);
  World alike = world_of(scene);
  alike.restore(good);
  alike.run(0.01);
  const auto refused = [&](auto change) {
    WorldState bad = good;
    change(bad);
    return refusal([&] { world.restore(bad); });
  };
  const auto integers = [](WorldState & s) -> auto& { return s.at<std::int32_t>("added/integer"); };
  EXPECT_THAT(refused([&](auto& s) { integers(s).pop_back(); }), HasSubstr("values of 1 bodies"));
  EXPECT_THAT(refused([&](auto& s) { integers(s)[0] = 77; }), HasSubstr("shape: number 77"));
  EXPECT_THAT(refused([&](auto& s) { integers(s)[0] = 1000; }), HasSubstr("shape number 1000"));
  EXPECT_THAT(refused([&](auto& s) { integers(s)[3] = 9; }), HasSubstr("material: 9"));
  EXPECT_THAT(refused([](auto& s) { s.template at<double>("added/number")[2] = -1; }),
              HasSubstr("mass: -1"));
  for (const std::vector<std::int32_t>& removed :
       {std::vector<std::int32_t>{1, 1}, {1, 0}, {1, 44}, {1, -2}})
    EXPECT_THAT(refused([&](auto& s) { s.template at<std::int32_t>("added/removed") = removed; }),
                HasSubstr("cannot have been removed"));
  for (const std::vector<std::int32_t>& name :
       {std::vector<std::int32_t>{0}, {3, 1, 'a'}, {0, 9, 'a'}, {0, 0}})
    EXPECT_THAT(refused([&](auto& s) { s.template at<std::int32_t>("added/name") = name; }),
                HasSubstr("of their names is not one"));
  EXPECT_NE(refused([](auto& s) { s.template at<std::int32_t>("body/id").pop_back(); }),
            "no error");
  EXPECT_EQ(world.body("guest"), 3);
  EXPECT_FALSE(world.has_body(1));
  EXPECT_EQ(hash_of(world.states(), 2, 4), hash_of(alike.states(), 2, 4));
  world.run(0.01), alike.run(0.01);
  EXPECT_EQ(hash_of(world.states(), 2, 4), hash_of(alike.states(), 2, 4));
}

/// Rounded bodies have more numbers; the tracking of forces is not in a state, and stays. Loads of the next step are those of
/// the state.
TEST_P(ChangingBodies, AStateOfOtherBodiesComesBack) {
  World world = world_of(two_spheres());
  world.track_forces();
  BodyDescription body = free_box({2, 0, 0.3}, {0.1, 0.1, 0.1}, 1);
  body.shape = shapes::Rounded::of(body.shape, 0.05);
  set_mass_from_density(body, 500);
  const int box = world.add(body);
  world.run(0.1);
  const WorldState state = world.save();
  world.run(0.3);
  const BodyStates expected = world.states();
  world.take_forces();
  world.restore(state);
  world.run(0.3);
  EXPECT_EQ(state_hash(world.states()), state_hash(expected));
  EXPECT_NEAR(world.states().position[static_cast<std::size_t>(box)].z, 0.15, 1e-3);
  EXPECT_NO_THROW(world.take_forces());
  const auto gained = [&](const WorldState& from) {
    world.restore(from);
    const Vec3d before = world.states().velocity[static_cast<std::size_t>(box)];
    world.step();
    return world.states().velocity[static_cast<std::size_t>(box)].x - before.x;
  };
  world.restore(state);
  world.apply_force(box, {200, 0, 0});
  const WorldState loaded = world.save();
  EXPECT_NEAR(gained(state), 0, 1e-3);
  world.add(sphere({9, 0, 3}, 0.1, 1));
  EXPECT_NEAR(gained(loaded), 200 * kStep / body.mass, 1e-3);
}

TEST_P(ChangingBodies, LoadsStayWithTheirBodies) {
  Scene scene = two_spheres();
  scene.gravity = {};
  scene.bodies[2].velocity = {};
  World world = world_of(scene);
  world.apply_force(2, {0, 300, 0});
  const int third = world.add(sphere({9, 0, 3}, 0.1, 1));
  world.apply_force(third, {500, 0, 0});
  world.apply_force(1, {0, 0, 800});
  world.remove(1);
  world.step();
  const BodyStates s = world.states();
  EXPECT_NEAR(s.velocity[2].y, 0.3, tolerance());
  EXPECT_NEAR(s.velocity[static_cast<std::size_t>(third)].x, 0.5, tolerance());
  if (backend() != BackendKind::cpu) return;  // writes the array from the host
  ASSERT_EQ(world.array("force").shape[0], 4);
  push(world, 2, 100);
  world.add(sphere({12, 0, 3}, 0.1, 1));
  world.run(0.01);
  EXPECT_NEAR(world.states().velocity[2].x, 1, tolerance());
}

TEST_P(ChangingBodies, AnyShape) {
  Scene scene = empty_scene(kStep, 0.5);
  scene.precision = "float";
  solve_to(scene, 1e-6);
  add_plane(scene);
  add_sphere(scene, {-1, 0, 0.1}, 0.1, 1);
  // Meshes that bodies of the run will have.
  BodyDescription hull, cross;
  set_hull(scene, hull, {{0, 0, 0}, {0.2, 0, 0}, {0, 0.2, 0}, {0, 0, 0.2}, {0.2, 0.2, 0}});
  set_mass_from_density(hull, 500);
  std::vector<ShapePart> parts(2);
  for (ShapePart& part : parts) part.shape.kind = shapes::Box::kind;
  parts[0].shape.half_extents = {0.2, 0.04, 0.04};
  parts[1].shape.half_extents = {0.04, 0.2, 0.04};
  set_compound(scene, cross, parts);
  set_mass_from_density(cross, 500);
  World world = world_of(scene);
  world.track_forces();
  world.run(0.02);
  BodyDescription capsule = free_box({}, {0.05, 0.05, 0.15}, 1);
  capsule.shape.kind = shapes::Capsule::kind;
  set_mass_from_density(capsule, 500);
  double mass = 1;
  double x = 0;
  std::vector<int> ids;
  for (BodyDescription body : {hull, capsule, cross, cross, free_box({}, {0.1, 0.1, 0.1}, 2)}) {
    body.position = {x += 1, 0, 0.3};
    mass += body.mass;
    ids.push_back(world.add(body));
    world.run(0.05);
  }
  world.run(2);
  EXPECT_NEAR(world.force_on(0).force.z, -mass * kGravity, 5e-3 * mass * kGravity);
  // One compound goes; parts of the other keep their names.
  const std::size_t impulses = world.save().at<Vec3d>("contact/impulse").size();
  world.remove(ids[2]);
  const WorldState s = world.save();
  EXPECT_LT(s.at<Vec3d>("contact/impulse").size(), impulses);
  world.step();
  EXPECT_NEAR(world.force_on(0).force.z, -(mass - cross.mass) * kGravity, 5e-3 * mass * kGravity);
  EXPECT_LT(world.states().velocity[static_cast<std::size_t>(ids[3])].z, 1e-3);
}

TEST_P(ChangingBodies, RainGoesOn) {
  Scene scene = two_spheres();
  scene.insertions.push_back({.time = 0.2, .bodies = {sphere({0, 3, 2}, 0.1, 1)}});
  World world = world_of(scene);
  world.run(0.1);
  EXPECT_EQ(world.add(sphere({0, -3, 2}, 0.1, 1)), 4);
  EXPECT_EQ(world.body_count(), 4);
  EXPECT_EQ(world.id_end(), 5);
  EXPECT_FALSE(world.has_body(3));
  EXPECT_TRUE(std::isnan(world.states().position[3].z));
  EXPECT_THAT(refusal([&] { world.remove(3); }), HasSubstr("body 3 is not in the simulation"));
  world.run(0.2);
  EXPECT_EQ(world.body_count(), 5);
  const BodyStates s = world.states();
  const double late = 0.1, early = 0.2;
  EXPECT_NEAR(s.position[3].z, 2 - 0.5 * kGravity * late * (late + kStep), tolerance());
  EXPECT_NEAR(s.position[4].z, 2 - 0.5 * kGravity * early * (early + kStep), tolerance());
  world.remove(3);
  EXPECT_EQ(world.body_count(), 4);
}

TEST_P(ChangingBodies, AStateFromBeforeRainComesBack) {
  Scene scene = two_spheres();
  scene.insertions.push_back({.time = 0.2, .bodies = {sphere({0, 3, 2}, 0.1, 1)}});
  World world = world_of(scene);
  world.run(0.1);
  const WorldState before = world.save();
  world.run(0.2);
  EXPECT_EQ(world.body_count(), 4);
  const std::uint64_t after = state_hash(world.states());
  world.restore(before);
  EXPECT_EQ(world.steps_done(), 100);
  EXPECT_EQ(world.body_count(), 3);
  EXPECT_FALSE(world.has_body(3));
  world.run(0.2);
  EXPECT_EQ(state_hash(world.states()), after);

  WorldOptions options;
  options.backend = backend();
  options.precision = precision();
  options.bodies_may_change = false;
  World fixed(scene, options);
  fixed.run(0.3);
  EXPECT_THAT(refusal([&] { fixed.restore(before); }),
              HasSubstr("is from before bodies were inserted"));
}

TEST_P(ChangingBodies, LoadsOfBodiesToComeStay) {
  if (backend() != BackendKind::cpu) GTEST_SKIP() << "writes the array from the host";
  Scene scene = two_spheres();
  scene.insertions.push_back({.time = 0.2, .bodies = {sphere({0, 3, 2}, 0.1, 1)}});
  World world = world_of(scene);
  push(world, 3, 100);
  world.add(sphere({12, 0, 3}, 0.1, 1));
  world.run(0.3);
  EXPECT_NEAR(world.states().velocity[3].x, 10, 10 * tolerance());
}

TEST_P(ChangingBodies, WhatIsWrongIsRefusedAndChangesNothing) {
  Scene scene = two_spheres();
  scene.joints.push_back({.kind = JointKind::ball, .bodies = {kWorldBody, 2}, .anchor = {5, 0, 3}});
  World world = world_of(scene);
  World alone = world_of(scene);
  world.run(0.05);
  alone.run(0.05);
  const auto added = [&](auto change, const std::string& name = "") {
    BodyDescription body = sphere({0, 0, 5}, 0.1, 1);
    change(body);
    return refusal([&] { world.add(body, name); });
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(added([](auto& b) { b.position.y = kNan; }),
              AllOf(HasSubstr("add(): body 3.position"), HasSubstr("finite")));
  EXPECT_THAT(added([](auto& b) { b.velocity.x = 1e30; }), HasSubstr("add(): body 3.velocity"));
  EXPECT_THAT(added([](auto& b) { b.mass = 0; }), HasSubstr("add(): body 3.mass: 0"));
  EXPECT_THAT(added([](auto& b) { b.mass = 1e30; }), HasSubstr("add(): body 3.mass: 1e+30"));
  EXPECT_THAT(added([](auto& b) { b.shape.radius = -1; }), HasSubstr("add(): body 3.radius: -1"));
  EXPECT_THAT(added([](auto& b) { b.material = 4; }), HasSubstr("add(): body 3.material: 4"));
  EXPECT_THAT(added([](auto& b) { b.group = 2; }), HasSubstr("add(): body 3.group: 2"));
  EXPECT_THAT(added([](auto& b) { b.kind = BodyKind::fixed; }), HasSubstr("add(): body 3.kind"));
  EXPECT_THAT(added([](auto& b) { b.shape.kind = shapes::Mesh::kind; }),
              HasSubstr("add(): body 3.mesh: -1"));
  EXPECT_THAT(added([](auto&) {}, "ball"),
              AllOf(HasSubstr("add(): body 3.name: \"ball\""), HasSubstr("body 1 has that name")));
  EXPECT_THAT(added([](auto&) {}, "world"), HasSubstr("stands for what bodies are fixed to"));
  EXPECT_THAT(refusal([&] {
                world.add_all({sphere({0, 0, 5}, 0.1, 1)}, {"a", "b"});
              }),
              HasSubstr("add_all(): 2 names"));
  EXPECT_THAT(refusal([&] { world.remove(3); }), HasSubstr("body 3 is not in the simulation"));
  EXPECT_THAT(refusal([&] { world.remove(-1); }), HasSubstr("body -1 is not in the simulation"));
  EXPECT_THAT(refusal([&] { world.remove(0); }), HasSubstr("remove(): body 0 is not free"));
  EXPECT_THAT(refusal([&] {
                world.remove_all(std::vector<int>{1, 1});
              }),
              AllOf(HasSubstr("body 1 is"), HasSubstr("twice")));
  EXPECT_THAT(refusal([&] { world.remove(2); }),
              HasSubstr("remove(): body 2 is held by joints[0], a ball"));
  EXPECT_EQ(world.id_end(), 3);
  world.run(0.1);
  alone.run(0.1);
  EXPECT_EQ(state_hash(world.states()), state_hash(alone.states()));
  world.remove(1);
  for (const auto& call : std::vector<std::function<void()>>{
           [&] { world.remove(1); }, [&] { world.apply_force(1, {}); },
           [&] { world.set_velocity(1, {}); }, [&] { world.force_on(1); }})
    EXPECT_THAT(refusal(call), HasSubstr("body 1 is not in the simulation: it was removed"));
  // Its name is free for others.
  EXPECT_EQ(world.add(sphere({0, 0, 5}, 0.1, 1), "ball"), 3);
  EXPECT_EQ(world.body("ball"), 3);
}

TEST_P(ChangingBodies, AWorldMayDoWithout) {
  const Scene scene = two_spheres();
  World world = world_of(scene);
  world.add(sphere({0, 0, 5}, 0.1, 1));
  WorldOptions options;
  options.backend = backend();
  options.precision = precision();
  options.bodies_may_change = false;
  World fixed(scene, options);
  EXPECT_THAT(refusal([&] {
                fixed.add(sphere({0, 0, 5}, 0.1, 1));
              }),
              HasSubstr("add() needs WorldOptions::bodies_may_change"));
  EXPECT_THAT(refusal([&] { fixed.remove(1); }), HasSubstr("remove() needs"));
  EXPECT_THAT(refusal([&] { fixed.restore(world.save()); }),
              HasSubstr("bodies that a program added or removed"));
}

TEST_P(ChangingBodies, TheLastOneMayGo) {
  Scene scene = two_spheres();
  World world = world_of(scene);
  world.run(0.01);
  world.remove_all(std::vector<int>{1, 2});
  EXPECT_EQ(world.body_count(), 1);
  EXPECT_EQ(world.step().contact_count, 0);
  const int id = world.add(sphere({0, 0, 1}, 0.1, 1));
  world.run(0.01);
  EXPECT_NEAR(world.states().velocity[static_cast<std::size_t>(id)].z, -kGravity * 0.01,
              tolerance());
}

}  // namespace
}  // namespace scree::parity
