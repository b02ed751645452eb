// Nothing passes a mesh: neither where its faces meet at an inner angle nor at any speed, nor where
// the domain repeats. On every backend there is.

#include <algorithm>
#include <cmath>

#include "shapes/mesh.h"
#include "tests/parity/parity.h"

namespace scree::parity {
namespace {

class MeshWalls : public ::testing::TestWithParam<std::tuple<BackendKind, Precision>> {
 protected:
  void SetUp() override {
    std::string reason;
    if (!backend_available(backend(), &reason)) GTEST_SKIP() << "no such backend: " << reason;
  }
  BackendKind backend() const { return std::get<0>(GetParam()); }
  Precision precision() const { return std::get<1>(GetParam()); }
  bool is_single() const { return precision() == Precision::single_precision; }
  World world(const Scene& scene) const { return world_on(backend(), scene, precision()); }
  Scene scene(double friction, double time_step = 0.01) const {
    Scene s = empty_scene(time_step, friction);
    solve_to(s, is_single() ? 1e-5 : 1e-10);
    s.gravity = {};
    return s;
  }
};
INSTANTIATE_TEST_SUITE_P(All, MeshWalls,
                         ::testing::Combine(::testing::ValuesIn(kBackends),
                                            ::testing::ValuesIn(kPrecisions)),
                         [](const auto& info) {
                           return std::string(name_of(std::get<0>(info.param))) + "_" +
                                  name_of(std::get<1>(info.param));
                         });

/// Adds a parallelogram of n x n cells, two triangles each; its outside is along cross(u, v).
void add_sheet(TriangleMesh& mesh, const Vec3d& corner, const Vec3d& u, const Vec3d& v, int n) {
  const auto first = static_cast<int>(mesh.vertices.size());
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i)
      mesh.vertices.push_back(corner + (1.0 * i / n) * u + (1.0 * j / n) * v);
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const int a = first + j * (n + 1) + i, b = a + 1, c = b + n + 1, d = a + n + 1;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  }
}

BodyDescription& add_mesh(Scene& scene, TriangleMesh mesh) {
  mesh.name = "mesh";
  mesh.closed = false;
  scene.meshes.push_back(mesh);
  BodyDescription body;
  body.kind = BodyKind::fixed;
  body.shape.kind = shapes::Mesh::kind;
  body.shape.mesh = static_cast<int>(scene.meshes.size()) - 1;
  scene.bodies.push_back(body);
  return scene.bodies.back();
}

TEST_P(MeshWalls, ASphereSlidesDownAWallOntoAPlateAsOnHalfSpaces) {
  for (const double slope : {15.0, 35.0, 60.0}) {
    const double sine = std::sin(radians(slope)), cosine = std::cos(radians(slope));
    for (const double way : {0.2, 1.0, 1.5, 3.0, 11.0}) {  // diameters in a step
      for (const int kind : {0, 1, 2}) {                   // one mesh, two, coarse
        const int n = kind == 2 ? 1 : 16;
        TriangleMesh wall, plate;
        add_sheet(wall, {0, -20, 0}, {0, 40, 0}, {0, 0, 40}, n);
        add_sheet(kind == 1 ? plate : wall, {0, -20, 0}, {40 * cosine, 0, -40 * sine}, {0, 40, 0},
                  n);
        Scene as_mesh = scene(0.3), as_planes = scene(0.3);
        for (Scene* s : {&as_mesh, &as_planes})
          add_sphere(*s, {0.5, 0.31, 7.17}, 0.5, 1).velocity = {0, 0, -way / 0.01};
        add_mesh(as_mesh, wall);
        if (kind == 1) add_mesh(as_mesh, plate);
        add_plane(as_planes, {1, 0, 0});
        add_plane(as_planes, {sine, 0, cosine});
        World mesh = world(as_mesh), planes = world(as_planes);
        for (int k = 0; k < static_cast<int>(9 / way) + 4; ++k) {
          mesh.step();
          planes.step();
          const Vec3d x = mesh.states().position[0];
          const double tolerance = (is_single() ? 1e-5 : 1e-9) * (1 + way);
          EXPECT_GT(sine * x.x + cosine * x.z, 0.5 - tolerance);
          EXPECT_LT(norm(x - planes.states().position[0]), 10 * tolerance)
              << "slope " << slope << " way " << way << " kind " << kind << " step " << k;
        }
      }
    }
  }
}

TEST_P(MeshWalls, NoSpeedLeadsOutOfARoom) {
  // A room with a step in its floor; a sphere crosses it many times in each step.
  TriangleMesh room;
  add_sheet(room, {0, 0, 0}, {5, 0, 0}, {0, 6, 0}, 3);
  add_sheet(room, {5, 0, 0}, {0, 0, 1}, {0, 6, 0}, 1);
  add_sheet(room, {5, 0, 1}, {5, 0, 0}, {0, 6, 0}, 3);
  add_sheet(room, {0, 0, 8}, {10, 0, 0}, {0, 6, 0}, 4);
  add_sheet(room, {0, 0, 0}, {0, 6, 0}, {0, 0, 8}, 2);
  add_sheet(room, {10, 0, 1}, {0, 6, 0}, {0, 0, 7}, 5);
  add_sheet(room, {0, 0, 0}, {10, 0, 0}, {0, 0, 8}, 1);
  add_sheet(room, {0, 6, 0}, {10, 0, 0}, {0, 0, 8}, 2);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int trial = 0; trial < 60; ++trial) {
    Scene s = scene(0.2);
    // 0.1 to 10 d in a step. What bounces could cross the whole room in the step of the impact.
    const bool bounces = trial % 2 != 0;
    s.materials[0].restitution = bounces ? 0.7 : 0;
    const double speed = 100 * std::pow(10, (bounces ? 1 : 2) * uniform(random) - 1);
    add_sphere(s, {1 + 3 * uniform(random), 1 + 4 * uniform(random), 3 + 3 * uniform(random)}, 0.5,
               1)
        .velocity = speed * normalized(Vec3d{uniform(random) - 0.5, uniform(random) - 0.5,
                                             uniform(random) - 0.5});
    add_mesh(s, room);
    World w = world(s);
    for (int k = 0; k < 40; ++k) {
      w.step();
      const Vec3d x = w.states().position[0];
      const double least = 0.5 * 0.99;
      ASSERT_GT(x.x, least) << "trial " << trial << " step " << k;
      ASSERT_LT(x.x, 10 - least) << "trial " << trial << " step " << k;
      ASSERT_GT(x.y, least) << "trial " << trial << " step " << k;
      ASSERT_LT(x.y, 6 - least) << "trial " << trial << " step " << k;
      ASSERT_LT(x.z, 8 - least) << "trial " << trial << " step " << k;
      ASSERT_GT(x.z, least) << "trial " << trial << " step " << k;
      // The step in the floor: its top, its side, its edge.
      const double dx = std::max(5 - x.x, 0.0), dz = std::max(x.z - 1, 0.0);
      ASSERT_GT(std::hypot(dx, dz), least)
          << "trial " << trial << " step " << k << " " << x.x << " " << x.z;
    }
  }
}

TEST_P(MeshWalls, AFastSphereSlidesOverAFlatMeshAsOnAHalfSpace) {
  TriangleMesh floor;
  add_sheet(floor, {-30, -30, 0}, {60, 0, 0}, {0, 60, 0}, 97);
  Scene as_mesh = scene(0), as_plane = scene(0);
  for (Scene* s : {&as_mesh, &as_plane}) {
    s->gravity = {0, 0, -9.81};
    add_sphere(*s, {-20, -9, 0.5}, 0.5, 1).velocity = {230, 80, 0};
  }
  add_mesh(as_mesh, floor);
  add_plane(as_plane);
  World mesh = world(as_mesh), plane = world(as_plane);
  for (int k = 0; k < 15; ++k) {
    EXPECT_EQ(mesh.step().contact_count, 1) << "step " << k;
    plane.step();
    EXPECT_LT(norm(mesh.states().position[0] - plane.states().position[0]),
              is_single() ? 1e-4 : 1e-9);
  }
}

Scene periodic_floor(Scene s) {
  s.periodicity = {{true, true, false}, {0, 0, 0}, {1, 1, 0}};
  s.gravity = {0, 0, -9.81};
  for (int k = 0; k < 20; ++k) {
    add_sphere(s, {0.05 * k + 0.01, 0.05 * (k * 7 % 20) + 0.02, 0.021}, 0.02, 0.1).velocity = {
        1, 0.5, 0};
  }
  return s;
}

TEST_P(MeshWalls, AFloorDrawnInOneCellIsThereInAll) {
  for (const int kind : {0, 1, 2, 3}) {
    Scene s = periodic_floor(scene(0.0, 1e-3));
    TriangleMesh floor;
    if (kind == 0) add_sheet(floor, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 1);
    if (kind == 1) add_sheet(floor, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 9);
    if (kind == 2) add_sheet(floor, {-3.3, 7.2, 0}, {1.7, 0, 0}, {0, 2.4, 0}, 5);  // over itself
    if (kind == 3) {
      add_wall_box(s, {0.5, 0.5, -0.1}, {0.5, 0.5, 0.1});
    } else {
      add_mesh(s, floor);
    }
    World w = world(s);
    for (int k = 0; k < 600; ++k) {
      const StepReport report = w.step();
      if (k > 30) {
        ASSERT_EQ(report.contact_count, 20) << "kind " << kind << " step " << k;
      }
    }
    for (int i = 0; i < 20; ++i) {
      EXPECT_NEAR(w.states().position[static_cast<std::size_t>(i)].z, 0.02, 2e-5)
          << "kind " << kind;
      EXPECT_NEAR(w.states().velocity[static_cast<std::size_t>(i)].x, 1, 1e-4) << "kind " << kind;
    }
  }
}

TEST_P(MeshWalls, ABlockAtAPeriodicSideIsThereOnBothSides) {
  for (const bool is_mesh : {false, true}) {
    Scene s = scene(0.5, 1e-3);
    s.periodicity = {{true, false, false}, {0, 0, 0}, {1, 0, 0}};
    s.gravity = {0, 0, -9.81};
    add_sphere(s, {0.93, 0, 0.16}, 0.05, 1);
    add_sphere(s, {0.07, 0.3, 0.16}, 0.05, 1);
    add_sphere(s, {0.5, 0, 0.06}, 0.05, 1);
    add_plane(s);
    if (is_mesh) {  // from -0.1 to 0.1 in x
      TriangleMesh block;
      add_sheet(block, {-0.1, -1, 0.1}, {0.2, 0, 0}, {0, 2, 0}, 2);
      add_mesh(s, block).position = {3, 0, 0};
    } else {
      add_wall_box(s, {0, 0, 0.05}, {0.1, 1, 0.05});
    }
    World w = world(s);
    for (int k = 0; k < 300; ++k) w.step();
    EXPECT_NEAR(w.states().position[0].z, 0.15, 1e-4);
    EXPECT_NEAR(w.states().position[1].z, 0.15, 1e-4);
    EXPECT_NEAR(w.states().position[2].z, 0.05, 1e-4);
  }
}

}  // namespace
}  // namespace scree::parity
