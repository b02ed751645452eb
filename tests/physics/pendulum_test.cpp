// Hinged bodies: periods, energy, forces of the hinge, chains, and what joints do beside contacts.
// VALIDATION A21 and A.6.

#include <gtest/gtest.h>

#include <algorithm>

#include "host/world_state.h"
#include "tests/physics/scene_builder.h"

namespace scree::physics {
namespace {

const std::vector<std::string> kSolvers{"apgd", "gauss_seidel", "gauss_seidel_colored", "jacobi"};

void add_hinge(Scene& scene, int a, int b, const Vec3d& anchor, const Vec3d& axis = {0, 1, 0}) {
  scene.joints.push_back({JointKind::hinge, {a, b}, anchor, axis});
}

/// A ball on a rod without mass, hinged at the origin; the angle is that from the vertical below.
struct Pendulum {
  double length = 1, radius = 0.01, mass = 1;
  double angle = kPi / 2;

  Scene scene(double h) const {
    Scene scene = empty_scene(h, 0);
    add_sphere(scene, length * Vec3d{std::sin(angle), 0, -std::cos(angle)}, radius, mass);
    add_hinge(scene, kWorldBody, 0, {});
    return scene;
  }
  double inertia() const { return mass * (length * length + 0.4 * radius * radius); }
  /// Of small swings [s].
  double small_period() const {
    return 2 * kPi * std::sqrt(inertia() / (mass * kGravity * length));
  }
};

/// Time between the first and the last passage of the vertical in the same direction, over their
/// number [s].
double period(World& world, const Scene& scene, double duration) {
  const double h = scene.stepping.time_step;
  std::vector<double> passages;
  double before = world.states().position[0].x;
  for (int k = 1; k <= steps_for(scene, duration); ++k) {
    EXPECT_TRUE(world.step().converged);
    const double now = world.states().position[0].x;
    if (before < 0 && now >= 0) passages.push_back(h * (k - now / (now - before)));
    before = now;
  }
  EXPECT_GE(passages.size(), 2u);
  return (passages.back() - passages.front()) / static_cast<double>(passages.size() - 1);
}

class PendulumPeriod : public testing::TestWithParam<std::string> {};

TEST_P(PendulumPeriod, A21_IsThatOfLargeSwings) {
  for (const auto& [degrees, factor] : {std::pair{90.0, 1.1803406}, {60.0, 1.0731820}}) {
    Pendulum pendulum;
    pendulum.angle = radians(degrees);
    Scene scene = pendulum.scene(1e-3);
    scene.solver.name = GetParam();
    World world = reference_world(scene);
    // The amplitude is off by the way of half a step.
    EXPECT_NEAR(period(world, scene, 5.5) / (factor * pendulum.small_period()), 1, 2e-6) << degrees;
  }
}
INSTANTIATE_TEST_SUITE_P(Solvers, PendulumPeriod, testing::ValuesIn(kSolvers),
                         [](const auto& one) { return one.param; });

// Velocities belong to the middle of steps, so a start at rest is one half a step before: with the
// velocity of that moment the way is of second order.
TEST(Pendulum, A21_WayIsOfSecondOrder) {
  const Pendulum pendulum;
  const auto angle_after = [&](double h, double duration) {
    Scene scene = pendulum.scene(h);
    const double start = kGravity * pendulum.mass * pendulum.length / pendulum.inertia();
    scene.bodies[0].angular_velocity = {0, -h / 2 * start, 0};
    scene.bodies[0].velocity = cross(scene.bodies[0].angular_velocity, scene.bodies[0].position);
    World world = reference_world(scene);
    run_for(world, scene, duration);
    const Vec3d x = world.states().position[0];
    return std::atan2(x.x, -x.z);
  };
  const double exact = angle_after(1e-4, 3);
  const double coarse = angle_after(2e-3, 3) - exact, fine = angle_after(1e-3, 3) - exact;
  EXPECT_LT(std::abs(coarse), 1e-4);
  EXPECT_NEAR(coarse / fine, 4, 0.3);
}

TEST(Pendulum, A21_HoldsInFloat) {
  const Pendulum pendulum;
  Scene scene = pendulum.scene(1e-3);
  scene.solver.stop = {StopRule::Level::quality, 0};
  World world(scene, cpu_options(1, Precision::single_precision));
  EXPECT_NEAR(period(world, scene, 5.5) / (1.1803406 * pendulum.small_period()), 1, 1e-4);
  EXPECT_NEAR(norm(world.states().position[0]), 1, 1e-6);
}

/// Kinetic and potential energy at the places of the steps: velocities are those between them.
class EnergyOfSteps {
 public:
  explicit EnergyOfSteps(const Scene& scene) : scene_(scene) {}
  /// Energy at the place before the last step [J]; needs two states.
  double add(const BodyStates& now) {
    double energy = 0;
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
      const BodyDescription& body = scene_.bodies[i];
      if (body.kind != BodyKind::free || before_.position.empty()) continue;
      const Vec3d v = 0.5 * (now.velocity[i] + before_.velocity[i]);
      const Vec3d w = rotate_back(before_.orientation[i],
                                  0.5 * (now.angular_velocity[i] + before_.angular_velocity[i]));
      energy += 0.5 * body.mass * norm2(v) + 0.5 * dot(w, hadamard(body.inertia, w)) -
                body.mass * dot(scene_.gravity, before_.position[i]);
    }
    before_ = now;
    return energy;
  }

 private:
  const Scene& scene_;
  BodyStates before_;
};

// The scheme is that of Verlet with constraints on places: the energy swings by the square of the
// step and does not drift, but for the 1e-7 m by which a joint may be off.
TEST(Pendulum, KeepsItsEnergy) {
  const Pendulum pendulum;
  const double weight = pendulum.mass * kGravity * pendulum.length;
  struct Change {
    double swing = 0;  ///< largest in the first swings, over m g L
    double drift = 0;  ///< of the mean, from the first five seconds to the last ones
  };
  const auto change = [&](double h) {
    const Scene scene = pendulum.scene(h);
    World world = reference_world(scene);
    EnergyOfSteps energy(scene);
    const int steps = steps_for(scene, 40), part = steps_for(scene, 5);
    Change c;
    for (int k = 0; k < steps; ++k) {
      world.step();
      const double now = energy.add(world.states()) / weight;
      if (k > 0 && k < part) c.swing = std::max(c.swing, std::abs(now));
      if (k > 0 && k < part) c.drift -= now / (part - 1);
      if (k >= steps - part) c.drift += now / part;
    }
    return c;
  };
  const Change coarse = change(4e-3), fine = change(2e-3);
  RecordProperty("swing_ppm", std::to_string(1e6 * fine.swing));
  RecordProperty("drift_ppm", std::to_string(1e6 * fine.drift));
  EXPECT_LT(fine.swing, 5e-5);
  EXPECT_LT(std::abs(coarse.drift), 3e-6);
  EXPECT_LT(std::abs(fine.drift), 3e-6);
  EXPECT_GT(coarse.swing / fine.swing, 3.5);
}

// A rod that hangs by its end: along it the hinge carries weight and centripetal force, across it
// what the moment of inertia leaves of the weight.
TEST(Pendulum, HingeCarriesTheForceOfASwingingRod) {
  constexpr double kLength = 0.6, kMass = 2;
  Scene scene = empty_scene(1e-4, 0);
  const double arm = kLength / 2;
  const BodyDescription rod = add_box(scene, {arm, 0, 0}, {arm, 0.02, 0.03}, kMass);
  add_hinge(scene, kWorldBody, 0, {});
  World world = reference_world(scene);
  const double about_hinge = rod.inertia.y + kMass * arm * arm;
  double largest = 0;
  BodyStates before = world.states();
  for (int k = 0; k < 6000; ++k) {
    world.step();
    const BodyStates now = world.states();
    const Vec3d out = normalized(before.position[0]);  // from the hinge along the rod
    const Vec3d down{0, 0, -1};
    const Vec3d along_fall = cross(Vec3d{0, 1, 0}, out);  // where the rod moves with w_y > 0
    const double w = 0.5 * (before.angular_velocity[0].y + now.angular_velocity[0].y);
    const double turning = kMass * kGravity * arm * dot(down, along_fall) / about_hinge;
    const Vec3d expected =
        kMass * ((turning * arm) * along_fall - (w * w * arm) * out) - kMass * kGravity * down;
    const JointRecord joint = world.joints().at(0);
    EXPECT_EQ(joint.body_a, kWorldBody);
    EXPECT_EQ(joint.body_b, 0);
    if (k > 0) largest = std::max(largest, norm(1e4 * joint.force - expected));
    EXPECT_LT(std::abs(joint.moment.y), 1e-12);
    before = now;
  }
  EXPECT_LT(largest / (kMass * kGravity), 1e-4);
}

// Equal point masses on equal rods: small swings are sums of two modes.
TEST(Pendulum, TwoLinksSwingInTheirModes) {
  constexpr double kAngle = 1e-3, kRadius = 0.01;
  const auto mode_period = [&](double ratio, double duration) {
    Scene scene = empty_scene(1e-3, 0);
    const Vec3d first{std::sin(kAngle), 0, -std::cos(kAngle)};
    const Vec3d second = first + Vec3d{std::sin(ratio * kAngle), 0, -std::cos(ratio * kAngle)};
    add_sphere(scene, first, kRadius, 1);
    add_sphere(scene, second, kRadius, 1);
    add_hinge(scene, kWorldBody, 0, {});
    add_hinge(scene, 0, 1, first);
    World world = reference_world(scene);
    return period(world, scene, duration);
  };
  const double slow = mode_period(std::sqrt(2.0), 6), fast = mode_period(-std::sqrt(2.0), 3);
  EXPECT_NEAR(slow * std::sqrt((2 - std::sqrt(2.0)) * kGravity) / (2 * kPi), 1, 1e-4);
  EXPECT_NEAR(slow / fast, 2.41421, 5e-4);
}

/// Rods of one length in a row from the origin, each hinged to the one before.
Scene chain(double h, int count, double length, const Vec3d& direction = {1, 0, 0}) {
  Scene scene = empty_scene(h, 0.3);
  for (int k = 0; k < count; ++k) {
    BodyDescription& rod = add_box(scene, (k + 0.5) * length * direction,
                                   {length / 2, 0.05 * length, 0.06 * length}, 0.1);
    rod.orientation = exp_map(std::atan2(-direction.z, direction.x) * Vec3d{0, 1, 0});
    add_hinge(scene, k == 0 ? kWorldBody : k - 1, k, k * length * direction);
  }
  return scene;
}

/// Largest distance of the ends of rods that should be one point [m].
double largest_gap(const BodyStates& s, double length) {
  double largest = 0;
  Vec3d end;
  for (std::size_t k = 0; k < s.position.size(); ++k) {
    const Vec3d half = rotate(s.orientation[k], {length / 2, 0, 0});
    largest = std::max(largest, norm(s.position[k] - half - end));
    end = s.position[k] + half;
  }
  return largest;
}

/// Largest gap of a chain of ten rods that falls from the horizontal [m].
double gap_of_falling_chain(double h, double duration) {
  Scene scene = chain(h, 10, 0.1);
  solve_to(scene, 1e-8);
  World world = reference_world(scene);
  double gap = 0, reported = 0;
  for (int k = 0; k < steps_for(scene, duration); ++k) {
    const StepReport report = world.step();
    EXPECT_TRUE(report.converged) << "step " << report.step;
    gap = std::max(gap, largest_gap(world.states(), 0.1));
    reported = std::max(reported, report.max_joint_error);
  }
  EXPECT_GT(reported, 0.5 * gap);
  EXPECT_LT(reported, 2 * gap);
  return gap;
}

// The end of the chain whips at more than 100 rad/s.
TEST(Pendulum, ChainKeepsItsJoints) { EXPECT_LT(gap_of_falling_chain(1e-3, 3), 2e-7); }

// A rod hinged at one end, the other one on the floor: each carries half of the weight.
class HingeAndFloor : public testing::TestWithParam<std::string> {};

TEST_P(HingeAndFloor, ShareTheWeight) {
  constexpr double kMass = 3, kHalf = 0.5, kThick = 0.05;
  for (const double friction : {0.0, 0.6}) {
    Scene scene = empty_scene(1e-3, friction);
    solve_to(scene, 1e-9);
    scene.solver.name = GetParam();
    add_plane(scene);
    add_box(scene, {kHalf, 0, kThick + 1e-4}, {kHalf, kThick, kThick}, kMass);
    // Only the far end touches: the rod falls by 1e-4 m there and turns about the hinge.
    add_hinge(scene, kWorldBody, 1, {0, 0, kThick + 1e-4});
    World world = reference_world(scene);
    StepReport report;
    for (int k = 0; k < 300; ++k) report = world.step();
    EXPECT_TRUE(report.converged);
    const double h = scene.stepping.time_step, weight = kMass * kGravity;
    // Friction at the floor has a lever at the hinge, and any value within its cone.
    Vec3d floor;
    for (const ContactRecord& contact : world.contacts())
      floor += contact.body_b == 1 ? contact.impulse : -contact.impulse;
    const double lift = floor.z * 2 * kHalf + floor.x * (kThick + 1e-4);
    EXPECT_NEAR(lift / h, weight * kHalf, 1e-4 * weight);
    if (friction == 0) {
      EXPECT_NEAR(normal_impulse(world, 1) / h, weight / 2, 1e-4 * weight);
    }
    EXPECT_LT(norm(floor + world.joints()[0].force - Vec3d{0, 0, weight * h}), 1e-6 * h * weight);
    EXPECT_LT(report.kinetic_energy, 1e-12);
  }
}
INSTANTIATE_TEST_SUITE_P(Solvers, HingeAndFloor, testing::ValuesIn(kSolvers),
                         [](const auto& one) { return one.param; });

/// A chain that falls on the floor, with a ball that it meets there.
Scene falling_chain() {
  Scene scene = chain(1e-3, 6, 0.1, normalized(Vec3d{1, 0, 0.2}));
  for (BodyDescription& rod : scene.bodies) rod.position.z += 0.05;
  for (Joint& joint : scene.joints) joint.anchor.z += 0.05;
  scene.joints.erase(scene.joints.begin());  // nothing holds it
  add_plane(scene);
  add_sphere(scene, {0.3, 0.02, 0.03}, 0.03, 0.2);
  solve_to(scene, 1e-9);
  return scene;
}

TEST(Pendulum, SolversAgreeOnAChainThatFalls) {
  std::vector<BodyStates> ends;
  for (const std::string& solver : kSolvers) {
    Scene scene = falling_chain();
    scene.solver.name = solver;
    scene.solver.max_iterations = 200000;
    World world = reference_world(scene);
    std::int64_t contacts = 0;
    for (int k = 0; k < 150; ++k) {
      const StepReport report = world.step();
      EXPECT_TRUE(report.converged) << solver << " step " << report.step;
      contacts = std::max(contacts, report.contact_count);
    }
    EXPECT_GT(contacts, 4);
    ends.push_back(world.states());
    for (std::size_t i = 0; i < ends[0].position.size(); ++i)
      EXPECT_LT(norm(ends.back().position[i] - ends[0].position[i]), 1e-6) << solver << " " << i;
  }
}

// Bodies are sorted in memory as they move, so that A and B of a joint change places.
TEST(Pendulum, OrderOfBodiesAndOfTheEndsOfJointsDoesNotMatter) {
  const Scene scene = falling_chain();
  Scene other = scene;
  std::reverse(other.bodies.begin(), other.bodies.end());
  const int last = last_id(scene);
  for (Joint& joint : other.joints) joint.bodies = {last - joint.bodies[1], last - joint.bodies[0]};
  std::reverse(other.joints.begin(), other.joints.end());
  World world = reference_world(scene), reversed = reference_world(other);
  for (int k = 0; k < 150; ++k) world.step(), reversed.step();
  const BodyStates a = world.states(), b = reversed.states();
  for (std::size_t i = 0; i < a.position.size(); ++i)
    EXPECT_LT(norm(a.position[i] - b.position[a.position.size() - 1 - i]), 1e-6) << i;
}

TEST(Pendulum, HasTheSameBitsOnAnyNumberOfThreads) {
  for (const std::string& solver : {std::string("apgd"), std::string("gauss_seidel_colored")}) {
    Scene scene = falling_chain();
    scene.solver.name = solver;
    std::vector<World> worlds;
    for (const int threads : {1, 2, 3}) worlds.emplace_back(scene, cpu_options(threads));
    for (int k = 0; k < 100; ++k)
      for (World& world : worlds) world.step();
    const BodyStates first = worlds[0].states();
    for (World& world : worlds) {
      const BodyStates other = world.states();
      for (std::size_t i = 0; i < first.position.size(); ++i) {
        EXPECT_EQ(first.position[i], other.position[i]);
        EXPECT_EQ(first.angular_velocity[i], other.angular_velocity[i]);
      }
    }
  }
}

TEST(Pendulum, GoesOnBitForBitFromASavedState) {
  for (const Precision precision : {Precision::single_precision, Precision::double_precision}) {
    Scene scene = falling_chain();
    scene.solver.stop = {StopRule::Level::preview, 0};  // so that the warm start counts
    World world(scene, cpu_options(1, precision));
    for (int k = 0; k < 70; ++k) world.step();
    const WorldState saved = world.save();
    EXPECT_EQ(saved.at<Vec3d>("joint/impulse").size(), 2 * scene.joints.size());
    World resumed(scene, cpu_options(1, precision));
    resumed.restore(saved);
    for (int k = 0; k < 70; ++k) {
      const StepReport a = world.step(), b = resumed.step();
      EXPECT_EQ(a.iterations, b.iterations) << a.step;
      EXPECT_EQ(a.residual_rms, b.residual_rms) << a.step;
    }
    const BodyStates a = world.states(), b = resumed.states();
    for (std::size_t i = 0; i < a.position.size(); ++i) EXPECT_EQ(a.position[i], b.position[i]);
  }
}

// Warm starts know a joint by its number: where a chain hangs still there is nothing left to do.
TEST(Pendulum, WarmStartHoldsAHangingChain) {
  const auto iterations = [](bool warm) {
    Scene scene = chain(1e-3, 10, 0.1, {0, 0, -1});
    solve_to(scene, 1e-7);
    scene.solver.warm_start = warm;
    World world = reference_world(scene);
    int sum = 0;
    for (int k = 0; k < 100; ++k) sum += world.step().iterations;
    // Ten rods of 0.1 kg.
    EXPECT_NEAR(world.joints()[0].force.z / 1e-3, kGravity, 1e-3 * kGravity);
    return sum;
  };
  EXPECT_LT(iterations(true), 0.2 * iterations(false));
}

TEST(Pendulum, BodiesOfAJointDoNotTouch) {
  Scene scene = empty_scene(1e-3, 0.5);
  scene.gravity = {};
  add_box(scene, {0, 0, 0}, {0.1, 0.1, 0.1}, 1);
  add_box(scene, {0.15, 0, 0}, {0.1, 0.1, 0.1}, 1);
  add_wall_box(scene, {-0.15, 0, 0}, {0.1, 0.1, 0.1});
  World free = reference_world(scene);
  EXPECT_GT(free.step().contact_count, 4);
  add_hinge(scene, 1, 0, {0.075, 0, 0});
  World half = reference_world(scene);
  const int wall_contacts = half.step().contact_count;
  EXPECT_GT(wall_contacts, 0);
  for (const ContactRecord& contact : half.contacts()) EXPECT_EQ(contact.body_b, 2);
  add_hinge(scene, 0, 2, {-0.075, 0, 0});
  World held = reference_world(scene);
  EXPECT_TRUE(held.overlaps().empty());
  for (int k = 0; k < 10; ++k) EXPECT_EQ(held.step().contact_count, 0);
  EXPECT_LT(norm(held.states().position[1] - Vec3d{0.15, 0, 0}), 1e-12);
}

// A rotor on an arm that turns: its axis is turned all the time, which takes a moment
// I3 w x W; second order, so after one solve the axis is off by the third power of the step. Solved
// again the joint is where it belongs.
TEST(Pendulum, HingeFollowsATurningArm) {
  const auto error = [](double h, bool once) {
    constexpr double kRate = 3, kSpin = 40;
    Scene scene = empty_scene(h, 0);
    scene.gravity = {};
    BodyDescription& arm =
        add_wall_box(scene, {0.25, 0, 0}, {0.25, 0.01, 0.01}, BodyKind::kinematic);
    Motion motion;
    motion.kind = Motion::Kind::rotating;
    motion.rate = kRate;
    arm.motion = motion;
    BodyDescription& rotor = add_box(scene, {0.6, 0, 0}, {0.01, 0.1, 0.1}, 1);
    rotor.velocity = {0, 0.6 * kRate, 0};
    rotor.angular_velocity = {kSpin, 0, kRate};
    add_hinge(scene, 0, 1, {0.5, 0, 0}, {1, 0, 0});
    if (once) {
      scene.solver.stop = {StopRule::Level::fixed_iterations, 0};
      scene.solver.max_iterations = 200;
    }
    World world = reference_world(scene);
    double largest = 0;
    for (int k = 0; k < steps_for(scene, 1); ++k) {
      world.step();
      const BodyStates s = world.states();
      const Vec3d on_arm = rotate(s.orientation[0], {1, 0, 0});
      largest = std::max(largest, norm(rotate(s.orientation[1], {1, 0, 0}) - on_arm));
      largest = std::max(largest, norm(s.position[1] - 0.6 * on_arm));
    }
    EXPECT_NEAR(world.states().angular_velocity[1].z, kRate, 1e-2);
    return largest;
  };
  const double coarse = error(1e-3, true), fine = error(5e-4, true);
  RecordProperty("coarse", std::to_string(1e9 * coarse));
  EXPECT_LT(coarse, 1e-5);
  EXPECT_NEAR(coarse / fine, 8, 1.5);
  EXPECT_LT(error(1e-3, false), 3e-7);  // the rotor's axis, 0.1 m of which are 1e-7 m
}

// Images of a periodic domain are the same chain.
TEST(Pendulum, SwingsThroughAPeriodicSide) {
  Scene scene = chain(1e-3, 4, 0.1);
  scene.joints.erase(scene.joints.begin());
  for (BodyDescription& rod : scene.bodies) rod.velocity = {1, 0, 0};
  scene.bodies[0].angular_velocity = {0, 3, 0};
  World plain = reference_world(scene);
  scene.periodicity.periodic = {true, false, false};
  scene.periodicity.lower = {0, 0, 0};
  scene.periodicity.upper = {0.5, 0, 0};
  World periodic = reference_world(scene);
  for (int k = 0; k < 700; ++k) plain.step(), periodic.step();
  const BodyStates a = plain.states(), b = periodic.states();
  for (std::size_t i = 0; i < a.position.size(); ++i) {
    Vec3d d = a.position[i] - b.position[i];
    d.x = std::remainder(d.x, 0.5);
    EXPECT_LT(norm(d), 1e-8) << i;
    EXPECT_GT(a.position[i].x, 0.5) << i;
  }
}

}  // namespace
}  // namespace scree::physics
