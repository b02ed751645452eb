// What the model of affine bodies does not have is refused by name.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "dynamics/affine/affine_setup.h"
#include "host/error.h"
#include "tests/dynamics/affine_scenes.h"
#include "tests/exact_triangles.h"
#include "tests/tetrahedra_box.h"

namespace scree::affine {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string refusal(const std::function<void(Scene&)>& change) {
  Scene scene = test::affine_scene(0.01, 0.5);
  physics::add_box(scene, {}, {0.1, 0.1, 0.1}, 1);
  physics::add_box(scene, {1, 0, 0}, {0.1, 0.1, 0.1}, 1);
  change(scene);
  try {
    const World world(scene, physics::cpu_options());
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing";
}

Joint joint(JointKind kind) {
  Joint j;
  j.kind = kind;
  j.bodies = {0, 1};
  j.anchor = {0.5, 0, 0};
  return j;
}

TEST(AffineRefusals, TakesWhatItHas) {
  EXPECT_EQ(refusal([](Scene&) {}), "nothing");
  EXPECT_EQ(refusal([](Scene& s) { s.joints.push_back(joint(JointKind::ball)); }), "nothing");
  EXPECT_EQ(refusal([](Scene& s) {
              s.joints.push_back(joint(JointKind::slider));
              s.joints[0].bodies = {kWorldBody, 0};
            }),
            "nothing");
  EXPECT_EQ(refusal([](Scene& s) {
              s.joints.push_back(joint(JointKind::hinge));
              s.joints[0].motor = JointMotor{};
              s.joints[0].limits = {-1, 1};
              s.joints[0].friction = 2;
            }),
            "nothing");
  EXPECT_EQ(refusal([](Scene& s) { s.bodies[0].locks = lock_x | lock_ry | lock_rz; }), "nothing");
}

TEST(AffineRefusals, WhatItDoesNotHaveIsNamed) {
  EXPECT_THAT(refusal([](Scene& s) { s.materials[0].restitution = 0.5; }),
              AllOf(HasSubstr("restitution: 0.5"), HasSubstr("must be 0")));
  EXPECT_THAT(refusal([](Scene& s) { s.materials[0].cohesion = 2; }), HasSubstr("cohesion"));
  EXPECT_THAT(refusal([](Scene& s) { s.bodies[1].locks = lock_rx; }),
              HasSubstr("must be none, two or three"));
  EXPECT_THAT(
      refusal([](Scene& s) { s.joints.push_back(joint(JointKind::slider)); }),
      AllOf(HasSubstr("joints[0]"), HasSubstr("slider"), HasSubstr("the world or a fixed body")));
  EXPECT_THAT(refusal([](Scene& s) { s.joints.push_back(joint(JointKind::universal)); }),
              AllOf(HasSubstr("joints[0]"), HasSubstr("universal"), HasSubstr("cylindrical")));
  for (void (*const set)(Joint&) :
       {+[](Joint& j) { j.swing = 1; }, +[](Joint& j) { j.friction = 1; },
        +[](Joint& j) {
          j.swing = 1, j.limits = {-1, 1};
        },
        +[](Joint& j) { j.swing = 1, j.motor = JointMotor{}; }})
    EXPECT_THAT(
        refusal([&](Scene& s) {
          s.joints.push_back(joint(JointKind::ball));
          set(s.joints[0]);
        }),
        AllOf(HasSubstr("joints[0].type: \"ball\" with a swing, limits, a motor or friction"),
              HasSubstr("must be without these")));
  EXPECT_THAT(refusal([](Scene& s) {
                s.joints.push_back(joint(JointKind::hinge));
                s.joints[0].break_force = 5;
              }),
              HasSubstr("a joint that breaks"));
  EXPECT_THAT(refusal([](Scene& s) {
                s.periodicity.periodic[0] = true;
                s.periodicity.upper = {10, 10, 10};
              }),
              HasSubstr("periodic"));
  EXPECT_THAT(refusal([](Scene& s) { s.insertions.push_back({.time = 1}); }),
              HasSubstr("insertions"));
  EXPECT_THAT(refusal([](Scene& s) {
                s.insertions.push_back({.time = 1, .bodies = {s.bodies[0]}});
                s.insertions[0].bodies[0].entry = 4;
              }),
              HasSubstr("bodies[4].insert_at: 1 is not allowed: must be missing"));
}

TEST(AffineRefusals, ParametersHaveTheirRanges) {
  EXPECT_THAT(refusal([](Scene& s) { s.dynamics.parameters["reach"] = -1; }),
              AllOf(HasSubstr("dynamics.reach: -1"), HasSubstr("must be 0 or more")));
  EXPECT_THAT(refusal([](Scene& s) { s.dynamics.parameters["stiffness"] = 0; }),
              AllOf(HasSubstr("dynamics.stiffness: 0"), HasSubstr("excluded")));
}

/// Whether triangles of two boxes meet. @param numbers  of a triangle of each
void expect_meeting(const Scene& scene, const std::vector<int>& numbers) {
  const AffineSetup setup = affine_setup(scene);
  std::array<exact::Triangle, 2> found;
  for (std::size_t body = 0; body < 2; ++body) {
    const Surface& surface = *setup.surfaces[static_cast<std::size_t>(setup.surface_of_body[body])];
    const auto number = static_cast<std::size_t>(body == 0 ? numbers.front() : numbers.back());
    for (std::size_t k = 0; k < 3; ++k)
      found[body][k] =
          point_of(setup.position[body],
                   surface.vertices[static_cast<std::size_t>(surface.triangles.at(number)[k])]);
  }
  EXPECT_TRUE(exact::triangles_touch(found[0], found[1]));
}

/// Whole numbers in a text that follow a word.
std::vector<int> numbers_after(const std::string& text, const std::string& word) {
  std::vector<int> numbers;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1))
    numbers.push_back(std::stoi(text.substr(at + word.size())));
  return numbers;
}

TEST(AffineRefusals, BodiesThatIntersectAreNamedWithTheirTriangles) {
  Scene scene;
  const std::string message = refusal([&](Scene& s) {
    s.bodies[1].position = {0.15, 0.05, 0.02};
    s.bodies[0].entry = 3;
    s.body_names = {{"lid", 0}, {"pot", 1}};
    scene = s;
  });
  EXPECT_THAT(message, AllOf(HasSubstr("bodies[3] \"lid\""), HasSubstr("body 1 \"pot\""),
                             HasSubstr(" intersect at the start: triangle "),
                             HasSubstr("between corners ")));
  std::vector<int> numbers = numbers_after(message, "triangle ");
  ASSERT_EQ(numbers.size(), 2u) << message;
  if (message.starts_with("body 1")) std::swap(numbers[0], numbers[1]);
  expect_meeting(scene, numbers);
}

TEST(AffineRefusals, BodiesThatTouchAreNamedWithTheirTriangles) {
  Scene scene;
  const auto beside = [&](double x, double far) {
    return refusal([&](Scene& s) {
      s.bodies[0].position.x = far;
      s.bodies[1].position = {far + x, 0, 0};
      s.body_names = {{"lid", 0}};
      scene = s;
    });
  };
  const std::string message = beside(0.2, 0);
  EXPECT_THAT(message, AllOf(HasSubstr("body 0 \"lid\""), HasSubstr("body 1"),
                             HasSubstr(" touch at the start: triangle ")));
  std::vector<int> numbers = numbers_after(message, "triangle ");
  ASSERT_EQ(numbers.size(), 2u) << message;
  if (message.starts_with("body 1")) std::swap(numbers[0], numbers[1]);
  expect_meeting(scene, numbers);
  // What rounding makes of a gap is none, and neither is what rounding takes away.
  EXPECT_THAT(beside(std::nextafter(0.2, 1), 0), HasSubstr("touch at the start"));
  EXPECT_THAT(beside(std::nextafter(0.2, 0), 0), HasSubstr("touch at the start"));
  EXPECT_THAT(beside(0.2 + 1e-13, 0), HasSubstr("touch at the start"));
  EXPECT_EQ(beside(0.2 + 1e-11, 0), "nothing");
  // It is larger far from the origin.
  EXPECT_THAT(beside(0.2 + 1e-11, 1000), HasSubstr("touch at the start"));
  EXPECT_EQ(beside(0.2 + 1e-8, 1000), "nothing");
}

TEST(AffineRefusals, ElasticBodiesThatIntersectAreNamedWithTheirTriangles) {
  Scene scene = test::affine_scene(0.01, 0.5);
  test::add_elastic_box(scene, {0, 0, 0}, {0.4, 0.4, 0.4}, {3, 3, 3}, 1000, {1e6, 0.3});
  physics::add_box(scene, {0.25, 0.03, 0.02}, {0.1, 0.1, 0.1}, 1);
  scene.body_names = {{"jelly", 0}};
  try {
    const World world(scene, physics::cpu_options());
    FAIL() << "no error";
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_THAT(message, AllOf(HasSubstr("body 0 \"jelly\""), HasSubstr("body 1"),
                               HasSubstr("intersect at the start: triangle ")));
    std::vector<int> numbers = numbers_after(message, "triangle ");
    ASSERT_EQ(numbers.size(), 2u) << message;
    if (message.starts_with("body 1")) std::swap(numbers[0], numbers[1]);
    // Of the elastic one as its mesh numbers them.
    const TriangleMesh& mesh = scene.meshes[static_cast<std::size_t>(scene.bodies[0].shape.mesh)];
    const AffineSetup setup = affine_setup(scene);
    const Surface& box = *setup.surfaces[static_cast<std::size_t>(setup.surface_of_body[1])];
    exact::Triangle first, second;
    for (std::size_t k = 0; k < 3; ++k) {
      first[k] = mesh.vertices[static_cast<std::size_t>(
          mesh.triangles.at(static_cast<std::size_t>(numbers[0]))[k])];
      second[k] = point_of(setup.position[1],
                           box.vertices[static_cast<std::size_t>(
                               box.triangles.at(static_cast<std::size_t>(numbers[1]))[k])]);
    }
    EXPECT_TRUE(exact::triangles_touch(first, second)) << message;
  }
}

}  // namespace
}  // namespace scree::affine
