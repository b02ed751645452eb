#pragma once
// Mechanical systems for the tests of CollisionIntegrator.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "host/collision_integrator.h"
#include "host/collision_walls.h"

namespace scree::physics {

inline constexpr double kWeight = 9.81;  // g [m/s^2]; masses are 1 kg

/// A figure for the tables of docs/results/variational.md, which bench/variational.py makes of the report of the tests.
inline void report(const std::string& key, double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.5g", value);
  testing::Test::RecordProperty(key, std::string(text));
}

/// V = weight q[coordinate].
inline void add_gravity(MechanicalSystem& system, std::size_t coordinate, double weight = kWeight) {
  system.potential = [=](std::span<const double> q) { return weight * q[coordinate]; };
  system.potential_gradient = [=](std::span<const double>, std::span<double> gradient) {
    std::fill(gradient.begin(), gradient.end(), 0.0);
    gradient[coordinate] = weight;
  };
}

/// Unit masses in n coordinates, without forces.
inline MechanicalSystem unit_masses(std::size_t n) {
  MechanicalSystem system;
  system.mass.assign(n * n, 0);
  for (std::size_t i = 0; i < n; ++i) system.mass[i * n + i] = 1;
  return system;
}

/// A ball above a floor in one coordinate, its height.
inline MechanicalSystem ball_on_floor() {
  MechanicalSystem system = unit_masses(1);
  add_gravity(system, 0);
  system.walls = {half_space_wall("floor", {{1}, 0})};
  return system;
}

/// What a run did to the energy of nodes.
struct EnergyRecord {
  double largest_change = 0;  // of E, relative to that at the start
  double last_change = 0;
};

/// Relative changes of the energy over a number of steps.
inline EnergyRecord run(CollisionIntegrator& integrator, int steps) {
  const double start = integrator.energy();
  EnergyRecord record;
  for (int i = 0; i < steps; ++i) {
    integrator.step();
    record.last_change = std::abs(integrator.energy() / start - 1);
    record.largest_change = std::max(record.largest_change, record.last_change);
  }
  return record;
}

/// A point above the parabola y = x^2/2 - 1/2, whose focus is the origin.
inline MechanicalSystem point_in_bowl() {
  MechanicalSystem system = unit_masses(2);
  add_gravity(system, 1);
  system.walls = {quadric_wall("bowl", {-1, 0, 0, 0}, {0, 1}, 0.5)};
  return system;
}

/// A rod of length 1 m in a vertical plane, (x, y, angle), whose ends stay above y = 0.
inline MechanicalSystem rod_on_floor() {
  MechanicalSystem system;
  system.mass = {1, 0, 0, 0, 1, 0, 0, 0, 1.0 / 12};
  add_gravity(system, 1);
  for (const double end : {0.5, -0.5})
    system.walls.push_back(
        plane_body_wall(end > 0 ? "right end" : "left end", {.x = end}, 0, 1, 0));
  system.momenta = {linear_momentum("p_x", {1, 0, 0})};
  return system;
}

/// 4 sigma of the energy after so many impacts, if their jumps g^2 h^2 (1 - 2 alpha) / 8 are independent of each other.
inline double random_walk_bound(const CollisionIntegrator& integrator, double h) {
  return 4 * kWeight * kWeight * h * h / (8 * integrator.energy()) *
         std::sqrt(static_cast<double>(integrator.totals().impacts) / 3);
}

}  // namespace scree::physics
