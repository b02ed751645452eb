// Convex bodies that turn and collide by the variational model: energy and momenta, the rod of case B08, corners on faces,
// many bodies, every shape.

#include "tests/dynamics/variational_bodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/error.h"
#include "host/state_hash.h"
#include "tests/box_separation.h"

namespace scree::test {
namespace {

struct Course {
  double largest_error = 0;  ///< of the energy, over that at the start
  double hits = 0, grazing = 0;
  double penetration = 0;
  StepReport last;
};
Course follow(World& world, int steps, double shift = 0) {
  Course c;
  double first = 0;
  for (int k = 0; k < steps; ++k) {
    c.last = world.step();
    if (k == 0) first = c.last.own[energy] - shift;
    c.largest_error = std::max(c.largest_error, std::abs((c.last.own[energy] - shift) / first - 1));
    c.hits += c.last.own[impacts];
    c.grazing += c.last.own[grazing];
    c.penetration = std::max(c.penetration, c.last.max_penetration);
  }
  return c;
}

/// A box that tumbles in a room.
Scene tumbling(double h, const Vec3d& gravity) {
  Scene scene = variational_scene(h);
  scene.gravity = gravity;
  add_room(scene, 0.5);
  BodyDescription& body = physics::add_box(scene, {}, {0.1, 0.05, 0.03}, 1);
  body.velocity = {0.7, 0.5, 0.3};
  body.angular_velocity = {3, 4, 5};
  return scene;
}

TEST(VariationalBodies, ABoxThatTumblesInARoomKeepsItsEnergyToRounding) {
  World world(tumbling(0.005, {}), cpu_options());
  const Course c = follow(world, 8000);
  EXPECT_GT(c.hits, 60);
  EXPECT_LT(c.largest_error, 1e-11);
  EXPECT_EQ(c.grazing, 0);
  EXPECT_EQ(c.penetration, 0);
}

TEST(VariationalBodies, BetweenHitsAllMomentaStay) {
  World world(tumbling(0.005, {}), cpu_options());
  StepReport before = world.step();
  int free_steps = 0;
  for (int k = 0; k < 2000; ++k) {
    const StepReport after = world.step();
    if (after.own[impacts] == 0) {
      EXPECT_EQ(momentum(after), momentum(before));
      EXPECT_LT(norm(angular_momentum(after) - angular_momentum(before)), 1e-15);
      ++free_steps;
    }
    before = after;
  }
  EXPECT_GT(free_steps, 1000);
}

TEST(VariationalBodies, UnderGravityTheEnergyOfATumblingBoxIsBounded) {
  // The gates of B04: G = 4 (m g^2 h^2 / 8 E) sqrt(hits / 3), and less with smaller steps.
  double mean[2] = {};
  for (int start = 0; start < 3; ++start) {
    for (int fine = 0; fine < 2; ++fine) {
      const double h = fine == 0 ? 0.004 : 0.002;
      Scene scene = tumbling(h, {0, 0, -g});
      scene.bodies[1].velocity.x += 0.1 * start;
      World world(scene, cpu_options());
      const double shift = -g * 0.5;  // that of the floor
      const Course c = follow(world, fine == 0 ? 5000 : 10000, shift);
      const double e = c.last.own[energy] - shift;
      EXPECT_GT(c.hits, 60);
      EXPECT_LT(c.largest_error, 1.5 * 4 * (g * g * h * h / 8 / e) * std::sqrt(c.hits / 3));
      EXPECT_LE(c.grazing, 2);
      EXPECT_EQ(c.penetration, 0);
      mean[fine] += c.largest_error;
    }
  }
  EXPECT_GT(mean[0] / mean[1], 2);
}

/// A rod of length and mass 1 above a floor, in the plane of x and z: all in that plane is symmetric.
Scene rod(double h) {
  Scene scene = variational_scene(h);
  scene.gravity = {0, 0, -g};
  physics::add_plane(scene);
  BodyDescription& body = add_solid(scene, shapes::Capsule::kind, {0, 0, 1.5}, {1e-4, 1e-4, 0.5});
  body.mass = 1;
  body.inertia = {1.0 / 12, 1.0 / 12, 1e-3};
  body.orientation = exp_map(Vec3d{0, physics::kPi / 2 - 0.3, 0});
  body.velocity = {0.2, 0, 0};
  body.angular_velocity = {0, -0.1, 0};
  return scene;
}

void expect_b08(int steps, const double (&reference)[3]) {
  double worst[3];
  for (int k = 0; k < 3; ++k) {
    const double h = 0.01 / (1 << k);
    World world(rod(h), cpu_options());
    const Course c = follow(world, steps);
    worst[k] = c.largest_error;
    const double gate = 4 * (g * g * h * h / 8 / (1.5 * g)) * std::sqrt(c.hits / 3);
    EXPECT_LT(c.largest_error, 1.5 * gate) << h;
    EXPECT_LT(c.largest_error, 5 * reference[k]) << h;
    EXPECT_NEAR(c.last.own[px], 0.2, 1e-13);
    EXPECT_EQ(c.last.own[py], 0);
    EXPECT_LT(std::abs(c.last.own[lx]) + std::abs(c.last.own[lz]), 1e-6) << "it stays in its plane";
    EXPECT_LE(c.grazing, 1e-3 * c.hits + 1);
    EXPECT_EQ(c.penetration, 0);
  }
  EXPECT_GT(worst[0] / worst[2], 4);
}
TEST(VariationalBodies, B08_ARodOnAFloor) { expect_b08(20000, {1.7e-3, 1.8e-4, 2.9e-5}); }
TEST(VariationalBodies, B08_ARodOnAFloorForAMillionSteps) {
  expect_b08(1000000, {6.0e-3, 1.4e-3, 1.7e-4});
}

TEST(VariationalBodies, ACornerOnAFaceKeepsAllMomenta) {
  std::mt19937 random(1);
  int hits = 0;
  for (int trial = 0; trial < 40; ++trial) {
    Scene scene = variational_scene(0.01);
    physics::add_box(scene, {}, {0.3, 0.3, 0.1}, 2).angular_velocity = 0.3 * normal_vector(random);
    // A corner ahead.
    BodyDescription& body = physics::add_box(scene, {0.1, 0.05, 0.6}, {0.1, 0.15, 0.2}, 1);
    body.orientation =
        exp_map(0.6 * normalized(Vec3d{1, -1, 0.2})) * exp_map(0.1 * normal_vector(random));
    body.velocity = {0.1, 0, -2};
    body.angular_velocity = normal_vector(random);
    World world(scene, cpu_options());
    const StepReport first = world.step();
    StepReport last = first;
    for (int k = 0; k < 60; ++k) {
      last = world.step();
      hits += static_cast<int>(last.own[impacts]);
    }
    EXPECT_NEAR(last.own[energy], first.own[energy], 1e-13 * first.own[energy]) << trial;
    EXPECT_LT(norm(momentum(last) - momentum(first)), 1e-14) << trial;
    EXPECT_LT(norm(angular_momentum(last) - angular_momentum(first)), 1e-14) << trial;
  }
  EXPECT_GT(hits, 40);
}

TEST(VariationalBodies, AFlatBoxBouncesOnAllFourCornersAsABallDoes) {
  // Drops from 1 m: after n bounces with restitution e it rises to e^(2 n).
  const double e = 0.9, h = 1e-3;
  Scene scene = variational_scene(h, e);
  scene.gravity = {0, 0, -g};
  physics::add_plane(scene);
  physics::add_box(scene, {0, 0, 1.1}, {0.2, 0.3, 0.1}, 1);
  World world(scene, cpu_options());
  std::vector<double> tops;
  double last = 2, before = 2;
  for (int k = 0; k < 3000; ++k) {
    world.step();
    const BodyStates s = world.states();
    const double z = s.position[1].z - 0.1;
    if (k > 1 && last > before && last >= z) tops.push_back(last);
    before = last, last = z;
    EXPECT_LT(norm(s.angular_velocity[1]), 1e-9);
  }
  ASSERT_GE(tops.size(), 3u);
  for (int n = 0; n < 3; ++n) EXPECT_NEAR(tops[n], std::pow(e, 2 * n + 2), 1e-4) << n;
}

TEST(VariationalBodies, ManyBoxesInARoomNeverOverlap) {
  const Vec3d half{0.05, 0.04, 0.03};
  Scene scene = variational_scene(0.005);
  const double room = 0.55;
  add_room(scene, room);
  std::mt19937 random(2);
  for (int k = 0; k < 125; ++k) {
    const Vec3d site(k % 5 - 2, k / 5 % 5 - 2, k / 25 - 2);
    BodyDescription& body = physics::add_box(scene, 0.2 * site, half, 1);
    body.orientation = random_turn(random);
    body.velocity = 0.5 * normal_vector(random);
    body.angular_velocity = 4.0 * normal_vector(random);
  }
  World world(scene, cpu_options());
  Course c;
  for (int round = 0; round < 100; ++round) {
    const Course part = follow(world, 10);
    c.hits += part.hits;
    c.largest_error = std::max(c.largest_error, part.largest_error);
    const BodyStates s = world.states();
    for (std::size_t i = 1; i < s.position.size(); ++i) {
      double reach[3] = {};
      for (int axis = 0; axis < 3; ++axis) {
        Vec3d unit;
        unit[axis] = 1;
        const Vec3d n = rotate_back(s.orientation[i], unit);
        for (int k = 0; k < 3; ++k) reach[axis] += half[k] * std::abs(n[k]);
        ASSERT_LT(std::abs(s.position[i][axis]) + reach[axis], room) << round << " body " << i;
      }
      for (std::size_t j = i + 1; j < s.position.size(); ++j) {
        if (norm(s.position[j] - s.position[i]) > 2 * norm(half)) continue;
        ASSERT_GT(box_separation(half, s.orientation[i], half, s.orientation[j],
                                 s.position[j] - s.position[i]),
                  0)
            << round << ": " << i << " and " << j;
      }
    }
  }
  EXPECT_GT(c.hits, 1500);
  EXPECT_LT(c.largest_error, 1e-12);
}

TEST(VariationalBodies, BodiesOfEveryShapeInAPeriodicBoxKeepMomentumAndEnergy) {
  constexpr double kCell = 0.15;
  Scene scene = every_shape(0.004, 4, kCell, 3);
  scene.periodicity.periodic = {true, true, true};
  scene.periodicity.upper = {4 * kCell, 4 * kCell, 4 * kCell};
  World world(scene, cpu_options());
  const StepReport first = world.step();
  const Course c = follow(world, 700);
  EXPECT_GT(c.hits, 400);
  EXPECT_LT(c.largest_error, 1e-11);
  EXPECT_LT(c.grazing, 0.01 * c.hits);
  EXPECT_LT(norm(momentum(c.last) - momentum(first)), 1e-12);
  EXPECT_EQ(c.penetration, 0);
}

TEST(VariationalBodies, B09_AStarInABox) {
  // In its plane and out of it, without gravity and with it.
  for (const Vec3d& rate : {Vec3d{0, 3, 0}, Vec3d{2, 3, 1}}) {
    for (const double gravity : {0.0, g}) {
      Scene scene = variational_scene(0.002);
      scene.gravity = {0, 0, -gravity};
      add_room(scene, 0.5);
      BodyDescription& star = add_star(scene, {0.05, 0, 0}, 0.2);
      star.velocity = {0.9, 0, 0.4};
      star.angular_velocity = rate;
      World world(scene, cpu_options());
      const double shift = -star.mass * gravity * 0.5;
      double hits = 0, first = 0, error = 0;
      StepReport before = world.step();
      first = before.own[energy] - shift;
      for (int k = 0; k < 15000; ++k) {
        const StepReport after = world.step();
        error = std::max(error, std::abs((after.own[energy] - shift) / first - 1));
        hits += after.own[impacts];
        EXPECT_EQ(after.max_penetration, 0);
        if (after.own[impacts] == 0 && gravity == 0) {
          EXPECT_EQ(momentum(after), momentum(before));
        }
        before = after;
      }
      EXPECT_GT(hits, 50);
      EXPECT_LT(error, gravity == 0 ? 1e-10 : 3e-3);
    }
  }
}

/// The arms of one star reach between those of the other, and neither is passed.
TEST(VariationalBodies, StarsLockAndLeaveWithTheirMomenta) {
  Scene scene = variational_scene(0.005);
  add_star(scene, {0, 0, 0}, 0.2).angular_velocity = {0, 4, 0};
  BodyDescription& other = add_star(scene, {0.45, 0.01, 0.02}, 0.2);
  other.angular_velocity = {0.1, -3, 0.2};
  other.velocity = {-0.5, 0, 0};
  World world(scene, cpu_options());
  const StepReport first = world.step();
  const Course c = follow(world, 300);
  EXPECT_GE(c.hits, 1);
  EXPECT_EQ(c.penetration, 0);
  EXPECT_LT(c.largest_error, 1e-12);
  EXPECT_LT(norm(momentum(c.last) - momentum(first)), 1e-13);
  EXPECT_LT(norm(angular_momentum(c.last) - angular_momentum(first)), 1e-13);
}

/// A box made of smaller ones, so many along each axis, with the mass and the place of a box.
void add_box_of_boxes(Scene& scene, const BodyDescription& box, const std::array<int, 3>& count) {
  Vec3d half;
  for (int k = 0; k < 3; ++k) half[k] = box.shape.half_extents[k] / count[k];
  BodyDescription body;
  body.position = box.position;
  std::vector<ShapePart> parts;
  for (int z = 0; z < count[2]; ++z)
    for (int y = 0; y < count[1]; ++y)
      for (int x = 0; x < count[0]; ++x)
        parts.push_back(
            part(box_of(half), {half.x * (2 * x + 1 - count[0]), half.y * (2 * y + 1 - count[1]),
                                half.z * (2 * z + 1 - count[2])}));
  set_compound(scene, body, std::move(parts), SharedMass::once);
  body.mass = box.mass;
  body.inertia = box.inertia;
  scene.bodies.push_back(body);
}

TEST(VariationalBodies, ABoxOfEightBoxesMovesAsOneOfOne) {
  Scene one = variational_scene(0.005);
  add_room(one, 0.5);
  Scene eight = one;
  const Vec3d half{0.1, 0.05, 0.03};
  physics::add_box(one, {}, half, 1);
  add_box_of_boxes(eight, one.bodies[1], {2, 2, 2});
  for (Scene* scene : {&one, &eight}) {
    scene->bodies[1].velocity = {0.7, 0.5, 0.3};
    scene->bodies[1].angular_velocity = {3, 4, 5};
  }
  World a(one, cpu_options()), b(eight, cpu_options());
  double hits = 0;
  for (int k = 0; k < 250; ++k) {
    const StepReport first = a.step(), second = b.step();
    hits += first.own[impacts];
    ASSERT_EQ(first.own[impacts], second.own[impacts]) << k;
  }
  EXPECT_GE(hits, 2);
  EXPECT_LT(norm(a.states().position[1] - b.states().position[1]), 1e-5);
}

/// It lands on 36 corners at once, of which eight are kept: those that let it bounce as it fell. The first eight lie on one side.
TEST(VariationalBodies, ABoxOfNineBoxesThatLandsFlatDoesNotTurn) {
  Scene one = variational_scene(1e-3), nine;
  one.gravity = {0, 0, -g};
  physics::add_plane(one);
  nine = one;
  physics::add_box(one, {0, 0, 0.3}, {0.2, 0.3, 0.1}, 1);
  add_box_of_boxes(nine, one.bodies[1], {3, 3, 1});
  World a(one, cpu_options()), b(nine, cpu_options());
  double hits = 0;
  for (int k = 0; k < 1500; ++k) {
    hits += a.step().own[impacts];
    b.step();
    ASSERT_LT(norm(b.states().angular_velocity[1]), 1e-8) << k;
    ASSERT_LT(norm(b.states().position[1] - a.states().position[1]), 1e-6) << k;
  }
  EXPECT_GT(hits, 2);
}

TEST(VariationalBodies, ADenseGasOfBoxesGoesOn) {
  // Edges that cross after an impact, corners in corners: nothing comes to rest without a force.
  constexpr double kCell = 0.15;
  Scene scene = variational_scene(0.004);
  scene.periodicity.periodic = {true, true, true};
  scene.periodicity.upper = {6 * kCell, 6 * kCell, 6 * kCell};
  std::mt19937 random(6);
  for (int k = 0; k < 216; ++k) {
    const Vec3d site(k % 6 + 0.5, k / 6 % 6 + 0.5, k / 36 + 0.5);
    BodyDescription& body = physics::add_box(scene, kCell * site, {0.045, 0.04, 0.03}, 1);
    body.velocity = 0.5 * normal_vector(random);
    body.angular_velocity = 5.0 * normal_vector(random);
  }
  World world(scene, cpu_options());
  const StepReport first = world.step();
  const Course c = follow(world, 120);
  EXPECT_GT(c.hits, 1000);
  EXPECT_LT(c.grazing, 1e-3 * c.hits);
  EXPECT_EQ(c.penetration, 0);
  EXPECT_LT(c.largest_error, 1e-12);
  EXPECT_LT(norm(momentum(c.last) - momentum(first)), 1e-12);
}

TEST(VariationalBodies, SpheresAmongOthersMoveAsSpheresAlone) {
  // Two spheres by the programs of spheres, and by those of convex bodies since a box is far away.
  Scene alone = variational_scene(0.01);
  add_sphere(alone, {0, 0, 0}, 0.2, 1).velocity = {1, 0.1, 0};
  add_sphere(alone, {1, 0.1, 0.05}, 0.3, 2).velocity = {-1, 0, 0};
  Scene mixed = alone;
  physics::add_box(mixed, {50, 0, 0}, {0.1, 0.2, 0.3}, 1);
  World a(alone, cpu_options()), b(mixed, cpu_options());
  double hits = 0;
  for (int k = 0; k < 100; ++k) {
    const StepReport first = a.step(), second = b.step();
    hits += first.own[impacts];
    EXPECT_EQ(first.own[impacts], second.own[impacts]);
  }
  EXPECT_EQ(hits, 1);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_LT(norm(a.states().position[i] - b.states().position[i]), 1e-6);
    EXPECT_LT(norm(a.states().velocity[i] - b.states().velocity[i]), 1e-6);
  }
}

TEST(VariationalBodies, WallsOfOtherShapesAreNotEntered) {
  Scene scene = variational_scene(0.002);
  scene.gravity = {0, 0, -g};
  add_room(scene, 0.5);
  physics::add_wall_box(scene, {0.05, 0, -0.4}, {0.1, 0.15, 0.1}).orientation =
      exp_map(Vec3d{0.3, 0.4, 0.5});
  physics::add_valley(scene).position = {0, 0, -0.2};
  for (int k = 0; k < 3; ++k) {
    BodyDescription& body =
        physics::add_box(scene, {-0.1 + 0.1 * k, 0.02, 0.1 + 0.1 * k}, {0.04, 0.03, 0.02}, 1);
    body.velocity = {0.2, 0.1 * k, 0};
    body.angular_velocity = {1, 2, 3.0 * k};
  }
  World world(scene, cpu_options());
  const Course c = follow(world, 3000, -3 * g * 0.5);
  EXPECT_GT(c.hits, 60);
  EXPECT_LT(c.largest_error, 5e-3);
  EXPECT_EQ(c.penetration, 0);
  for (std::size_t i = 3; i < 6; ++i) {
    const Vec3d x = world.states().position[i];
    EXPECT_LT(std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)}), 0.5);
  }
}

TEST(VariationalBodies, AllShapesAmongAllWalls) {
  const Scene scene = bodies_among_walls();
  double shift = 0;
  for (const BodyDescription& body : scene.bodies)
    if (body.kind == BodyKind::free) shift -= body.mass * 0.45;
  World world(scene, cpu_options());
  const Course c = follow(world, 400, shift);
  EXPECT_GT(c.hits, 200);
  EXPECT_LT(c.largest_error, 1e-4);
  EXPECT_EQ(c.penetration, 0);
}

TEST(VariationalBodies, ARestingBoxIsRefusedByName) {
  Scene scene = variational_scene(0.005, 0.3);
  scene.gravity = {0, 0, -g};
  physics::add_plane(scene);
  physics::add_box(scene, {0, 0, 0.3}, {0.1, 0.1, 0.1}, 1);
  World world(scene, cpu_options());
  try {
    follow(world, 2000);
    FAIL() << "it cannot bounce for ever";
  } catch (const RunError& error) {
    EXPECT_NE(std::string(error.what()).find("body 1"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("rest"), std::string::npos) << error.what();
  }
}

TEST(VariationalBodies, SpinsThatNoStepResolvesEndTheRun) {
  // Forty turns a step are solved, and keep the energy; more than that is told.
  Scene scene = variational_scene(0.005);
  physics::add_box(scene, {}, {0.1, 0.2, 0.3}, 1).angular_velocity = {3e4, 2e4, 1e4};
  World world(scene, cpu_options());
  EXPECT_LT(follow(world, 20).largest_error, 1e-9);
  scene.bodies[0].angular_velocity = {1e6, 1e6, 0};
  World faster(scene, cpu_options());
  try {
    faster.step();
    FAIL();
  } catch (const RunError& error) {
    EXPECT_NE(std::string(error.what()).find("body 0 turns by"), std::string::npos) << error.what();
  }
}

TEST(VariationalBodies, BodiesThatOverlapAtTheStartAreRefused) {
  Scene scene = variational_scene(0.005);
  physics::add_box(scene, {}, {0.1, 0.1, 0.1}, 1);
  physics::add_box(scene, {0.19, 0, 0}, {0.1, 0.1, 0.1}, 1);
  try {
    World world(scene, cpu_options());
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("overlaps"), std::string::npos) << error.what();
  }
  scene.bodies[1].position.x = 0.2;
  World world(scene, cpu_options());  // touching is apart
  world.step();
}

TEST(VariationalBodies, ARunGoesOnFromACheckpointWithTheSameBits) {
  constexpr double kCell = 0.15;
  Scene scene = every_shape(0.004, 3, kCell, 4);
  scene.periodicity.periodic = {true, true, true};
  scene.periodicity.upper = {3 * kCell, 3 * kCell, 3 * kCell};
  World one(scene, cpu_options());
  follow(one, 130);
  const WorldState saved = one.save();
  World other(scene, cpu_options());
  other.restore(saved);
  const Course a = follow(one, 130), b = follow(other, 130);
  EXPECT_GT(a.hits, 20);
  EXPECT_EQ(a.hits, b.hits);
  EXPECT_EQ(state_hash(one.states()), state_hash(other.states()));
}

TEST(VariationalBodies, ThreadsDoNotChangeABit) {
  constexpr double kCell = 0.15;
  Scene scene = every_shape(0.004, 4, kCell, 5);
  scene.periodicity.periodic = {true, true, true};
  scene.periodicity.upper = {4 * kCell, 4 * kCell, 4 * kCell};
  World one(scene, cpu_options(1)), two(scene, cpu_options(2));
  const Course c = follow(one, 150);
  follow(two, 150);
  EXPECT_GT(c.hits, 50);
  EXPECT_EQ(state_hash(one.states()), state_hash(two.states()));
}

}  // namespace
}  // namespace scree::test
