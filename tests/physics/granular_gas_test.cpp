// Gases of spheres: they keep their energy when elastic, never gain any, and cool by Haff's law,
// T = T0 / (1 + t / tau)^2.

#include <gtest/gtest.h>

#include <array>

#include "tests/physics/scene_builder.h"

namespace scree::physics {
namespace {

/// Unit spheres at random places of a periodic cube, none overlapping.
std::vector<Vec3d> random_centers(int count, double edge, std::mt19937& random) {
  const int cells = static_cast<int>(edge);
  const double size = edge / cells;
  std::vector<std::vector<Vec3d>> cell(static_cast<std::size_t>(cells * cells * cells));
  const auto wrap = [&](int i) { return (i + cells) % cells; };
  const auto cell_of = [&](int i, int j, int k) -> std::vector<Vec3d>& {
    return cell[static_cast<std::size_t>((wrap(i) * cells + wrap(j)) * cells + wrap(k))];
  };
  std::uniform_real_distribution<double> coordinate(0, edge);
  std::vector<Vec3d> centers;
  while (static_cast<int>(centers.size()) < count) {
    const double px = coordinate(random), py = coordinate(random), pz = coordinate(random);
    const std::array<int, 3> at{static_cast<int>(px / size), static_cast<int>(py / size),
                                static_cast<int>(pz / size)};
    bool is_free = true;
    for (int i = -1; i <= 1 && is_free; ++i)
      for (int j = -1; j <= 1 && is_free; ++j)
        for (int k = -1; k <= 1 && is_free; ++k)
          for (const Vec3d& other : cell_of(at[0] + i, at[1] + j, at[2] + k)) {
            Vec3d d = other - Vec3d{px, py, pz};
            for (int axis = 0; axis < 3; ++axis) d[axis] -= edge * std::round(d[axis] / edge);
            is_free = is_free && norm2(d) > 1;
          }
    if (!is_free) continue;
    centers.push_back({px, py, pz});
    cell_of(at[0], at[1], at[2]).push_back(centers.back());
  }
  return centers;
}

struct Gas {
  double temperature = 0;
  Vec3d momentum;
};
Gas gas_of(const BodyStates& s) {
  Gas gas;
  for (const Vec3d& v : s.velocity) {
    gas.temperature += norm2(v) / 3;
    gas.momentum += v;
  }
  gas.temperature /= static_cast<double>(s.velocity.size());
  return gas;
}

/// Unit spheres of mass 1 and temperature 1 at a solid fraction, in a periodic cube.
Scene gas_scene(int count, double solid_fraction, double h, double e, double friction) {
  Scene scene = empty_scene(h, friction);
  scene.gravity = {};
  scene.materials[0].restitution = e;
  scene.stepping.restitution_threshold = 0;
  solve_to(scene, 1e-8);
  const double edge = std::cbrt(count * (kPi / 6) / solid_fraction);
  scene.periodicity = {{true, true, true}, {}, {edge, edge, edge}};
  std::mt19937 random(11);
  for (const Vec3d& center : random_centers(count, edge, random)) add_sphere(scene, center, 0.5, 1);
  std::normal_distribution<double> normal;
  Vec3d mean;
  for (BodyDescription& body : scene.bodies) {
    const double vx = normal(random), vy = normal(random), vz = normal(random);
    body.velocity = {vx, vy, vz};
    mean += 1.0 / count * body.velocity;
  }
  double squares = 0;
  for (BodyDescription& body : scene.bodies) squares += norm2(body.velocity -= mean);
  for (BodyDescription& body : scene.bodies) body.velocity *= std::sqrt(3 * count / squares);
  return scene;
}

struct EnergyHistory {
  double start = 0, end = 0;
  double largest_gain = 0;  ///< of a step, over the start
  double deepest = 0;       ///< largest penetration [m]
  double kept_course = 0;   ///< mean cosine between first and last velocities
};
EnergyHistory energies(const Scene& scene, int steps) {
  World world(scene, cpu_options(0));
  const BodyStates first = world.states();
  EnergyHistory history;
  for (const Vec3d& v : first.velocity) history.start += 0.5 * norm2(v);
  double before = history.start;
  for (int k = 0; k < steps; ++k) {
    const StepReport report = world.step();
    EXPECT_TRUE(report.converged);
    history.largest_gain =
        std::max(history.largest_gain, (report.kinetic_energy - before) / history.start);
    history.deepest = std::max(history.deepest, report.max_penetration);
    before = report.kinetic_energy;
  }
  history.end = before;
  const BodyStates last = world.states();
  const auto count = static_cast<double>(first.velocity.size());
  for (std::size_t i = 0; i < first.velocity.size(); ++i)
    history.kept_course += dot(first.velocity[i], last.velocity[i]) /
                           (norm(first.velocity[i]) * norm(last.velocity[i])) / count;
  return history;
}

// Spheres move 3.5 % of their diameter a step, RMS; fast ones, and chains of impacts within a step,
// are many. Every sphere collides some seven times.
TEST(GranularGas, A22_ElasticGasKeepsItsEnergy) {
  const EnergyHistory gas = energies(gas_scene(400, 0.2, 0.02, 1, 0), 100);
  EXPECT_LT(gas.kept_course, 0.3);
  EXPECT_NEAR(gas.end / gas.start, 1, 1e-6);
  EXPECT_LT(gas.largest_gain, 1e-9);
  EXPECT_LT(gas.deepest, 0.03);
}

TEST(GranularGas, A22_FrictionNeverAddsEnergy) {
  for (const double e : {1.0, 0.8}) {
    const EnergyHistory gas = energies(gas_scene(400, 0.2, 0.02, e, 0.5), 100);
    EXPECT_LT(gas.kept_course, 0.3) << e;
    EXPECT_LT(gas.end, 0.9 * gas.start) << e;
    EXPECT_LT(gas.largest_gain, 1e-9) << e;
  }
}

// A collision of smooth spheres takes the share 1 - e^2 of the energy of their approach along the
// normal, which is T per collision on average in a gas of mass 1: (1 - e^2) T / 2 each sphere.
TEST(GranularGas, A22_InelasticGasLosesTheEnergyOfItsCollisions) {
  const double e = 0.9, solid_fraction = 0.1, h = 0.01;
  const double number_density = solid_fraction / (kPi / 6);
  const double chi = (1 - solid_fraction / 2) / std::pow(1 - solid_fraction, 3);
  const double rate = 4 * number_density * chi * std::sqrt(kPi);
  const double tau = 6 / ((1 - e * e) * rate);
  const int steps = 200;
  const EnergyHistory gas = energies(gas_scene(2000, solid_fraction, h, e, 0), steps);
  const double cooled = 1 / std::sqrt(gas.end / gas.start) - 1;
  EXPECT_NEAR(cooled / (steps * h / tau), 1, 0.06);
  EXPECT_LT(gas.largest_gain, 1e-9);
}

TEST(GranularGas, C50_CoolsByHaffsLaw) {
  const int count = 4096;
  const double solid_fraction = 0.10, e = 0.8;
  const double number_density = solid_fraction / (kPi / 6);
  const double chi = (1 - solid_fraction / 2) / std::pow(1 - solid_fraction, 3);
  const double rate = 4 * number_density * chi * std::sqrt(kPi);  // collisions, d = m = T0 = 1
  const double tau = 6 / ((1 - e * e) * rate);
  EXPECT_NEAR(rate, 1.76454, 1e-5);
  EXPECT_NEAR(tau, 9.4453, 1e-4);

  const Scene scene = gas_scene(count, solid_fraction, 0.02 / rate, e, 0);
  World world(scene, cpu_options(0));
  const Gas start = gas_of(world.states());
  EXPECT_NEAR(start.temperature, 1, 1e-12);
  // 1 / sqrt(T) - 1 = t / tau: slope through the origin over the first tau.
  double xy = 0, xx = 0;
  const int steps = steps_for(scene, 5 * tau);
  for (int k = 1; k <= steps; ++k) {
    world.step();
    if (world.time() > tau || k % 20 != 0) continue;
    const double x = world.time() / tau;
    xy += x * (1 / std::sqrt(gas_of(world.states()).temperature) - 1);
    xx += x * x;
  }
  const Gas end = gas_of(world.states());
  RecordProperty("early_slope", std::to_string(xy / xx));
  RecordProperty("temperature_times_36", std::to_string(36 * end.temperature));
  EXPECT_NEAR(xy / xx, 1, 0.05);
  EXPECT_NEAR(36 * end.temperature, 1, 0.15);
  EXPECT_LT(norm(end.momentum - start.momentum), 1e-10);
}

}  // namespace
}  // namespace scree::physics
