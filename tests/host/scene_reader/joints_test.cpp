// Joints of scene files: what is read, what is refused, what the world of a program refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/problems/body_problem.h"
#include "host/world_state.h"
#include "tests/host/input_files.h"
#include "tests/host/scene_texts.h"
#include "tests/physics/joint_scenes.h"

namespace scree {
namespace {

using test::parsed;
using test::refusal;
using testing::HasSubstr;
using testing::StartsWith;

/// A ball with a name, one that joins later, a box without a name, a floor; and joints.
std::string with_joints(const std::string& joints, const std::string& keys = "") {
  return R"({"time_step": 1e-3, "duration": 1, "bodies": [
    {"name": "bob", "shape": "sphere", "radius": 0.1, "density": 1000},
    {"name": "late", "shape": "sphere", "radius": 0.1, "density": 1000, "insert_at": 1},
    {"shape": "box", "size": [1, 1, 1], "density": 1000, "position": [0, 0, 3]},
    {"name": "floor", "shape": "half_space"}], )" +
         keys + R"("joints": [)" + joints + "]}";
}

TEST(Joints, AreRead) {
  const Scene scene = parsed(with_joints(R"(
      {"type": "hinge", "bodies": ["world", "bob"], "anchor": [0, 0, 1], "axis": [0, 3, 0]},
      {"type": "ball", "bodies": ["bob", 2], "anchor": [0, 0.5, 0]},
      {"type": "fixed", "bodies": [2, "floor"], "anchor": [1, 2, 3]})"));
  ASSERT_EQ(scene.joints.size(), 3u);
  EXPECT_EQ(scene.joints[0].kind, JointKind::hinge);
  EXPECT_EQ(scene.joints[0].bodies, (std::array{kWorldBody, 0}));
  EXPECT_EQ(scene.joints[0].anchor, (Vec3d{0, 0, 1}));
  EXPECT_EQ(scene.joints[0].axis, (Vec3d{0, 1, 0}));
  EXPECT_EQ(scene.joints[1].kind, JointKind::ball);
  // The second entry joins later, so the box is the second of Scene::bodies.
  EXPECT_EQ(scene.joints[1].bodies, (std::array{0, 1}));
  EXPECT_EQ(scene.joints[2].kind, JointKind::fixed);
  EXPECT_EQ(scene.joints[2].bodies, (std::array{1, 2}));
}

TEST(Joints, OfAllKindsAreRead) {
  const Scene scene = parsed(with_joints(R"(
      {"type": "slider", "bodies": ["world", 2], "anchor": [0, 0, 1], "axis": [2, 0, 0],
       "limits": [-1, 2], "motor": {"speed": 3, "max_force": 4}, "friction": 5, "break_force": 6,
       "break_moment": 7},
      {"type": "cylindrical", "bodies": ["world", 2], "anchor": [0, 0, 1], "axis": [0, 0, 1]},
      {"type": "universal", "bodies": ["bob", 2], "anchor": [0, 0, 1], "axis": [0, 0, 1],
       "second_axis": [0, 3, 0]},
      {"type": "distance", "bodies": ["bob", 2], "anchors": [[1, 0, 0], [0, 2, 0]]},
      {"type": "cable", "bodies": ["bob", 2], "anchors": [[1, 0, 0], [0, 2, 0]], "length": 5},
      {"type": "spring", "bodies": ["bob", 2], "anchors": [[1, 0, 0], [0, 2, 0]], "length": 0,
       "stiffness": 100, "damping": 2},
      {"type": "hinge", "bodies": ["world", "bob"], "anchor": [0, 0, 1], "axis": [0, 3, 0],
       "motor": {"position": 0.5, "stiffness": 10, "damping": 1}})"));
  ASSERT_EQ(scene.joints.size(), 7u);
  const Joint& slider = scene.joints[0];
  EXPECT_EQ(slider.kind, JointKind::slider);
  EXPECT_EQ(slider.axis, (Vec3d{1, 0, 0}));
  EXPECT_EQ(slider.limits, (std::array{-1.0, 2.0}));
  ASSERT_TRUE(slider.motor);
  EXPECT_EQ(slider.motor->speed, 3);
  EXPECT_EQ(slider.motor->max_force, 4);
  EXPECT_EQ(slider.friction, 5);
  EXPECT_EQ(slider.break_force, 6);
  EXPECT_EQ(slider.break_moment, 7);
  EXPECT_EQ(scene.joints[1].kind, JointKind::cylindrical);
  EXPECT_FALSE(scene.joints[1].motor);
  EXPECT_EQ(scene.joints[2].second_axis, (Vec3d{0, 1, 0}));
  EXPECT_EQ(scene.joints[3].anchor, (Vec3d{1, 0, 0}));
  EXPECT_EQ(scene.joints[3].second_anchor, (Vec3d{0, 2, 0}));
  EXPECT_LT(scene.joints[3].length, 0);
  EXPECT_EQ(scene.joints[4].kind, JointKind::cable);
  EXPECT_EQ(scene.joints[4].length, 5);
  EXPECT_EQ(scene.joints[5].length, 0);
  EXPECT_EQ(scene.joints[5].stiffness, 100);
  EXPECT_EQ(scene.joints[5].damping, 2);
  EXPECT_EQ(scene.joints[6].motor->position, 0.5);
  EXPECT_EQ(scene.joints[6].motor->stiffness, 10);
  EXPECT_TRUE(std::isinf(scene.joints[6].motor->max_force));
}

TEST(Joints, MotorsWithATorqueOrAForceAreRead) {
  const Scene scene = parsed(with_joints(R"(
      {"type": "hinge", "bodies": ["world", "bob"], "anchor": [0, 0, 1], "axis": [0, 1, 0],
       "motor": {"torque": -0.05}},
      {"type": "slider", "bodies": ["world", 2], "anchor": [0, 0, 1], "axis": [1, 0, 0],
       "motor": {"force": 7, "damping": 2}})"));
  EXPECT_EQ(scene.joints[0].motor->force, -0.05);
  EXPECT_FALSE(scene.joints[0].motor->keeps_speed());
  EXPECT_EQ(scene.joints[1].motor->force, 7);
  EXPECT_EQ(scene.joints[1].motor->damping, 2);
}

TEST(Joints, CylindricalOnesMayBeDrivenAlongAndAboutTheirAxis) {
  const Scene scene = parsed(with_joints(R"(
      {"type": "cylindrical", "bodies": ["world", 2], "anchor": [0, 0, 1], "axis": [0, 0, 1],
       "limits": [-1, 2], "motor": {"force": 4}, "friction": 5,
       "turn": {"limits": [-3, 4], "motor": {"torque": 6}, "friction": 7}},
      {"type": "cylindrical", "bodies": ["world", 2], "anchor": [0, 0, 1], "axis": [0, 0, 1]})"));
  const Joint& joint = scene.joints[0];
  EXPECT_EQ(joint.limits, (std::array{-1.0, 2.0}));
  EXPECT_EQ(joint.motor->force, 4);
  EXPECT_EQ(joint.friction, 5);
  EXPECT_EQ(joint.turn.limits, (std::array{-3.0, 4.0}));
  EXPECT_EQ(joint.turn.motor->force, 6);
  EXPECT_EQ(joint.turn.friction, 7);
  EXPECT_FALSE(scene.joints[1].turn.motor);
  EXPECT_TRUE(std::isinf(scene.joints[1].turn.limits[0]));
}

TEST(Joints, BallJointsMayHaveAConeLimitsAMotorAndFriction) {
  const Scene scene = parsed(with_joints(R"(
      {"type": "ball", "bodies": ["world", 2], "anchor": [0, 0, 1], "axis": [0, 0, 2],
       "swing": 0.5, "swing_axis": [0, 3, 0], "limits": [-1, 2], "motor": {"torque": 4},
       "friction": 5, "break_moment": 6},
      {"type": "ball", "bodies": ["world", 2], "anchor": [0, 0, 1], "friction": 7},
      {"type": "ball", "bodies": ["world", 2], "anchor": [0, 0, 1], "axis": [0, 0, 1]})"));
  const Joint& joint = scene.joints[0];
  EXPECT_EQ(joint.axis, (Vec3d{0, 0, 1}));
  EXPECT_EQ(joint.swing, 0.5);
  EXPECT_EQ(joint.swing_axis, (Vec3d{0, 1, 0}));
  EXPECT_EQ(joint.limits, (std::array{-1.0, 2.0}));
  EXPECT_EQ(joint.motor->force, 4);
  EXPECT_EQ(joint.friction, 5);
  EXPECT_EQ(joint.break_moment, 6);
  EXPECT_EQ(scene.joints[1].friction, 7);
  EXPECT_TRUE(std::isinf(scene.joints[1].swing));
  EXPECT_FALSE(scene.joints[1].swing_axis);
}

TEST(Joints, UniversalOnesMayBeDrivenAboutBothAxes) {
  const Scene scene = parsed(with_joints(R"(
      {"type": "universal", "bodies": ["world", 2], "anchor": [0, 0, 1], "axis": [0, 0, 1],
       "second_axis": [1, 0, 0], "limits": [-1, 2], "motor": {"torque": 4}, "friction": 5,
       "second_turn": {"limits": [-3, 4], "motor": {"speed": 6}, "friction": 7}})"));
  const Joint& joint = scene.joints[0];
  EXPECT_EQ(joint.limits, (std::array{-1.0, 2.0}));
  EXPECT_EQ(joint.motor->force, 4);
  EXPECT_EQ(joint.friction, 5);
  EXPECT_EQ(joint.second_turn.limits, (std::array{-3.0, 4.0}));
  EXPECT_EQ(joint.second_turn.motor->speed, 6);
  EXPECT_EQ(joint.second_turn.friction, 7);
  EXPECT_FALSE(joint.turn.motor);
}

struct Refusal {
  const char* what;
  std::string text;
  std::string message;
};
class JointRefusal : public testing::TestWithParam<Refusal> {};

TEST_P(JointRefusal, NamesPathValueAndExpectation) {
  EXPECT_THAT(refusal([] { parsed(GetParam().text); }),
              StartsWith("x.json: " + GetParam().message));
}

const std::string kAt = R"(, "anchor": [0, 0, 1])";
/// A scene with one joint of `bob` to the world, its other keys given.
std::string joint(const std::string& type, const std::string& keys) {
  return with_joints(R"({"type": ")" + type + R"(", "bodies": ["world", "bob"], )" + keys + "}");
}
std::string hinge(const std::string& keys) {
  return joint("hinge", R"("anchor": [0, 0, 1], "axis": [0, 1, 0], )" + keys);
}
std::string cylindrical(const std::string& keys) {
  return joint("cylindrical", R"("anchor": [0, 0, 1], "axis": [0, 1, 0], )" + keys);
}
std::string ball(const std::string& keys) {
  return joint("ball", R"("anchor": [0, 0, 1], )" + keys);
}
std::string turning_ball(const std::string& keys) { return ball(R"("axis": [0, 1, 0], )" + keys); }
std::string universal(const std::string& keys) {
  return joint("universal",
               R"("anchor": [0, 0, 1], "axis": [0, 1, 0], "second_axis": [1, 0, 0], )" + keys);
}
std::string line(const std::string& type, const std::string& keys) {
  return joint(type, R"("anchors": [[0, 0, 1], [0, 0, 0]])" + keys);
}

INSTANTIATE_TEST_SUITE_P(
    Joints, JointRefusal,
    testing::Values(
        Refusal{"Type",
                with_joints(R"({"type": "hing", "bodies": ["world", 0], "axis": [0, 1, 0])" + kAt +
                            "}"),
                "joints[0].type: \"hing\" is not allowed: must be one of \"hinge\", \"ball\", "
                "\"fixed\", \"slider\", \"cylindrical\", \"universal\", \"distance\", \"cable\", "
                "\"spring\"; did you mean \"hinge\"?"},
        Refusal{"NoType", with_joints(R"({"bodies": ["world", 0])" + kAt + "}"),
                "joints[0].type: missing: must be one of"},
        Refusal{"NoAxis", with_joints(R"({"type": "hinge", "bodies": ["world", 0])" + kAt + "}"),
                "joints[0].axis: missing: a hinge needs the direction it turns about"},
        Refusal{"AxisOfFixed",
                with_joints(R"({"type": "fixed", "bodies": ["world", 0], "axis": [0, 1, 0])" + kAt +
                            "}"),
                "joints[0].axis: a joint of type \"fixed\" has no such key"},
        Refusal{"NoAnchor", with_joints(R"({"type": "ball", "bodies": ["world", 0]})"),
                "joints[0].anchor: missing: must be a point of both bodies"},
        Refusal{"FarAnchor",
                with_joints(R"({"type": "ball", "bodies": ["world", 0], "anchor": [0, 0, 1e30]})"),
                "joints[0].anchor: [0, 0, 1e+30] is not allowed: must be three numbers from"},
        Refusal{"OneBody", with_joints(R"({"type": "ball", "bodies": ["bob"])" + kAt + "}"),
                "joints[0].bodies: [\"bob\"] is not allowed: must be two bodies"},
        Refusal{"WrongName",
                with_joints(R"({"type": "ball", "bodies": ["bob", "flor"])" + kAt + "}"),
                "joints[0].bodies[1]: \"flor\" is not allowed: must be the `name` of one of "
                "`bodies`, its number in that list from 0, or \"world\"; did you mean \"floor\"?"},
        Refusal{"WrongNumber", with_joints(R"({"type": "ball", "bodies": ["bob", 4])" + kAt + "}"),
                "joints[0].bodies[1]: 4 is not allowed"},
        Refusal{"Late", with_joints(R"({"type": "ball", "bodies": ["bob", "late"])" + kAt + "}"),
                "joints[0].bodies[1]: \"late\" is not allowed: must be there from the start"},
        Refusal{"SameBody", with_joints(R"({"type": "ball", "bodies": ["bob", 0])" + kAt + "}"),
                "joints[0].bodies: the same body twice is not allowed"},
        Refusal{"NotFree",
                with_joints(R"({"type": "ball", "bodies": ["world", "floor"])" + kAt + "}"),
                "joints[0].bodies: a joint of two bodies that are not free is not allowed"},
        Refusal{"ZeroAxis", joint("slider", R"("anchor": [0, 0, 1], "axis": [0, 0, 0])"),
                "joints[0].axis: [0,0,0] is not allowed"},
        Refusal{"NoSecondAxis", joint("universal", R"("anchor": [0, 0, 1], "axis": [0, 0, 1])"),
                "joints[0].second_axis: missing: a universal joint needs the axis of its cross in "
                "the second body"},
        Refusal{"SkewSecondAxis",
                joint("universal",
                      R"("anchor": [0, 0, 1], "axis": [0, 0, 1], "second_axis": [0, 0, 5])"),
                "joints[0].second_axis: [0, 0, 1] is not allowed: must be at a right angle to "
                "`axis`, which is [0, 0, 1]"},
        Refusal{"SecondAxisOfHinge", hinge(R"("second_axis": [1, 0, 0])"),
                "joints[0].second_axis: a joint of type \"hinge\" has no such key"},
        Refusal{"AnchorsOfHinge", hinge(R"("anchors": [[0, 0, 1], [0, 0, 0]])"),
                "joints[0].anchors: a joint of type \"hinge\" has no such key"},
        Refusal{"AnchorOfCable", line("cable", R"(, "anchor": [0, 0, 1])"),
                "joints[0].anchor: a joint of type \"cable\" has no such key"},
        Refusal{"NoAnchors", joint("distance", R"("length": 1)"),
                "joints[0].anchors: missing: must be two points at the start"},
        Refusal{"OneAnchor", joint("distance", R"("anchors": [[0, 0, 1]])"),
                "joints[0].anchors: [[0,0,1]] is not allowed: must be two points at the start"},
        Refusal{"FarSecondAnchor", joint("cable", R"("anchors": [[0, 0, 1], [0, 0, 1e30]])"),
                "joints[0].anchors[1]: [0, 0, 1e+30] is not allowed"},
        Refusal{"NoDistance", joint("distance", R"("anchors": [[0, 0, 1], [0, 0, 1]])"),
                "joints[0].anchors: one point twice is not allowed: a distance of zero has no "
                "direction; use a ball joint"},
        Refusal{"ZeroLength", line("distance", R"(, "length": 0)"),
                "joints[0].length: 0 is not allowed: must be positive"},
        Refusal{"ZeroLengthOfCable", line("cable", R"(, "length": 0)"),
                "joints[0].length: 0 is not allowed: must be positive"},
        Refusal{"NegativeLength", line("spring", R"(, "length": -1, "stiffness": 1)"),
                "joints[0].length: -1 is not allowed: must be zero or positive"},
        Refusal{"NoLengthOfCable", joint("cable", R"("anchors": [[0, 0, 1], [0, 0, 1]])"),
                "joints[0].anchors: one point twice is not allowed: a distance of zero has no "
                "direction; use a ball joint"},
        Refusal{"LengthOfHinge", hinge(R"("length": 1)"),
                "joints[0].length: a joint of type \"hinge\" has no such key"},
        Refusal{"LimitsReversed", hinge(R"("limits": [1, -1])"),
                "joints[0].limits: [1,-1] is not allowed: must be two numbers [low, high], low "
                "below high"},
        Refusal{"LimitsOfFixed", joint("fixed", R"("anchor": [0, 0, 1], "limits": [-1, 1])"),
                "joints[0].limits: a joint of type \"fixed\" has no such key"},
        Refusal{"LimitsOfBallWithoutAxis",
                joint("ball", R"("anchor": [0, 0, 1], "limits": [-1, 1])"),
                "joints[0].axis: missing: a ball joint needs the direction that its swing, limits "
                "and motor are about"},
        Refusal{"SwingWithoutAxis", joint("ball", R"("anchor": [0, 0, 1], "swing": 1)"),
                "joints[0].axis: missing: a ball joint needs the direction that its swing, limits "
                "and motor are about"},
        Refusal{"ZeroAxisOfBall", ball(R"("swing": 1, "axis": [0, 0, 0])"),
                "joints[0].axis: [0,0,0] is not allowed: must be a direction, not of zero length"},
        Refusal{"ZeroSwingAxis", turning_ball(R"("swing": 1, "swing_axis": [0, 0, 0])"),
                "joints[0].swing_axis: [0,0,0] is not allowed: must be a direction"},
        Refusal{"OppositeSwingAxis", turning_ball(R"("swing": 1, "swing_axis": [0, -1, 0])"),
                "joints[0].swing_axis: [0, -1, 0] is not allowed: must be 3 rad from `axis` at "
                "most, which is [0, 1, 0]"},
        Refusal{"WideSwing", turning_ball(R"("swing": 3.2)"),
                "joints[0].swing: 3.2 is not allowed: must be an angle above 0 and up to 3.14159 "
                "[rad]"},
        Refusal{"NoSwing", turning_ball(R"("swing": 0)"),
                "joints[0].swing: 0 is not allowed: must be positive"},
        Refusal{"NegativeSwing", turning_ball(R"("swing": -1)"),
                "joints[0].swing: -1 is not allowed: must be positive"},
        Refusal{"SwingInWords", turning_ball(R"("swing": "wide")"),
                "joints[0].swing: \"wide\" is not allowed"},
        Refusal{"LimitsBesideAWideSwing", turning_ball(R"("swing": 3.1, "limits": [-1, 1])"),
                "joints[0].swing: 3.1 is not allowed: must be up to 3 [rad] beside limits or a "
                "motor: where the axes of the bodies are opposite, there is no angle about them"},
        Refusal{"MotorWithoutSwing", turning_ball(R"("motor": {"speed": 1})"),
                "joints[0].swing: none is not allowed: must be up to 3 [rad] beside limits or a "
                "motor"},
        Refusal{"LimitsOfBallReversed", turning_ball(R"("swing": 1, "limits": [1, -1])"),
                "joints[0].limits: [1,-1] is not allowed: must be two numbers [low, high], low "
                "below high"},
        Refusal{"NegativeFrictionOfBall", ball(R"("friction": -1)"),
                "joints[0].friction: -1 is not allowed: must be zero or positive"},
        Refusal{"HugeFrictionOfBall", ball(R"("friction": 1e30)"),
                "joints[0].friction: 1e+30 is not allowed: must be zero or positive and up to"},
        Refusal{"ForceOfBall", turning_ball(R"("swing": 1, "motor": {"force": 1})"),
                "joints[0].motor.force: a motor of this joint has no such key, it has \"torque\""},
        Refusal{"SwingOfHinge", hinge(R"("swing": 1)"),
                "joints[0].swing: a joint of type \"hinge\" has no such key"},
        Refusal{"SwingAxisOfHinge", hinge(R"("swing_axis": [1, 0, 0])"),
                "joints[0].swing_axis: a joint of type \"hinge\" has no such key"},
        Refusal{"TurnOfUniversal", universal(R"("turn": {"friction": 1})"),
                "joints[0].turn: a joint of type \"universal\" has no such key"},
        Refusal{"SecondTurnOfCylindrical", cylindrical(R"("second_turn": {"friction": 1})"),
                "joints[0].second_turn: a joint of type \"cylindrical\" has no such key"},
        Refusal{"LimitsOfUniversalReversed", universal(R"("limits": [1, -1])"),
                "joints[0].limits: [1,-1] is not allowed: must be two numbers"},
        Refusal{"LimitsOfSecondTurnReversed", universal(R"("second_turn": {"limits": [1, -1]})"),
                "joints[0].second_turn.limits: [1,-1] is not allowed: must be two numbers"},
        Refusal{"NegativeFrictionOfSecondTurn", universal(R"("second_turn": {"friction": -1})"),
                "joints[0].second_turn.friction: -1 is not allowed: must be zero or positive"},
        Refusal{"HugeFrictionOfSecondTurn", universal(R"("second_turn": {"friction": 1e30})"),
                "joints[0].second_turn.friction: 1e+30 is not allowed: must be zero or positive "
                "and up to"},
        Refusal{"ForceOfSecondTurn", universal(R"("second_turn": {"motor": {"force": 1}})"),
                "joints[0].second_turn.motor.force: a motor of this joint has no such key, it has "
                "\"torque\""},
        Refusal{"UnknownKeyOfSecondTurn", universal(R"("second_turn": {"axis": [0, 0, 1]})"),
                "joints[0].second_turn.axis: unknown key. Known keys: limits, motor, friction"},
        Refusal{"MotorOfCable", line("cable", R"(, "motor": {"speed": 1})"),
                "joints[0].motor: a joint of type \"cable\" has no such key"},
        Refusal{"FrictionOfSpring", line("spring", R"(, "stiffness": 1, "friction": 1)"),
                "joints[0].friction: a joint of type \"spring\" has no such key"},
        Refusal{"NegativeFriction", hinge(R"("friction": -1)"),
                "joints[0].friction: -1 is not allowed: must be zero or positive"},
        Refusal{"HugeFriction", hinge(R"("friction": 1e30)"),
                "joints[0].friction: 1e+30 is not allowed: must be zero or positive and up to"},
        Refusal{"MotorWithoutTarget", hinge(R"("motor": {"max_force": 1})"),
                "joints[0].motor: must have either \"speed\", or \"position\""},
        Refusal{"MotorWithTwoTargets",
                hinge(R"("motor": {"speed": 1, "position": 1, "stiffness": 1})"),
                "joints[0].motor: must have either \"speed\", or \"position\""},
        Refusal{"TorqueWithSpeed", hinge(R"("motor": {"speed": 1, "torque": 1})"),
                "joints[0].motor.speed: a motor with \"torque\" has no such key"},
        Refusal{"TorqueWithPosition",
                hinge(R"("motor": {"torque": 1, "position": 1, "stiffness": 1})"),
                "joints[0].motor.position: a motor with \"torque\" has no such key"},
        Refusal{"TorqueWithMaxForce", hinge(R"("motor": {"torque": 1, "max_force": 1})"),
                "joints[0].motor.max_force: a motor with \"torque\" has no such key"},
        Refusal{"ForceOfHinge", hinge(R"("motor": {"force": 1})"),
                "joints[0].motor.force: a motor of this joint has no such key, it has \"torque\""},
        Refusal{
            "TorqueOfSlider",
            joint("slider", R"("anchor": [0, 0, 1], "axis": [0, 1, 0], "motor": {"torque": 1})"),
            "joints[0].motor.torque: a motor of this joint has no such key, it has \"force\""},
        Refusal{"HugeTorque", hinge(R"("motor": {"torque": 1e30})"),
                "joints[0].motor.torque: 1e+30 is not allowed: must be from"},
        Refusal{"TorqueInWords", hinge(R"("motor": {"torque": "1"})"),
                "joints[0].motor.torque: \"1\" is not allowed"},
        Refusal{"TurnOfHinge", hinge(R"("turn": {"friction": 1})"),
                "joints[0].turn: a joint of type \"hinge\" has no such key"},
        Refusal{"UnknownKeyOfTurn", cylindrical(R"("turn": {"axis": [0, 0, 1]})"),
                "joints[0].turn.axis: unknown key. Known keys: limits, motor, friction"},
        Refusal{"ForceOfTurn", cylindrical(R"("turn": {"motor": {"force": 1}})"),
                "joints[0].turn.motor.force: a motor of this joint has no such key, it has "
                "\"torque\""},
        Refusal{"HugeFrictionOfTurn", cylindrical(R"("turn": {"friction": 1e30})"),
                "joints[0].turn.friction: 1e+30 is not allowed: must be zero or positive and up "
                "to"},
        Refusal{"HugeTorqueOfTurn", cylindrical(R"("turn": {"motor": {"torque": 1e30}})"),
                "joints[0].turn.motor.torque: 1e+30 is not allowed: must be from"},
        Refusal{"PositionWithoutStiffness", hinge(R"("motor": {"position": 1})"),
                "joints[0].motor.stiffness: missing"},
        Refusal{"SpeedWithStiffness", hinge(R"("motor": {"speed": 1, "stiffness": 1})"),
                "joints[0].motor.stiffness: a motor with \"speed\" has no such key"},
        Refusal{"MotorWithoutForce", hinge(R"("motor": {"speed": 1, "max_force": 0})"),
                "joints[0].motor.max_force: 0 is not allowed: must be positive"},
        Refusal{"HugeSpeed", hinge(R"("motor": {"speed": 1e30})"),
                "joints[0].motor.speed: 1e+30 is not allowed: must be from"},
        Refusal{"UnknownKeyOfMotor", hinge(R"("motor": {"sped": 1})"),
                "joints[0].motor.sped: unknown key"},
        Refusal{"NoStiffness", line("spring", ""), "joints[0].stiffness: missing: must be that of"},
        Refusal{"SlackSpring", line("spring", R"(, "stiffness": 0)"),
                "joints[0].stiffness: 0 without damping is not allowed: a spring must pull or "
                "damp"},
        Refusal{"StiffnessOfCable", line("cable", R"(, "stiffness": 5)"),
                "joints[0].stiffness: a joint of type \"cable\" has no such key"},
        Refusal{
            "BreakMomentOfALine", line("cable", R"(, "break_moment": 4)"),
            "joints[0].break_moment: 4 of a \"cable\" is not allowed: between two points no moment "
            "acts; take break_force"},
        Refusal{"BreakForce", hinge(R"("break_force": 0)"),
                "joints[0].break_force: 0 is not allowed: must be positive"},
        Refusal{"BreakMomentOfABall",
                with_joints(R"({"type": "ball", "bodies": ["world", 0])" + kAt +
                            R"(, "break_moment": 4})"),
                "joints[0].break_moment: 4 of a \"ball\" is not allowed: a ball joint without "
                "swing, limits, a motor and friction carries no moment; take break_force"},
        Refusal{"BreakMoment", hinge(R"("break_moment": -2)"),
                "joints[0].break_moment: -2 is not allowed: must be positive"},
        Refusal{"UnknownKey",
                with_joints(R"({"type": "ball", "body": 1, "bodies": ["world", 0])" + kAt + "}"),
                "joints[0].body: unknown key. Known keys: type, bodies, anchor, axis, "
                "anchors, second_axis, length, limits, motor, friction, turn, second_turn, swing, "
                "swing_axis, stiffness, damping, break_force, break_moment"},
        Refusal{"NameTwice", test::with_body(R"({"name": "a", "shape": "half_space"},
                                                {"name": "a", "shape": "half_space"})"),
                "bodies[2].name: \"a\" is not allowed: bodies[1] has this name"},
        Refusal{"NameOfWorld", test::with_body(R"({"name": "world", "shape": "half_space"})"),
                "bodies[1].name: \"world\" is not allowed: must be a name, and not \"world\""}),
    [](const auto& one) { return std::string(one.param.what); });

TEST(Joints, OfProgramsAreCheckedToo) {
  Scene scene = physics::empty_scene(1e-3, 0);
  physics::add_sphere(scene, {}, 0.1, 1);
  scene.joints.push_back({JointKind::hinge, {kWorldBody, 1}, {0, 0, 1}, {0, 1, 0}});
  EXPECT_THAT(refusal([&] { validate(scene); }),
              StartsWith("joints[0].bodies[1]: 1 is not allowed"));
  scene.joints[0] = {JointKind::hinge, {kWorldBody, 0}, {0, 0, 1}, {0, 2, 0}};
  EXPECT_THAT(refusal([&] { validate(scene); }),
              StartsWith("joints[0].axis: [0, 2, 0] is not allowed: must have length 1"));
  Joint& joint = scene.joints[0];
  joint.axis = {0, 1, 0};
  joint.limits = {1, -1};
  EXPECT_EQ(refusal([&] { validate(scene); }),
            "joints[0].limits: [1, -1] is not allowed: must be two numbers, the lower one first");
  joint.limits = {-1, 1};
  joint.motor = JointMotor{.stiffness = -1};
  EXPECT_THAT(refusal([&] { validate(scene); }),
              StartsWith("joints[0].motor.stiffness: -1 is not allowed"));
  joint.motor = JointMotor{.speed = 2, .force = 3};
  EXPECT_EQ(refusal([&] { validate(scene); }),
            "joints[0].motor.torque: 3 is not allowed: must be without speed, position, stiffness "
            "and max_force: a motor has one law");
  joint.motor = JointMotor{};
  joint.kind = JointKind::fixed;
  EXPECT_EQ(refusal([&] { validate(scene); }),
            "joints[0].type: \"fixed\" with limits, a motor or friction is not allowed: a hinge, a "
            "ball joint, a slider, a cylindrical or a universal joint can have these");
  joint.kind = JointKind::ball;
  for (const double swing : {0.0, -1.0, 4.0, std::numeric_limits<double>::quiet_NaN(),
                             -std::numeric_limits<double>::infinity()}) {
    joint.swing = swing;
    EXPECT_THAT(refusal([&] { validate(scene); }),
                AllOf(StartsWith("joints[0].swing: "), HasSubstr("above 0 and up to 3.14159")));
  }
  joint.swing = 1;
  joint.swing_axis = Vec3d{0, 2, 0};
  EXPECT_EQ(refusal([&] { validate(scene); }),
            "joints[0].swing_axis: [0, 2, 0] is not allowed: must have length 1");
  joint.swing_axis.reset();
  joint.kind = JointKind::hinge;
  EXPECT_EQ(refusal([&] { validate(scene); }),
            "joints[0].type: \"hinge\" with a swing is not allowed: a ball joint can have it");
  joint.swing = std::numeric_limits<double>::infinity();
  joint.second_turn.friction = 1;
  EXPECT_EQ(refusal([&] { validate(scene); }),
            "joints[0].type: \"hinge\" with a second turn is not allowed: a universal joint can "
            "have it");
  joint.second_turn = {};
  joint.kind = JointKind::hinge;
  joint.turn.friction = 1;
  EXPECT_EQ(
      refusal([&] { validate(scene); }),
      "joints[0].type: \"hinge\" with a turn is not allowed: a cylindrical joint can have it");
}

/// A ball that hangs from the world.
Scene hanging_ball() {
  Scene scene = physics::empty_scene(1e-3, 0);
  physics::add_sphere(scene, {}, 0.1, 1);
  scene.joints.push_back({JointKind::hinge, {kWorldBody, 0}, {0, 0, 1}, {0, 1, 0}});
  return scene;
}

// What a joint measures in space that repeats is that of the nearest image.
TEST(Joints, ThatLeaveHalfAPeriodAreRefused) {
  Scene scene = physics::empty_scene(1e-3, 0);
  physics::add_sphere(scene, {}, 0.1, 1);
  scene.periodicity.periodic = {true, false, false};
  scene.periodicity.lower = {-0.5, -1, -1};
  scene.periodicity.upper = {0.5, 1, 1};
  Joint slider = physics::joint_of(JointKind::slider, kWorldBody, 0, {}, {1, 0, 0});
  scene.joints = {slider};
  EXPECT_EQ(refusal([&] { validate(scene); }), "no error");
  scene.joints[0].limits = {-0.2, 0.75};
  EXPECT_THAT(
      refusal([&] { validate(scene); }),
      HasSubstr("joints[0].limits: [-0.2, 0.75] is not allowed: must be nearer than half of "
                "the period, 0.5 [m]"));
  scene.joints[0] = slider;
  scene.joints[0].motor = JointMotor{.position = 0.7, .stiffness = 10};
  EXPECT_THAT(refusal([&] { validate(scene); }), HasSubstr("joints[0].motor.position: 0.7"));
  scene.joints[0] = slider;
  scene.joints[0].axis = normalized(Vec3d{1, 1, 0});
  EXPECT_THAT(refusal([&] { validate(scene); }),
              HasSubstr("must be along a direction in which space repeats, or across it"));
  scene.joints[0].axis = {0, 1, 0};
  EXPECT_EQ(refusal([&] { validate(scene); }), "no error");
  scene.joints[0] = physics::line_of(JointKind::cable, kWorldBody, 0, {0.1, 0, 0}, {});
  scene.joints[0].length = 0.4;
  EXPECT_EQ(refusal([&] { validate(scene); }), "no error");
  scene.joints[0].length = 0.7;
  EXPECT_THAT(refusal([&] { validate(scene); }),
              HasSubstr("joints[0].length: 0.7 is not allowed: must be less than half of the "
                        "period, 0.5 [m]"));
}

TEST(Joints, AreRefusedWithSolversThatDoNotKnowThem) {
  Scene scene = hanging_ball();
  scene.solver.name = "schwarz";
  EXPECT_EQ(
      refusal([&] { const World world(scene, physics::cpu_options()); }),
      "solver.name: \"schwarz\" is not allowed: the scene has joints, which it does not know; "
      "these do: \"apgd\", \"jacobi\", \"gauss_seidel\", \"gauss_seidel_colored\"");
}

TEST(Joints, ThatAreDrivenHaveNoFileOfTheirProblem) {
  BodyProblem problem;
  World held = physics::reference_world(hanging_ball());
  EXPECT_EQ(refusal([&] { held.step(problem); }), "no error");
  Scene scene = hanging_ball();
  scene.joints[0].limits = {-1, 1};
  World world = physics::reference_world(scene);
  EXPECT_THAT(refusal([&] { world.step(problem); }), HasSubstr("joints[0] (hinge) has limits"));
  scene.joints[0].kind = JointKind::cylindrical;
  scene.joints[0].limits = Joint{}.limits;
  scene.joints[0].turn.friction = 1;
  World turned = physics::reference_world(scene);
  EXPECT_THAT(refusal([&] { turned.step(problem); }),
              HasSubstr("joints[0] (cylindrical) has friction"));
}

TEST(Joints, OfASavedStateAreThoseOfTheScene) {
  World world = physics::reference_world(hanging_ball());
  world.step();
  WorldState state = world.save();
  state.at<Vec3d>("joint/impulse").pop_back();
  EXPECT_EQ(refusal([&] { world.restore(state); }),
            "checkpoint: 1 vectors of joint impulses, expected 2 of 1 joints");
  state = world.save();
  state.at<double>("joint/position").push_back(1);
  EXPECT_EQ(refusal([&] { world.restore(state); }),
            "checkpoint: 2 positions and 1 marks of broken joints, expected 1 of each");
}

}  // namespace
}  // namespace scree
