// Impacts of few bodies by the variational model, against closed forms (cases B of the validation catalogue).

#include <gtest/gtest.h>

#include "shapes/capsule.h"
#include "shapes/cylinder.h"
#include "tests/dynamics/variational_scenes.h"

namespace scree::test {
namespace {

/// A ball of radius 1/4 whose lowest point starts 1 m above a floor.
Scene ball_on_floor(double h, double restitution = 1) {
  Scene scene = variational_scene(h, restitution);
  scene.gravity = {0, 0, -g};
  physics::add_plane(scene);
  add_sphere(scene, {0, 0, 1.25}, 0.25, 1);
  return scene;
}

struct Bounces {
  double largest_error = 0;  ///< of the energy, over that at the start
  double hits = 0;
  double identity_error = 0;
  double penetration = 0;
};
Bounces bounce(double h, int steps) {
  World world(ball_on_floor(h), cpu_options());
  Bounces b;
  for (int k = 0; k < steps; ++k) {
    const StepReport r = world.step();
    const double height_energy = g * 0.25;  // of the center, when the ball touches
    b.largest_error = std::max(b.largest_error, std::abs(r.own[energy] - height_energy - g) / g);
    b.hits += r.own[impacts];
    b.identity_error = std::max(b.identity_error, r.own[identity_error]);
    b.penetration = std::max(b.penetration, r.max_penetration);
  }
  return b;
}

TEST(VariationalImpacts, B01_BallOnAFloorKeepsItsEnergy) {
  const int steps = 1000000;
  const Bounces coarse = bounce(0.01, steps), middle = bounce(0.005, steps),
                fine = bounce(0.0025, steps);
  EXPECT_NEAR(coarse.hits, 11075, 20);
  EXPECT_LT(coarse.largest_error, 3 * 1.22e-3);
  EXPECT_LT(middle.largest_error, 3 * 7.1e-5);
  EXPECT_LT(fine.largest_error, 3 * 1.2e-5);
  EXPECT_LT(coarse.largest_error, 4 * (g * g * 1e-4 / 8 / g) * std::sqrt(coarse.hits / 3));
  for (const Bounces& b : {coarse, middle, fine}) {
    EXPECT_LT(b.identity_error, 1e-13);
    EXPECT_LT(b.penetration, 1e-12);
  }
}

/// An impact at the part alpha of a step changes the energy by g^2 h^2 (1 - 2 alpha) / 8.
TEST(VariationalImpacts, B01_EnergyJumpsByItsFormula) {
  for (const double h : {0.01, 0.005}) {
    World world(ball_on_floor(h), cpu_options());
    StepReport before = world.step();
    int hits = 0;
    for (int k = 0; k < 20000; ++k) {
      const BodyStates at = world.states();
      const StepReport after = world.step();
      const double jump = after.own[energy] - before.own[energy];
      before = after;
      if (after.own[impacts] == 0) {
        EXPECT_NEAR(jump, 0, 1e-12);
        continue;
      }
      ++hits;
      const double z = at.position[1].z - 0.25, v = at.velocity[1].z;
      const double alpha = (v + std::sqrt(v * v + 2 * g * z)) / g / h;
      ASSERT_NEAR(jump, g * g * h * h * (1 - 2 * alpha) / 8, 1e-11)
          << "step " << k << " alpha " << alpha;
    }
    EXPECT_GT(hits, 100);
  }
}

/// However many impacts are in a step, the discrete energy of its last part is that of its first.
TEST(VariationalImpacts, SeveralImpactsInAStepCarryTheDiscreteEnergy) {
  const double h = 0.05, r = 0.25, lid = 0.625;  // room of 1/8 m
  Scene scene = variational_scene(h);
  scene.gravity = {0, 0, -g};
  physics::add_plane(scene);
  physics::add_plane(scene, {0, 0, -1}, {0, 0, lid});
  add_sphere(scene, {0, 0, 0.3}, r, 1).velocity = {0, 0, 9};
  World world(scene, cpu_options());
  double several = 0;
  BodyStates before = world.states();
  for (int k = 0; k < 500; ++k) {
    const StepReport report = world.step();
    const BodyStates after = world.states();
    const auto node_energy = [](const BodyStates& s) {
      return 0.5 * norm2(s.velocity[2]) + g * s.position[2].z;
    };
    // From a node to the plate ahead, and back to the one behind, along the parabola.
    const auto time_to_plate = [&](double z, double v) {
      const double down = z - r, up = lid - r - z;
      const double floor = (v + std::sqrt(v * v + 2 * g * down)) / g;
      const double left = v * v - 2 * g * up;
      return v > 0 && left >= 0 ? (v - std::sqrt(left)) / g : floor;
    };
    const double first = time_to_plate(before.position[2].z, before.velocity[2].z);
    const double last = time_to_plate(after.position[2].z, -after.velocity[2].z);
    ASSERT_GE(report.own[impacts], 1);
    several += report.own[impacts] > 1;
    const double jump = node_energy(after) - node_energy(before);
    ASSERT_NEAR(jump, g * g / 8 * (last * last - first * first), 1e-11) << "step " << k;
    before = after;
  }
  EXPECT_GT(several, 400);
}

/// The same of two bodies that meet: what one loses the other gains, but for the parts of the step.
TEST(VariationalImpacts, PairsCarryTheSumOfTheirDiscreteEnergies) {
  const double h = 0.1, ma = 2, mb = 0.5;
  Scene scene = variational_scene(h);
  scene.gravity = {0, 0, -g};
  add_sphere(scene, {0, 0, 5}, 0.25, ma).velocity = {5, 0, 0.5};
  add_sphere(scene, {0.75, 0.1, 5.1}, 0.25, mb).velocity = {-1, 0, 0};
  World world(scene, cpu_options());
  const double start = 0.5 * ma * 25.25 + ma * g * 5 + 0.5 * mb + mb * g * 5.1;
  const Vec3d d{0.75, 0.1, 0.1}, u{-6, 0, -0.5};
  const double b = dot(d, u), t = (-b - std::sqrt(b * b - norm2(u) * (norm2(d) - 0.25))) / norm2(u);
  const StepReport report = world.step();
  ASSERT_EQ(report.own[impacts], 1);
  EXPECT_NEAR(report.own[energy] - start, (ma + mb) * g * g * h * (h - 2 * t) / 8, 1e-12);
  EXPECT_NEAR(report.own[px], 5 * ma - mb, 1e-14);
  EXPECT_NEAR(report.own[pz], 0.5 * ma - (ma + mb) * g * h, 1e-14);
}

/// Heights are e^2 times those before, and times those of the closed form, to second order in h.
TEST(VariationalImpacts, B10_PartlyElasticBouncesAreOfSecondOrder) {
  const double e = 0.9, end = 3;
  // Where the ball is, from one parabola to the next.
  const auto exact = [&](double t) {
    double v = std::sqrt(2 * g), start = v / g;
    if (t < start) return 1 - 0.5 * g * t * t;
    for (;;) {
      v *= e;
      if (t < start + 2 * v / g) return v * (t - start) - 0.5 * g * (t - start) * (t - start);
      start += 2 * v / g;
    }
  };
  double error[2] = {};
  for (int level = 0; level < 2; ++level) {
    const double h = 0.01 / (level == 0 ? 1 : 8);
    World world(ball_on_floor(h, e), cpu_options());
    const int steps = static_cast<int>(std::lround(end / h));
    for (int k = 0; k < steps; ++k) {
      world.step();
      const double z = world.states().position[1].z - 0.25;
      error[level] = std::max(error[level], std::abs(z - exact(world.time())));
    }
  }
  EXPECT_LT(error[0], 20 * g * 1e-4);
  EXPECT_LT(error[1], error[0] / 20) << "64 if the impacts fell on the same parts of steps";
}

TEST(VariationalImpacts, TwoSpheresExchangeMomentumAlongTheLineOfCenters) {
  for (const double e : {1.0, 0.6, 0.0}) {
    Scene scene = variational_scene(0.5, e);
    const double r1 = 0.3, r2 = 0.5, m1 = 2, m2 = 0.7;
    const Vec3d n = normalized(Vec3d{1, 2, -2});
    const Vec3d v1{1, 0.4, -0.8}, v2{-0.2, -0.5, 0.3};
    const double t = 0.2;  // of the impact
    const Vec3d touch1{0.1, 0.2, 0.3}, touch2 = touch1 + (r1 + r2) * n;
    add_sphere(scene, touch1 - t * v1, r1, m1).velocity = v1;
    add_sphere(scene, touch2 - t * v2, r2, m2).velocity = v2;
    ASSERT_LT(dot(v2 - v1, n), 0);
    World world(scene, cpu_options());
    const StepReport report = world.step();
    const double push = (1 + e) * dot(v1 - v2, n) / (1 / m1 + 1 / m2);
    const Vec3d w1 = v1 - (push / m1) * n, w2 = v2 + (push / m2) * n;
    const BodyStates after = world.states();
    EXPECT_LT(norm(after.velocity[0] - w1), 1e-14);
    EXPECT_LT(norm(after.velocity[1] - w2), 1e-14);
    EXPECT_LT(norm(after.position[0] - touch1 - 0.3 * w1), 1e-14);
    EXPECT_LT(norm(after.position[1] - touch2 - 0.3 * w2), 1e-14);
    EXPECT_EQ(report.own[impacts], 1);
    EXPECT_LT(norm(momentum(report) - m1 * v1 - m2 * v2), 1e-14);
    const Vec3d l = m1 * cross(touch1, v1) + m2 * cross(touch2, v2);
    EXPECT_LT(norm(angular_momentum(report) - l), 1e-14);
  }
}

/// Spheres that touch hand an impact on one after the other, as those of a cradle do.
TEST(VariationalImpacts, A43_CradlesHandImpactsOn) {
  for (const double space : {0.0, 1e-3}) {
    for (const int moving : {1, 2}) {
      Scene scene = variational_scene(0.25);
      for (int k = 0; k < 5; ++k) {
        // Binary fractions: spheres of radius 1/2 touch to the bit.
        const double gap = k < moving ? -0.125 : 0;
        add_sphere(scene, {k * (1 + space) + gap, 0, 0}, 0.5, 1).velocity = {k < moving ? 1.0 : 0.0,
                                                                             0, 0};
      }
      World world(scene, cpu_options());
      const StepReport report = world.step();
      const BodyStates after = world.states();
      for (int k = 0; k < 5; ++k)
        EXPECT_NEAR(after.velocity[k].x, k < 5 - moving ? 0 : 1, 1e-13)
            << "sphere " << k << ", " << moving;
      EXPECT_EQ(report.own[impacts], moving == 1 ? 4 : 6);
    }
  }
}

/// Shoots a sphere of radius r at walls, and expects it to come off like a ray of light off a plane with normal n through
/// the point that its center reaches.
void expect_mirrored(Scene scene, const Vec3d& center, const Vec3d& n, const Vec3d& v, double r,
                     const char* what) {
  const double h = scene.stepping.time_step, t = 0.37 * h;
  BodyDescription& body = add_sphere(scene, center - t * v, r, 1.7);
  body.velocity = v;
  World world(scene, cpu_options());
  const StepReport report = world.step();
  const Vec3d mirrored = v - 2 * dot(v, n) * n;
  const BodyStates after = world.states();
  EXPECT_LT(norm(after.velocity.back() - mirrored), 1e-11 * norm(v)) << what;
  EXPECT_LT(norm(after.position.back() - center - (h - t) * mirrored), 1e-11) << what;
  EXPECT_EQ(report.own[impacts], 1) << what;
  EXPECT_LT(report.own[identity_error], 1e-12) << what;
}

/// Faces, edges and corners of a box and of the same box as a mesh: the point nearest to the center gives the normal.
TEST(VariationalImpacts, B06_FacesEdgesAndCornersReflectAboutTheClosestPoint) {
  const Vec3d half{0.5, 0.7, 0.9}, at{0.3, -0.2, 0.1};
  Scene with_box = variational_scene(0.2), with_mesh = variational_scene(0.2);
  physics::add_wall_box(with_box, at, half);
  TriangleMesh mesh;
  for (int k = 0; k < 8; ++k)
    mesh.vertices.push_back(at + Vec3d{(k & 1 ? 1 : -1) * half.x, (k & 2 ? 1 : -1) * half.y,
                                       (k & 4 ? 1 : -1) * half.z});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  physics::add_mesh(with_mesh, mesh);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 200; ++trial) {
    // A direction outward from the box: the normal of a face, an edge or a corner that it belongs to.
    Vec3d n{uniform(random), uniform(random), uniform(random)};
    Vec3d point;
    const int kept = trial % 3;  // axes along which the point is inside
    for (int k = 0; k < 3; ++k) {
      if ((k + trial / 3) % 3 < kept) {
        n[k] = 0;
        point[k] = 0.9 * half[k] * uniform(random);
      } else {
        point[k] = n[k] > 0 ? half[k] : -half[k];
      }
    }
    n = normalized(n);
    const double r = 0.05 + 0.2 * std::abs(uniform(random));
    Vec3d v;
    // No grazing, and no way back that meets the box again.
    do v = {3 * uniform(random), 3 * uniform(random), 3 * uniform(random)};
    while (dot(v, n) > -0.5 * norm(v) || norm(v) < 0.5);
    expect_mirrored(with_box, at + point + r * n, n, v, r, "box");
    expect_mirrored(with_mesh, at + point + r * n, n, v, r, "mesh");
  }
}

TEST(VariationalImpacts, RoundWallsReflectAboutTheirNormals) {
  std::mt19937 random(8);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 100; ++trial) {
    const Vec3d u = normalized(Vec3d{normal(random), normal(random), normal(random)});
    const double r = 0.2;
    Vec3d v;
    do v = {normal(random), normal(random), normal(random)};
    while (dot(v, u) > -0.6 * norm(v) || norm(v) < 0.5);
    BodyDescription wall;
    wall.kind = BodyKind::fixed;
    wall.position = {0.1, 0.2, 0.3};
    Scene scene = variational_scene(0.1);

    wall.shape.kind = shapes::Sphere::kind;
    wall.shape.radius = 0.4;
    scene.bodies = {wall};
    expect_mirrored(scene, wall.position + 0.6 * u, u, v, r, "sphere");

    wall.shape = {};
    wall.shape.kind = shapes::Capsule::kind;
    wall.shape.half_extents = {0.3, 0.3, 0.8};
    scene.bodies = {wall};
    const Vec3d on_axis{0, 0, 0.5 * u.y};
    const Vec3d side = std::abs(u.y) < 1 ? normalized(Vec3d{u.x, u.y, 0}) : u;
    if (dot(v, side) < -0.4 * norm(v))
      expect_mirrored(scene, wall.position + on_axis + 0.5 * side, side, v, r, "capsule");

    wall.shape.kind = shapes::Ellipsoid::kind;
    wall.shape.half_extents = {0.4, 0.6, 0.9};
    scene.bodies = {wall};
    const Vec3d e = wall.shape.half_extents;
    // The point whose normal is u.
    const Vec3d scaled = hadamard(e, u);
    const Vec3d point = hadamard(e, (1 / norm(scaled)) * scaled);
    expect_mirrored(scene, wall.position + point + r * u, u, v, r, "ellipsoid");
  }
}

/// In the corner of a container all three walls are met at once: the velocity turns back.
TEST(VariationalImpacts, B07_TheCornerOfAContainerTurnsVelocitiesBack) {
  Scene scene = variational_scene(0.5);
  BodyDescription room;
  room.kind = BodyKind::fixed;
  room.shape.kind = shapes::Container::kind;
  room.shape.half_extents = {0.5, 0.5, 0.5};
  scene.bodies = {room};
  const Vec3d corner{0.375, 0.375, 0.375}, v{1, 0.75, 0.5};
  add_sphere(scene, corner - 0.25 * v, 0.125, 1).velocity = v;
  World world(scene, cpu_options());
  const StepReport report = world.step();
  const BodyStates after = world.states();
  EXPECT_EQ(report.own[impacts], 1) << "one, with the normal cone of three walls";
  EXPECT_LT(norm(after.velocity[1] + v), 1e-15);
  EXPECT_LT(norm(after.position[1] - corner + 0.25 * v), 1e-15);
}

/// Two triangles that meet in a valley: both are met at once, at the bottom of a blunt one and of a sharp one.
TEST(VariationalImpacts, ValleysAreMetByTheirNormalCones) {
  Scene scene = variational_scene(0.25);
  TriangleMesh valley;
  valley.closed = false;
  valley.name = "valley";
  valley.vertices = {{-3, -3, 3}, {-3, 3, 3}, {0, -3, 0}, {0, 3, 0}, {3, -3, 3}, {3, 3, 3}};
  valley.triangles = {{0, 2, 3}, {0, 3, 1}, {2, 4, 5}, {2, 5, 3}};
  physics::add_mesh(scene, valley);
  const double r = 0.25, bottom = r * std::sqrt(2.0);
  for (const Vec3d& v : {Vec3d{0, 0, -2}, Vec3d{0.5, 0.25, -2}, Vec3d{-0.5, 1, -1}}) {
    Scene shot = scene;
    add_sphere(shot, Vec3d{0, 0.1, bottom} - 0.125 * v, r, 1).velocity = v;
    World world(shot, cpu_options());
    world.step();
    // Both sides are at a right angle, so x and z turn round.
    EXPECT_LT(norm(world.states().velocity[1] - Vec3d{-v.x, v.y, -v.z}), 1e-13);
  }
}

/// Reflections in a room of planes unfold to straight lines.
TEST(VariationalImpacts, BilliardsInABoxUnfold) {
  Scene scene = variational_scene(0.7);
  BodyDescription room;
  room.kind = BodyKind::fixed;
  room.shape.kind = shapes::Container::kind;
  room.shape.half_extents = {0.5, 0.75, 1};
  scene.bodies = {room};
  const Vec3d x{0.1, 0.2, -0.3}, v{1.3, -0.9, 0.7};
  const double r = 0.1;
  add_sphere(scene, x, r, 1).velocity = v;
  World world(scene, cpu_options());
  double hits = 0;
  for (int k = 0; k < 1000; ++k) hits += world.step().own[impacts];
  const Vec3d end = world.states().position[1];
  double expected_hits = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double half = room.shape.half_extents[axis] - r, way = x[axis] + 700 * v[axis];
    const double cells = std::floor((way + half) / (2 * half));
    double inside = way - cells * 2 * half;
    if (std::fmod(std::abs(cells), 2) == 1) inside = -inside;
    EXPECT_NEAR(end[axis], inside, 1e-9);
    expected_hits += std::abs(cells);
  }
  EXPECT_EQ(hits, expected_hits);
  EXPECT_NEAR(norm(world.states().velocity[1]), norm(v), 1e-13);
}

/// A ball that falls past a ledge fast enough to pass it within a step does not.
TEST(VariationalImpacts, NothingIsPassedWithinAStep) {
  Scene scene = variational_scene(0.5);
  scene.gravity = {0, 0, -g};
  physics::add_wall_box(scene, {0, 0, 0}, {1, 1, 0.005});
  add_sphere(scene, {0.2, 0.1, 2}, 0.1, 1).velocity = {0, 0, -100};
  World world(scene, cpu_options());
  const StepReport report = world.step();
  EXPECT_EQ(report.own[impacts], 1);
  EXPECT_GT(world.states().position[1].z, 0.1);
}

}  // namespace
}  // namespace scree::test
