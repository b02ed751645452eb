// Bodies that slide over the seam of two others, or pass close by an edge, do not feel it; steps that are there stop them.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/box_mesh.h"
#include "tests/physics/described_bodies.h"
#include "tests/physics/scene_builder.h"

namespace scree::physics {
namespace {

struct Slider {
  const char* shape;
  double height;  // m, of its center above what it stands on
};
const Slider kBox{R"("shape": "box", "size": [0.1, 0.08, 0.06])", 0.03};
const Slider kSliders[]{
    kBox,
    {R"("shape": "box", "size": [0.1, 0.08, 0.06],
        "rotation_deg": {"axis": [0, 0, 1], "angle": 25})",
     0.03},
    {R"("shape": "cylinder", "radius": 0.05, "length": 0.06)", 0.03},
    {R"("shape": "cone", "radius": 0.05, "length": 0.1)", 0.025},
    {R"("shape": "hull", "points": [[0.05, 0.04, -0.03], [-0.05, 0.04, -0.03], [0.05, -0.04, -0.03],
        [-0.05, -0.04, -0.03], [0.02, 0.02, 0.05], [-0.03, 0, 0.05]])",
     -1},
    {R"("shape": "ellipsoid", "size": [0.12, 0.08, 0.06])", 0.03},
    {R"("shape": "box", "size": [0.07, 0.05, 0.03], "rounding": 0.015)", 0.03}};

const char* const kSlabs[]{
    R"({"shape": "box", "kind": "fixed", "size": [0.25, 1, 0.1], "position": [%, 0, #]})",
    R"({"shape": "cylinder", "kind": "fixed", "radius": 0.3, "length": 0.1, "position": [%, 0, #]})",
    R"({"shape": "hull", "kind": "fixed", "position": [%, 0, #], "points": [
        [0.125, 0.5, -0.05], [-0.125, 0.5, -0.05], [0.125, -0.5, -0.05], [-0.125, -0.5, -0.05],
        [0.125, 0.5, 0.05], [-0.125, 0.5, 0.05], [0.125, -0.5, 0.05], [-0.125, -0.5, 0.05]]})"};

std::string put(std::string text, char mark, double value) {
  return text.replace(text.find(mark), 1, std::to_string(value));
}

/// Slabs side by side along x, whose tops are at z = 0, the first one's middle at x = 0. @param lower  every second one, by so much [m]
Scene floor_of(const char* slab, double gap, double lower, double time_step) {
  Scene scene = empty_scene(time_step, 0);
  scene.gravity = {0, 0, -kGravity};
  std::string bodies;
  for (int k = 0; k < 8; ++k) {
    const std::string at = put(slab, '%', (0.25 + gap) * k);
    bodies += put(at, '#', -0.05 - (k % 2 == 1 ? lower : 0)) + ",";
  }
  const Scene read = scene_of(bodies + R"({"shape": "sphere", "radius": 0.1, "density": 1})");
  scene.bodies.assign(read.bodies.begin(), read.bodies.end() - 1);
  for (BodyDescription& body : scene.bodies) body.group = 0;
  scene.meshes = read.meshes;
  return scene;
}

double lowest_point(const Scene& scene, const BodyDescription& body) {
  double z = 0;
  for (const Vec3d& x : scene.meshes[static_cast<std::size_t>(body.shape.mesh)].vertices)
    z = std::min(z, rotate(body.orientation, x).z);
  return z;
}

struct Slid {
  Vec3d velocity, turn;
  double height = 0;  // m, above where it was
};

/// Slides a body over all slabs but the last.
Slid slide(Scene scene, const Slider& slider, double speed) {
  BodyDescription& body = add_described(scene, slider.shape);
  const double height = slider.height > 0 ? slider.height : -lowest_point(scene, body);
  body.position = {0, 0.03, height};
  body.velocity = {speed, 0, 0};
  const int id = last_id(scene);
  World world = reference_world(scene);
  const auto k = static_cast<std::size_t>(id);
  run_for(world, scene, 1.5 / speed);
  const BodyStates s = world.states();
  return {s.velocity[k], s.angular_velocity[k], s.position[k].z - height};
}

TEST(FlushSeams, BodiesOfAllShapesSlideOverThem) {
  for (const char* slab : kSlabs) {
    for (const Slider& slider : kSliders) {
      SCOPED_TRACE(std::string(slab).substr(0, 25) + slider.shape);
      const Slid end = slide(floor_of(slab, 0, 0, 1e-3), slider, 2);
      EXPECT_NEAR(norm(end.velocity - Vec3d{2, 0, 0}), 0, 1e-5);
      EXPECT_NEAR(norm(end.turn), 0, 1e-3);
      EXPECT_NEAR(end.height, 0, 1e-6);
    }
  }
}

// Triangles of a side know no other plane than their own, and so need one of the body.
TEST(FlushSeams, OfMeshes) {
  for (const Slider& slider : kSliders) {
    if (std::string(slider.shape).find("ellipsoid") != std::string::npos) continue;
    SCOPED_TRACE(slider.shape);
    Scene scene = empty_scene(1e-3, 0);
    scene.gravity = {0, 0, -kGravity};
    for (int k = 0; k < 8; ++k)
      add_mesh(scene, test::box_mesh({0.125, 0.5, 0.05})).position = {0.25 * k, 0, -0.05};
    const Slid end = slide(scene, slider, 2);
    EXPECT_NEAR(norm(end.velocity - Vec3d{2, 0, 0}), 0, 1e-5);
    EXPECT_NEAR(norm(end.turn), 0, 1e-3);
    EXPECT_NEAR(end.height, 0, 1e-6);
  }
}

TEST(FlushSeams, OfAnyStepAndSpeed) {
  for (const double time_step : {1.0 / 60, 2e-3}) {
    for (const double speed : {0.3, 2.0, 10.0}) {
      for (const Slider& slider : {kSliders[0], kSliders[1], kSliders[2]}) {
        SCOPED_TRACE(std::to_string(time_step) + " " + std::to_string(speed) + slider.shape);
        const Slid end = slide(floor_of(kSlabs[0], 0, 0, time_step), slider, speed);
        EXPECT_NEAR(norm(end.velocity - Vec3d{speed, 0, 0}), 0, 1e-4);
        EXPECT_NEAR(end.height, 0, 1e-5);
      }
    }
  }
}

// Slower than what it falls within a step.
TEST(FlushSeams, SlowBodiesPassThem) {
  for (const double speed : {0.02, 1e-3}) {
    for (const Slider& slider : {kSliders[0], kSliders[1], kSliders[2], kSliders[5]}) {
      SCOPED_TRACE(std::to_string(speed) + slider.shape);
      Scene scene = floor_of(kSlabs[0], 0, 0, 1e-3);
      BodyDescription& body = add_described(scene, slider.shape);
      body.position = {0.07 - 1e-4, 0, slider.height};
      body.velocity = {speed, 0, 0};
      World world = reference_world(scene);
      run_for(world, scene, 1);
      EXPECT_NEAR(world.states().velocity.back().x, speed, 1e-3 * speed);
    }
  }
}

TEST(FlushSeams, SmallStepsAndGapsDoNotCount) {
  for (const Slider& slider : {kSliders[0], kSliders[1], kSliders[2], kSliders[4]}) {
    SCOPED_TRACE(slider.shape);
    const Slid steps = slide(floor_of(kSlabs[0], 0, 1e-6, 1e-3), slider, 2);
    EXPECT_NEAR(norm(steps.velocity - Vec3d{2, 0, 0}), 0, 5e-3);
    const Slid gaps = slide(floor_of(kSlabs[0], 1e-3, 0, 1e-3), slider, 2);
    EXPECT_NEAR(norm(gaps.velocity - Vec3d{2, 0, 0}), 0, 1e-5);
  }
}

TEST(FlushSeams, StepsThatAreThereStopBodies) {
  for (const Slider& slider : {kSliders[0], kSliders[2]}) {
    SCOPED_TRACE(slider.shape);
    const double step = 0.01 * kBox.height;
    Scene scene = floor_of(kSlabs[0], 0, step, 1e-3);
    BodyDescription& body = add_described(scene, slider.shape);
    body.position = {0.25, 0, slider.height - step};
    body.velocity = {1, 0, 0};
    World world = reference_world(scene);
    run_for(world, scene, 0.3);
    EXPECT_LT(world.states().velocity.back().x, 0.5);
  }
}

// Free bodies as a floor: side by side on a plane.
TEST(FlushSeams, OfFreeBodies) {
  for (const Slider& slider : {kSliders[0], kSliders[2], kSliders[4]}) {
    SCOPED_TRACE(slider.shape);
    Scene scene = empty_scene(1e-3, 0);
    scene.gravity = {0, 0, -kGravity};
    add_plane(scene);
    for (int k = 0; k < 5; ++k) add_box(scene, {0.25 * k, 0, 0.1}, {0.125, 0.3, 0.1}, 1000);
    BodyDescription& body = add_described(scene, slider.shape);
    body.position = {0, 0, 0.2 + (slider.height > 0 ? slider.height : -lowest_point(scene, body))};
    body.velocity = {2, 0, 0};
    World world = reference_world(scene);
    run_for(world, scene, 0.45);
    EXPECT_NEAR(world.states().velocity.back().x, 2, 1e-4);
    EXPECT_GT(world.states().position.back().x, 0.85);
  }
}

Scene scene_without_gravity() {
  Scene scene = empty_scene(2e-3, 0);
  scene.gravity = {};
  return scene;
}

TEST(ClosePasses, BodiesOfAllShapesPassAnEdge) {
  for (const double clearance : {1e-6, 1e-4, 1e-3, 4e-3}) {
    for (const Slider& slider : kSliders) {
      if (slider.height < 0) continue;
      SCOPED_TRACE(std::to_string(clearance) + slider.shape);
      Scene scene = scene_without_gravity();
      add_wall_box(scene, {0.3, 0, -0.05}, {0.1, 1, 0.05});
      BodyDescription& body = add_described(scene, slider.shape);
      body.position = {0, 0, slider.height + clearance};
      body.velocity = {3, 0, 0};
      World world = reference_world(scene);
      run_for(world, scene, 0.2);
      const BodyStates s = world.states();
      EXPECT_NEAR(norm(s.velocity.back() - Vec3d{3, 0, 0}), 0, 1e-9);
      EXPECT_NEAR(norm(s.angular_velocity.back()), 0, 1e-9);
    }
  }
}

TEST(ClosePasses, ABodyFallsBesideAWall) {
  Scene scene = scene_without_gravity();
  add_wall_box(scene, {0.151, 0, -0.5}, {0.1, 1, 0.5});
  add_box(scene, {0, 0, 0.2}, {0.05, 0.04, 0.03}, 1).velocity = {0, 0, -4};
  World world = reference_world(scene);
  run_for(world, scene, 0.15);
  EXPECT_NEAR(norm(world.states().velocity[1] - Vec3d{0, 0, -4}), 0, 1e-12);
}

/// Of free bodies, about the origin.
Vec3d angular_momentum(const Scene& scene, const BodyStates& s) {
  Vec3d sum;
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    const BodyDescription& body = scene.bodies[k];
    sum += body.mass * cross(s.position[k], s.velocity[k]) +
           rotate(s.orientation[k],
                  hadamard(body.inertia, rotate_back(s.orientation[k], s.angular_velocity[k])));
  }
  return sum;
}

TEST(ClosePasses, CornersThatHitKeepTheAngularMomentum) {
  for (const double down : {0.45, 1.5}) {  // the side is reached first, or the top
    SCOPED_TRACE(down);
    Scene scene = scene_without_gravity();
    add_box(scene, {}, {0.05, 0.04, 0.03}, 1).velocity = {0.1, 0.2, -0.3};
    add_box(scene, {0.103, 0.01, 0.0602}, {0.05, 0.04, 0.03}, 2).velocity = {-3, 0.1, -down};
    World world = reference_world(scene);
    const BodyStates start = world.states();
    run_for(world, scene, 0.01);
    const BodyStates end = world.states();
    const Vec3d gained = end.velocity[1] - start.velocity[1];
    EXPECT_GT(down < 1 ? gained.z : gained.x, 0.02);
    const Vec3d before = angular_momentum(scene, start);
    EXPECT_NEAR(norm(angular_momentum(scene, end) - before), 0, 1e-9 * norm(before));
  }
}

// It comes from above and from the side at once, and reaches the top first.
TEST(ClosePasses, WhatComesDownOnAnEdgeLandsOnTop) {
  for (const double ahead : {0.2, 0.5, 0.8}) {
    SCOPED_TRACE(ahead);
    Scene scene = scene_without_gravity();
    const double h = scene.stepping.time_step;
    add_wall_box(scene, {0.2, 0, -0.5}, {0.1, 1, 0.5});
    // The side is reached at `ahead` of the first step, the top at 0.9 of it.
    const Vec3d velocity{2, 0, -4};
    add_box(scene, {0.05 - ahead * h * velocity.x, 0, 0.03 - 0.9 * h * velocity.z},
            {0.05, 0.04, 0.03}, 1)
        .velocity = velocity;
    World world = reference_world(scene);
    world.step();
    EXPECT_NEAR(world.states().velocity[1].x, 2, 1e-9);
    EXPECT_GT(world.states().velocity[1].z, -3.9);
  }
}

}  // namespace
}  // namespace scree::physics
