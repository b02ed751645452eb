// Walls that fill a periodic domain: bodies do not feel where a mesh ends and its image begins.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "host/error.h"
#include "host/scene/height_field.h"
#include "tests/physics/described_bodies.h"
#include "tests/physics/round_bodies.h"
#include "tests/physics/scene_builder.h"

namespace scree::physics {
namespace {

constexpr double kPeriod = 2.1;  // m, the period

/// @param repeats  lengths that the field has along x; it fills the domain if that is one
void add_waves(Scene& scene, double height, int repeats) {
  const std::size_t cells = 14;
  const double length = kPeriod * repeats, width = kPeriod;
  HeightGrid grid{cells + 1, cells * static_cast<std::size_t>(repeats) + 1, {}};
  for (std::size_t row = 0; row <= cells; ++row)
    for (std::size_t k = 0; k < grid.columns; ++k)
      grid.heights.push_back(
          height * std::cos(2 * std::numbers::pi * static_cast<double>(k % cells) / cells));
  add_mesh(scene, height_field_mesh("waves", grid, {length, width}, 0.3));
}

Scene periodic_scene(double friction, double height) {
  Scene scene = empty_scene(1e-3, friction, Model::exact);
  scene.stepping.envelope = 1e-2;
  scene.gravity = {0, 0, -kGravity};
  scene.periodicity.periodic = {true, true, false};
  scene.periodicity.lower = {-kPeriod / 2, -kPeriod / 2, 0};
  scene.periodicity.upper = {kPeriod / 2, kPeriod / 2, 0};
  add_waves(scene, height, 1);
  return scene;
}

TEST(PeriodicSeams, ASphereRollsOverOneAsOnAPlane) {
  Scene scene = periodic_scene(0.5, 0);
  BodyDescription& ball = add_sphere(scene, {0.7, 0.31, 0.1}, 0.1, 1);
  ball.velocity = {0.8, 0.3, 0};
  ball.angular_velocity = {-3, 8, 0};
  World world = reference_world(scene);
  run_for(world, scene, 3);
  const BodyStates s = world.states();
  EXPECT_NEAR(norm(s.velocity[1] - Vec3d{0.8, 0.3, 0}), 0, 1e-6);
  EXPECT_NEAR(s.position[1].z, 0.1, 1e-6);
}

const char* const kShapes[]{
    R"("shape": "box", "size": [0.14, 0.12, 0.1])",
    R"("shape": "hull", "points": [[0.07, 0.06, -0.05], [-0.07, 0.06, -0.05],
                               [0.07, -0.06, -0.05], [-0.07, -0.06, -0.05], [0, 0, 0.15]])",
    R"("shape": "cylinder", "radius": 0.06, "length": 0.1)",
    R"("shape": "ellipsoid", "size": [0.14, 0.12, 0.1])"};

/// The lowest point of a body as it stands, from its center [m].
double lowest(const Scene& scene, const BodyDescription& body) {
  if (body.shape.mesh < 0) return -body.shape.half_extents.z;
  double z = 0;
  for (const Vec3d& x : scene.meshes[static_cast<std::size_t>(body.shape.mesh)].vertices)
    z = std::min(z, x.z);
  return z;
}

TEST(PeriodicSeams, BodiesOfAllShapesSlideOverOneAsOnAPlane) {
  for (const char* shape : kShapes) {
    SCOPED_TRACE(shape);
    Scene scene = periodic_scene(0, 0);
    BodyDescription& body = add_described(scene, shape);
    const double height = -lowest(scene, body);
    body.position = {0.7, 0.3, height};
    body.velocity = {0.8, 0.3, 0};
    World world = reference_world(scene);
    run_for(world, scene, 3);
    const BodyStates s = world.states();
    EXPECT_NEAR(norm(s.velocity[1] - Vec3d{0.8, 0.3, 0}), 0, 1e-6);
    EXPECT_NEAR(s.position[1].z, height, 1e-6);
  }
}

// Over waves that repeat a body goes as over many of them.
TEST(PeriodicSeams, WavesGoOn) {
  for (const char* shape :
       {R"("shape": "sphere", "radius": 0.08)", kShapes[0], kShapes[1], kShapes[3]}) {
    SCOPED_TRACE(shape);
    std::vector<BodyStates> end;
    for (const bool repeats : {true, false}) {
      Scene scene = periodic_scene(0, 0.1);
      solve_to(scene, 1e-9);
      if (!repeats) {
        scene.periodicity.periodic = {false, true, false};
        scene.bodies.clear();
        scene.meshes.clear();
        add_waves(scene, 0.1, 5);
      }
      BodyDescription& body = add_described(scene, shape);
      body.position = {0, 0.3, 0.2};
      body.velocity = {3, 0.4, 0};
      World world = reference_world(scene);
      run_for(world, scene, 0.7);
      end.push_back(world.states());
    }
    EXPECT_GT(end[1].position[1].x, kPeriod / 2);  // it has crossed one
    Vec3d off = end[1].position[1] - end[0].position[1];
    for (int k = 0; k < 2; ++k) off[k] -= kPeriod * std::round(off[k] / kPeriod);
    EXPECT_NEAR(norm(off), 0, 1e-6);
  }
}

/// A fixed box whose edges are rounded.
BodyDescription rounded_plate() {
  const Scene read = scene_of(
      R"({"shape": "box", "kind": "fixed", "size": [2.1, 2.1, 0.2], "rounding": 0.02},
         {"shape": "sphere", "radius": 0.1, "density": 1, "position": [0, 0, 9]})");
  return read.bodies.at(0);
}

TEST(PeriodicSeams, RoundedPlatesGoOn) {
  for (const char* shape : {R"("shape": "sphere", "radius": 0.05)", kShapes[0]}) {
    SCOPED_TRACE(shape);
    Scene scene = periodic_scene(0, 0);
    scene.bodies.clear();
    scene.meshes.clear();
    scene.bodies.push_back(rounded_plate());
    scene.bodies.back().group = 0;
    scene.bodies.back().position.z = -0.1;
    BodyDescription& body = add_described(scene, shape);
    body.position = {0.7, 0.2, 0.05};
    body.velocity = {0.8, 0.3, 0};
    World world = reference_world(scene);
    run_for(world, scene, 3);
    EXPECT_NEAR(norm(world.states().velocity[1] - Vec3d{0.8, 0.3, 0}), 0, 1e-6);
  }
}

// Boxes and cylinders as long as the period, or longer.
TEST(PeriodicSeams, PlatesAndRodsGoOn) {
  for (const double length : {kPeriod, kPeriod + 0.4}) {
    for (const bool is_plate : {true, false}) {
      for (const char* shape : {R"("shape": "sphere", "radius": 0.05)", kShapes[0], kShapes[2]}) {
        SCOPED_TRACE(std::string(is_plate ? "plate, " : "rod, ") + shape);
        Scene scene = periodic_scene(0, 0);
        scene.bodies.clear();
        scene.meshes.clear();
        if (is_plate) {
          add_wall_box(scene, {0.3, 0, -0.1}, {length / 2, length / 2, 0.1});
        } else {
          scene.bodies.push_back(cylinder({0.3, 0, -0.1}, kAlongX, 0.1, length));
          scene.bodies.back().kind = BodyKind::fixed;
        }
        BodyDescription& body = add_described(scene, shape);
        const double height = 0.05;
        body.position = {0.7, 0, height};
        body.velocity = {0.8, 0, 0};
        if (!is_plate) body.locks = lock_all & ~(lock_x | lock_z);  // or it falls off sideways
        World world = reference_world(scene);
        run_for(world, scene, 3);
        const BodyStates s = world.states();
        EXPECT_NEAR(norm(s.velocity[1] - Vec3d{0.8, 0, 0}), 0, 1e-6);
        EXPECT_NEAR(s.position[1].z, height, 1e-6);
      }
    }
  }
}

/// An open tube along y.
TriangleMesh tube(double radius, double length, int sides) {
  TriangleMesh mesh;
  mesh.name = "tube";
  mesh.closed = false;
  for (int end = 0; end < 2; ++end)
    for (int k = 0; k < sides; ++k) {
      const double angle = 2 * kPi * k / sides;
      mesh.vertices.push_back(
          {radius * std::sin(angle), (end - 0.5) * length, radius * std::cos(angle)});
    }
  for (int k = 0; k < sides; ++k) {
    const int next = (k + 1) % sides;
    mesh.triangles.push_back({k, next, sides + next});
    mesh.triangles.push_back({k, sides + next, sides + k});
  }
  return mesh;
}

/// A drum that turns, endless along y.
Scene drum_scene() {
  Scene scene = empty_scene(1e-3, 0, Model::exact);
  scene.stepping.envelope = 1e-2;
  scene.gravity = {0, 0, -kGravity};
  scene.periodicity.periodic = {false, true, false};
  scene.periodicity.lower = {0, -0.3, 0};
  scene.periodicity.upper = {0, 0.3, 0};
  BodyDescription& drum = add_mesh(scene, tube(0.5, 0.6, 48));
  drum.kind = BodyKind::kinematic;
  Motion turning;
  turning.kind = Motion::Kind::rotating;
  turning.axis = {0, 1, 0};
  turning.rate = 0.01;
  drum.motion = turning;
  return scene;
}

TEST(PeriodicSeams, AlongADrumThatTurnsBodiesKeepTheirSpeed) {
  for (const char* shape : {R"("shape": "sphere", "radius": 0.05)", kShapes[0], kShapes[3]}) {
    SCOPED_TRACE(shape);
    Scene scene = drum_scene();
    BodyDescription& body = add_described(scene, shape);
    body.position = {0, 0, -0.42};
    body.velocity = {0, 0.7, 0};
    World world = reference_world(scene);
    for (int k = 0; k < 2000; ++k) {
      world.step();
      ASSERT_NEAR(world.states().velocity[1].y, 0.7, 1e-6) << "step " << k;
    }
    EXPECT_LT(world.states().position[1].z, -0.4);
  }
}

TEST(PeriodicSeams, AWallThatGoesOnMayNotTurnOutOfItsPlace) {
  Scene scene = drum_scene();
  add_sphere(scene, {0, 0, -0.4}, 0.05, 1);
  World world = reference_world(scene);
  Motion motion = scene.bodies[0].motion;
  motion.rate = 1;
  world.set_motion(0, motion);
  world.step();
  motion.rate = 0;
  motion.axis = {0, 0, 1};
  world.set_motion(0, motion);
  motion.rate = 1;
  motion.axis = {1, 0, 0};
  try {
    world.set_motion(0, motion);
    FAIL() << "it may turn about x";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("periodic"), std::string::npos) << e.what();
  }
}

// A side that does not meet the other one is a wall, as it was.
TEST(PeriodicSeams, AStepBetweenImagesStopsASphere) {
  Scene scene = periodic_scene(0, 0);
  scene.bodies.clear();
  scene.meshes.clear();
  HeightGrid ramp{2, 8, {}};
  for (int row = 0; row < 2; ++row)
    for (int k = 0; k < 8; ++k) ramp.heights.push_back(0.3 - 0.3 * k / 7);
  add_mesh(scene, height_field_mesh("ramp", ramp, {kPeriod, kPeriod}, 0.3));
  add_sphere(scene, {0, 0, 0.3}, 0.08, 1);
  World world = reference_world(scene);
  run_for(world, scene, 4);
  EXPECT_NEAR(norm(world.states().velocity[1]), 0, 0.5);
  EXPECT_LT(world.states().position[1].z, 0.2);
}

}  // namespace
}  // namespace scree::physics
