// Meshes as free bodies, collision groups and loads in scene files: for the models of dynamics that
// have them. Where the program has no such model, that is what tests skip by.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "dynamics/dynamics_card.h"
#include "host/scene_reader.h"
#include "tests/host/input_files.h"
#include "tests/host/scene_texts.h"

namespace scree {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// The first model that has all three.
const DynamicsCard* surface_model() {
  for (const DynamicsCard& card : dynamics_cards())
    if (card.meshes_may_be_free && card.has_collision_groups && card.has_loads) return &card;
  return nullptr;
}

/// A brick of edges 2, 4, 6 m with a corner at the origin, of quads.
constexpr const char* kBrickFile =
    "v 0 0 0\nv 2 0 0\nv 2 4 0\nv 0 4 0\nv 0 0 6\nv 2 0 6\nv 2 4 6\nv 0 4 6\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

class FreeMeshesOfScenes : public testing::Test {
 protected:
  void SetUp() override {
    if (surface_model() == nullptr) GTEST_SKIP() << "no model of dynamics has free meshes";
    folder_ = test::write_file("brick.obj", kBrickFile).parent_path();
    test::write_file("card.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\nf 1 3 2\n");
  }
  Scene read(const std::string& bodies) const {
    return parse_scene(R"({"time_step": 1e-3, "duration": 1, "materials": {"m": {"friction": 0}},
                           "dynamics": {"type": ")" +
                           std::string(surface_model()->name) + R"("}, "bodies": [)" + bodies +
                           "]}",
                       "x.json", folder_);
  }
  std::string refused(const std::string& bodies) const {
    return test::refusal([&] { read(bodies); });
  }

 private:
  std::filesystem::path folder_;
};

TEST_F(FreeMeshesOfScenes, OneHasThePoseOfItsCenterOfMass) {
  const Scene scene = read(
      R"({"shape": "mesh", "kind": "free", "file": "brick.obj", "scale": 0.5, "density": 10,
          "position": [1, 0, 0], "rotation_deg": {"axis": [0, 0, 1], "angle": 90}},
         {"shape": "mesh", "kind": "free", "file": "brick.obj", "scale": 0.5, "mass": 3,
          "position": [20, 0, 0]},
         {"shape": "mesh", "file": "brick.obj", "scale": 0.5, "position": [-20, 0, 0]})");
  const BodyDescription& body = scene.bodies.at(0);
  EXPECT_NEAR(body.mass, 10 * 6, 1e-12);
  // The center, (0.5, 1, 1.5), after a quarter turn about z.
  EXPECT_LT(norm(body.position - Vec3d{1 - 1, 0.5, 1.5}), 1e-12);
  EXPECT_NEAR(body.inertia.x, 60. / 12 * (4 + 9), 1e-12);
  EXPECT_NEAR(body.inertia.z, 60. / 12 * (1 + 4), 1e-12);
  EXPECT_NEAR(scene.bodies.at(1).mass, 3, 1e-12);
  EXPECT_EQ(scene.bodies.at(1).shape.mesh, body.shape.mesh);
  EXPECT_EQ(scene.bodies.at(2).kind, BodyKind::fixed) << "unless the file says that it is free";
  EXPECT_NE(scene.bodies.at(2).shape.mesh, body.shape.mesh) << "in the frame of the file";
}

TEST_F(FreeMeshesOfScenes, OnlySolidsAreFree) {
  const std::string open = refused(
      R"({"shape": "mesh", "kind": "free", "file": "brick.obj", "closed": false, "density": 1})");
  EXPECT_THAT(open, AllOf(HasSubstr("bodies[0].closed"), HasSubstr("only closed surfaces")));
  EXPECT_THAT(refused(R"({"shape": "mesh", "kind": "free", "file": "card.obj", "density": 1})"),
              HasSubstr("card.obj"));
}

TEST_F(FreeMeshesOfScenes, GroupsAndLoadsAreRead) {
  const Scene scene = read(
      R"({"shape": "mesh", "kind": "free", "file": "brick.obj", "density": 10, "collision_group": 4,
          "force": [1, 2, 3], "torque": [0, 0, 5]},
         {"shape": "box", "size": [1, 1, 1], "density": 1, "position": [9, 9, 9]})");
  EXPECT_EQ(scene.bodies.at(0).collision_group, 4);
  EXPECT_EQ(scene.bodies.at(0).load->force, Vec3d(1, 2, 3));
  EXPECT_EQ(scene.bodies.at(0).load->torque, Vec3d(0, 0, 5));
  EXPECT_EQ(scene.bodies.at(1).collision_group, kNoCollisionGroup);
  EXPECT_EQ(norm(scene.bodies.at(1).load->force), 0);
  EXPECT_THAT(
      refused(R"({"shape": "box", "size": [1, 1, 1], "density": 1, "collision_group": -1})"),
      HasSubstr("bodies[0].collision_group: -1 is not allowed"));
  EXPECT_THAT(
      refused(R"({"shape": "box", "size": [1, 1, 1], "kind": "fixed", "force": [1, 0, 0]})"),
      AllOf(HasSubstr("bodies[0].force"), HasSubstr("only free bodies")));
}

TEST(OtherModels, RefuseFreeMeshesGroupsAndLoads) {
  const auto refused = [](const std::string& body) {
    return test::refusal([&] { test::parsed(test::with_body(body)); });
  };
  test::write_file("brick.obj", kBrickFile);
  const std::string ball = R"({"shape": "sphere", "radius": 0.1, "density": 1)";
  EXPECT_THAT(refused(ball + R"(, "collision_group": 0})"),
              AllOf(HasSubstr("x.json: bodies[1].collision_group: 0 is not allowed"),
                    HasSubstr("the dynamics \"rigid\" has no such groups")));
  EXPECT_THAT(refused(ball + R"(, "force": [1, 0, 0]})"),
              AllOf(HasSubstr("bodies[1].force: [1, 0, 0] is not allowed"),
                    HasSubstr("the dynamics \"rigid\" have no such load")));
  EXPECT_THAT(refused(ball + R"(, "torque": [0, 0, 1]})"), HasSubstr("bodies[1].torque"));
  EXPECT_THAT(refused(ball + R"(, "torque": [0, 0, 0]})"), HasSubstr("no error"));
}

TEST(OtherModels, RefuseFreeMeshesByKind) {
  const auto folder = test::write_file("brick.obj", kBrickFile).parent_path();
  const std::string message = test::refusal([&] {
    parse_scene(
        test::with_body(R"({"shape": "mesh", "kind": "free", "file": "brick.obj", "density": 1})"),
        "x.json", folder);
  });
  EXPECT_THAT(message, AllOf(HasSubstr("bodies[1].kind: \"free\" is not allowed"),
                             HasSubstr("can be free")));
}

}  // namespace
}  // namespace scree
