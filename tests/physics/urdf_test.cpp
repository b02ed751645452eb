// Robots from URDF files against closed forms: mass and inertia of the file, motors and dampers of joints.
#include "host/urdf.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shapes/half_space.h"
#include "shapes/shape_card.h"
#include "tests/physics/joint_scenes.h"
#include "tests/urdf_support.h"

namespace scree::physics {
namespace {

UrdfModel model_of(const std::string& text) { return parse_urdf(text, "model.urdf"); }

class UrdfPhysics : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::reads_urdf()) GTEST_SKIP() << "built without tinyxml2";
  }
};

/// A link on a hinge about y of the world; its center of mass 0.3 m below, its moments those of no box.
std::string hanging(const std::string& joint) {
  return R"(<robot name="m"><link name="world"/>
    <link name="rod">
      <inertial><origin xyz="0 0 -0.3"/><mass value="2"/><inertia ixx="0.07" iyy="0.05" izz="0.03"/></inertial>
      <collision><origin xyz="0 0 -0.3"/><geometry><box size="0.05 0.05 0.6"/></geometry></collision>
    </link>
    <joint name="j" type="continuous"><parent link="world"/><child link="rod"/><axis xyz="0 1 0"/>)" +
         joint + "</joint></robot>";
}

/// Lets what hangs swing from 0.2 rad.
void expect_period_of_inertia(const Scene& scene) {
  World world = joint_world(scene, Precision::double_precision);
  const double period = period_of(
      world, 8000, [&] { return world.states().position[0].x; }, [](const StepReport&) {});
  // Moment about the hinge over weight times arm, and the series in the amplitude of 0.2.
  const double about_hinge = 0.05 + 2 * 0.3 * 0.3;
  const double small = 2 * kPi * std::sqrt(about_hinge / (2 * 9.81 * 0.3));
  const double expected = small * (1 + 0.2 * 0.2 / 16 + 11.0 / 3072 * std::pow(0.2, 4));
  EXPECT_NEAR(period, expected, 1e-4 * expected);
}

TEST_F(UrdfPhysics, APendulumSwingsAsItsInertiaSays) {
  Scene scene = empty_scene(1e-3, 0.5);
  UrdfPlacement placement;
  placement.joint_positions = {{"j", 0.2}};
  add_urdf(scene, model_of(hanging("")), placement);
  expect_period_of_inertia(scene);
}

/// Its shapes do not change how a body swings, wherever they are on it.
TEST_F(UrdfPhysics, APendulumOfOtherShapesSwingsTheSame) {
  std::string text = hanging("");
  text.insert(text.find("</link>", text.find("<collision>")),
              R"(<collision><origin xyz="0.1 0.05 -0.6" rpy="0.4 0.3 0.2"/>)"
              R"(<geometry><cylinder radius="0.1" length="0.2"/></geometry></collision>)");
  Scene scene = empty_scene(1e-3, 0.5);
  UrdfPlacement placement;
  placement.joint_positions = {{"j", 0.2}};
  add_urdf(scene, model_of(text), placement);
  ASSERT_TRUE(shape_card(scene.bodies.at(0).shape.kind).is_compound);
  expect_period_of_inertia(scene);
}

/// The floor carries a body at the places where its shapes are.
TEST_F(UrdfPhysics, ABodyOfTwoShapesStandsOnBoth) {
  Scene scene = empty_scene(1e-3, 0.5);
  BodyDescription floor;
  floor.kind = BodyKind::fixed;
  floor.shape.kind = shapes::HalfSpace::kind;
  scene.bodies.push_back(floor);
  UrdfPlacement placement;
  placement.pose.position = {0, 0, 0.1};
  add_urdf(scene, model_of(R"(<robot name="m"><link name="a">
      <inertial><origin xyz="0.2 0 0.3"/><mass value="2"/><inertia ixx="0.07" iyy="0.05" izz="0.03"/></inertial>
      <collision><origin xyz="-0.5 0 0" rpy="1.5707963267948966 0 0"/>
        <geometry><cylinder radius="0.1" length="1"/></geometry></collision>
      <collision><origin xyz="0.5 0 0" rpy="1.5707963267948966 0 0"/>
        <geometry><cylinder radius="0.1" length="1"/></geometry></collision></link></robot>)"),
           placement);
  World world = joint_world(scene, Precision::double_precision);
  world.run(0.5);
  const Vec3d at = world.states().position[1];
  EXPECT_NEAR(at.x, 0.2, 1e-4);
  EXPECT_NEAR(at.z, 0.4, 1e-4);
  double left = 0, right = 0;  // of its weight, as the levers say
  for (const ContactRecord& contact : world.contacts())
    (contact.point.x < 0 ? left : right) += std::abs(contact.impulse.z) / 1e-3;
  EXPECT_NEAR(left, 2 * 9.81 * 0.3, 0.02);
  EXPECT_NEAR(right, 2 * 9.81 * 0.7, 0.02);
}

TEST_F(UrdfPhysics, AMotorTurnsAWheelWithTheEffortOfTheFile) {
  const UrdfModel model = model_of(R"(<robot name="m"><link name="world"/>
    <link name="wheel">
      <inertial><mass value="1"/><inertia ixx="0.02" iyy="0.02" izz="0.04"/></inertial>
      <collision><geometry><cylinder radius="0.2" length="0.1"/></geometry></collision>
    </link>
    <joint name="axle" type="continuous"><parent link="world"/><child link="wheel"/><axis xyz="0 0 1"/>
      <limit effort="0.4" velocity="5"/></joint></robot>)");
  Scene scene = empty_scene(1e-3, 0.5);
  UrdfPlacement placement;
  placement.motors["axle"].speed = 3;
  add_urdf(scene, model, placement);
  World world = joint_world(scene, Precision::double_precision);
  // 0.4 N m on 0.04 kg m^2: 10 rad/s^2 up to 3 rad/s.
  world.run(0.15);
  EXPECT_NEAR(world.states().angular_velocity[0].z, 1.5, 1e-6);
  world.run(0.25);
  EXPECT_NEAR(world.states().angular_velocity[0].z, 3, 1e-6);
}

TEST_F(UrdfPhysics, DampingOfAJointSlowsItDown) {
  const UrdfModel model = model_of(hanging(R"(<dynamics damping="0.46"/>)"));
  Scene scene = empty_scene(1e-4, 0.5);
  scene.gravity = {0, 0, 0};
  UrdfPlacement placement;
  placement.angular_velocity = {0, 2, 0};
  add_urdf(scene, model, placement);
  World world = joint_world(scene, Precision::double_precision);
  world.run(0.5);
  // 0.46 N m s over the moment of 0.23 kg m^2 about the hinge: a rate of 2 / s.
  EXPECT_NEAR(world.states().angular_velocity[0].y, 2 * std::exp(-1.0), 2e-3);
}

TEST_F(UrdfPhysics, AVehicleDrivesAsFastAsItsWheelsTurn) {
  const UrdfModel model = read_urdf(SCREE_SCENE_DIR "/urdf/rover.urdf");
  Scene scene = empty_scene(1e-3, 0.8);
  solve_to(scene, 1e-7);
  add_plane(scene);
  UrdfPlacement placement;
  for (const char* wheel : {"front_left", "front_right", "rear_left", "rear_right"})
    placement.motors[wheel].speed = 4;
  add_urdf(scene, model, placement);
  World world = joint_world(scene, Precision::double_precision);
  world.run(1);
  const auto chassis = static_cast<std::size_t>(world.body("rover/chassis"));
  const Vec3d start = world.states().position[chassis];
  world.run(0.5);
  const Vec3d way = world.states().position[chassis] - start;
  EXPECT_NEAR(way.x, 4 * 0.08 * 0.5, 1e-3);
  EXPECT_NEAR(way.y, 0, 1e-3);
  EXPECT_NEAR(way.z, 0, 1e-4);
}

}  // namespace
}  // namespace scree::physics
