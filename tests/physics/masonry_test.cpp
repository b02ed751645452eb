// A semicircular arch of stones: it stands and falls on either side of the least thickness, and of the least friction, at which there
// is an equilibrium. These come from the linear program of limit analysis with the same joints.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/hulls.h"
#include "tests/physics/long_tests.h"
#include "tests/physics/scene_builder.h"

namespace scree::physics {
namespace {

constexpr double kDepth = 0.2;

/// Corners of stone k: its joints are radial, and all of its faces are flat. The center line has a radius of 1 m.
std::vector<Vec3d> corners_of_stone(int k, int stones, double thickness) {
  std::vector<Vec3d> corners;
  for (const int joint : {k, k + 1}) {
    const double angle = kPi * joint / stones;
    for (const double r : {1 - thickness / 2, 1 + thickness / 2})
      for (const double y : {-kDepth / 2, kDepth / 2})
        corners.push_back({-r * std::cos(angle), y, r * std::sin(angle)});
  }
  return corners;
}

/// An arch that stands on the floor z = 0.
Scene arch(int stones, double thickness, double friction, Model model) {
  Scene scene = empty_scene(2e-3, friction, model);
  solve_to(scene, 1e-6);
  for (int k = 0; k < stones; ++k) {
    BodyDescription stone;
    set_hull(scene, stone, corners_of_stone(k, stones, thickness));
    set_mass_from_density(stone, 2400);
    scene.bodies.push_back(stone);
  }
  add_plane(scene);
  return scene;
}

/// How far the crown has come down after 2 s [m]; what falls freely comes to lie on the floor, 0.9 m below.
double drop_of_crown(const Scene& scene) {
  const std::size_t crown = (scene.bodies.size() - 1) / 2;
  World world = reference_world(scene);
  const double start = world.states().position[crown].z;
  const StepReport report = run_for(world, scene, 2);
  EXPECT_TRUE(report.converged);
  return start - world.states().position[crown].z;
}

class Arch : public testing::TestWithParam<Model> {};
INSTANTIATE_TEST_SUITE_P(Models, Arch, testing::Values(Model::convex, Model::exact),
                         [](const auto& info) { return std::string(name_of(info.param)); });

// Five hinges form where it is too thin: at the crown, the haunches and the springings.
TEST_P(Arch, A64_StandsAndFallsAtTheLeastThickness) {
  constexpr double kLeast = 0.10672;
  EXPECT_LT(drop_of_crown(arch(27, 1.02 * kLeast, 0.7, GetParam())), 1e-4);
  EXPECT_GT(drop_of_crown(arch(27, 0.98 * kLeast, 0.7, GetParam())), 0.5);
}

// A thick arch fails by sliding where the friction is too low.
TEST_P(Arch, A65_StandsAndFallsAtTheLeastFriction) {
  constexpr double kLeast = 0.30899;
  EXPECT_LT(drop_of_crown(arch(27, 0.2, 1.02 * kLeast, GetParam())), 1e-4);
  EXPECT_GT(drop_of_crown(arch(27, 0.2, 0.98 * kLeast, GetParam())), 0.05);
}

/// Least thickness over radius at high friction, and least friction of an arch of thickness 0.2, from the same program.
struct LeastOf {
  int stones;
  double thickness, friction;
};

TEST_P(Arch, A64_A65_OfFewerAndMoreStones) {
  if (!runs_long_tests()) GTEST_SKIP() << kLongTest;
  for (const LeastOf& least : {LeastOf{11, 0.10459, 0.30703}, LeastOf{19, 0.10612, 0.30693},
                               LeastOf{101, 0.10745, 0.30914}}) {
    SCOPED_TRACE(least.stones);
    const auto drop = [&](double thickness, double friction) {
      return drop_of_crown(arch(least.stones, thickness, friction, GetParam()));
    };
    EXPECT_LT(drop(1.02 * least.thickness, 0.7), 1e-4);
    EXPECT_GT(drop(0.98 * least.thickness, 0.7), 0.5);
    EXPECT_LT(drop(0.2, 1.02 * least.friction), 1e-4);
    EXPECT_GT(drop(0.2, 0.98 * least.friction), 0.05);
  }
}

}  // namespace
}  // namespace scree::physics
