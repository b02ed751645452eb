// Boxes and capsules on triangle meshes and on each other: at rest, sliding over inner edges, at the edge of a block, and
// fast; cylinders_test.cpp has their piles.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/physics/round_bodies.h"

namespace scree::physics {
namespace {

/// A level floor of 2 n n triangles whose diagonals turn from cell to cell; vertices do not lie on round numbers.
void add_mesh_floor(Scene& scene, int n, double edge) {
  TriangleMesh floor;
  floor.name = "floor";
  floor.closed = false;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      floor.vertices.push_back({edge * (static_cast<double>(i) / n - 0.503),
                                edge * (static_cast<double>(j) / n - 0.507), 0});
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      if ((i + j) % 2 == 0) {
        floor.triangles.push_back({a, b, d});
        floor.triangles.push_back({a, d, c});
      } else {
        floor.triangles.push_back({a, b, c});
        floor.triangles.push_back({b, d, c});
      }
    }
  }
  add_mesh(scene, floor);
}

/// A closed block from -half to half.
TriangleMesh block(const Vec3d& half) {
  TriangleMesh mesh;
  mesh.name = "block";
  const Surface surface = box_surface(half, 0);
  mesh.vertices = surface.vertices;
  for (const std::vector<int>& face : surface.faces) {
    mesh.triangles.push_back({face[0], face[1], face[2]});
    mesh.triangles.push_back({face[0], face[2], face[3]});
  }
  return mesh;
}

TEST(ConvexOnMesh, ABoxRestsOnItsFourCornersWhereverEdgesLie) {
  for (const double turn : {0.0, 0.3, kPi / 4}) {
    for (const int cells : {1, 7, 40}) {
      Scene scene = empty_scene(1e-2, 0.5);
      add_box(scene, {0.01, 0.02, 0.1}, {0.15, 0.2, 0.1}, 2).orientation =
          exp_map(Vec3d{0, 0, turn});
      add_mesh_floor(scene, cells, 2);
      World world = reference_world(scene);
      for (int k = 0; k < 100; ++k) {
        const StepReport report = world.step();
        ASSERT_EQ(report.contact_count, 4) << cells << " at " << turn << " step " << k;
        ASSERT_LT(report.kinetic_energy, 1e-15) << k;
      }
      EXPECT_NEAR(world.states().position[0].z, 0.1, 1e-9);
    }
  }
}

TEST(ConvexOnMesh, ABoxRestsInFloat) {
  Scene scene = empty_scene(1e-2, 0.5);
  solve_to(scene, 1e-6);
  add_box(scene, {0.01, 0.02, 0.1}, {0.15, 0.2, 0.1}, 2).orientation = exp_map(Vec3d{0, 0, 0.3});
  add_mesh_floor(scene, 7, 2);
  World world(scene, cpu_options(1, Precision::single_precision));
  for (int k = 0; k < 300; ++k) {
    const StepReport report = world.step();
    ASSERT_GE(report.contact_count, 4) << k;
    ASSERT_LT(report.kinetic_energy, 1e-9) << k;
  }
  EXPECT_NEAR(world.states().position[0].z, 0.1, 1e-5);
}

// Friction slows it as on a plane, and nothing else does: an edge that caught it would turn or lift it.
TEST(ConvexOnMesh, ABoxSlidesOverInnerEdgesAsOnAPlane) {
  constexpr double kFriction = 0.2, kStep = 2e-3;
  constexpr int kSteps = 250;
  for (const Vec3d& way : {Vec3d{1, 0, 0}, normalized(Vec3d{0.7, -0.4, 0})}) {
    Scene scene = empty_scene(kStep, kFriction, Model::exact);
    BodyDescription& box = add_box(scene, {-0.3, 0.1, 0.05}, {0.11, 0.08, 0.05}, 1);
    box.velocity = 2.0 * way;
    add_mesh_floor(scene, 23, 4);
    World world = reference_world(scene);
    for (int k = 0; k < kSteps; ++k) world.step();
    const BodyStates s = world.states();
    const double speed = 2 - kFriction * kGravity * kStep * kSteps;
    EXPECT_NEAR(dot(s.velocity[0], way), speed, 1e-6);
    EXPECT_NEAR(norm(s.velocity[0]), speed, 1e-6);
    EXPECT_NEAR(s.position[0].z, 0.05, 1e-7);
    EXPECT_LT(norm(s.angular_velocity[0]), 1e-6);
  }
}

TEST(ConvexOnMesh, ACapsuleLiesAndRollsOverInnerEdges) {
  constexpr double kRadius = 0.1, kStep = 1e-3;
  Scene scene = empty_scene(kStep, 0.8, Model::exact);
  tilt(scene, 10);
  scene.bodies.push_back(capsule({-0.5, 0, kRadius}, kAlongY, kRadius, 0.4));
  add_mesh_floor(scene, 23, 4);
  const BodyDescription body = scene.bodies[0];
  World world = reference_world(scene);
  for (int k = 0; k < 600; ++k) ASSERT_EQ(world.step().contact_count, 2) << k;
  const BodyStates s = world.states();
  const double ratio = body.inertia.z / (body.mass * kRadius * kRadius);
  const double speed = kGravity * std::sin(radians(10)) / (1 + ratio) * kStep * 600;
  EXPECT_NEAR(s.velocity[0].x, speed, 1e-5 * speed);
  EXPECT_NEAR(s.velocity[0].y, 0, 1e-7);
  EXPECT_NEAR(s.position[0].z, kRadius, 1e-6);
}

TEST(ConvexOnMesh, ABoxOnABlockStandsWhileItsCenterIsOverIt) {
  for (const double over : {0.09, 0.11}) {
    Scene scene = empty_scene(5e-3, 0.6);
    solve_to(scene, 1e-9);
    add_box(scene, {0.5 - 0.1 + over, 0.1, 0.6}, {0.1, 0.1, 0.1}, 1);
    add_mesh(scene, block({0.5, 0.5, 0.5}));
    World world = reference_world(scene);
    double deepest = 0;
    for (int k = 0; k < 160; ++k) deepest = std::max(deepest, world.step().max_penetration);
    const double z = world.states().position[0].z;
    EXPECT_LT(deepest, 1e-3);
    if (over < 0.1) {
      EXPECT_NEAR(z, 0.6, 1e-6);
    } else {
      EXPECT_LT(z, 0.5) << "it falls off";
    }
  }
}

TEST(ConvexOnMesh, ThoseThatFallOnCornersComeToRestOnAClosedBlock) {
  Scene scene = empty_scene(5e-3, 0.5);
  solve_to(scene, 1e-7);
  scene.solver.max_iterations = 500;
  for (int k = 0; k < 4; ++k) {
    const Vec3d at{0.3 * (k % 2) - 0.15, 0.3 * (k / 2) - 0.15, 0.7};
    const Quatd turn = exp_map(Vec3d{0.5 + 0.2 * k, 0.3, 0.1 * k});
    if (k % 2 == 0)
      add_box(scene, at, {0.06, 0.05, 0.07}, 1).orientation = turn;
    else
      scene.bodies.push_back(capsule(at, turn, 0.05, 0.1));
  }
  add_mesh(scene, block({0.5, 0.5, 0.5}));
  World world = reference_world(scene);
  double deepest = 0;
  StepReport report;
  for (int k = 0; k < 800; ++k) {
    report = world.step();
    deepest = std::max(deepest, report.max_penetration);
  }
  EXPECT_LT(deepest, 2e-3);
  EXPECT_LT(report.kinetic_energy, 1e-5);
  for (const Vec3d& x : world.states().position)
    if (norm(x) > 0) {
      EXPECT_GT(x.z, 0.5 + 0.045);
    }
}

TEST(ConvexOnMesh, BoxesAndCapsulesRestInAValley) {
  Scene scene = empty_scene(2e-3, 0.3);
  solve_to(scene, 1e-8);
  add_box(scene, {0.002, 0.001, 0.03}, {0.012, 0.01, 0.008}, 0.01);
  scene.bodies.push_back(capsule({0.03, 0.01, 0.03}, kAlongX, 0.008, 0.01));
  add_valley(scene);
  World world = reference_world(scene);
  double deepest = 0;
  for (int k = 0; k < 1500; ++k) deepest = std::max(deepest, world.step().max_penetration);
  const BodyStates s = world.states();
  EXPECT_LT(deepest, 2e-4);
  EXPECT_GT(s.position[0].z, 0.006);
  EXPECT_GT(s.position[1].z, 0.006);
  EXPECT_LT(norm(s.velocity[0]), 1e-3) << "the box; the capsule may roll";
}

TEST(ConvexOnMesh, FastBoxesAndCapsulesDoNotPassAThinWall) {
  for (const bool is_box : {true, false}) {
    for (const double turn : {0.0, 0.5}) {
      Scene scene = empty_scene(1e-3, 0.3);
      solve_to(scene, 1e-6);
      scene.gravity = {};
      const Quatd q = exp_map(Vec3d{turn, 0.3 * turn, 0});
      if (is_box) {
        add_box(scene, {0.013, 0.021, 0.37}, {0.02, 0.015, 0.01}, 1).orientation = q;
      } else {
        scene.bodies.push_back(capsule({0.013, 0.021, 0.37}, q, 0.01, 0.03));
      }
      scene.bodies[0].velocity = {0, 0, -100};
      add_mesh_floor(scene, 9, 2);
      World world = reference_world(scene);
      double lowest = INFINITY;
      for (int k = 0; k < 30; ++k) {
        world.step();
        lowest = std::min(lowest, world.states().position[0].z);
      }
      EXPECT_GT(lowest, 0) << is_box << turn;
    }
  }
}

TEST(CapsulesOnBoxes, OneLiesOnAFreeBoxOnTheFloor) {
  Scene scene = empty_scene(1e-2, 0.5);
  add_box(scene, {0, 0, 0.1}, {0.3, 0.2, 0.1}, 5);
  scene.bodies.push_back(capsule({0.02, 0.01, 0.25}, kAlongX, 0.05, 0.3));
  add_plane(scene);
  World world = reference_world(scene);
  for (int k = 0; k < 200; ++k) {
    const StepReport report = world.step();
    ASSERT_EQ(report.contact_count, 4 + 2) << k;
    ASSERT_LT(report.kinetic_energy, 1e-15) << k;
  }
  EXPECT_NEAR(world.states().position[1].z, 0.25, 1e-9);
}

TEST(CapsulesOnBoxes, OneOverTheEdgeOfAFixedBoxSlidesOff) {
  Scene scene = empty_scene(5e-3, 0.1);
  solve_to(scene, 1e-9);
  scene.bodies.push_back(capsule({0.45, 0, 0.55}, kAlongX, 0.05, 0.3));
  add_wall_box(scene, {}, {0.5, 0.5, 0.5});
  scene.bodies[0].position.x = 0.56;
  World world = reference_world(scene);
  double deepest = 0;
  for (int k = 0; k < 200; ++k) deepest = std::max(deepest, world.step().max_penetration);
  EXPECT_LT(world.states().position[0].z, 0.3);
  EXPECT_LT(deepest, 1e-3);
}

}  // namespace
}  // namespace scree::physics
