// Small bodies with corners rain on ground whose heights lie at random beside each other. In the valleys and pits of it their corners
// lie over no triangle as soon as they are a little too deep.

#include <gtest/gtest.h>

#include <random>

#include "host/hulls.h"
#include "tests/physics/described_bodies.h"
#include "tests/physics/terrain.h"

namespace scree::physics {
namespace {

enum class Ground { height_field, open_mesh };
enum class Bodies { tetrahedra, hulls };

/// The upper side of the ground alone, which has two sides then.
TriangleMesh surface_of(const TriangleMesh& solid, double lowest) {
  TriangleMesh open = solid;
  open.closed = false;
  std::erase_if(open.triangles, [&](const auto& triangle) {
    for (const auto v : triangle)
      if (solid.vertices[static_cast<std::size_t>(v)].z < lowest) return true;
    return false;
  });
  // Only those of the base are left out, which come last.
  std::size_t used = 0;
  for (const auto& triangle : open.triangles)
    for (const auto v : triangle) used = std::max(used, static_cast<std::size_t>(v) + 1);
  open.vertices.resize(used);
  return open;
}

std::vector<Vec3d> corners_of(Bodies kind, double size, std::mt19937& random) {
  if (kind == Bodies::tetrahedra) return {{}, {size, 0, 0}, {0, size, 0}, {0, 0, size}};
  std::normal_distribution<double> normal;
  std::vector<Vec3d> points;
  for (auto k = 4 + random() % 9; k > 0; --k) {
    const double x = normal(random), y = normal(random), z = normal(random);
    points.push_back((0.6 * size) * normalized(Vec3d{x, y, 0.5 * z}));
  }
  return points;
}

/// The depth of the deepest corner of all bodies below the ground after a while [m].
double deepest_corner(Ground ground, Bodies kind, unsigned seed, double time_step, double seconds) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> height(0, 0.1), size(0.009, 0.025), beside(-0.04, 0.04);
  std::normal_distribution<double> normal;
  const HeightGrid grid = grid_of(12, 12, 1, 1, [&](double, double) { return height(random); });
  Scene scene = empty_scene(time_step, 0.5);
  solve_to(scene, 1e-4);
  scene.gravity = {0, 0, -kGravity};
  const TriangleMesh solid = height_field_mesh("heights", grid, {1, 1}, 0.1);
  add_mesh(scene, ground == Ground::height_field ? solid : surface_of(solid, 0));
  for (int k = 0; k < 108; ++k) {
    BodyDescription body;
    set_hull(scene, body, corners_of(kind, size(random), random));
    body.position = {0.13 * (k % 6) - 0.325 + beside(random),
                     0.13 * (k / 6 % 6) - 0.325 + beside(random), 0.13 + 0.05 * (k / 36)};
    body.orientation =
        normalized(Quatd{normal(random), normal(random), normal(random), normal(random)});
    set_mass_from_density(body, 2500);
    scene.bodies.push_back(body);
  }
  World world = reference_world(scene);
  run_for(world, scene, seconds);
  const BodyStates s = world.states();
  double deepest = 0;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const Vec3d& x = s.position[i];
    if (std::abs(x.x) > 0.45 || std::abs(x.y) > 0.45) continue;  // off the rim
    for (const Vec3d& corner :
         scene.meshes[static_cast<std::size_t>(scene.bodies[i].shape.mesh)].vertices) {
      const Vec3d at = x + rotate(s.orientation[i], corner);
      deepest = std::max(deepest, height_of(grid, 1, 1, at.x, at.y) - at.z);
    }
  }
  return deepest;
}

struct Rain {
  const char* name;
  Ground ground;
  Bodies bodies;
  unsigned seed;
  double time_step, seconds;
};

class RoughTerrain : public testing::TestWithParam<Rain> {};
INSTANTIATE_TEST_SUITE_P(
    Of, RoughTerrain,
    testing::Values(Rain{"AHeightField", Ground::height_field, Bodies::tetrahedra, 1, 1e-3, 0.8},
                    Rain{"AnOpenMesh", Ground::open_mesh, Bodies::tetrahedra, 2, 1e-3, 0.8},
                    Rain{"SmallSteps", Ground::height_field, Bodies::tetrahedra, 3, 2.5e-4, 0.55},
                    Rain{"HullsOnAHeightField", Ground::height_field, Bodies::hulls, 4, 1e-3, 0.8},
                    Rain{"HullsOnAnOpenMesh", Ground::open_mesh, Bodies::hulls, 5, 1e-3, 0.8}),
    [](const auto& info) { return std::string(info.param.name); });

TEST_P(RoughTerrain, HoldsTheCornersOfSmallBodies) {
  const Rain& p = GetParam();
  EXPECT_LT(deepest_corner(p.ground, p.bodies, p.seed, p.time_step, p.seconds), 1e-3);
}

/// Needles and plates that are thinner than what they go in a step come down, each with a ball after it that drives it into the ground.
/// @param spin  by which they turn in a step at first [rad]
/// @return  how many of their centers are below the ground after a while
int count_below(Ground ground, double spin, unsigned seed, Precision precision) {
  constexpr int kRow = 10;
  constexpr double kSpacing = 0.05, kSide = 0.55, kTimeStep = 1e-3;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> height(0, 0.08), size(4e-3, 8e-3), aside(-0.5, 0.5);
  std::normal_distribution<double> normal;
  const auto direction = [&] {
    const double x = normal(random), y = normal(random), z = normal(random);
    return normalized(Vec3d{x, y, z});
  };
  const HeightGrid grid = grid_of(23, 23, 1, 1, [&](double, double) { return height(random); });
  Scene scene = empty_scene(kTimeStep, 0.1);
  solve_to(scene, 1e-3);
  scene.gravity = {0, 0, -kGravity};
  const TriangleMesh solid = height_field_mesh("heights", grid, {kSide, kSide}, 0.05);
  add_mesh(scene, ground == Ground::height_field ? solid : surface_of(solid, 0));
  for (int k = 0; k < kRow * kRow; ++k) {
    const double s = size(random), vx = aside(random), vy = aside(random);
    const Vec3d place{kSpacing * (k % kRow - 0.5 * (kRow - 1)),
                      kSpacing * (k / kRow - 0.5 * (kRow - 1)), 0};
    BodyDescription body;
    if (k % 2 == 0) {
      set_hull(scene, body,
               {{0, 0, 2.5 * s},
                {0.2 * s, 0, 0},
                {-0.1 * s, 0.17 * s, 0},
                {-0.1 * s, -0.17 * s, 0},
                {0, 0, -2.5 * s}});
    } else {
      body.shape.kind = shapes::Box::kind;
      body.shape.half_extents = {s, s, 0.05 * s};
    }
    body.position = place + Vec3d{0, 0, 0.1};
    body.velocity = {vx, vy, -1.5};
    body.orientation = exp_map(kPi * direction());
    body.angular_velocity = (spin / kTimeStep) * direction();
    set_mass_from_density(body, 2500);
    scene.bodies.push_back(body);
    add_sphere(scene, place + Vec3d{0, 0, 0.135}, 0.01, 0.02).velocity = {vx, vy, -3};
  }
  World world(scene, cpu_options(1, precision));
  run_for(world, scene, 0.1);
  const BodyStates states = world.states();
  int below = 0;
  for (std::size_t i = 1; i < scene.bodies.size(); i += 2) {
    const Vec3d& x = states.position[i];
    if (std::abs(x.x) < 0.49 * kSide && std::abs(x.y) < 0.49 * kSide)
      below += is_above(grid, kSide, kSide, x) ? 0 : 1;
  }
  return below;
}

TEST(RoughTerrainHits, CentersOfNeedlesAndPlatesStayAbove) {
  constexpr auto kFloat = Precision::single_precision, kDouble = Precision::double_precision;
  EXPECT_EQ(count_below(Ground::height_field, 0.05, 1, kFloat), 0);
  EXPECT_EQ(count_below(Ground::height_field, 1, 4, kDouble), 0);
  EXPECT_EQ(count_below(Ground::open_mesh, 0.05, 6, kDouble), 0);
  EXPECT_EQ(count_below(Ground::open_mesh, 1, 7, kFloat), 0);
}

}  // namespace
}  // namespace scree::physics
