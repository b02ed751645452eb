// Gases of the variational model: what is conserved, the order of impacts, and Haff's law.

#include <gtest/gtest.h>

#include "host/state_hash.h"
#include "tests/dynamics/variational_scenes.h"

namespace scree::test {
namespace {

/// Spheres in a room without gravity, from one impact to the next of all: nothing is assumed of steps, neighbors or
/// islands.
class EventDriven {
 public:
  EventDriven(const Scene& scene, const Vec3d& half, const Vec3d& period)
      : half_(half), period_(period) {
    for (const BodyDescription& body : scene.bodies)
      if (body.kind == BodyKind::free) bodies_.push_back(body);
    e_ = scene.materials[0].restitution;
  }
  void run(double time) {
    for (;;) {
      double first = time;
      std::size_t a = 0, b = 0;
      int wall = -1;
      for (std::size_t i = 0; i < bodies_.size(); ++i) {
        for (int axis = 0; axis < 3 && !(period_[axis] > 0); ++axis) {
          const double v = bodies_[i].velocity[axis];
          const double room = half_[axis] - bodies_[i].shape.radius;
          const double t = v > 0   ? (room - bodies_[i].position[axis]) / v
                           : v < 0 ? (-room - bodies_[i].position[axis]) / v
                                   : first;
          if (t < first) first = t, a = i, wall = axis;
        }
        for (std::size_t k = i + 1; k < bodies_.size(); ++k) {
          const double t = meeting(bodies_[i], bodies_[k]);
          if (t < first) first = t, a = i, b = k, wall = -2;
        }
      }
      for (BodyDescription& body : bodies_) body.position += first * body.velocity;
      time -= first;
      if (wall == -1) return;
      ++impacts;
      if (wall >= 0) {
        bodies_[a].velocity[wall] *= -e_;
      } else {
        bounce(bodies_[a], bodies_[b]);
      }
    }
  }
  const std::vector<BodyDescription>& bodies() const { return bodies_; }
  int impacts = 0;

 private:
  Vec3d apart(const BodyDescription& a, const BodyDescription& b) const {
    Vec3d d = b.position - a.position;
    for (int k = 0; k < 3; ++k)
      if (period_[k] > 0) d[k] -= period_[k] * std::round(d[k] / period_[k]);
    return d;
  }
  double meeting(const BodyDescription& a, const BodyDescription& b) const {
    const Vec3d d = apart(a, b), u = b.velocity - a.velocity;
    const double sum = a.shape.radius + b.shape.radius;
    const double p = dot(d, u), q = norm2(u), c = norm2(d) - sum * sum;
    if (p >= 0 || p * p - q * c < 0) return 1e300;
    return std::max(0.0, (-p - std::sqrt(p * p - q * c)) / q);
  }
  void bounce(BodyDescription& a, BodyDescription& b) const {
    const Vec3d n = normalized(apart(a, b));
    const double push = (1 + e_) * dot(a.velocity - b.velocity, n) / (1 / a.mass + 1 / b.mass);
    a.velocity -= (push / a.mass) * n;
    b.velocity += (push / b.mass) * n;
  }
  Vec3d half_, period_;
  double e_;
  std::vector<BodyDescription> bodies_;
};

/// Spheres of several sizes and masses in a room.
Scene mixed_room(int count, double half, double time_step, double restitution) {
  Scene scene = variational_scene(time_step, restitution);
  std::mt19937 random(12);
  std::uniform_real_distribution<double> uniform(-1, 1);
  while (static_cast<int>(scene.bodies.size()) < count) {
    const double r = 0.25 + 0.15 * uniform(random);
    const Vec3d x = (half - r) * Vec3d{uniform(random), uniform(random), uniform(random)};
    const bool is_free = std::all_of(
        scene.bodies.begin(), scene.bodies.end(),
        [&](const BodyDescription& o) { return norm(o.position - x) > r + o.shape.radius; });
    if (!is_free) continue;
    add_sphere(scene, x, r, 1 + 0.8 * uniform(random)).velocity = {uniform(random), uniform(random),
                                                                   uniform(random)};
  }
  BodyDescription room;
  room.kind = BodyKind::fixed;
  room.shape.kind = shapes::Container::kind;
  room.shape.half_extents = {half, half, half};
  scene.bodies.push_back(room);
  return scene;
}

/// Rounding grows with every impact: so many are compared as leave some digits.
void expect_order(const Scene& scene, const Vec3d& half, const Vec3d& period, int steps,
                  double tolerance) {
  World world(scene, cpu_options());
  EventDriven oracle(scene, half, period);
  double counted = 0, largest_rounds = 0;
  for (int k = 0; k < steps; ++k) {
    const StepReport report = world.step();
    counted += report.own[impacts];
    largest_rounds = std::max(largest_rounds, report.own[rounds]);
    EXPECT_LT(report.max_penetration, 1e-11);
  }
  oracle.run(steps * scene.stepping.time_step);
  EXPECT_EQ(counted, oracle.impacts);
  EXPECT_GT(largest_rounds, 1);
  const BodyStates states = world.states();
  for (std::size_t i = 0; i < oracle.bodies().size(); ++i) {
    Vec3d d = states.position[i] - oracle.bodies()[i].position;
    for (int k = 0; k < 3; ++k)
      if (period[k] > 0) d[k] -= period[k] * std::round(d[k] / period[k]);
    EXPECT_LT(norm(d), tolerance) << "body " << i;
    EXPECT_LT(norm(states.velocity[i] - oracle.bodies()[i].velocity), tolerance) << "body " << i;
  }
}

TEST(VariationalGas, ImpactsComeInTheOrderOfTheirTimes) {
  for (const double e : {1.0, 0.7}) {
    const double half = 1.5;
    const Scene scene = mixed_room(40, half, 0.15, e);
    expect_order(scene, {half, half, half}, {}, 8, 1e-7);
  }
}

/// With lists of neighbors, periodic, and bodies that meet several others in a step.
TEST(VariationalGas, PeriodicGasHasTheOrderOfAnEventDrivenRun) {
  const Scene scene = gas(6, 0.2, 0.15, 1);
  const Vec3d period = scene.periodicity.upper;
  expect_order(scene, {}, period, 8, 1e-7);
}

/// Without forces impacts do not depend on the time step.
TEST(VariationalGas, TimeStepsDoNotMatterWithoutForces) {
  std::vector<Vec3d> reference;
  for (const double h : {0.2, 0.05, 0.0125}) {
    const Scene scene = gas(6, 0.1, h, 1);
    World world(scene, cpu_options());
    physics::run_for(world, scene, 1);
    const BodyStates states = world.states();
    if (reference.empty()) reference = states.position;
    for (std::size_t i = 0; i < reference.size(); ++i) {
      Vec3d d = states.position[i] - reference[i];
      for (int k = 0; k < 3; ++k)
        d[k] -= scene.periodicity.upper[k] * std::round(d[k] / scene.periodicity.upper[k]);
      EXPECT_LT(norm(d), 1e-9) << h;
    }
  }
}

TEST(VariationalGas, ConservesEnergyAndMomentum) {
  Scene scene = gas(8, 0.15, 0.02, 1);
  World world(scene, cpu_options());
  StepReport first = world.step();
  double hits = 0;
  for (int k = 0; k < 2000; ++k) {
    const StepReport r = world.step();
    hits += r.own[impacts];
    ASSERT_NEAR(r.own[energy], first.own[energy], 1e-11 * first.own[energy]);
    ASSERT_LT(norm(momentum(r) - momentum(first)), 1e-11);
    ASSERT_LT(r.max_penetration, 1e-12);
    ASSERT_LT(r.own[identity_error], 1e-12);
    ASSERT_EQ(r.own[grazing], 0);
  }
  EXPECT_GT(hits, 20000);
}

/// In a room that is shaken by nothing but its own bounces, with gravity: the energy wanders, but does not drift; angular
/// momentum about a vertical axis would need a round room.
TEST(VariationalGas, EnergyUnderGravityIsOfSecondOrder) {
  double largest[2] = {};
  for (int level = 0; level < 2; ++level) {
    Scene scene = mixed_room(60, 2, level == 0 ? 0.02 : 0.005, 1);
    scene.gravity = {0, 0, -2};
    World world(scene, cpu_options());
    const double start = world.step().own[energy];
    double hits = 0;
    for (int k = 0; k < (level == 0 ? 1000 : 4000); ++k) {
      const StepReport r = world.step();
      hits += r.own[impacts];
      largest[level] = std::max(largest[level], std::abs(r.own[energy] - start));
      ASSERT_LT(r.max_penetration, 1e-12);
    }
    EXPECT_GT(hits, 1000);
  }
  EXPECT_LT(largest[0], 0.05);
  EXPECT_LT(largest[1], largest[0] / 6) << "16 but for chance";
}

TEST(VariationalGas, ThreadsAndRunsGiveTheSameBits) {
  const Scene scene = gas(9, 0.2, 0.05, 0.95);
  std::vector<std::uint64_t> hashes;
  std::vector<double> energies;
  for (const int threads : {1, 2, 3, 1}) {
    World world(scene, cpu_options(threads));
    StepReport last;
    for (int k = 0; k < 100; ++k) last = world.step();
    hashes.push_back(state_hash(world.states()));
    energies.push_back(last.own[energy]);
  }
  for (std::size_t k = 1; k < hashes.size(); ++k) {
    EXPECT_EQ(hashes[k], hashes[0]);
    EXPECT_EQ(energies[k], energies[0]);
  }
}

TEST(VariationalGas, AResumedRunHasTheSameBits) {
  const Scene scene = gas(6, 0.2, 0.05, 0.95);
  World whole(scene, cpu_options()), again(scene, cpu_options());
  for (int k = 0; k < 70; ++k) whole.step();
  const WorldState saved = whole.save();
  for (int k = 0; k < 5; ++k) again.step();
  again.restore(saved);
  for (int k = 0; k < 80; ++k) {
    const StepReport a = whole.step(), b = again.step();
    ASSERT_EQ(a.own, b.own) << k;
    ASSERT_EQ(a.step, b.step);
  }
  EXPECT_EQ(state_hash(whole.states()), state_hash(again.states()));
}

/// Haff: 1 / sqrt(T) grows linearly, T = T0 / (1 + t / tau)^2.
void expect_haff(int per_edge, double taus, double slope_tolerance) {
  const double solid_fraction = 0.10, e = 0.8;
  const double number_density = solid_fraction / (physics::kPi / 6);
  const double chi = (1 - solid_fraction / 2) / std::pow(1 - solid_fraction, 3);
  const double rate = 4 * number_density * chi * std::sqrt(physics::kPi),
               tau = 6 / ((1 - e * e) * rate);
  EXPECT_NEAR(rate, 1.76454, 1e-5);
  EXPECT_NEAR(tau, 9.4453, 1e-4);
  const Scene scene = gas(per_edge, solid_fraction, 0.02 / rate, e);
  World world(scene, cpu_options());
  const double count = std::pow(per_edge, 3);
  double xy = 0, xx = 0;
  Vec3d first;
  StepReport r;
  const int steps = physics::steps_for(scene, taus * tau);
  for (int k = 1; k <= steps; ++k) {
    r = world.step();
    if (k == 1) first = momentum(r);
    if (world.time() > tau || k % 20 != 0) continue;
    const double x = world.time() / tau;
    xy += x * (1 / std::sqrt(r.kinetic_energy / 1.5 / count) - 1);
    xx += x * x;
  }
  testing::Test::RecordProperty("early_slope", std::to_string(xy / xx));
  EXPECT_NEAR(xy / xx, 1, slope_tolerance);
  EXPECT_LT(norm(momentum(r) - first), 1e-10);
  if (taus >= 5) {
    EXPECT_NEAR(36 * r.kinetic_energy / 1.5 / count, 1, 0.15);
  }
}

TEST(VariationalGas, C50_CoolsByHaffsLaw) { expect_haff(16, 5, 0.05); }

}  // namespace
}  // namespace scree::test
