// The collision integrator on a rigid star of five arms in a box, with a peg that comes into its notches.

#include <gtest/gtest.h>

#include <numbers>

#include "tests/physics/collision_systems.h"

namespace scree::physics {
namespace {

using Place = std::array<double, 2>;

constexpr double kTip = 0.3, kNotch = 0.12;  // radii [m]
constexpr double kMostDistance = 1.5;        // of the peg from the center of the star [m]

Place corner(int k) {  // tips are even
  const double angle = std::numbers::pi * k / 5, r = k % 2 == 0 ? kTip : kNotch;
  return {r * std::cos(angle), r * std::sin(angle)};
}

/// How far a peg at the origin is to the outside of the line from a to b of a body, which leaves the body at its left.
WallFunction peg_beside(Place a, Place b) {
  const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
  const double nx = (b[1] - a[1]) / length, ny = -(b[0] - a[0]) / length;
  const double offset = nx * a[0] + ny * a[1];
  WallFunction out;
  out.value = [=](std::span<const double> q) {  // n.R(-angle)(-x) - offset
    const double c = std::cos(q[2]), s = std::sin(q[2]);
    return -nx * (c * q[0] + s * q[1]) - ny * (-s * q[0] + c * q[1]) - offset;
  };
  out.gradient = [=](std::span<const double> q, std::span<double> gradient) {
    const double c = std::cos(q[2]), s = std::sin(q[2]);
    gradient[0] = -nx * c + ny * s;
    gradient[1] = -nx * s - ny * c;
    gradient[2] = -nx * (-s * q[0] + c * q[1]) + ny * (c * q[0] + s * q[1]);
  };
  out.curvature = {1, 1, 1 + kMostDistance};
  return out;
}

/// The peg stays outside of an arm. Beyond the notches the arm is longer than it looks: its base lies within the star, where
/// no peg comes, so at a notch one side of each arm is met.
Wall peg_outside_arm(int arm) {
  const Place tip = corner(2 * arm), right = corner(2 * arm + 9), left = corner(2 * arm + 1);
  const auto beyond = [&](Place notch) {
    return Place{tip[0] + 1.3 * (notch[0] - tip[0]), tip[1] + 1.3 * (notch[1] - tip[1])};
  };
  Wall wall;
  wall.name = "arm " + std::to_string(arm);
  wall.parts = {peg_beside(beyond(right), tip), peg_beside(tip, beyond(left)),
                peg_beside(beyond(left), beyond(right))};
  return wall;
}

/// In the box |x|, |y| <= 1 with the peg at the origin.
MechanicalSystem star_in_box() {
  MechanicalSystem system;
  system.mass = {1, 0, 0, 0, 1, 0, 0, 0, 0.02};
  for (int arm = 0; arm < 5; ++arm) {
    const Place tip = corner(2 * arm);
    const PlaneBodyPoint point{.x = tip[0], .y = tip[1]};
    for (const auto& [x, y] : {Place{1, 0}, Place{-1, 0}, Place{0, 1}, Place{0, -1}})
      system.walls.push_back(plane_body_wall("side", point, x, y, -1));
  }
  for (int arm = 0; arm < 5; ++arm) system.walls.push_back(peg_outside_arm(arm));
  system.momenta = {
      linear_momentum("p_x", {1, 0, 0}),
      linear_momentum("p_y", {0, 1, 0}),
      // Turning about the peg moves the star and its angle: (x, y, angle)' = (-y, x, 1).
      {"about the peg", [](std::span<const double> q, std::span<const double> p) {
         return q[0] * p[1] - q[1] * p[0] + p[2];
       }}};
  return system;
}

CollisionIntegrator thrown_star(MechanicalSystem system, double h, double x = 0.5) {
  return {std::move(system), {.step = h}, {x, 0.4, 0.2}, {0.7, -0.9, 1.3}};
}

TEST(CollisionStar, B09_EnergyAndMomentaWithoutForces) {
  CollisionIntegrator star = thrown_star(star_in_box(), 0.02);
  const double energy = star.energy();
  int at_peg = 0, at_sides = 0;
  double largest = 0;
  for (int i = 0; i < 200000; ++i) {
    const std::vector<double> before = star.momentum(), momenta = star.momenta();
    star.step();
    const double change = std::abs(star.energy() / energy - 1);
    largest = std::max(largest, change);
    ASSERT_LE(change, 1e-10) << i;
    if (star.impacts().empty()) {
      ASSERT_EQ(star.momentum(), before);
      continue;
    }
    bool peg_only = true, sides_keep[2] = {true, true};
    for (const Impact& impact : star.impacts())
      for (const ActivePart& part : impact.parts) {
        peg_only &= part.wall >= 20;
        sides_keep[0] &= part.wall < 20 && part.wall % 4 >= 2;
        sides_keep[1] &= part.wall < 20 && part.wall % 4 < 2;
      }
    at_peg += peg_only;
    at_sides += sides_keep[0] || sides_keep[1];
    for (std::size_t axis = 0; axis < 2; ++axis)
      if (sides_keep[axis]) {
        ASSERT_NEAR(star.momenta()[axis], momenta[axis], 1e-13);
      }
    if (peg_only) {
      ASSERT_NEAR(star.momenta()[2], momenta[2], 1e-12);
    }
  }
  report("largest", largest);
  report("impacts", static_cast<double>(star.totals().impacts));
  report("closest_point_error", star.totals().largest_closest_point_error);
  EXPECT_GT(at_peg, 100);
  EXPECT_GT(at_sides, 1000);
  EXPECT_GE(star.totals().smallest_gap, -1e-12);
  EXPECT_LE(star.totals().largest_closest_point_error, 1e-12);
  EXPECT_EQ(star.totals().grazing_impacts, 0);
}

TEST(CollisionStar, B09_EnergyUnderGravity) {
  double coarse = 0;
  for (const double h : {0.01, 0.005, 0.0025}) {
    double mean = 0;
    std::int64_t impacts = 0, grazing = 0;
    for (int start = 0; start < 5; ++start) {
      MechanicalSystem system = star_in_box();
      add_gravity(system, 1);
      const auto potential = system.potential;
      system.potential = [potential](std::span<const double> q) {
        return potential(q) + 2 * kWeight;  // so that the energy is not near zero
      };
      CollisionIntegrator star = thrown_star(std::move(system), h, 0.5 + 0.02 * start);
      const double largest = run(star, 20000).largest_change;
      EXPECT_LE(largest, 1.5 * random_walk_bound(star, h));
      EXPECT_GE(star.totals().smallest_gap, -1e-12);
      impacts += star.totals().impacts;
      grazing += star.totals().grazing_impacts;
      mean += largest / 5;
    }
    report("mean_" + std::to_string(std::lround(h * 10000)) + "e-4", mean);
    if (coarse > 0) {
      EXPECT_GE(coarse / mean, 2) << h;
    }
    coarse = mean;
    EXPECT_LT(static_cast<double>(grazing), 1e-3 * static_cast<double>(impacts)) << h;
  }
}

// The star comes down with a notch on the peg: both sides are met at once, and it goes back as it came.
TEST(CollisionStar, NotchOnThePeg) {
  MechanicalSystem system = star_in_box();
  const double angle =
      -0.5 * std::numbers::pi - std::numbers::pi / 5;  // the first notch looks down
  CollisionIntegrator star(std::move(system), {.step = 0.5}, {0, 0.4, angle}, {0, -1, 0});
  star.step();
  ASSERT_EQ(star.impacts().size(), 1);
  EXPECT_EQ(star.impacts().front().parts.size(), 2);
  EXPECT_NEAR(star.velocity()[0], 0, 1e-12);
  EXPECT_NEAR(star.velocity()[1], 1, 1e-12);
  EXPECT_NEAR(star.velocity()[2], 0, 1e-12);
  EXPECT_NEAR(star.position()[1], kNotch + 0.5 - (0.4 - kNotch), 1e-12);
  EXPECT_LE(star.impacts().front().closest_point_error, 1e-12);
}

}  // namespace
}  // namespace scree::physics
