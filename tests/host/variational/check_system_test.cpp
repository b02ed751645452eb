// What the collision integrator refuses, by name, before it starts.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "host/collision_integrator.h"
#include "host/collision_walls.h"

namespace scree {
namespace {

/// All that a CollisionIntegrator is made of: a point between a floor and an obstacle.
struct Parts {
  MechanicalSystem system;
  ImpactSettings settings{.step = 0.1};
  std::vector<double> position{0, 1}, velocity{0, 0};

  Parts() {
    system.mass = {1, 0, 0, 1};
    system.walls = {half_space_wall("floor", {{0, 1}, 0}),
                    convex_obstacle("corner", {{{0, 1}, 0.5}, {{1, 0}, 0.5}})};
  }
  CollisionIntegrator made() const { return {system, settings, position, velocity}; }
};

void expect_refusal(const std::string& message, const std::function<void(Parts&)>& spoil) {
  Parts parts;
  EXPECT_NO_THROW(parts.made());
  spoil(parts);
  try {
    parts.made();
    FAIL() << "taken, expected: " << message;
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr(message));
  }
}

TEST(CheckSystem, NamesWhatIsWrong) {
  const double infinity = std::numeric_limits<double>::infinity();
  const auto pull = [](std::span<const double> q) { return q[0]; };
  expect_refusal("position is empty", [](Parts& p) { p.position.clear(); });
  expect_refusal("velocity has 1 numbers, expected 2", [](Parts& p) { p.velocity = {1}; });
  expect_refusal("not finite", [&](Parts& p) { p.velocity[1] = infinity; });
  expect_refusal("mass has 3 numbers, expected n x n = 4",
                 [](Parts& p) { p.system.mass.pop_back(); });
  expect_refusal("mass has a number that is not finite",
                 [&](Parts& p) { p.system.mass[0] = infinity; });
  expect_refusal("mass[1][0] = 0.5 and mass[0][1] = 0", [](Parts& p) { p.system.mass[2] = 0.5; });
  expect_refusal("not positive definite", [](Parts& p) { p.system.mass[0] = -1; });
  expect_refusal("a potential needs a gradient", [&](Parts& p) { p.system.potential = pull; });
  expect_refusal("momentum \"L\" has no function", [](Parts& p) {
    p.system.momenta = {{"L", {}}};
  });
  expect_refusal("step is 0, expected a finite number > 0", [](Parts& p) { p.settings.step = 0; });
  expect_refusal("max_impacts is 0", [](Parts& p) { p.settings.max_impacts = 0; });
  expect_refusal("together is 1", [](Parts& p) { p.settings.together = 1; });
  expect_refusal("handover_speed is -1", [](Parts& p) { p.settings.handover_speed = -1; });
  expect_refusal("samples is 0", [](Parts& p) { p.settings.samples = 0; });
  expect_refusal("wall \"floor\" has no parts", [](Parts& p) { p.system.walls[0].parts.clear(); });
  expect_refusal("wall \"floor\" has a part without value or gradient",
                 [](Parts& p) { p.system.walls[0].parts[0].gradient = {}; });
  expect_refusal("wall \"floor\": restitution 1.1",
                 [](Parts& p) { p.system.walls[0].restitution = 1.1; });
  expect_refusal("wall \"floor\": friction -1", [](Parts& p) { p.system.walls[0].friction = -1; });
  expect_refusal("wall \"floor\": curvature has 1 numbers, expected 2",
                 [](Parts& p) { p.system.walls[0].parts[0].curvature = {0}; });
  expect_refusal("wall \"floor\": curvature -1", [](Parts& p) {
    p.system.walls[0].parts[0].curvature = {0, -1};
  });
  expect_refusal("wall \"floor\" is -0.25 at the start", [](Parts& p) { p.position = {1, -0.25}; });
  expect_refusal("wall \"corner\" is -0.25 at the start", [](Parts& p) {
    p.position = {0.125, 0.25};
  });
}

TEST(CheckSystem, WallsNameWhatIsWrong) {
  EXPECT_THROW(half_space_wall("w", {{0, 0}, 1}), InputError);
  EXPECT_THROW(quadric_wall("w", {1, 0, 0}, {0, 0}, 1), InputError);
  EXPECT_THROW(quadric_wall("w", {1, 2, 0, 1}, {0, 0}, 1), InputError);
  EXPECT_THROW(ball_pair_wall("w", {.first_b = 2, .distance = 1}), InputError);
  EXPECT_THROW(ball_pair_wall("w", {.first_b = 4, .distance = 1}), InputError);
  EXPECT_THROW(ball_pair_wall("w", {.distance = 0}), InputError);
  EXPECT_THROW(plane_body_wall("w", {.coordinate_count = 4, .first = 2}, 0, 1, 0), InputError);
  EXPECT_THROW(plane_body_wall("w", {.coordinate_count = 3}, 0, 0, -1), InputError);
  EXPECT_THROW(plane_body_wall("w", {.coordinate_count = 3}, NAN, 1, 0), InputError);
}

// A wall whose gradient vanishes on it has no normal there.
TEST(CheckSystem, AWallWithoutNormalIsRefusedWhereItIsHit) {
  Parts parts;
  Wall flat;
  flat.name = "flat";
  flat.parts.resize(1);
  flat.parts[0].value = [](std::span<const double> q) { return q[0] < 0.5 ? 0.0 : -1.0; };
  flat.parts[0].gradient = [](std::span<const double>, std::span<double> g) { g[0] = g[1] = 0; };
  parts.system.walls = {flat};
  parts.velocity = {10, 0};
  CollisionIntegrator integrator = parts.made();
  try {
    integrator.step();
    FAIL();
  } catch (const RunError& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("its gradient is zero"));
  }
}

}  // namespace
}  // namespace scree
