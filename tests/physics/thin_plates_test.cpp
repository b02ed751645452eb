// Bodies of all simple shapes shot at plates a tenth as thick as their way in a step: fixed boxes, meshes without thickness,
// and free plates.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include "shapes/capsule.h"
#include "tests/physics/scene_builder.h"

namespace scree::physics {
namespace {

constexpr double kSpeed = 100;       // [m/s]
constexpr double kPlateStep = 1e-3;  // [s]: 0.1 m a step
constexpr double kSize = 0.02;       // [m]
constexpr double kThin = 0.005;

enum class Plate { box, mesh, free };
const char* name_of(Plate plate) {
  return plate == Plate::box ? "box" : plate == Plate::mesh ? "mesh" : "free";
}

BodyDescription shot_of(const std::string& shape) {
  BodyDescription body;
  body.shape.kind = shape == "sphere" ? shapes::Sphere::kind
                    : shape == "box"  ? shapes::Box::kind
                                      : shapes::Capsule::kind;
  body.shape.radius = kSize;
  body.shape.half_extents = shape == "box" ? Vec3d{kSize, 0.7 * kSize, 0.5 * kSize}
                                           : Vec3d{0.5 * kSize, 0.5 * kSize, kSize};
  set_mass_from_density(body, 1000);
  return body;
}

class ThinPlates : public testing::TestWithParam<std::tuple<Plate, std::string, Precision>> {};
INSTANTIATE_TEST_SUITE_P(
    All, ThinPlates,
    testing::Combine(testing::Values(Plate::box, Plate::mesh, Plate::free),
                     testing::Values("sphere", "box", "capsule"),
                     testing::Values(Precision::single_precision, Precision::double_precision)),
    [](const auto& info) {
      return std::string(name_of(std::get<0>(info.param))) + "_" + std::get<1>(info.param) +
             (std::get<2>(info.param) == Precision::single_precision ? "_float" : "_double");
    });

// The plate is the plane x = 0, 2 m wide. What is shot from the left stays left of it; a free plate is as heavy as a plate of steel.
TEST_P(ThinPlates, AreNotPassedAt100MetersPerSecond) {
  const auto& [plate, shape, precision] = GetParam();
  for (const double start : {-0.33, -0.3571, -0.405}) {
    for (const double turn : {0.0, 0.6}) {
      Scene scene = empty_scene(kPlateStep, 0.3);
      solve_to(scene, 1e-5);
      scene.gravity = {};
      BodyDescription shot = shot_of(shape);
      shot.position = {start, 0.013, 0.021};
      shot.orientation = exp_map(Vec3d{turn, 0.3 * turn, 0.7 * turn});
      shot.velocity = {kSpeed, 3, 0};
      shot.angular_velocity = {0, 20 * turn, 0};
      scene.bodies.push_back(shot);
      if (plate == Plate::box) {
        add_wall_box(scene, {}, {kThin, 1, 1});
      } else if (plate == Plate::free) {
        add_box(scene, {}, {kThin, 1, 1}, 2 * kThin * 4 * 7800);
      } else {
        TriangleMesh mesh;
        mesh.name = "plate";
        mesh.closed = false;
        mesh.vertices = {{0, -1, -1}, {0, 1, -1}, {0, 1, 1}, {0, -1, 1}};
        mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
        add_mesh(scene, mesh);
      }
      World world(scene, cpu_options(1, precision));
      double farthest = -INFINITY;
      for (int k = 0; k < 20; ++k) {
        world.step();
        const BodyStates s = world.states();
        const Vec3d from_plate = rotate_back(s.orientation[1], s.position[0] - s.position[1]);
        farthest = std::max(farthest, from_plate.x);
      }
      EXPECT_LT(farthest, 0) << start << " " << turn;
      if (plate != Plate::free) continue;
      // It took up what the shot lost: momentum is that of the start.
      const BodyStates s = world.states();
      const double all = shot.mass * s.velocity[0].x + scene.bodies[1].mass * s.velocity[1].x;
      EXPECT_NEAR(all, shot.mass * kSpeed, 1e-3 * shot.mass * kSpeed);
      EXPECT_GT(s.velocity[1].x, 0);
    }
  }
}

}  // namespace
}  // namespace scree::physics
