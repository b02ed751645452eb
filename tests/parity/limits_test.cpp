// The ends of the range, on every backend there is and with every solver that runs on both: no
// contact, one contact, far more contacts than expected, all bodies at one point, states that are
// not finite, and more bodies than memory.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "host/error.h"
#include "tests/parity/parity.h"

namespace scree::parity {
namespace {

class Limits : public ::testing::TestWithParam<std::tuple<BackendKind, Precision, std::string>> {
 protected:
  void SetUp() override {
    std::string reason;
    if (!backend_available(backend(), &reason)) GTEST_SKIP() << "no such backend: " << reason;
  }
  BackendKind backend() const { return std::get<0>(GetParam()); }
  Precision precision() const { return std::get<1>(GetParam()); }
  World world(Scene scene) const {
    scene.solver.name = std::get<2>(GetParam());
    return world_on(backend(), scene, precision());
  }
  double tolerance() const { return precision() == Precision::single_precision ? 1e-6 : 1e-12; }
};
INSTANTIATE_TEST_SUITE_P(
    All, Limits,
    ::testing::Combine(::testing::ValuesIn(kBackends), ::testing::ValuesIn(kPrecisions),
                       ::testing::Values("apgd", "schwarz", "gauss_seidel_colored", "jacobi")),
    [](const auto& info) {
      return std::string(name_of(std::get<0>(info.param))) + "_" +
             name_of(std::get<1>(info.param)) + "_" + std::get<2>(info.param);
    });

TEST_P(Limits, NoContact) {
  Scene scene = empty_scene(1e-3, 0.5);
  add_sphere(scene, {0, 0, 1}, 0.1, 1);
  World w = world(scene);
  const StepReport report = w.step();
  EXPECT_EQ(report.contact_count, 0);
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(report.residual_max_body_a, -1);
  EXPECT_NEAR(w.states().velocity[0].z, -kGravity * 1e-3, tolerance());
  EXPECT_TRUE(w.contacts().empty());
}

TEST_P(Limits, OneContact) {
  Scene scene = empty_scene(1e-3, 0.5);
  solve_to(scene, precision() == Precision::single_precision ? 1e-6 : 1e-12);
  add_sphere(scene, {0, 0, 0.1}, 0.1, 2);
  add_plane(scene);
  World w = world(scene);
  const StepReport report = w.step();
  EXPECT_EQ(report.contact_count, 1);
  EXPECT_TRUE(report.converged);
  EXPECT_NEAR(w.states().velocity[0].z, 0, 10 * tolerance());
  ASSERT_EQ(w.contacts().size(), 1u);
  const ContactRecord c = w.contacts()[0];
  const double up = c.body_b == 0 ? 1 : -1;
  EXPECT_NEAR(up * c.impulse.z, 2 * kGravity * 1e-3, 10 * tolerance());
  EXPECT_NEAR(up * c.normal.z, 1, tolerance());
}

TEST_P(Limits, BodiesCreatedInOnePlace) {
  // Every pair is in contact: 250 bodies have 31125, far beyond the usual six per body.
  const int n = 250;
  Scene scene = empty_scene(1e-3, 0.5);
  scene.solver.max_iterations = 20;
  for (int i = 0; i < n; ++i)
    add_sphere(scene, {1e-3 * (i % 7), 1e-3 * (i % 11), 1e-3 * (i % 13)}, 0.1, 1);
  World w = world(scene);
  EXPECT_EQ(w.step().contact_count, n * (n - 1) / 2);
  EXPECT_EQ(w.contacts().size(), static_cast<std::size_t>(n * (n - 1) / 2));
  for (int k = 0; k < 5; ++k) w.step();
  for (const Vec3d& x : w.states().position) EXPECT_TRUE(is_finite(x));
}

TEST_P(Limits, AllBodiesAtOnePoint) {
  // No distance gives a normal, and every body is in contact with every other.
  const int n = 40;
  Scene scene = empty_scene(1e-3, 0.5);
  scene.solver.max_iterations = 20;
  for (int i = 0; i < n; ++i) add_sphere(scene, {0.25, -0.5, 1}, 0.1, 1);
  World w = world(scene);
  const StepReport first = w.step();
  EXPECT_EQ(first.contact_count, n * (n - 1) / 2);
  EXPECT_NEAR(first.max_penetration, 0.2, 1e-6);
  for (const ContactRecord& c : w.contacts()) EXPECT_NEAR(norm(c.normal), 1, 1e-5);
  for (int k = 0; k < 20; ++k) w.step();
  double apart = 0;
  for (const Vec3d& x : w.states().position) {
    ASSERT_TRUE(is_finite(x));
    apart = std::max(apart, norm(x - w.states().position[0]));
  }
  EXPECT_GT(apart, 1e-3);  // they are pushed out of each other
}

TEST_P(Limits, FiftyNeighborsEachInTheFirstStep) {
  // Spheres created overlapping, on a lattice of 2.3 points a diameter: inside it each touches the
  // 56 that are less than 2.3 points away.
  const int side = 14;
  const double d = 0.02, spacing = d / 2.3;
  Scene scene = empty_scene(1e-3, 0.5);
  scene.solver.max_iterations = 30;
  for (int k = 0; k < side * side * side; ++k) {
    const Vec3d cell{static_cast<double>(k % side), static_cast<double>(k / side % side),
                     static_cast<double>(k / side / side)};
    add_sphere(scene, spacing * cell, d / 2, 0.01);
  }
  int ends = 0;  // of contacts, two each
  for (int z = -2; z <= 2; ++z) {
    for (int y = -2; y <= 2; ++y) {
      for (int x = -2; x <= 2; ++x) {
        if (x * x + y * y + z * z == 0 || spacing * std::sqrt(x * x + y * y + z * z) > d) continue;
        ends += (side - std::abs(x)) * (side - std::abs(y)) * (side - std::abs(z));
      }
    }
  }
  World w = world(scene);
  EXPECT_EQ(w.step().contact_count, ends / 2);
  EXPECT_GT(ends, 35 * side * side * side);
  for (int k = 0; k < 3; ++k) w.step();
  for (const Vec3d& x : w.states().position) EXPECT_TRUE(is_finite(x));
}

TEST_P(Limits, ATimeStepFarTooLargeEnds) {
  // Ten seconds a step: a correct run or a clear message, never a hang.
  Scene scene = empty_scene(10, 0.5);
  scene.solver.max_iterations = 50;
  for (int i = 0; i < 300; ++i)
    add_sphere(scene, {0.21 * (i % 10), 0.21 * (i / 10 % 10), 0.1 + 0.21 * (i / 100)}, 0.1, 1);
  add_plane(scene);
  World w = world(scene);
  try {
    double below = 1e-3;  // residuals are velocities: they move bodies into the floor
    for (int k = 0; k < 5; ++k) {
      below += 10 * w.step().residual_max;
      for (const Vec3d& x : w.states().position) {
        EXPECT_TRUE(is_finite(x));
        EXPECT_GT(x.z, 0.1 - below) << "step " << k;
      }
    }
  } catch (const RunError& error) {
    EXPECT_NE(std::string(error.what()).find("body"), std::string::npos) << error.what();
  }
}

TEST_P(Limits, NoStepIsTooLargeForTheFloor) {
  // A sphere at rest above the floor falls past it within the step: 9.8 m in 1 s, a quarter of a
  // millimeter in 5 ms.
  struct Fall {
    double h, radius, gap;
  };
  for (const Fall& fall : {Fall{1, 0.1, 0.11}, Fall{1, 0.1, 9.7}, Fall{5e-3, 5e-3, 2e-4}}) {
    Scene scene = empty_scene(fall.h, 0.5);
    solve_to(scene, 1e-5 * fall.radius / fall.h);
    add_sphere(scene, {0, 0, fall.radius + fall.gap}, fall.radius, 1);
    add_plane(scene);
    World w = world(scene);
    for (int k = 0; k < 4; ++k) {
      w.step();
      EXPECT_GT(w.states().position[0].z, (1 - 1e-4) * fall.radius) << "gap " << fall.gap;
    }
    EXPECT_NEAR(w.states().position[0].z, fall.radius, 1e-4 * fall.radius);
  }
}

TEST_P(Limits, AVelocityThatIsNotFiniteNamesTheBody) {
  Scene scene = empty_scene(1e-3, 0.5);
  for (int i = 0; i < 50; ++i) add_sphere(scene, {0.205 * i, 0, 0.1}, 0.1, 1);
  add_plane(scene);
  for (const bool touching : {true, false}) {
    if (!touching) scene.bodies.pop_back();
    World w = world(scene);
    w.step();
    WorldState state = w.save();
    const int bad = 17;
    const auto& id = state.at<std::int32_t>("body/id");
    for (std::size_t i = 0; i < id.size(); ++i)
      if (id[i] == bad)
        state.at<Vec3d>("body/velocity")[i].y = std::numeric_limits<double>::quiet_NaN();
    w.restore(state);
    try {
      w.step();
      ADD_FAILURE() << "the step went through, " << (touching ? "touching" : "free");
    } catch (const RunError& error) {
      EXPECT_NE(std::string(error.what()).find("17"), std::string::npos) << error.what();
    }
  }
}

TEST_P(Limits, AVelocityBeyondTheRangeIsRefusedByName) {
  Scene scene = empty_scene(1e-3, 0.5);
  for (int i = 0; i < 20; ++i) add_sphere(scene, {0.3 * i, 0, 0.1}, 0.1, 1);
  scene.bodies[13].velocity = {0, 0, precision() == Precision::single_precision ? 1e30 : 1e200};
  try {
    world(scene);
    ADD_FAILURE() << "the scene was taken";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("bodies[13].velocity"), std::string::npos)
        << error.what();
  }
}

TEST_P(Limits, ABodyThatLeavesTheRangeIsNamed) {
  Scene scene = empty_scene(1.0, 0.5);
  for (int i = 0; i < 20; ++i) add_sphere(scene, {0.3 * i, 0, 0.1}, 0.1, 1);
  scene.bodies[13].velocity = {0, 0, 9e14};  // 9e14 m after one step, beyond 1e15 m after two
  World w = world(scene);
  w.step();
  try {
    w.step();
    ADD_FAILURE() << "the step went through";
  } catch (const RunError& error) {
    EXPECT_NE(std::string(error.what()).find("13"), std::string::npos) << error.what();
  }
}

/// What `scree run` asks before it makes a world.
class MemoryLimit : public ::testing::TestWithParam<std::tuple<BackendKind, Precision>> {
 protected:
  void SetUp() override {
    std::string reason;
    if (!backend_available(std::get<0>(GetParam()), &reason))
      GTEST_SKIP() << "no such backend: " << reason;
  }
  WorldOptions options() const {
    WorldOptions o;
    o.backend = std::get<0>(GetParam());
    o.precision = std::get<1>(GetParam());
    o.memory_limit = std::size_t{8} << 20;
    return o;
  }
  static Scene spheres(int count) {
    Scene scene = empty_scene(1e-3, 0.5);
    for (int i = 0; i < count; ++i)
      add_sphere(scene, {0.21 * (i % 16), 0.21 * (i / 16 % 16), 0.21 * (i / 256)}, 0.1, 1);
    return scene;
  }
};
INSTANTIATE_TEST_SUITE_P(All, MemoryLimit,
                         ::testing::Combine(::testing::ValuesIn(kBackends),
                                            ::testing::ValuesIn(kPrecisions)),
                         [](const auto& info) {
                           return std::string(name_of(std::get<0>(info.param))) + "_" +
                                  name_of(std::get<1>(info.param));
                         });

TEST_P(MemoryLimit, MoreBodiesThanMemoryAreRefusedWithTheNumberThatFits) {
  const double fit = bodies_that_fit(spheres(100), options());
  ASSERT_GT(fit, 8000);
  ASSERT_LT(fit, 40000);
  try {
    require_memory(spheres(static_cast<int>(fit) + 1), options());
    ADD_FAILURE() << "one body too many is taken";
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find(std::to_string(static_cast<int>(fit) + 1) + " bodies need"),
              std::string::npos)
        << message;
    EXPECT_NE(message.find("about " + std::to_string(static_cast<int>(fit)) + " bodies fit"),
              std::string::npos)
        << message;
  }
}

TEST_P(MemoryLimit, AsManyBodiesAsFitAreTakenAndKeepToIt) {
  const Scene scene = spheres(static_cast<int>(bodies_that_fit(spheres(100), options())));
  EXPECT_NO_THROW(require_memory(scene, options()));
  World w(scene, options());
  for (int k = 0; k < 3; ++k) w.step();
  EXPECT_LE(w.peak_memory(), options().memory_limit);
}

TEST_P(MemoryLimit, WithoutALimitTheFreeMemoryOfTheDeviceCounts) {
  WorldOptions free = options();
  free.memory_limit = 0;
  const DeviceInfo device = device_info(free.backend);
  EXPECT_GT(device.free_bytes, 0u);
  EXPECT_LE(device.free_bytes, device.memory_bytes);
  EXPECT_NO_THROW(require_memory(spheres(100), free));
  EXPECT_GT(bodies_that_fit(spheres(100), free), 1e4);
}

}  // namespace
}  // namespace scree::parity
