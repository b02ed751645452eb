// Small bodies of all shapes shot at thin walls at 100 m/s, five to ten times their size a step: wherever they hit, however they
// lie, and whatever the wall is, they stay before it.

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "tests/box_mesh.h"
#include "tests/physics/described_bodies.h"

namespace scree::physics {
namespace {

constexpr double kShotSpeed = 100;  // [m/s]
constexpr double kShotStep = 1e-3;  // [s]
constexpr int kShots = 12;          // of a shape

struct Named {
  std::string name, keys;
};
void PrintTo(const Named& what, std::ostream* out) { *out << what.name; }

const std::vector<Named> kShotShapes = {
    {"box", R"("shape": "box", "size": [0.02, 0.016, 0.012])"},
    {"capsule", R"("shape": "capsule", "radius": 0.006, "length": 0.012)"},
    {"cylinder", R"("shape": "cylinder", "radius": 0.01, "length": 0.016)"},
    {"cone", R"("shape": "cone", "radius": 0.012, "length": 0.02)"},
    {"ellipsoid", R"("shape": "ellipsoid", "size": [0.024, 0.016, 0.012])"},
    {"hull", R"("shape": "hull", "points": [[-0.01, -0.01, -0.008], [0.01, -0.01, -0.008],
        [0.01, 0.01, -0.008], [-0.01, 0.01, -0.008], [0.006, 0.006, 0.01], [-0.006, -0.004, 0.01]])"},
    {"rounded_box", R"("shape": "box", "size": [0.016, 0.012, 0.008], "rounding": 0.002)"},
    {"compound", R"("shape": "compound", "parts": [
        {"shape": "cone", "radius": 0.008, "length": 0.016},
        {"shape": "ellipsoid", "size": [0.016, 0.01, 0.01], "position": [0.008, 0, 0]}])"}};

/// Walls about x = 0, 1.6 m wide; those of two parts meet at y = 0. The keys are those of whole bodies.
const std::vector<Named> kWalls = {
    {"box", R"({"shape": "box", "kind": "fixed", "size": [0.002, 1.6, 1.6]})"},
    {"free_box", R"({"shape": "box", "size": [0.002, 1.6, 1.6], "density": 8000})"},
    {"two_boxes",
     R"({"shape": "box", "kind": "fixed", "size": [0.002, 0.8, 1.6], "position": [0, -0.4, 0]},
                     {"shape": "box", "kind": "fixed", "size": [0.002, 0.8, 1.6], "position": [0, 0.4, 0]})"},
    {"two_hulls",
     R"({"shape": "hull", "kind": "fixed", "points": [[-0.001, -0.8, -0.8], [0.001, -0.8, -0.8],
                      [-0.001, 0, -0.8], [0.001, 0, -0.8], [-0.001, -0.8, 0.8], [0.001, -0.8, 0.8], [-0.001, 0, 0.8], [0.001, 0, 0.8]]},
                     {"shape": "hull", "kind": "fixed", "points": [[-0.001, 0.8, -0.8], [0.001, 0.8, -0.8],
                      [-0.001, 0, -0.8], [0.001, 0, -0.8], [-0.001, 0.8, 0.8], [0.001, 0.8, 0.8], [-0.001, 0, 0.8], [0.001, 0, 0.8]]})"},
    {"compound", R"({"shape": "compound", "kind": "fixed", "parts": [
                     {"shape": "box", "size": [0.002, 0.8, 1.6], "position": [0, -0.4, 0]},
                     {"shape": "box", "size": [0.002, 0.8, 1.6], "position": [0, 0.4, 0]}]})"},
    {"cone", R"({"shape": "cone", "kind": "fixed", "radius": 0.8, "length": 0.02,
                 "rotation_deg": {"axis": [0, 1, 0], "angle": -90}})"},
    {"ellipsoid", R"({"shape": "ellipsoid", "kind": "fixed", "size": [0.1, 1.6, 1.6]})"},
    {"cylinder", R"({"shape": "cylinder", "kind": "fixed", "radius": 0.1, "length": 1.6})"}};

class FastBodies : public testing::TestWithParam<Named> {};
INSTANTIATE_TEST_SUITE_P(All, FastBodies, testing::ValuesIn(kWalls),
                         [](const auto& info) { return info.param.name; });

class Shots {
 public:
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(random_()) / std::minstd_rand::max();
  }
  /// Shoots the last body of a scene, in any pose.
  Scene next(Scene scene) {
    scene.stepping.time_step = kShotStep;
    scene.gravity = {};
    BodyDescription& body = scene.bodies.back();
    body.position = {between(-0.6, -0.5), between(-0.012, 0.012), between(-0.02, 0.02)};
    body.velocity = {kShotSpeed, 0, 0};
    body.orientation = exp_map(Vec3d{between(-2, 2), between(-2, 2), between(-2, 2)});
    return scene;
  }
  Vec3d spin() { return {between(-400, 400), between(-400, 400), between(-400, 400)}; }

 private:
  std::minstd_rand random_{7};
};

TEST_P(FastBodies, DoNotPassThinWalls) {
  Shots shots;
  for (const Named& shape : kShotShapes) {
    const Scene wall_and_shot =
        scene_of(GetParam().keys + ", {" + shape.keys + R"(, "density": 1000})");
    for (int shot = 0; shot < kShots; ++shot) {
      const Scene scene = shots.next(wall_and_shot);
      const std::size_t id = scene.bodies.size() - 1;
      World world(scene, cpu_options());
      for (int k = 0; k < 12; ++k) world.step();
      const std::vector<Vec3d> position = world.states().position;
      // A free wall is pushed along.
      EXPECT_LT(position[id].x, position[0].x) << shape.name << " " << shot;
    }
  }
}

// Boxes whose own faces part them from the plate, too, look ahead to the end of the step, where they would be behind it.
TEST(FastBoxes, DoNotPassPlatesInAnyPose) {
  Shots shots;
  for (const char* size : {"0.01, 0.01, 0.01", "0.02, 0.005, 0.005"}) {
    for (const char* plate : {"0.002, 0.8, 0.8", "0.01, 0.8, 0.8"}) {
      const std::string box = R"({"shape": "box", "density": 3000, "size": [)";
      const Scene both = scene_of(R"({"shape": "box", "kind": "fixed", "size": [)" +
                                  std::string(plate) + "]}, " + box + size + "]}");
      for (int shot = 0; shot < 100; ++shot) {
        World world(shots.next(both), cpu_options());
        for (int k = 0; k < 8; ++k) world.step();
        EXPECT_LT(world.states().position[1].x, 0) << size << " " << plate << " " << shot;
      }
    }
  }
}

// They turn by more than a radian a step, so corners come behind the slab, where a triangle may hold neither them nor any that part from
// it, and the middle follows.
TEST(FastPlates, DoNotPassSlabsOfMeshes) {
  const TriangleMesh slab = test::box_mesh({0.001, 0.2, 0.2});
  Shots shots;
  for (int shot = 0; shot < 400; ++shot) {
    Scene scene = scene_of(R"({"shape": "box", "density": 3000, "size": [0.002, 0.01, 0.02]})");
    add_mesh(scene, slab);
    std::swap(scene.bodies[0], scene.bodies[1]);
    scene = shots.next(scene);
    if (shot % 2 == 1) scene.bodies[1].angular_velocity = shots.spin();
    World world(scene, cpu_options());
    for (int k = 0; k < 12; ++k) world.step();
    EXPECT_LT(world.states().position[1].x, 0) << shot;
  }
}

// Bodies that move by less than a fifth of their thickness of 12 mm in a step stop where they touch, off their center, too.
TEST(BodiesOnSpheres, StopWhereTheyTouch) {
  for (const Named& shape : kShotShapes) {
    for (const double way : {1.2e-3, 1.9e-3, 2.3e-3}) {
      Scene scene = scene_of(R"({"shape": "sphere", "density": 1000, "radius": 0.03}, {)" +
                             shape.keys + R"(, "density": 1000})");
      scene.stepping.time_step = kShotStep;
      scene.gravity = {};
      scene.bodies[0].position = {0.008, 0.002, 0.06};
      scene.bodies[0].velocity = {0, 0, -way / kShotStep};
      World world(scene, cpu_options());
      double deepest = 0;
      for (int k = 0; k < 40; ++k) deepest = std::max(deepest, world.step().max_penetration);
      EXPECT_LT(deepest, 5e-4) << shape.name << " " << way;
    }
  }
}

// The one contact of a sphere and another body stops a point of that, which spins on; its middle stays outside.
TEST(FastSmallBodies, DoNotGoDeepIntoSpheres) {
  constexpr double kRadius = 0.1;
  Shots shots;
  for (const Named& shape : kShotShapes) {
    const Scene both = scene_of(R"({"shape": "sphere", "kind": "fixed", "radius": 0.1}, {)" +
                                shape.keys + R"(, "density": 1000})");
    for (int shot = 0; shot < 4 * kShots; ++shot) {
      World world(shots.next(both), cpu_options());
      for (int k = 0; k < 12; ++k) {
        world.step();
        EXPECT_GT(norm(world.states().position[1]), kRadius) << shape.name << " " << shot;
      }
    }
  }
}

}  // namespace
}  // namespace scree::physics
