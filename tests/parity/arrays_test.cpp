// Arrays that a World hands out, and loads that a program writes there. On every backend there is.

#include <gmock/gmock.h>

#include "host/error.h"
#include "host/state_hash.h"
#include "tests/parity/device_memory.h"
#include "tests/parity/parity.h"

namespace scree::parity {
namespace {

using ::testing::HasSubstr;

class Arrays : public ::testing::TestWithParam<std::tuple<BackendKind, Precision>> {
 protected:
  void SetUp() override {
    std::string reason;
    if (!backend_available(backend(), &reason)) GTEST_SKIP() << "no such backend: " << reason;
  }
  static BackendKind backend() { return std::get<0>(GetParam()); }
  static bool is_single() { return std::get<1>(GetParam()) == Precision::single_precision; }
  static DataType real() { return is_single() ? DataType::float32 : DataType::float64; }
  static World world_of(const Scene& scene) {
    return world_on(backend(), scene, std::get<1>(GetParam()));
  }
};
INSTANTIATE_TEST_SUITE_P(All, Arrays,
                         ::testing::Combine(::testing::ValuesIn(kBackends),
                                            ::testing::ValuesIn(kPrecisions)),
                         [](const auto& info) {
                           return std::string(name_of(std::get<0>(info.param))) + "_" +
                                  name_of(std::get<1>(info.param));
                         });

/// Reads a view row by row, whatever its type and strides.
std::vector<std::vector<double>> rows_of(const ArrayView& v) {
  std::vector<std::vector<double>> rows;
  for (std::int64_t i = 0; i < v.shape[0]; ++i) {
    std::vector<double> row;
    for (std::int64_t k = 0; k < v.shape[1]; ++k) {
      const void* at = static_cast<const char*>(v.data) + i * v.strides[0] + k * v.strides[1];
      const auto number = [&](auto value) {
        read_memory(v, at, &value, sizeof value);
        return static_cast<double>(value);
      };
      switch (v.type) {
        case DataType::float32:
          row.push_back(number(0.0f));
          break;
        case DataType::float64:
          row.push_back(number(0.0));
          break;
        case DataType::int32:
          row.push_back(number(std::int32_t{0}));
          break;
        case DataType::uint8:
          row.push_back(number(std::uint8_t{0}));
          break;
      }
    }
    rows.push_back(row);
  }
  return rows;
}

void write_row(const ArrayView& v, std::int64_t row, const std::vector<double>& values) {
  ASSERT_TRUE(v.writable);
  for (std::size_t k = 0; k < values.size(); ++k) {
    void* at = static_cast<char*>(v.data) + row * v.strides[0] +
               static_cast<std::int64_t>(k) * v.strides[1];
    if (v.type == DataType::float32) {
      const auto value = static_cast<float>(values[k]);
      write_memory(v, at, &value, sizeof value);
    } else {
      write_memory(v, at, &values[k], sizeof values[k]);
    }
  }
}

std::vector<double> numbers(const Vec3d& v) { return {v.x, v.y, v.z}; }

/// Row of a body in the arrays of bodies.
std::int64_t row_of(World& world, int id) {
  const auto ids = rows_of(world.array("id"));
  for (std::size_t i = 0; i < ids.size(); ++i)
    if (ids[i][0] == id) return static_cast<std::int64_t>(i);
  ADD_FAILURE() << "no row of body " << id;
  return 0;
}

/// Spheres of two radii above a floor, which comes first: ids and rows differ.
Scene bed(int count = 60) {
  Scene scene = empty_scene(2e-3, 0.4);
  scene.solver.stop = {};
  scene.solver.max_iterations = 60;
  add_plane(scene);
  add_lattice(scene, count, 5, 5, {0, 0, 0.06}, 0.11, 0.05, 2500, 1);
  scene.bodies[3].shape.radius = 0.04;
  return scene;
}

Scene one_sphere(double mass, double radius, double h = 1e-2) {
  Scene scene = empty_scene(h, 0.5);
  scene.gravity = {};
  add_sphere(scene, {0, 0, 0}, radius, mass);
  return scene;
}

TEST_P(Arrays, ShowTheStatesWithoutACopy) {
  World world = world_of(bed());
  const void* const position = world.array("position").data;
  const void* const velocity = world.array("velocity").data;
  for (int k = 0; k < 70; ++k) world.step();  // more than one reordering
  EXPECT_EQ(world.array("position").data, position);
  EXPECT_EQ(world.array("velocity").data, velocity);
  const ArrayView v = world.array("velocity");
  EXPECT_EQ(v.type, real());
  EXPECT_EQ(v.dimensions, 2);
  EXPECT_EQ(v.shape, (std::array<std::int64_t, 2>{60, 3}));
  EXPECT_EQ(v.strides[0], 3 * v.strides[1]);
  EXPECT_EQ(v.backend, backend());
  EXPECT_EQ(v.stream != nullptr, backend() == BackendKind::cuda);
  EXPECT_EQ(world.array("position").type, DataType::float64);

  const BodyStates states = world.states();
  const auto ids = rows_of(world.array("id")), x = rows_of(world.array("position")), u = rows_of(v),
             q = rows_of(world.array("orientation")), w = rows_of(world.array("angular_velocity"));
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const auto id = static_cast<std::size_t>(ids[i][0]);
    EXPECT_EQ(x[i], numbers(states.position[id]));
    EXPECT_EQ(u[i], numbers(states.velocity[id]));
    EXPECT_EQ(w[i], numbers(states.angular_velocity[id]));
    const Quatd& o = states.orientation[id];
    EXPECT_EQ(q[i], (std::vector<double>{o.w, o.x, o.y, o.z}));
  }
  const auto all = rows_of(world.array("row_id"));
  ASSERT_EQ(all.size(), 61u);
  EXPECT_EQ(all[60][0], 0) << "the floor comes behind the free bodies";
}

TEST_P(Arrays, ShowTheContactsOfTheLastStep) {
  World world = world_of(bed());
  EXPECT_EQ(world.array("contact_gap").shape[0], 0) << "no step yet";
  for (int k = 0; k < 40; ++k) world.step();
  const auto contacts = world.contacts();
  ASSERT_GT(contacts.size(), 20u);
  const auto id = rows_of(world.array("row_id")), a = rows_of(world.array("contact_body_a")),
             b = rows_of(world.array("contact_body_b")), n = rows_of(world.array("contact_normal")),
             gap = rows_of(world.array("contact_gap")),
             impulse = rows_of(world.array("contact_impulse"));
  ASSERT_EQ(impulse.size(), contacts.size());
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    EXPECT_EQ(id[static_cast<std::size_t>(a[c][0])][0], contacts[c].body_a);
    EXPECT_EQ(id[static_cast<std::size_t>(b[c][0])][0], contacts[c].body_b);
    EXPECT_EQ(n[c], numbers(contacts[c].normal));
    EXPECT_EQ(gap[c][0], contacts[c].gap);
    EXPECT_EQ(impulse[c], numbers(contacts[c].impulse));
  }
  world.overlaps();
  EXPECT_EQ(world.array("contact_impulse").shape[0], 0) << "not of a step";
  EXPECT_TRUE(world.contacts().empty());
}

TEST_P(Arrays, ContactsAreThoseOfTheLastStepOrNone) {
  World world = world_of(bed());
  for (int k = 0; k < 40; ++k) world.step();
  const WorldState earlier = world.save();
  for (int k = 0; k < 40; ++k) world.step();  // the order of the bodies changes between
  EXPECT_FALSE(world.contacts().empty());
  world.restore(earlier);
  EXPECT_TRUE(world.contacts().empty());
  world.step();
  EXPECT_FALSE(world.contacts().empty());
  world.arrays_changed(Written::poses);
  EXPECT_TRUE(world.contacts().empty());
}

TEST_P(Arrays, AStepThatFailsLeavesNoContacts) {
  Scene scene = bed();
  scene.materials[0].restitution = 0.5;
  World world = world_of(scene);
  while (world.steps_done() < 64) world.step();  // the next one sorts the bodies
  world.arrays_changed(Written::velocities);
  write_row(world.array("force"), 7, {0, std::nan(""), 0});
  EXPECT_THROW(world.step(), RunError);
  EXPECT_TRUE(world.contacts().empty());
}

TEST_P(Arrays, OfConstantsThatAllShareHaveNoStride) {
  Scene scene = bed();
  World different = world_of(scene);
  EXPECT_GT(different.array("radius").strides[0], 0);
  const auto radius = rows_of(different.array("radius"));
  EXPECT_NEAR(radius[static_cast<std::size_t>(row_of(different, 3))][0], 0.04, 1e-8);
  EXPECT_NEAR(radius[static_cast<std::size_t>(row_of(different, 4))][0], 0.05, 1e-8);

  World same = world_of(one_sphere(4, 0.1));
  const ArrayView mass = same.array("inverse_mass");
  EXPECT_EQ(mass.strides[0], 0);
  EXPECT_EQ(mass.shape[0], 1);
  EXPECT_EQ(mass.dimensions, 1);
  EXPECT_FALSE(mass.writable);
  EXPECT_EQ(rows_of(mass)[0][0], 0.25);
  EXPECT_EQ(same.array("inverse_mass").data, mass.data);
}

TEST_P(Arrays, UnknownOnesAreRefusedWithTheNames) {
  World world = world_of(one_sphere(1, 0.1));
  for (const ArrayInfo& info : world.arrays()) {
    EXPECT_EQ(world.array(info.name).writable, info.writable) << info.name;
    EXPECT_FALSE(info.unit.empty() || info.meaning.empty()) << info.name;
  }
  try {
    world.array("velocities");
    FAIL() << "not refused";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("\"velocities\""));
    EXPECT_THAT(error.what(), HasSubstr("velocity, angular_velocity, id"));
    EXPECT_THAT(error.what(), HasSubstr("contact_impulse"));
  }
}

TEST_P(Arrays, VelocitiesWrittenAreThoseOfTheNextStep) {
  World world = world_of(one_sphere(1, 0.1));
  world.step();
  write_row(world.array("velocity"), 0, {2, 0, -1});
  write_row(world.array("angular_velocity"), 0, {0, 0, 0.5});
  world.arrays_changed(Written::velocities);
  world.step();
  const BodyStates s = world.states();
  EXPECT_EQ(numbers(s.velocity[0]), (std::vector<double>{2, 0, -1}));
  EXPECT_NEAR(s.position[0].x, 2e-2, 1e-9);
  EXPECT_NEAR(s.position[0].z, -1e-2, 1e-9);
  EXPECT_NEAR(rotation_angle(s.orientation[0]), 5e-3, 1e-6);
}

TEST_P(Arrays, ABodyPutElsewhereTouchesWhatIsThere) {
  // Two heaps far from each other; a sphere of one is put above the other and lands there.
  Scene scene = bed(30);
  add_sphere(scene, {40, 0, 0.05}, 0.05, 1);
  World world = world_of(scene);
  for (int k = 0; k < 100; ++k) world.step();
  const double top = [&] {
    double z = 0;
    for (const Vec3d& x : world.states().position) z = std::max(z, x.z);
    return z;
  }();
  write_row(world.array("position"), row_of(world, 31), {0.22, 0.22, top + 0.2});
  write_row(world.array("orientation"), row_of(world, 31), {0, 0, 2, 0});
  world.arrays_changed(Written::poses);
  EXPECT_EQ(numbers(world.states().orientation[31].vec()), (std::vector<double>{0, 1, 0}));
  EXPECT_EQ(world.array("contact_gap").shape[0], 0) << "they were of the old places";
  bool has_hit = false;
  for (int k = 0; k < 150; ++k) {
    world.step();
    for (const ContactRecord& c : world.contacts())
      has_hit = has_hit || (c.body_b == 31 && c.body_a > 0) || (c.body_a == 31 && c.body_b > 0);
  }
  EXPECT_TRUE(has_hit) << "fell through the heap";
}

TEST_P(Arrays, WrittenStatesThatNoBodyCanHaveAreRefused) {
  const auto refused = [&](const char* array, const std::vector<double>& values, Written what) {
    World world = world_of(one_sphere(1, 0.1));
    write_row(world.array(array), 0, values);
    EXPECT_THROW(world.arrays_changed(what), InputError) << array;
  };
  refused("velocity", {std::nan(""), 0, 0}, Written::velocities);
  refused("angular_velocity", {0, 1e30, 0}, Written::velocities);
  refused("position", {0, 0, 1e20}, Written::poses);
  refused("orientation", {0, 0, 0, 0}, Written::poses);
}

TEST_P(Arrays, WhatIsNotWrittenKeepsItsBits) {
  World plain = world_of(bed()), asked = world_of(bed());
  for (int k = 0; k < 30; ++k) {
    plain.step();
    for (const ArrayInfo& info : asked.arrays())
      if (info.name != "force" && info.name != "torque") asked.array(info.name);
    asked.arrays_changed(Written::velocities);
    asked.step();
    ASSERT_EQ(state_hash(plain.states()), state_hash(asked.states())) << "step " << k;
  }
}

TEST_P(Arrays, AConstantForceMovesABodyAsGravityWould) {
  // h sums to x = f t^2 / 2 m (1 + h / t), which the discrete step has exactly.
  const double mass = 0.5, h = 1e-2;
  Scene heavy = one_sphere(mass, 0.1, h);
  heavy.gravity = {3, 0, -8};
  World pulled = world_of(heavy), pushed = world_of(one_sphere(mass, 0.1, h));
  write_row(pushed.array("force"), 0, {1.5, 0, -4});
  const int steps = 200;
  for (int k = 0; k < steps; ++k) pulled.step(), pushed.step();
  const double t = steps * h;
  const Vec3d closed = 0.5 * t * t * (1 + h / t) * Vec3d{3, 0, -8};
  const double tolerance = is_single() ? 3e-5 : 1e-13;
  const BodyStates with_force = pushed.states(), with_gravity = pulled.states();
  EXPECT_NEAR(norm(with_force.position[0] - closed) / norm(closed), 0, tolerance);
  EXPECT_NEAR(norm(with_force.position[0] - with_gravity.position[0]) / norm(closed), 0, tolerance);
}

TEST_P(Arrays, ATorqueSpinsABody) {
  const double mass = 2, radius = 0.1, moment = 0.4 * mass * radius * radius, h = 1e-2;
  World ball = world_of(one_sphere(mass, radius, h));
  write_row(ball.array("torque"), 0, {0, 0, 1e-3});
  for (int k = 0; k < 100; ++k) ball.step();
  EXPECT_NEAR(ball.states().angular_velocity[0].z / (1e-3 / moment), 1, 1e-5);

  // A box about its axes, turned by a quarter about z: its x moment acts along y.
  Scene scene = empty_scene(h, 0.5);
  scene.gravity = {};
  add_box(scene, {}, {0.1, 0.2, 0.3}, 3).orientation = {std::sqrt(0.5), 0, 0, std::sqrt(0.5)};
  const Vec3d moments = scene.bodies[0].inertia;
  World box = world_of(scene);
  write_row(box.array("torque"), 0, {0, 1e-3, 0});
  box.step();
  EXPECT_NEAR(box.states().angular_velocity[0].y / (h * 1e-3 / moments.x), 1, 1e-5);
  EXPECT_NEAR(box.states().angular_velocity[0].x, 0, 1e-9);
}

TEST_P(Arrays, LoadsStayWithTheirBodies) {
  // By id: while bodies change places in storage, and for bodies that join later.
  Scene scene = bed(40);
  scene.gravity = {};
  scene.insertions.push_back({0.05, {sphere({0.2, 0.2, 3}, 0.05, 2)}, {}});
  World world = world_of(scene);
  const ArrayView force = world.array("force");
  EXPECT_EQ(force.shape[0], 42);
  for (int id = 0; id < 42; ++id) write_row(force, id, {0, 0, 0});
  write_row(force, 0, {0, 0, 1e6});  // the floor is fixed
  write_row(force, 41, {6, 0, 0});
  write_row(force, 40, {0, 0, 12});  // of the top layer
  const double mass = 4.0 / 3 * kPi * 1.25e-4 * 2500;
  for (int k = 0; k < 150; ++k) world.step();
  EXPECT_EQ(world.array("force").data, force.data);
  const BodyStates s = world.states();
  EXPECT_NEAR(s.velocity[40].z, 12 / mass * 0.3, 1e-4);
  EXPECT_NEAR(s.velocity[41].x, 6.0 / 2 * 0.25, 1e-4);
  EXPECT_EQ(norm(s.velocity[0]), 0);
  EXPECT_EQ(norm(s.velocity[20]), 0);
}

TEST_P(Arrays, ALoadedBodyRestsWhereGravityWouldHoldIt) {
  // Pressed onto the floor by a force alone, and held on a slope of the load by friction.
  Scene scene = empty_scene(1e-3, 0.5);
  scene.gravity = {};
  solve_to(scene, is_single() ? 1e-6 : 1e-11);
  add_plane(scene);
  add_box(scene, {0, 0, 0.1}, {0.1, 0.1, 0.1}, 2);
  World world = world_of(scene);
  write_row(world.array("force"), 1, {4, 0, -20});
  for (int k = 0; k < 100; ++k) world.step();
  EXPECT_NEAR(normal_impulse(world, 1), 20 * 1e-3, 2e-6);
  EXPECT_NEAR(world.states().position[1].x, 0, 1e-5);
  write_row(world.array("force"), 1, {14, 0, -20});  // beyond the cone: slides by (14 - 10) / 2
  const double before = world.states().velocity[1].x;
  for (int k = 0; k < 100; ++k) world.step();
  EXPECT_NEAR(world.states().velocity[1].x - before, 2 * 0.1, 2e-3);
}

TEST_P(Arrays, LockedAxesTakeNoLoads) {
  Scene scene = one_sphere(1, 0.1);
  scene.bodies[0].locks = lock_x | lock_rotation;
  World world = world_of(scene);
  write_row(world.array("force"), 0, {5, 1, 0});
  write_row(world.array("torque"), 0, {1, 1, 1});
  for (int k = 0; k < 100; ++k) world.step();
  const BodyStates s = world.states();
  EXPECT_EQ(s.velocity[0].x, 0);
  EXPECT_NEAR(s.velocity[0].y, 1, 1e-5);
  EXPECT_EQ(norm(s.angular_velocity[0]), 0);
}

TEST_P(Arrays, ALoadThatIsNotFiniteStopsTheRunByName) {
  World world = world_of(bed());
  write_row(world.array("force"), 7, {0, std::nan(""), 0});
  try {
    world.step();
    FAIL() << "not refused";
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), HasSubstr("step 1: the force or torque on body 7 "));
  }
}

TEST_P(Arrays, AFastLoadDoesNotPushBodiesThroughAFloor) {
  // In one step the force alone would carry the sphere from above the floor to far below it.
  Scene scene = empty_scene(1e-2, 0.5);
  scene.gravity = {};
  solve_to(scene, is_single() ? 1e-4 : 1e-9);
  add_plane(scene);
  add_sphere(scene, {0, 0, 0.5}, 0.1, 1);
  World world = world_of(scene);
  write_row(world.array("force"), 1, {0, 0, -2e4});  // 2 m in the first step
  world.step();
  EXPECT_NEAR(world.states().position[1].z, 0.1, 1e-5);
}

}  // namespace
}  // namespace scree::parity
