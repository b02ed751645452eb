// Bodies on terrain from grids of heights: inner edges are not felt, nothing gets through, and what
// rolls or slides over many cells does as on a half space.

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "host/scene_reader.h"
#include "host/state_hash.h"
#include "tests/host/gray_png.h"
#include "tests/host/input_files.h"
#include "tests/physics/described_bodies.h"
#include "tests/physics/terrain.h"

namespace scree::physics {
namespace {

Motion at_velocity(const Vec3d& velocity) {
  Motion motion;
  motion.kind = Motion::Kind::linear;
  motion.velocity = velocity;
  return motion;
}

TEST(HeightFields, BodiesRestOnAFlatOneAtTheExactHeight) {
  Scene scene = empty_scene(1e-3, 0.5);
  scene.stepping.envelope = 1e-2;
  add_field(scene, grid_of(7, 5, 3, 2, [](double, double) { return 0.3; }), 3, 2);
  // Over a face, an inner edge, a diagonal and a vertex.
  const Vec3d places[]{{0.1, 0.05, 0}, {0.5, 0.2, 0}, {-0.25, 0.25, 0}, {-0.5, -0.5, 0}};
  for (Vec3d x : places) {
    x.z = 0.3 + 0.04;
    add_sphere(scene, x, 0.04, 1);
  }
  add_box(scene, {1, 0.5, 0.3 + 0.06}, {0.2, 0.1, 0.06}, 1);
  World world = reference_world(scene);
  for (int k = 0; k < 300; ++k) world.step();
  const BodyStates s = world.states();
  for (std::size_t i = 1; i < scene.bodies.size(); ++i)
    EXPECT_LT(norm(s.position[i] - scene.bodies[i].position), 1e-9) << i;
  int contacts[6] = {};
  for (const ContactRecord& c : world.contacts()) ++contacts[c.body_a == 0 ? c.body_b : c.body_a];
  for (int i = 1; i <= 4; ++i) EXPECT_EQ(contacts[i], 1) << "a sphere on a plane has one";
}

class HeightFieldSlope : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Degrees, HeightFieldSlope, ::testing::Values(5.0, 20.0, 40.0));

TEST_P(HeightFieldSlope, OfManyCellsIsRolledDownAsAHalfSpace) {
  const double angle = radians(GetParam()), r = 0.05;
  const Vec3d normal{std::sin(angle), 0, std::cos(angle)};
  Scene field = empty_scene(1e-3, 0.6);
  field.stepping.envelope = 1e-2;
  field.gravity = {0, 0, -kGravity};
  Scene plane = field;
  add_field(field, grid_of(81, 9, 8, 0.8, [&](double x, double) { return -std::tan(angle) * x; }),
            8, 0.8);
  add_plane(plane, normal);
  const Vec3d start{-3.5, 0.013, 3.5 * std::tan(angle)};
  for (Scene* scene : {&field, &plane}) add_sphere(*scene, start + r * normal, r, 1);
  World on_field = reference_world(field), on_plane = reference_world(plane);
  for (int k = 0; k < 1000; ++k) {
    on_field.step();
    on_plane.step();
    const Vec3d x = on_field.states().position[1];
    ASSERT_LT(norm(x - on_plane.states().position[1]), 1e-8) << "step " << k;
    ASSERT_NEAR(dot(x, normal), r, 1e-8) << "step " << k;
  }
  const double a = kGravity * std::sin(angle) / 1.4;
  const BodyStates s = on_field.states();
  EXPECT_NEAR(norm(s.velocity[1]), a, 0.002 * a);
  EXPECT_NEAR(s.angular_velocity[1].y * r, norm(s.velocity[1]), 1e-6);
}

TEST(HeightFields, ABoxSlidesOverInnerEdgesAsOnAPlane) {
  const double angle = radians(40), mu = 0.5;
  const Vec3d normal{std::sin(angle), 0, std::cos(angle)};
  Scene scene = empty_scene(1e-3, mu, Model::exact);
  scene.stepping.envelope = 1e-2;
  scene.gravity = {0, 0, -kGravity};
  add_field(scene, grid_of(61, 9, 6, 0.8, [&](double x, double) { return -std::tan(angle) * x; }),
            6, 0.8);
  BodyDescription& box = add_box(scene, Vec3d{-2.5, 0.02, 2.5 * std::tan(angle)} + 0.05 * normal,
                                 {0.07, 0.06, 0.05}, 1);
  box.orientation = exp_map(Vec3d{0, angle, 0});
  const Vec3d start = box.position;
  World world = reference_world(scene);
  const double a = kGravity * (std::sin(angle) - mu * std::cos(angle)), h = 1e-3;
  for (int k = 1; k <= 700; ++k) {
    world.step();
    const BodyStates s = world.states();
    const Vec3d along{std::cos(angle), 0, -std::sin(angle)};
    const Vec3d expected = start + (a * h * h * k * (k + 1.0) / 2) * along;
    ASSERT_LT(norm(s.position[1] - expected), 1e-5) << "step " << k;
  }
}

TEST(HeightFields, BodiesLieInAValleyAsBetweenTwoPlanes) {
  const double angle = radians(45), r = 0.1;
  Scene scene = empty_scene(1e-3, 0.3);
  scene.stepping.envelope = 1e-2;
  scene.gravity = {0, 0, -kGravity};
  add_field(scene, grid_of(9, 7, 2, 2, [&](double x, double) { return std::abs(x); }), 2, 2);
  add_sphere(scene, {0, 0.11, r / std::cos(angle)}, r, 1);
  BodyDescription& cube = add_box(scene, {0, -0.4, 0.1 * std::sqrt(2.0)}, {0.1, 0.1, 0.1}, 1);
  cube.orientation = exp_map(Vec3d{0, angle, 0});
  World world = reference_world(scene);
  for (int k = 0; k < 500; ++k) world.step();
  const BodyStates s = world.states();
  for (const std::size_t i : {1u, 2u}) {
    EXPECT_LT(norm(s.position[i] - scene.bodies[i].position), 1e-6) << i;
    Vec3d carried;
    int count = 0;
    for (const ContactRecord& c : world.contacts()) {
      if (c.body_a != static_cast<int>(i) && c.body_b != static_cast<int>(i)) continue;
      carried += c.body_b == static_cast<int>(i) ? c.impulse : -c.impulse;
      ++count;
    }
    EXPECT_GE(count, 2) << i;
    EXPECT_LT(norm(carried - Vec3d{0, 0, 1e-3 * kGravity}), 1e-8) << i;
  }
}

// z = x^2 + y^2: the triangles of a bowl lie above it, so a body on them does, too.
TEST(HeightFields, AHeapInABowlStaysAndIsCarried) {
  Scene scene = empty_scene(2e-3, 0.4);
  solve_to(scene, 1e-7);
  scene.gravity = {0, 0, -kGravity};
  const auto bowl = [](double x, double y) { return x * x + y * y; };
  add_field(scene, grid_of(25, 25, 2, 2, bowl), 2, 2);
  double mass = 0;
  for (int k = 0; k < 24; ++k) {
    const Vec3d x{0.22 * (k % 3 - 1) + 0.01, 0.22 * (k / 3 % 3 - 1) - 0.02, 0.35 + 0.2 * (k / 9)};
    BodyDescription& body =
        k % 2 == 0 ? add_sphere(scene, x, 0.08, 1) : add_box(scene, x, {0.08, 0.06, 0.05}, 1);
    mass += body.mass;
  }
  World world = reference_world(scene);
  const StepReport report = run_for(world, scene, 3);
  EXPECT_LT(report.kinetic_energy, 1e-3 * mass);
  const BodyStates s = world.states();
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const Vec3d x = s.position[i];
    EXPECT_GT(x.z, bowl(x.x, x.y) + 0.045) << i;
  }
  double carried = 0;
  for (const ContactRecord& c : world.contacts()) {
    if (c.body_a == 0) carried += c.impulse.z;
    if (c.body_b == 0) carried -= c.impulse.z;
  }
  EXPECT_NEAR(std::abs(carried), mass * kGravity * 2e-3, 0.02 * mass * kGravity * 2e-3);
}

// Tetrahedra rain on peaks as sharp as they are, of heights that lie at random beside each other. Their edges lie over notches, where no
// corner of theirs is over a triangle.
TEST(HeightFields, SharpBodiesStayOnSharpPeaks) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> height(0, 0.15), turn(-1, 1);
  const HeightGrid grid = grid_of(30, 30, 2, 2, [&](double, double) { return height(random); });
  Scene scene = empty_scene(1e-3, 0.5);
  solve_to(scene, 1e-5);
  scene.gravity = {0, 0, -kGravity};
  add_field(scene, grid, 2, 2, 0.5);
  for (int k = 0; k < 9; ++k) {
    BodyDescription& body = add_described(
        scene,
        R"("shape": "hull", "points": [[-0.1, -0.1, -0.05], [0.15, -0.05, -0.05], [0, 0.14, -0.05], [0, 0, 0.12]])");
    body.position = {0.6 * (k % 3 - 1), 0.6 * (k / 3 - 1), 0.35};
    body.orientation = normalized(Quatd{turn(random), turn(random), turn(random), turn(random)});
  }
  World world(scene, cpu_options(2));
  int deep = 0;
  for (int k = 0; k < 1000; ++k) deep += world.step().max_penetration > 5e-3;
  EXPECT_LE(deep, 2);
  const BodyStates s = world.states();
  for (std::size_t i = 1; i < s.position.size(); ++i) EXPECT_GT(s.position[i].z, 0.05) << i;
}

// Spheres go five diameters a step, boxes a quarter of their edge: only the ways of spheres are followed.
TEST(HeightFields, NoSpeedLeadsThrough) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-0.8, 0.8), tilted(-1, 1);
  const auto hills = [](double x, double y) {
    return 0.1 * std::sin(7 * x) * std::cos(6 * y) + 0.05 * std::cos(15 * x);
  };
  const HeightGrid grid = grid_of(31, 31, 2, 2, hills);
  for (const double restitution : {0.0, 0.7}) {
    for (const bool is_box : {false, true}) {
      SCOPED_TRACE(testing::Message() << "restitution " << restitution << " box " << is_box);
      Scene scene = empty_scene(1e-3, 0.3);
      solve_to(scene, 1e-8);
      scene.materials[0].restitution = restitution;
      scene.gravity = {0, 0, -kGravity};
      add_field(scene, grid, 2, 2, 0.02);  // thinner than a step is long
      for (int k = 0; k < 60; ++k) {
        const Vec3d x{place(random), place(random), 0.4 + (is_box ? 0.05 : 0.3) * k};
        BodyDescription& body =
            is_box ? add_box(scene, x, {0.02, 0.02, 0.02}, 1) : add_sphere(scene, x, 0.015, 1);
        body.velocity = (is_box ? 10.0 : 100.0) *
                        normalized(Vec3d{0.3 * tilted(random), 0.3 * tilted(random), -1});
      }
      World world = reference_world(scene);
      std::vector<char> was_inside(scene.bodies.size(), 1);
      int seen = 0;
      for (int k = 0; k < 400; ++k) {
        world.step();
        const BodyStates s = world.states();
        for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
          const Vec3d& x = s.position[i];
          if (std::abs(x.x) > 0.97 || std::abs(x.y) > 0.97) was_inside[i] = 0;  // off the rim
          if (!was_inside[i]) continue;
          ++seen;
          ASSERT_TRUE(is_above(grid, 2, 2, x))
              << "body " << i << " step " << k << " at " << x.x << " " << x.y << " " << x.z
              << " velocity " << s.velocity[i].x << " " << s.velocity[i].y << " "
              << s.velocity[i].z;
        }
      }
      EXPECT_GT(seen, 2000);
    }
  }
}

/// Lets bodies of a shape, turned in all ways, fall on a field. @return  how many centers came below its surface
int count_fallen_through(const HeightGrid& grid, double lx, double ly, const std::string& shape,
                         const std::vector<Vec3d>& places, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Scene scene = empty_scene(1e-3, 0.5);
  solve_to(scene, 1e-7);
  scene.gravity = {0, 0, -kGravity};
  add_field(scene, grid, lx, ly, 0.05);
  for (const Vec3d& x : places) {
    BodyDescription& body = add_described(scene, shape);
    body.position = x;
    if (seed > 0)
      body.orientation =
          normalized(Quatd{normal(random), normal(random), normal(random), normal(random)});
  }
  World world = reference_world(scene);
  std::vector<char> is_through(scene.bodies.size(), 0);
  for (int k = 0; k < 300; ++k) {
    world.step();
    const BodyStates s = world.states();
    for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
      const Vec3d& x = s.position[i];
      if (std::abs(x.x) < 0.45 * lx && std::abs(x.y) < 0.45 * ly && !is_above(grid, lx, ly, x))
        is_through[i] = 1;
    }
  }
  return static_cast<int>(std::count(is_through.begin(), is_through.end(), 1));
}

const char* const kShapes[]{
    R"("shape": "ellipsoid", "size": [0.1, 0.08, 0.06])",
    R"("shape": "capsule", "radius": 0.04, "length": 0.05)",
    R"("shape": "cone", "radius": 0.04, "length": 0.1, "rotation_deg": {"axis": [1, 0, 0], "angle": 180})",
    R"("shape": "cylinder", "radius": 0.04, "length": 0.1)",
    R"("shape": "ellipsoid", "size": [0.08, 0.06, 0.04], "rounding": 0.01)",
    R"("shape": "box", "size": [0.1, 0.08, 0.06])"};

// Edges go down from the middle on two sides and up on the others: one that is sharp meets such that are not.
TEST(HeightFields, SaddlesHoldBodiesOfAllShapes) {
  for (const double height : {0.06, 0.005, 0.001}) {
    const HeightGrid grid = grid_of(3, 3, 0.4, 0.4, [&](double x, double y) {
      return height * (std::abs(x) - std::abs(y)) / 0.2;
    });
    for (const char* shape : kShapes)
      for (const Vec3d& x : {Vec3d{0, 0, 0.1}, Vec3d{0.02, 0, 0.1}, Vec3d{-0.01, 0.015, 0.1}})
        EXPECT_EQ(count_fallen_through(grid, 0.4, 0.4, shape, {x}, 0), 0)
            << shape << " over " << height << " m at " << x.x << " " << x.y;
  }
}

TEST(HeightFields, HillsHoldBodiesOfAllShapes) {
  constexpr double kTurn = 6.283185307179586;
  const HeightGrid grid = grid_of(31, 25, 1.5, 1.2, [](double x, double y) {
    return 0.02 * std::sin(kTurn * x / 0.5) * std::cos(kTurn * y / 0.4);
  });
  std::vector<Vec3d> places;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 5; ++j) places.push_back({-0.5 + 0.2 * i, -0.4 + 0.2 * j, 0.1});
  for (const char* shape : kShapes)
    EXPECT_EQ(count_fallen_through(grid, 1.5, 1.2, shape, places, 7), 0) << shape;
}

TEST(HeightFields, AMovingOneCarriesWhatLiesOnIt) {
  Scene scene = empty_scene(1e-3, 0.5);
  scene.stepping.envelope = 1e-2;
  scene.gravity = {0, 0, -kGravity};
  BodyDescription& field =
      add_field(scene, grid_of(7, 5, 3, 2, [](double, double) { return 0.3; }), 3, 2);
  field.kind = BodyKind::kinematic;
  field.motion = at_velocity({0.4, 0, 0.2});
  add_sphere(scene, {0.1, 0.05, 0.34}, 0.04, 1).velocity = {0.4, 0, 0.2};
  add_box(scene, {-0.5, 0.2, 0.36}, {0.2, 0.1, 0.06}, 1).velocity = {0.4, 0, 0.2};
  World world = reference_world(scene);
  for (int k = 0; k < 1000; ++k) world.step();
  const BodyStates s = world.states();
  for (const std::size_t i : {1u, 2u})
    EXPECT_LT(norm(s.position[i] - (scene.bodies[i].position + Vec3d{0.4, 0, 0.2})), 1e-7) << i;
}

TEST(HeightFields, ARisingOneLeavesNothingBehind) {
  Scene scene = empty_scene(1e-3, 0.5);
  scene.gravity = {0, 0, -kGravity};
  const HeightGrid grid = grid_of(
      9, 9, 2, 2, [](double x, double y) { return 0.1 * std::cos(5 * x) * std::cos(4 * y); });
  BodyDescription& field = add_field(scene, grid, 2, 2, 0.02);
  field.kind = BodyKind::kinematic;
  field.motion = at_velocity({0, 0, 100});
  for (int k = 0; k < 5; ++k) add_sphere(scene, {0.3 * k - 0.6, 0.1, 0.5}, 0.03, 1);
  World world = reference_world(scene);
  for (int k = 0; k < 10; ++k) world.step();
  for (int i = 1; i <= 5; ++i) {
    const BodyStates s = world.states();
    const auto n = static_cast<std::size_t>(i);
    EXPECT_TRUE(is_above(grid, 2, 2, s.position[n] - Vec3d{0, 0, 1})) << i;
  }
}

// The solid has sides: a ball is held by them, and one that rolls off the rim falls past them.
TEST(HeightFields, EndAtTheirRim) {
  Scene scene = empty_scene(1e-3, 0.0);
  scene.gravity = {};
  add_field(scene, grid_of(5, 5, 2, 2, [](double, double) { return 0.0; }), 2, 2, 0.5);
  add_sphere(scene, {1.5, 0.1, -0.2}, 0.1, 1).velocity = {-1, 0, 0};
  add_sphere(scene, {0.3, -0.9, -0.8}, 0.1, 1).velocity = {0, 0, 1};
  add_sphere(scene, {1.2, -0.4, 0.3}, 0.1, 1).velocity = {0, 0, -2};
  World world = reference_world(scene);
  for (int k = 0; k < 1000; ++k) world.step();
  const BodyStates s = world.states();
  EXPECT_NEAR(s.position[1].x, 1.1, 1e-6) << "held by a side";
  EXPECT_NEAR(s.position[2].z, -0.6, 1e-6) << "held by the base";
  EXPECT_NEAR(s.position[3].z, 0.3 - 2, 1e-9) << "beyond the rim there is nothing";
}

TEST(HeightFields, OneOfATableAndOneOfAPictureGiveTheSameBits) {
  std::vector<int> gray;
  std::string table;
  for (int r = 0; r < 12; ++r) {
    for (int c = 0; c < 15; ++c) {
      gray.push_back((c * 37 + r * 91) % 256);
      table += (c == 0 ? "" : ",") + std::to_string(gray.back());
    }
    table += "\n";
  }
  std::vector<int> wide;
  for (const int g : gray) wide.push_back(257 * g);
  test::write_file("field.csv", table);
  test::write_file("field8.png", test::png_bytes(15, 12, gray));
  test::write_file("field16.png", test::png_bytes(15, 12, wide, {.depth = 16}));
  const auto hash = [](const std::string& keys) {
    const auto file = test::write_file("scene.json", R"({"time_step": 1e-3, "duration": 1,
      "bodies": [{"shape": "height_field", "extent": [1.4, 1.1], )" +
                                                         keys + R"(}],
      "particles": [{"layout": "lattice", "count": 40, "radius": 0.03, "density": 1000,
        "region": {"min": [-0.5, -0.4, 0.3], "max": [0.5, 0.4, 0.6]}}]})");
    World world(read_scene(file), cpu_options());
    for (int k = 0; k < 400; ++k) world.step();
    return state_hash(world.states());
  };
  // Black is 0 and white 255/1024 m: all heights are exact.
  const std::uint64_t of_table = hash(R"("file": "field.csv", "height_scale": 0.0009765625)");
  const std::string range = R"("height_range": [0, 0.2490234375])";
  EXPECT_EQ(hash(R"("file": "field8.png", )" + range), of_table);
  EXPECT_EQ(hash(R"("file": "field16.png", )" + range), of_table);
  EXPECT_NE(hash(R"("file": "field.csv", "height_scale": 0.0009765626)"), of_table);
}

}  // namespace
}  // namespace scree::physics
