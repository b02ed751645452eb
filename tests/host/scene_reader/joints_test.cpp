// Joints of scene files: what is read, what is refused, what the world of a program refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/problems/body_problem.h"
#include "host/world_state.h"
#include "tests/host/input_files.h"
#include "tests/host/scene_texts.h"
#include "tests/physics/scene_builder.h"

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

INSTANTIATE_TEST_SUITE_P(
    Joints, JointRefusal,
    testing::Values(
        Refusal{"Type",
                with_joints(R"({"type": "hing", "bodies": ["world", 0], "axis": [0, 1, 0])" + kAt +
                            "}"),
                "joints[0].type: \"hing\" is not allowed: must be one of \"hinge\", \"ball\", "
                "\"fixed\"; did you mean \"hinge\"?"},
        Refusal{"NoType", with_joints(R"({"bodies": ["world", 0])" + kAt + "}"),
                "joints[0].type: missing: must be one of"},
        Refusal{"NoAxis", with_joints(R"({"type": "hinge", "bodies": ["world", 0])" + kAt + "}"),
                "joints[0].axis: missing: a hinge needs the direction it turns about"},
        Refusal{"AxisOfBall",
                with_joints(R"({"type": "ball", "bodies": ["world", 0], "axis": [0, 1, 0])" + kAt +
                            "}"),
                "joints[0].axis: a joint of type \"ball\" has no such key"},
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
        Refusal{"UnknownKey",
                with_joints(R"({"type": "ball", "body": 1, "bodies": ["world", 0])" + kAt + "}"),
                "joints[0].body: unknown key. Known keys: type, bodies, anchor, axis"},
        Refusal{"NameTwice", test::with_body(R"({"name": "a", "shape": "half_space"},
                                                {"name": "a", "shape": "half_space"})"),
                "bodies[2].name: \"a\" is not allowed: bodies[1] has this name"},
        Refusal{"NameOfWorld", test::with_body(R"({"name": "world", "shape": "half_space"})"),
                "bodies[1].name: \"world\" is not allowed: must be a name, and not \"world\""},
        Refusal{"Impacts",
                with_joints(R"({"type": "ball", "bodies": ["world", "bob"])" + kAt + "}",
                            R"("materials": {"default": {"restitution": 0.5}}, )"),
                "stepping.restitution_law: \"poisson\" in a scene with joints and restitution is "
                "not allowed: impacts before the loads do not know joints yet"}),
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
}

/// A ball that hangs from the world.
Scene hanging_ball() {
  Scene scene = physics::empty_scene(1e-3, 0);
  physics::add_sphere(scene, {}, 0.1, 1);
  scene.joints.push_back({JointKind::hinge, {kWorldBody, 0}, {0, 0, 1}, {0, 1, 0}});
  return scene;
}

TEST(Joints, AreRefusedWithSolversThatDoNotKnowThem) {
  Scene scene = hanging_ball();
  scene.solver.name = "schwarz";
  EXPECT_EQ(
      refusal([&] { const World world(scene, physics::cpu_options()); }),
      "solver.name: \"schwarz\" is not allowed: the scene has joints, which it does not know; "
      "these do: \"apgd\", \"jacobi\", \"gauss_seidel\", \"gauss_seidel_colored\"");
}

TEST(Joints, AreRefusedWithExactFriction) {
  Scene scene = hanging_ball();
  scene.solver.exact_coulomb = true;
  EXPECT_THAT(refusal([&] { validate(scene); }),
              StartsWith("solver.model: \"exact\" in a scene with joints is not allowed"));
}

TEST(Joints, HaveNoFileOfTheirProblem) {
  World world = physics::reference_world(hanging_ball());
  BodyProblem problem;
  EXPECT_THAT(refusal([&] { world.step(problem); }),
              HasSubstr("scene with joints cannot be stored"));
}

TEST(Joints, OfASavedStateAreThoseOfTheScene) {
  World world = physics::reference_world(hanging_ball());
  world.step();
  WorldState state = world.save();
  state.at<Vec3d>("joint/impulse").pop_back();
  EXPECT_EQ(refusal([&] { world.restore(state); }),
            "checkpoint: 1 vectors of joint impulses, expected 2 of 1 joints");
}

}  // namespace
}  // namespace scree
