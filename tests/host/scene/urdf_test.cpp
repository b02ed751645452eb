// URDF files: what they become, and what is refused.
#include "host/urdf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host/scene/compound.h"
#include "host/scene_reader.h"
#include "kernels/math/sym3.h"
#include "shapes/shape_card.h"
#include "tests/host/input_files.h"
#include "tests/urdf_support.h"

namespace scree {
namespace {

using test::reads_urdf;
using test::refusal;
using test::write_file;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class Urdf : public testing::Test {
 protected:
  void SetUp() override {
    if (!reads_urdf()) GTEST_SKIP() << "built without tinyxml2";
  }
};
using UrdfRefusal = Urdf;

std::string robot(const std::string& inside) {
  return "<robot name=\"arm\">\n" + inside + "</robot>";
}

/// A link of 2 kg with a ball about its center of mass.
std::string link(const std::string& name, const std::string& more = "") {
  return "<link name=\"" + name +
         R"("><inertial><mass value="2"/><inertia ixx="0.1" iyy="0.1" izz="0.1"/></inertial>)"
         R"(<collision><geometry><sphere radius="0.1"/></geometry></collision>)" +
         more + "</link>\n";
}

std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                  const std::string& child, const std::string& more = "") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent +
         "\"/><child link=\"" + child + "\"/>" + more + "</joint>\n";
}

Scene robot_scene(const std::string& text, const UrdfPlacement& placement = {}) {
  Scene scene;
  add_urdf(scene, parse_urdf(text, "arm.urdf"), placement);
  validate(scene);
  return scene;
}

std::string refusal_of(const std::string& text, const UrdfPlacement& placement = {}) {
  return refusal([&] { robot_scene(text, placement); });
}

void expect_vector(const Vec3d& a, const Vec3d& b, double within = 1e-14) {
  EXPECT_NEAR(norm(a - b), 0, within) << vector_text(a) << " against " << vector_text(b);
}

TEST(UrdfWithoutXml, SaysWhichPackageIsMissing) {
  if (reads_urdf()) GTEST_SKIP() << "built with tinyxml2";
  EXPECT_THAT(refusal_of("<robot/>"),
              AllOf(StartsWith("arm.urdf: "), HasSubstr("libtinyxml2-dev")));
}

std::string scene_with(const std::string& entry, const std::string& more = "") {
  return R"({"time_step": 1e-3, "duration": 1, "materials": {"default": {}, "rubber": {"friction": 1}},
      "bodies": [{"name": "floor", "shape": "half_space"},
                 {"name": "late", "shape": "sphere", "radius": 0.1, "density": 1000, "insert_at": 1}],
      "urdf": [)" +
         entry + "]" + more + "}";
}

TEST_F(Urdf, LinksBecomeBodiesAndJoints) {
  const Scene scene = robot_scene(robot(
      link("a") + link("b") + link("c") + link("d") +
      joint(
          "ab", "revolute", "a", "b",
          R"(<origin xyz="1 0 0"/><axis xyz="0 2 0"/><limit lower="-1" upper="0.5" effort="3" velocity="2"/>)"
          R"(<dynamics damping="0.25" friction="0.5"/>)") +
      joint(
          "bc", "prismatic", "b", "c",
          R"(<origin xyz="0 0 1"/><axis xyz="0 0 1"/><limit lower="0" upper="2" effort="3" velocity="2"/>)") +
      joint("ad", "floating", "a", "d", R"(<origin xyz="0 5 0"/>)")));
  ASSERT_EQ(scene.bodies.size(), 4u);
  EXPECT_EQ(scene.body_names.at("arm/b"), 1);
  EXPECT_EQ(scene.bodies[1].mass, 2);
  EXPECT_EQ(scene.bodies[1].shape.radius, 0.1);
  expect_vector(scene.bodies[1].position, {1, 0, 0});
  expect_vector(scene.bodies[static_cast<std::size_t>(scene.body_names.at("arm/d"))].position,
                {0, 5, 0});
  ASSERT_EQ(scene.joints.size(), 2u);  // a floating joint is none
  const Joint& hinge = scene.joints[0];
  EXPECT_EQ(hinge.kind, JointKind::hinge);
  EXPECT_EQ(hinge.bodies, (std::array{0, 1}));
  expect_vector(hinge.anchor, {1, 0, 0});
  expect_vector(hinge.axis, {0, 1, 0});
  EXPECT_EQ(hinge.limits, (std::array{-1.0, 0.5}));
  EXPECT_EQ(hinge.friction, 0.5);
  ASSERT_TRUE(hinge.motor.has_value());  // a damper that pulls nowhere
  EXPECT_EQ(hinge.motor->damping, 0.25);
  EXPECT_EQ(hinge.motor->stiffness, 0);
  EXPECT_EQ(scene.joints[1].kind, JointKind::slider);
  EXPECT_FALSE(scene.joints[1].motor.has_value());
}

TEST_F(Urdf, FramesFollowEachOther) {
  // Two arms of 1 m: the first turned by 90 degrees about z, the second by 30 degrees about its own y.
  const std::string text =
      robot(link("a") + link("b") + link("c") +
            joint("ab", "continuous", "a", "b", R"(<origin xyz="0 0 1"/><axis xyz="0 0 1"/>)") +
            joint("bc", "continuous", "b", "c",
                  R"(<origin xyz="1 0 0" rpy="0.3 0.2 0.1"/><axis xyz="0 1 0"/>)"));
  UrdfPlacement placement;
  placement.pose = {{10, 20, 30}, exp_map(Vec3d{std::numbers::pi / 2, 0, 0})};
  placement.joint_positions = {{"ab", std::numbers::pi / 2}, {"bc", std::numbers::pi / 6}};
  placement.velocity = {1, 0, 0};
  placement.angular_velocity = {0, 0, 2};
  const Scene scene = robot_scene(text, placement);
  // In the frame of the root: b at (0, 0, 1), c 1 m along the turned x, so at (0, 1, 1).
  expect_vector(scene.bodies[1].position, {10, 19, 30}, 1e-13);
  expect_vector(scene.bodies[2].position, {10, 19, 31}, 1e-13);
  // Roll, pitch and yaw are about fixed axes.
  const Quatd rpy =
      exp_map(Vec3d{0, 0, 0.1}) * exp_map(Vec3d{0, 0.2, 0}) * exp_map(Vec3d{0.3, 0, 0});
  const Quatd joint_frame =
      exp_map(Vec3d{std::numbers::pi / 2, 0, 0}) * exp_map(Vec3d{0, 0, std::numbers::pi / 2}) * rpy;
  expect_vector(scene.joints[1].axis, rotate(joint_frame, Vec3d{0, 1, 0}), 1e-13);
  const Quatd own = joint_frame * exp_map(Vec3d{0, std::numbers::pi / 6, 0});
  expect_vector(rotate(scene.bodies[2].orientation, Vec3d{1, 0, 0}), rotate(own, Vec3d{1, 0, 0}),
                1e-13);
  expect_vector(scene.bodies[2].velocity, {1 - 2 * (19 - 20), 2 * (10 - 10), 0}, 1e-13);
}

TEST_F(Urdf, LimitsAndMotorsCountFromZeroOfTheFile) {
  const std::string text = robot(
      link("a") + link("b") +
      joint("ab", "revolute", "a", "b",
            R"(<limit lower="-1" upper="2" effort="7" velocity="2"/><dynamics damping="0.5"/>)"));
  UrdfPlacement placement;
  placement.joint_positions = {{"ab", 0.5}};
  JointMotor motor;
  motor.position = 1;
  motor.stiffness = 10;
  motor.damping = 1;
  placement.motors = {{"ab", motor}};
  const Scene scene = robot_scene(text, placement);
  EXPECT_EQ(scene.joints[0].limits, (std::array{-1.5, 1.5}));
  EXPECT_EQ(scene.joints[0].motor->position, 0.5);
  EXPECT_EQ(scene.joints[0].motor->max_force, 7);
  EXPECT_EQ(scene.joints[0].motor->damping, 1.5);  // its own and that of the joint
}

TEST_F(Urdf, MotorsMayHaveATorque) {
  const std::filesystem::path file = write_file(
      "arm.urdf",
      robot(
          link("a") + link("b") + link("c") +
          joint(
              "ab", "revolute", "a", "b",
              R"(<limit lower="-1" upper="2" effort="7" velocity="2"/><dynamics damping="0.5"/>)") +
          joint("bc", "prismatic", "b", "c",
                R"(<limit lower="-1" upper="2" effort="5" velocity="2"/>)")));
  const auto scene_of = [&](const std::string& motors) {
    return parse_scene(
        scene_with(R"({"file": "arm.urdf", "joint_positions": {"ab": 0.5}, "motors": )" + motors +
                   "}"),
        "x.json", file.parent_path());
  };
  const Scene scene = scene_of(R"({"ab": {"torque": -6}, "bc": {"force": 4}})");
  EXPECT_EQ(scene.joints[0].motor->force, -6);
  EXPECT_EQ(scene.joints[0].motor->damping, 0.5);  // that of the joint
  EXPECT_EQ(scene.joints[1].motor->force, 4);
  EXPECT_THAT(refusal([&] { scene_of(R"({"ab": {"torque": -8}})"); }),
              AllOf(HasSubstr("urdf[0].motors.ab.torque: -8"), HasSubstr("limited to 7")));
  EXPECT_THAT(refusal([&] { scene_of(R"({"bc": {"torque": 1}})"); }),
              AllOf(HasSubstr("urdf[0].motors.bc.torque: "), HasSubstr("it has \"force\"")));
  EXPECT_THAT(refusal([&] { scene_of(R"({"cb": {"force": 1}})"); }),
              AllOf(HasSubstr("urdf[0].motors.cb: "), HasSubstr("no revolute")));
}

TEST_F(Urdf, InertiaKeepsItsAxes) {
  // A ball whose moments are those of no ball: the tensor in the world is that of the file.
  const std::string text =
      robot(R"(<link name="a"><inertial><origin rpy="0.4 0.5 0.6"/><mass value="3"/>
      <inertia ixx="0.3" iyy="0.4" izz="0.5" ixy="0.02" ixz="-0.03" iyz="0.04"/></inertial>
      <collision><geometry><sphere radius="0.1"/></geometry></collision></link>)");
  const BodyDescription body = robot_scene(text).bodies.at(0);
  const Sym3<double> world = rotated_diagonal(body.orientation, body.inertia);
  const Quatd q = exp_map(Vec3d{0, 0, 0.6}) * exp_map(Vec3d{0, 0.5, 0}) * exp_map(Vec3d{0.4, 0, 0});
  Sym3<double> given;
  given.xx = 0.3, given.yy = 0.4, given.zz = 0.5;
  given.xy = 0.02, given.xz = -0.03, given.yz = 0.04;
  for (const Vec3d& v : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}})
    expect_vector(world * v, rotate(q, given * rotate_back(q, v)), 1e-14);
}

TEST_F(Urdf, FixedLinksThatLackMassOrShapeAreOneBody) {
  // A frame without mass, a body, and two loads of 1 kg without a shape on either side of it.
  const std::string load =
      R"("><inertial><mass value="1"/><inertia ixx="0.01" iyy="0.02" izz="0.03"/></inertial></link>)";
  const Scene scene = robot_scene(robot(
      "<link name=\"foot\"/>" + link("a") + "<link name=\"left" + load + "<link name=\"right" +
      load + joint("f", "fixed", "foot", "a", R"(<origin xyz="0 0 1"/>)") +
      joint("l", "fixed", "a", "left", R"(<origin xyz="0 0.5 0"/>)") +
      joint("r", "fixed", "a", "right", R"(<origin xyz="0 -0.5 0"/>)")));
  ASSERT_EQ(scene.bodies.size(), 1u);
  EXPECT_TRUE(scene.joints.empty());
  const BodyDescription& body = scene.bodies[0];
  EXPECT_EQ(body.mass, 4);
  expect_vector(body.position, {0, 0, 1});
  const Sym3<double> world = rotated_diagonal(body.orientation, body.inertia);
  EXPECT_NEAR(world.xx, 0.1 + 2 * (0.01 + 0.25), 1e-14);
  EXPECT_NEAR(world.yy, 0.1 + 2 * 0.02, 1e-14);
  EXPECT_NEAR(world.zz, 0.1 + 2 * (0.03 + 0.25), 1e-14);
  for (const char* name : {"arm/foot", "arm/a", "arm/left", "arm/right"})
    EXPECT_EQ(scene.body_names.at(name), 0) << name;
}

/// Where the parts of a body are in the world.
std::vector<ShapePart> parts_in_world(const Scene& scene, const BodyDescription& body) {
  std::vector<ShapePart> parts = parts_of(scene, body.shape);
  for (ShapePart& part : parts) {
    part.position = body.position + rotate(body.orientation, part.position);
    part.orientation = body.orientation * part.orientation;
  }
  return parts;
}

TEST_F(Urdf, WholeBodiesThatAreFixedAreOne) {
  const Scene scene = robot_scene(
      robot(link("a") + link("b") + joint("ab", "fixed", "a", "b", R"(<origin xyz="1 0 0"/>)")));
  ASSERT_EQ(scene.bodies.size(), 1u);
  EXPECT_TRUE(scene.joints.empty());
  const BodyDescription& body = scene.bodies[0];
  EXPECT_EQ(body.mass, 4);
  expect_vector(body.position, {0.5, 0, 0});
  const Sym3<double> world = rotated_diagonal(body.orientation, body.inertia);
  EXPECT_NEAR(world.xx, 0.2, 1e-14);
  EXPECT_NEAR(world.yy, 0.2 + 4 * 0.25, 1e-14);
  EXPECT_NEAR(world.zz, 0.2 + 4 * 0.25, 1e-14);
  const std::vector<ShapePart> parts = parts_in_world(scene, body);
  ASSERT_EQ(parts.size(), 2u);
  expect_vector(parts[0].position, {0, 0, 0});
  expect_vector(parts[1].position, {1, 0, 0});
  EXPECT_EQ(parts[1].shape.radius, 0.1);
}

TEST_F(Urdf, ShapesAreWhereTheFileSaysWhateverTheInertia) {
  UrdfPlacement placement;
  placement.pose = {{3, 4, 5}, exp_map(Vec3d{0.1, 0.7, -0.4})};
  const auto in_world = [&](const Vec3d& x) {
    return placement.pose.position + rotate(placement.pose.orientation, x);
  };
  const Scene scene = robot_scene(
      robot(
          R"(<link name="a"><inertial><origin xyz="0.1 0.2 0.3"/><mass value="2"/>)"
          R"(<inertia ixx="0.3" ixy="0.02" ixz="-0.03" iyy="0.4" iyz="0.01" izz="0.5"/></inertial>)"
          R"(<collision><origin xyz="0 0 0.5" rpy="0.3 0 0"/><geometry><box size="1 2 3"/></geometry></collision>)"
          R"(<collision><origin xyz="1 0 0" rpy="0 0.5 0"/><geometry><cylinder radius="0.2" length="1"/></geometry></collision></link>)"),
      placement);
  const BodyDescription& body = scene.bodies.at(0);
  EXPECT_EQ(body.mass, 2);
  expect_vector(body.position, in_world({0.1, 0.2, 0.3}));
  const Quatd to_link = conjugate(placement.pose.orientation) * body.orientation;
  const Sym3<double> own = rotated_diagonal(to_link, body.inertia);
  for (const auto& [is, should] :
       {std::pair{own.xx, 0.3}, std::pair{own.yy, 0.4}, std::pair{own.zz, 0.5},
        std::pair{own.xy, 0.02}, std::pair{own.xz, -0.03}, std::pair{own.yz, 0.01}})
    EXPECT_NEAR(is, should, 1e-14);
  const std::vector<ShapePart> parts = parts_in_world(scene, body);
  ASSERT_EQ(parts.size(), 2u);
  expect_vector(parts[0].position, in_world({0, 0, 0.5}));
  expect_vector(parts[1].position, in_world({1, 0, 0}));
  const auto expect_turned = [&](const ShapePart& part, const Vec3d& rotation) {
    for (const Vec3d& v : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}})
      expect_vector(rotate(part.orientation, v),
                    rotate(placement.pose.orientation, rotate(exp_map(rotation), v)));
  };
  expect_turned(parts[0], {0.3, 0, 0});
  expect_turned(parts[1], {0, 0.5, 0});
}

TEST_F(Urdf, AMeshOffTheCenterOfMassIsAPart) {
  const std::filesystem::path mesh = write_file(
      "wedge.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 2\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
  Scene scene;
  add_urdf(scene,
           parse_urdf(robot(R"(<link name="a"><inertial><origin xyz="1 1 1"/><mass value="2"/>)"
                            R"(<inertia ixx="1" iyy="1.1" izz="1.2"/></inertial><collision>)"
                            R"(<geometry><mesh filename="wedge.obj" scale="1 -1 1"/></geometry>)"
                            R"(</collision></link>)"),
                      mesh.parent_path() / "arm.urdf"));
  validate(scene);
  const BodyDescription& body = scene.bodies.at(0);
  expect_vector(body.position, {1, 1, 1});
  const std::vector<ShapePart> parts = parts_in_world(scene, body);
  ASSERT_EQ(parts.size(), 1u);
  expect_vector(parts[0].position, {0.25, -0.25, 0.5}, 1e-12);
}

TEST_F(UrdfRefusal, OfTwoMaterialsOfOneBody) {
  const std::string text =
      robot(link("a") + link("b") + joint("ab", "fixed", "a", "b", R"(<origin xyz="1 0 0"/>)"));
  UrdfPlacement placement;
  placement.surfaces["b"].group = 1;
  EXPECT_THAT(refusal_of(text, placement),
              AllOf(StartsWith("arm.urdf: line 3: link \"b\""), HasSubstr("link \"a\"")));
}

TEST_F(UrdfRefusal, OfJointsThatStartBeyondTheirLimits) {
  const std::string text =
      robot(link("a") + link("b") +
            joint("ab", "revolute", "a", "b",
                  R"(<limit lower="0.5" upper="1" effort="7" velocity="2"/>)"));
  EXPECT_THAT(refusal_of(text),
              AllOf(HasSubstr("joint_positions.ab: 0"), HasSubstr("from 0.5 to 1")));
  UrdfPlacement placement;
  placement.joint_positions = {{"ab", 0.75}};
  EXPECT_EQ(refusal_of(text, placement), "no error");
}

TEST_F(UrdfRefusal, OfAVelocityWhereTheBaseIsFixed) {
  UrdfPlacement placement;
  placement.fixed_base = true;
  placement.velocity = {1, 0, 0};
  const std::string text = robot(link("a") + link("b") + joint("ab", "continuous", "a", "b"));
  EXPECT_THAT(refusal_of(text, placement), HasSubstr("the base is fixed"));
}

TEST_F(Urdf, ARootCalledWorldRests) {
  const std::string shape =
      R"(<collision><origin xyz="0 0 -1"/><geometry><box size="2 2 2"/></geometry></collision>)";
  const std::string arm = link("a") + joint("wa", "continuous", "world", "a");
  const Scene bare = robot_scene(robot("<link name=\"world\"/>" + arm));
  EXPECT_EQ(bare.joints.at(0).bodies, (std::array{kWorldBody, 0}));
  const Scene scene = robot_scene(robot("<link name=\"world\">" + shape + shape + "</link>" + arm));
  ASSERT_EQ(scene.bodies.size(), 3u);  // one fixed body for each collision
  EXPECT_EQ(scene.bodies[0].kind, BodyKind::fixed);
  EXPECT_EQ(scene.bodies[2].kind, BodyKind::free);
  EXPECT_EQ(scene.joints.at(0).bodies, (std::array{0, 2}));
  UrdfPlacement fixed;
  fixed.fixed_base = true;
  const Scene pillar =
      robot_scene(robot(link("a") + link("b") + joint("ab", "floating", "a", "b")), fixed);
  EXPECT_EQ(pillar.bodies.at(0).kind, BodyKind::fixed);
  EXPECT_EQ(pillar.bodies.at(1).kind, BodyKind::free);
}

TEST_F(Urdf, MeshesAreLookedForBesideTheFileAndAboveIt) {
  const std::string tetrahedron =
      "v 1 1 1\nv 1 -1 -1\nv -1 1 -1\nv -1 -1 1\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n";
  const std::filesystem::path mesh = write_file("t.obj", tetrahedron);
  const auto model = [&](const std::string& name) {
    return robot(
        R"(<link name="a"><inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1"/></inertial>
        <collision><geometry><mesh filename=")" +
        name + R"(" scale="0.1 0.1 0.1"/></geometry></collision></link>)");
  };
  const std::string folder = mesh.parent_path().filename().string();
  std::filesystem::create_directories(mesh.parent_path() / "urdf");
  for (const auto& [name, urdf] :
       {std::pair{std::string("t.obj"), mesh.parent_path() / "a.urdf"},
        {"package://" + folder + "/t.obj", mesh.parent_path() / "a.urdf"},
        {"package://" + folder + "/t.obj", mesh.parent_path() / "urdf/a.urdf"},
        {"file://" + mesh.string(), "a.urdf"}}) {
    const UrdfModel read = parse_urdf(model(name), urdf);
    Scene scene;
    add_urdf(scene, read);
    validate(scene);
    EXPECT_NEAR(scene.bodies.at(0).shape.volume, 8.0 / 3 * 1e-3, 1e-12) << name;
  }
  EXPECT_THAT(
      refusal([&] { parse_urdf(model("package://nowhere/t.obj"), mesh.parent_path() / "a.urdf"); }),
      AllOf(HasSubstr("a.urdf: line 2: link \"a\""), HasSubstr("package://nowhere/t.obj"),
            HasSubstr("has such a file")));
  EXPECT_THAT(refusal([&] { parse_urdf(model("none.obj"), mesh.parent_path() / "a.urdf"); }),
              AllOf(HasSubstr("none.obj"), HasSubstr("no such file")));
}

TEST_F(Urdf, WhatSaysNothingHereIsCounted) {
  const UrdfModel model =
      parse_urdf(robot(link("a", "<visual/><visual/>") + "<gazebo/><transmission/>"), "arm.urdf");
  EXPECT_EQ(model.not_read,
            (std::map<std::string, int>{{"gazebo", 1}, {"transmission", 1}, {"visual", 2}}));
}

TEST_F(UrdfRefusal, OfFiles) {
  EXPECT_THAT(refusal_of("<robot name=\"a\">\n<link"),
              AllOf(StartsWith("arm.urdf: line "), HasSubstr("broken XML")));
  EXPECT_THAT(refusal_of(""), AllOf(StartsWith("arm.urdf: "), HasSubstr("XML")));
  EXPECT_THAT(refusal_of("<sdf/>"), HasSubstr("must be <robot>"));
  EXPECT_THAT(refusal_of("<robot/>"), HasSubstr("a robot must have a name"));
  EXPECT_THAT(refusal_of(robot("")), HasSubstr("no <link>"));
  EXPECT_THAT(refusal_of(robot("<xacro:include/>")), HasSubstr("expand the file with xacro"));
  EXPECT_THAT(refusal([] { read_urdf("nowhere.urdf"); }), HasSubstr("nowhere.urdf: no such file"));
}

struct BadUrdf {
  const char* name;
  std::string text;
  std::vector<std::string> words;
};

void PrintTo(const BadUrdf& bad, std::ostream* out) { *out << bad.name; }

std::string with_inertia(const std::string& inertia, const std::string& mass = "1") {
  return robot(
      "<link name=\"a\"><inertial><mass value=\"" + mass + "\"/><inertia " + inertia +
      "/></inertial><collision><geometry><sphere radius=\"1\"/></geometry></collision></link>");
}
std::string with_shape(const std::string& collision) {
  return robot(
      R"(<link name="a"><inertial><mass value="1"/><inertia ixx="1" iyy="2" izz="2.5"/></inertial>)" +
      collision + "</link>");
}
std::string with_joint(const std::string& type, const std::string& more) {
  return robot(link("a") + link("b") + joint("ab", type, "a", "b", more));
}

const std::vector<BadUrdf>& bad_urdfs() {
  static const std::vector<BadUrdf> all{
      {"NoNameOfLink", robot("<link/>"), {"line 2: link", "name is missing"}},
      {"NoNameOfJoint", robot(link("a") + "<joint/>"), {"line 3: joint", "name is missing"}},
      {"LinkTwice",
       robot(link("a") + link("a")),
       {"line 3: link \"a\"", "second link of this name"}},
      {"JointTwice",
       robot(link("a") + link("b") + link("c") + joint("j", "fixed", "a", "b") +
             joint("j", "fixed", "a", "c")),
       {"line 6: joint \"j\"", "second joint of this name"}},
      {"UnknownLink",
       robot(link("a") + joint("j", "fixed", "a", "bb")),
       {"joint \"j\"", "\"bb\"", "no link has this name"}},
      {"NoParent",
       robot(link("a") + R"(<joint name="j" type="fixed"><child link="a"/></joint>)"),
       {"<parent> is missing"}},
      {"TwoParents",
       robot(link("a") + link("b") + link("c") + joint("ac", "fixed", "a", "c") +
             joint("bc", "fixed", "b", "c")),
       {"joint \"bc\"", "\"c\" is the child of joint \"ac\" already"}},
      {"Circle",
       robot(link("a") + link("b") + joint("ab", "fixed", "a", "b") +
             joint("ba", "fixed", "b", "a")),
       {"circle"}},
      {"CircleBelow",
       robot(link("r") + link("a") + link("b") + joint("ab", "fixed", "a", "b") +
             joint("ba", "fixed", "b", "a")),
       {"link \"a\"", "circle"}},
      {"OwnParent", robot(link("a") + joint("j", "fixed", "a", "a")), {"joint \"j\"", "one link"}},
      {"TwoRoots", robot(link("a") + link("b")), {"link \"b\"", "one tree"}},
      {"NegativeMass",
       with_inertia(R"(ixx="1" iyy="1" izz="1")", "-2"),
       {"<mass>: value \"-2\"", "zero or positive [kg]"}},
      {"UnreadableMass",
       with_inertia(R"(ixx="1" iyy="1" izz="1")", "2kg"),
       {"<mass>: value \"2kg\""}},
      {"NoNumberMass",
       with_inertia(R"(ixx="1" iyy="1" izz="1")", "nan"),
       {"<mass>: value \"nan\""}},
      {"IndefiniteInertia",
       with_inertia(R"(ixx="1" iyy="1" izz="1" ixy="2")"),
       {"<inertia>", "ixy 2", "positive definite"}},
      {"ZeroInertia",
       with_inertia(R"(ixx="1" iyy="0" izz="1")"),
       {"<inertia>", "positive definite"}},
      {"MissingInertia", with_inertia(R"(ixx="1" iyy="1")"), {"<inertia>: izz is missing"}},
      {"NoGeometry", with_shape("<collision/>"), {"<collision>: <geometry> is missing"}},
      {"UnknownGeometry",
       with_shape("<collision><geometry><torus/></geometry></collision>"),
       {"<torus> is not a known shape"}},
      {"NegativeRadius",
       with_shape(R"(<collision><geometry><sphere radius="-1"/></geometry></collision>)"),
       {"<sphere>: radius \"-1\"", "positive [m]"}},
      {"TwoNumbers",
       with_shape(R"(<collision><geometry><box size="1 2"/></geometry></collision>)"),
       {"<box>: size \"1 2\"", "three positive edges"}},
      {"FourNumbers",
       with_shape(R"(<collision><geometry><box size="1 2 3 4"/></geometry></collision>)"),
       {"<box>: size \"1 2 3 4\""}},
      {"HugeSize",
       with_shape(R"(<collision><geometry><box size="1e300 1 1"/></geometry></collision>)"),
       {"link \"a\"", "as a body"}},
      {"UnreadableOrigin",
       with_shape(
           R"(<collision><origin xyz="1 2 x"/><geometry><box size="1 2 3"/></geometry></collision>)"),
       {"<origin>: xyz \"1 2 x\""}},
      {"NoScale",
       with_shape(
           R"(<collision><geometry><mesh filename="a.stl" scale="1 0 1"/></geometry></collision>)"),
       {"<mesh>: scale \"1 0 1\"", "other than zero"}},
      {"NoCollision", with_shape(""), {"link \"a\"", "no <collision>"}},
      {"NoMass",
       robot(link("a") + "<link name=\"b\"/>" + joint("ab", "continuous", "a", "b")),
       {"link \"b\"", "no mass"}},
      {"UnknownType", with_joint("hinge", ""), {"joint \"ab\"", "type \"hinge\"", "revolute"}},
      {"Planar", with_joint("planar", ""), {"joint \"ab\"", "planar joints are not represented"}},
      {"Mimic",
       with_joint("continuous", "<mimic joint=\"x\"/>"),
       {"joint \"ab\"", "<mimic> is not represented"}},
      {"ZeroAxis",
       with_joint("continuous", R"(<axis xyz="0 0 0"/>)"),
       {"joint \"ab\"", "<axis>: xyz \"0 0 0\"", "not of zero length"}},
      {"NoLimit", with_joint("revolute", ""), {"joint \"ab\"", "<limit> is missing"}},
      {"LimitsReversed",
       with_joint("revolute", R"(<limit lower="1" upper="-1"/>)"),
       {"<limit>: lower 1 and upper -1", "must not be above"}},
      {"NegativeEffort",
       with_joint("revolute", R"(<limit effort="-1"/>)"),
       {"<limit>: effort \"-1\""}},
      {"NegativeDamping",
       with_joint("continuous", R"(<dynamics damping="-1"/>)"),
       {"<dynamics>: damping \"-1\""}},
      {"TwoOrigins",
       with_joint("continuous", "<origin/><origin/>"),
       {"<origin>", "must be there once"}},
  };
  return all;
}

class UrdfFault : public testing::TestWithParam<BadUrdf> {};

TEST_P(UrdfFault, IsNamed) {
  if (!reads_urdf()) GTEST_SKIP() << "built without tinyxml2";
  const std::string text = refusal_of(GetParam().text);
  EXPECT_THAT(text, StartsWith("arm.urdf: "));
  EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  for (const std::string& word : GetParam().words) EXPECT_THAT(text, HasSubstr(word));
}

INSTANTIATE_TEST_SUITE_P(All, UrdfFault, testing::ValuesIn(bad_urdfs()),
                         [](const auto& one) { return std::string(one.param.name); });

TEST_F(UrdfRefusal, OfWhatASceneAsksFor) {
  const std::string text = robot(link("a") + link("b") + link("c") +
                                 joint("ab", "revolute", "a", "b",
                                       R"(<limit lower="-1" upper="2" effort="7" velocity="2"/>)") +
                                 joint("bc", "fixed", "b", "c"));
  JointMotor fast;
  fast.speed = -3;
  JointMotor strong;
  strong.max_force = 8;
  UrdfPlacement p;
  p.motors = {{"bc", fast}};
  EXPECT_THAT(refusal_of(text, p),
              AllOf(StartsWith("arm.urdf: motors.bc: "), HasSubstr("no revolute")));
  p.motors = {{"ab", fast}};
  EXPECT_THAT(refusal_of(text, p),
              AllOf(HasSubstr("motors.ab.speed: -3"), HasSubstr("limited to 2")));
  p.motors = {{"ab", strong}};
  EXPECT_THAT(refusal_of(text, p),
              AllOf(HasSubstr("motors.ab.max_force: 8"), HasSubstr("limited to 7")));
  p.motors.clear();
  p.joint_positions = {{"ab", 2.5}};
  EXPECT_THAT(refusal_of(text, p),
              AllOf(HasSubstr("joint_positions.ab: 2.5"), HasSubstr("from -1 to 2")));
  p.joint_positions.clear();
  p.surfaces["d"];
  EXPECT_THAT(refusal_of(text, p), AllOf(HasSubstr("links.d"), HasSubstr("no link")));
  EXPECT_THAT(refusal([&] {
                Scene scene;
                const UrdfModel model = parse_urdf(text, "arm.urdf");
                add_urdf(scene, model);
                add_urdf(scene, model);
              }),
              AllOf(HasSubstr("\"arm/a\" is there already"), HasSubstr("name of its own")));
}

// ---- as an entry of a scene ---------------------------------------------------------------------

TEST_F(Urdf, IsAnEntryOfAScene) {
  const std::filesystem::path file = write_file(
      "arm.urdf", robot(link("a", "<visual/>") + link("b") +
                        joint("ab", "continuous", "a", "b", R"(<origin xyz="1 0 0"/>)")));
  std::vector<std::string> notes;
  const Scene scene = parse_scene(
      scene_with(
          R"({"file": "arm.urdf", "position": [0, 0, 2], "links": {"b": {"material": "rubber", "group": "hand"}},
                     "motors": {"ab": {"speed": 3, "max_force": 4}}},
                    {"file": "arm.urdf", "name": "other", "position": [0, 5, 2], "velocity": [0, 0, 1]})",
          R"(, "joints": [{"type": "ball", "bodies": ["world", "other/a"], "anchor": [0, 5, 2]}])"),
      "x.json", file.parent_path(), {}, &notes);
  ASSERT_EQ(scene.bodies.size(), 5u);
  EXPECT_EQ(scene.body_names.at("arm/b"), 2);
  EXPECT_EQ(scene.body_names.at("other/a"), 3);
  EXPECT_EQ(scene.body_names.at("floor"), 0);
  EXPECT_EQ(scene.body_names.at("late"), 5);
  expect_vector(scene.bodies[2].position, {1, 0, 2});
  expect_vector(scene.bodies[3].velocity, {0, 0, 1});
  EXPECT_EQ(scene.materials[static_cast<std::size_t>(scene.bodies[2].material)].name, "rubber");
  EXPECT_EQ(scene.groups[static_cast<std::size_t>(scene.bodies[2].group)], "hand");
  ASSERT_EQ(scene.joints.size(), 3u);
  EXPECT_EQ(scene.joints[0].motor->speed, 3);
  EXPECT_EQ(scene.joints[2].bodies, (std::array{kWorldBody, 3}));
  ASSERT_EQ(notes.size(), 2u);
  EXPECT_THAT(notes[0], AllOf(HasSubstr("arm.urdf: 2 bodies of 2 links, 1 joints, 4 kg"),
                              HasSubstr("not used: <visual> (1)")));
}

TEST_F(UrdfRefusal, OfEntriesOfAScene) {
  const std::filesystem::path file = write_file("arm.urdf", robot(link("a")));
  write_file("bad.urdf", robot("<link/>"));
  const auto refused = [&](const std::string& entry) {
    return refusal([&] { parse_scene(scene_with(entry), "x.json", file.parent_path()); });
  };
  EXPECT_THAT(refused(R"({"name": "a"})"), StartsWith("x.json: urdf[0].file: missing"));
  EXPECT_THAT(refused(R"({"file": "none.urdf"})"),
              AllOf(StartsWith("x.json: urdf[0].file: "), HasSubstr("no such file")));
  EXPECT_THAT(refused(R"({"file": "bad.urdf"})"),
              AllOf(StartsWith("x.json: urdf[0].file: "),
                    HasSubstr("bad.urdf: line 2: link: name is missing")));
  EXPECT_THAT(refused(R"({"file": "arm.urdf", "motors": {"x": {"speed": 1}}})"),
              AllOf(StartsWith("x.json: urdf[0].motors.x: "), HasSubstr("no revolute")));
  EXPECT_THAT(refused(R"({"file": "arm.urdf", "motors": {"x": {"speed": "1"}}})"),
              StartsWith("x.json: urdf[0].motors.x.speed: \"1\" is not allowed"));
  EXPECT_THAT(refused(R"({"file": "arm.urdf", "motor": {}})"),
              AllOf(StartsWith("x.json: urdf[0].motor: unknown key"), HasSubstr("motors")));
  EXPECT_THAT(refused(R"({"file": "arm.urdf", "links": {"a": {"friction": 1}}})"),
              StartsWith("x.json: urdf[0].links.a.friction: unknown key"));
}

}  // namespace
}  // namespace scree
