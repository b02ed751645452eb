// What the model of affine bodies does not have is refused by name.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "host/error.h"
#include "tests/dynamics/affine_scenes.h"

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

TEST(AffineRefusals, BodiesThatTouchAreNamed) {
  EXPECT_THAT(refusal([](Scene& s) {
                s.bodies[1].position = {0.2, 0, 0};
              }),
              HasSubstr("bodies 0 and 1 touch at the start"));
}

}  // namespace
}  // namespace scree::affine
