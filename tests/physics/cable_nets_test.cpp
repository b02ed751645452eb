// Chains and nets of cables: those that are taut hold like rods and are solved with these all at once, those that are slack do
// nothing, and steps need no iterations while nothing else acts.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/physics/joint_scenes.h"

namespace scree::physics {
namespace {

/// Distance, radius and mass of knots. They are too small to meet in what follows.
constexpr double kNetSpacing = 0.1, kKnotRadius = 0.0005, kKnotMass = 0.02;
enum class Held { corners, rim };

/// Knots in a plane square of z = 0, lines between neighbors. Solved to `quality`, as scenes are by default.
/// @param slack  of cables, their length over the distance of their knots
Scene net_of(JointKind kind, int knots, Held held, double slack = 1) {
  Scene scene = empty_scene(1e-3, 0);
  scene.solver = SolverSettings{};
  const auto id = [&](int i, int j) { return i * knots + j; };
  const auto at = [](int i, int j) { return Vec3d{i * kNetSpacing, j * kNetSpacing, 0}; };
  const auto add_line = [&](int i, int j, int k, int m) {
    Joint line = line_of(kind, id(k, m), id(i, j), at(k, m), at(i, j));
    if (slack > 1) line.length = slack * kNetSpacing;
    if (kind == JointKind::spring) line.stiffness = 2e5, line.damping = 0.2;
    scene.joints.push_back(line);
  };
  for (int i = 0; i < knots; ++i)
    for (int j = 0; j < knots; ++j) {
      add_sphere(scene, at(i, j), kKnotRadius, kKnotMass);
      if (i > 0) add_line(i, j, i - 1, j);
      if (j > 0) add_line(i, j, i, j - 1);
      const int ends = (i == 0 || i == knots - 1 ? 1 : 0) + (j == 0 || j == knots - 1 ? 1 : 0);
      if (ends > (held == Held::corners ? 1 : 0))
        scene.joints.push_back(joint_of(JointKind::ball, kWorldBody, id(i, j), at(i, j)));
    }
  return scene;
}

std::size_t middle_of(int knots) { return static_cast<std::size_t>((knots / 2) * (knots + 1)); }

/// What a run of a net came to.
struct NetRun {
  int iterations = 0, unconverged = 0;
  double joint_error = 0;  ///< largest [m]
  double gained = 0;       ///< most energy beyond that of the start [J]
};

NetRun run_net(World& world, const Scene& scene, int steps) {
  NetRun run;
  EnergyOfSteps energy(world, scene);
  for (int k = 0; k < steps; ++k) {
    const StepReport report = world.step();
    run.iterations += report.iterations;
    run.unconverged += report.converged ? 0 : 1;
    run.joint_error = std::max(run.joint_error, report.max_joint_error);
    run.gained = std::max(run.gained, energy.of_step(world) - energy.start());
  }
  return run;
}

/// Drag brings all to rest.
void bring_to_rest(World& world, const Scene& scene, int steps) {
  for (int k = 0; k < steps; ++k) {
    const BodyStates s = world.states();
    for (std::size_t i = 0; i < scene.bodies.size(); ++i)
      world.apply_force(static_cast<int>(i), (-5 * scene.bodies[i].mass) * s.velocity[i], {});
    ASSERT_TRUE(world.step().converged) << k;
  }
}

// Flat, with a weight of 1 kg at its middle: all cables lie in straight lines, where nothing holds the weight at first.
TEST(CableNets, AFlatNetUnderAWeightNeedsNoIterations) {
  Scene scene = net_of(JointKind::cable, 16, Held::corners);
  add_sphere(scene, {0.75, 0.75, -0.3}, 0.05, 1);
  scene.joints.push_back(
      line_of(JointKind::cable, 7 * 16 + 7, 256, {0.7, 0.7, 0}, {0.75, 0.75, -0.25}));
  World world = reference_world(scene);
  const NetRun run = run_net(world, scene, 200);
  EXPECT_EQ(run.unconverged, 0);
  EXPECT_LE(run.iterations, 2 * 200);
  EXPECT_LT(run.joint_error, 1e-3);
  // What takes the ends of taut cables back to where they belong must not throw the knots about.
  EXPECT_LT(run.gained, 1);  // a net of rods gains 0.5 J, and the weight falls by 4 J
  EXPECT_LT(world.states().position[256].z, -0.4);
}

/// Lines that hang side by side between two beams, with lines across; they start on an arc.
Scene hammock(JointKind kind) {
  constexpr int kAlong = 16, kAcross = 6;
  constexpr double kHalfAngle = 1, kArc = 0.75;
  Scene scene = empty_scene(1e-3, 0);
  scene.solver = SolverSettings{};
  const auto at = [](int i, int j) {
    const double turn = kHalfAngle * (2.0 * i / (kAlong - 1) - 1);
    return Vec3d{kArc * std::sin(turn), j * kNetSpacing, -kArc * std::cos(turn)};
  };
  const auto id = [](int i, int j) { return i * kAcross + j; };
  for (int i = 0; i < kAlong; ++i)
    for (int j = 0; j < kAcross; ++j) {
      add_sphere(scene, at(i, j), kKnotRadius, kKnotMass);
      if (i > 0)
        scene.joints.push_back(line_of(kind, id(i - 1, j), id(i, j), at(i - 1, j), at(i, j)));
      if (j > 0)
        scene.joints.push_back(line_of(kind, id(i, j - 1), id(i, j), at(i, j - 1), at(i, j)));
      if (i == 0 || i == kAlong - 1)
        scene.joints.push_back(joint_of(JointKind::ball, kWorldBody, id(i, j), at(i, j)));
    }
  return scene;
}

TEST(CableNets, AHammockOfCablesHangsAsOneOfRodsDoes) {
  const Scene scene = hammock(JointKind::cable);
  World cables = reference_world(scene), rods = reference_world(hammock(JointKind::distance));
  bring_to_rest(cables, scene, 3000);
  bring_to_rest(rods, scene, 3000);
  const BodyStates a = cables.states(), b = rods.states();
  double sag = 0, apart = 0;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    EXPECT_LT(norm(a.velocity[i]), 1e-4);
    sag = std::max(sag, -a.position[i].z);
    apart = std::max(apart, norm(a.position[i] - b.position[i]));
  }
  EXPECT_GT(sag, 0.755);  // the arc is at 0.75
  EXPECT_LT(apart, 1e-4);
}

// Between hooks 1 m apart a chain of 1.2 m has the form y = a cosh(x / a) with 2 a sinh(1 / 2 a) = 1.2 m.
TEST(CableNets, AChainOfCablesIsACatenary) {
  constexpr int kLinks = 60;
  constexpr double kSag = 0.292344, kLength = 1.2, kParameter = 0.469542;
  Scene scene = empty_scene(1e-3, 0);
  scene.solver = SolverSettings{};
  const auto at = [](int k) { return Vec3d{-0.5 + 1.0 * k / kLinks, 0, 0}; };
  for (int k = 1; k < kLinks; ++k) add_sphere(scene, at(k), kKnotRadius, kKnotMass);
  for (int k = 0; k < kLinks; ++k) {
    const int a = k == 0 ? kWorldBody : k - 1, b = k + 1 == kLinks ? kWorldBody : k;
    Joint cable = line_of(JointKind::cable, a, b, at(k), at(k + 1));
    cable.length = kLength / kLinks;
    scene.joints.push_back(cable);
  }
  World world = reference_world(scene);
  // It falls as it is, and cables become taut from the hooks on, until knots of the middle meet.
  const NetRun run = run_net(world, scene, 320);
  EXPECT_EQ(run.unconverged, 0);
  EXPECT_EQ(run.iterations, 0);
  EXPECT_LT(run.joint_error, 1e-5);
  EXPECT_LT(run.gained, 1e-3);
  bring_to_rest(world, scene, 4000);
  const BodyStates s = world.states();
  double lowest = 0;
  for (const Vec3d& x : s.position) lowest = std::min(lowest, x.z);
  EXPECT_NEAR(-lowest, kSag, 0.02 * kSag);
  const Vec3d pull = 1e3 * world.joints()[0].force;
  const double weight = (kLinks - 1) * kKnotMass * kGravity;
  EXPECT_NEAR(std::abs(pull.z), weight / 2, 0.01 * weight);
  const double along = weight / kLength * kParameter;
  EXPECT_NEAR(std::abs(pull.x), along, 0.03 * along);
}

// Slack at first: knots fly freely until cables are taut, which takes energy and gives none.
TEST(CableNets, ANetThatIsThrownUpFallsUntilItIsTaut) {
  constexpr int kKnots = 16;
  Scene scene = net_of(JointKind::cable, kKnots, Held::corners, 1.1);
  for (BodyDescription& knot : scene.bodies) knot.velocity = {0, 0, 1};
  World world = reference_world(scene);
  const NetRun flight = run_net(world, scene, 40);
  EXPECT_EQ(flight.iterations, 0);
  const double free = 0.04 - 0.5 * kGravity * 0.04 * 0.041;
  EXPECT_NEAR(world.states().position[middle_of(kKnots)].z, free, 1e-9);
  int within = 0;
  for (const JointRecord& joint : world.joints()) {
    if (joint.body_a == kWorldBody || joint.body_b == kWorldBody || joint.body_a <= 2 * kKnots ||
        joint.body_b >= kKnots * (kKnots - 2))
      continue;
    ++within;
    EXPECT_EQ(norm(joint.force), 0);
  }
  EXPECT_GT(within, kKnots);
  const NetRun run = run_net(world, scene, 600);
  EXPECT_EQ(run.unconverged, 0);
  EXPECT_LE(run.iterations, 600);
  EXPECT_LT(run.joint_error, 1e-5);
  EXPECT_LT(run.gained, 1e-2);
  EXPECT_LT(world.states().position[middle_of(kKnots)].z, -0.1);
}

TEST(CableNets, ABallIsCaughtAndHeld) {
  constexpr int kKnots = 12;
  constexpr int kBall = kKnots * kKnots;
  Scene scene = net_of(JointKind::cable, kKnots, Held::rim, 1.02);
  add_sphere(scene, {0.55, 0.55, 0.2}, 0.15, 1).velocity = {0, 0, -3};
  World world = reference_world(scene);
  const NetRun run = run_net(world, scene, 400);
  EXPECT_EQ(run.unconverged, 0);
  EXPECT_LE(run.iterations, 30 * 400);
  EXPECT_LT(run.joint_error, 1e-3);
  EXPECT_LT(run.gained, 0.05);
  bring_to_rest(world, scene, 2500);
  // It lies in the net, which carries both.
  EXPECT_LT(norm(world.states().velocity[kBall]), 1e-3);
  EXPECT_NEAR(world.states().position[kBall].z, 0, 0.2);
  Vec3d force;
  for (const JointRecord& joint : world.joints())
    if (joint.body_a == kWorldBody) force += 1e3 * joint.force;
  const double weight = (1 + kBall * kKnotMass) * kGravity;
  EXPECT_NEAR(force.z, weight, 0.01 * weight);
}

// Taut or slack, whatever the number of threads.
TEST(CableNets, HaveTheSameBitsOnAnyNumberOfThreads) {
  Scene scene = net_of(JointKind::cable, 8, Held::rim, 1.05);
  add_sphere(scene, {0.33, 0.36, 0.2}, 0.1, 0.5).velocity = {0, 0, -3};
  expect_same_bits_on_threads(scene, 150);
}

TEST(CableNets, NetsOfStiffSpringsNeedNoIterations) {
  const Scene scene = net_of(JointKind::spring, 16, Held::corners);
  World world = reference_world(scene);
  const NetRun run = run_net(world, scene, 200);
  EXPECT_EQ(run.unconverged, 0);
  EXPECT_EQ(run.iterations, 0);
  EXPECT_LT(run.gained, 0.01);
}

// Thirty links that stick out from a wall and sink until each lies against its limit.
TEST(CableNets, AChainThatLiesAgainstItsLimitsNeedsFewIterations) {
  Scene scene = empty_scene(1e-3, 0);
  scene.solver = SolverSettings{};
  for (int k = 0; k < 30; ++k) {
    add_box(scene, {0.1 * k + 0.05, 0, 0}, {0.05, 0.01, 0.01}, 0.05);
    Joint hinge =
        joint_of(JointKind::hinge, k == 0 ? kWorldBody : k - 1, k, {0.1 * k, 0, 0}, {0, 1, 0});
    hinge.limits = {-0.05, 0.05};
    scene.joints.push_back(hinge);
  }
  World world = reference_world(scene);
  const NetRun run = run_net(world, scene, 1000);
  EXPECT_LE(run.unconverged, 10);
  EXPECT_LE(run.iterations, 10 * 1000);
  // The last limits that it falls against turn it back no more.
  EXPECT_LT(norm(world.states().velocity[29]), 1e-6);
  for (const JointRecord& joint : world.joints()) EXPECT_NEAR(joint.position, 0.05, 1e-6);
}

}  // namespace
}  // namespace scree::physics
