// The collision integrator without forces: billiards, corners of both kinds, wedges, tangents.

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "tests/physics/collision_systems.h"

namespace scree::physics {
namespace {

using Point = std::array<double, 2>;

/// A point of unit mass in the plane.
CollisionIntegrator shot(std::vector<Wall> walls, double h, Point q, Point v) {
  MechanicalSystem system = unit_masses(2);
  system.walls = std::move(walls);
  return {std::move(system), {.step = h}, {q[0], q[1]}, {v[0], v[1]}};
}

void expect_state(const CollisionIntegrator& integrator, Point q, Point v, double tolerance) {
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(integrator.position()[i], q[i], tolerance);
    EXPECT_NEAR(integrator.velocity()[i], v[i], tolerance);
  }
}

Wall third_quadrant() { return convex_obstacle("quadrant", {{{1, 0}, 0}, {{0, 1}, 0}}); }

std::vector<Wall> unit_box() {
  return {half_space_wall("left", {{1, 0}, 0}), half_space_wall("below", {{0, 1}, 0}),
          half_space_wall("right", {{-1, 0}, -1}), half_space_wall("above", {{0, -1}, -1})};
}

/// x^2/4 + y^2 <= 1
Wall ellipse() { return quadric_wall("ellipse", {-0.5, 0, 0, -2}, {0, 0}, 1); }

// The product of the angular momenta about the foci is kept, as is the speed.
TEST(CollisionBilliard, B05_InvariantsOfTheEllipse) {
  CollisionIntegrator point = shot({ellipse()}, 0.05, {0.3, 0.2}, {0.8, 0.6});
  const auto invariant = [&] {
    const double x = point.position()[0], y = point.position()[1];
    const double u = point.velocity()[0], v = point.velocity()[1], focus = std::sqrt(3);
    return ((x - focus) * v - y * u) * ((x + focus) * v - y * u);
  };
  const double start = invariant();
  EXPECT_NEAR(start, -1.0796, 1e-12);
  double speed_error = 0, invariant_error = 0;
  for (int i = 0; i < 1000000; ++i) {
    point.step();
    speed_error =
        std::max(speed_error, std::abs(std::hypot(point.velocity()[0], point.velocity()[1]) - 1));
    invariant_error = std::max(invariant_error, std::abs(invariant() / start - 1));
  }
  report("speed_error", speed_error);
  report("invariant_error", invariant_error);
  report("closest_point_error", point.totals().largest_closest_point_error);
  EXPECT_LE(speed_error, 1e-10);
  EXPECT_LE(invariant_error, 1e-10);
  EXPECT_NEAR(static_cast<double>(point.totals().impacts), 23989, 2);
  EXPECT_EQ(point.totals().grazing_impacts, 0);
  EXPECT_LE(point.totals().largest_closest_point_error, 1e-12);
  EXPECT_GE(point.totals().smallest_gap, -1e-12);
}

// The same wall without its bound of curvature is followed by samples.
TEST(CollisionBilliard, SampledWallsFindTheSameImpacts) {
  Wall sampled = ellipse();
  sampled.parts[0].curvature.clear();
  CollisionIntegrator a = shot({ellipse()}, 0.05, {0.3, 0.2}, {0.8, 0.6});
  CollisionIntegrator b = shot({sampled}, 0.05, {0.3, 0.2}, {0.8, 0.6});
  for (int i = 0; i < 20000; ++i) {
    a.step();
    b.step();
  }
  EXPECT_EQ(a.totals().impacts, b.totals().impacts);
  expect_state(b, {a.position()[0], a.position()[1]}, {a.velocity()[0], a.velocity()[1]}, 1e-9);
}

TEST(CollisionBilliard, B06_ReentrantCorner) {
  const std::array<std::array<Point, 4>, 3> cases = {
      {{{{.3, .3}, {-1, -1}, {.2, .2}, {1, 1}}},
       {{{.2, .05}, {-1, -.25}, {.3, .075}, {1, .25}}},
       {{{-.5, .4}, {.3, -1}, {-.35, .1}, {.3, 1}}}}};
  double largest_error = 0;
  for (const auto& [q, v, q_after, v_after] : cases) {
    CollisionIntegrator point = shot({third_quadrant()}, 0.5, q, v);
    point.step();
    expect_state(point, q_after, v_after, 1e-12);
    for (std::size_t i = 0; i < 2; ++i)
      largest_error = std::max(largest_error, std::abs(point.position()[i] - q_after[i]));
  }
  report("error", largest_error);
}

// Random shots at the obstacle, some at its corner and some past it, against the geometry: what is hit, where the point is then,
// and that the impact is the closest point of the obstacle to the chord.
TEST(CollisionBilliard, B06_ClosestPointOnRandomShots) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  const double h = 1;
  int hits = 0, cuts = 0, corners = 0;
  double largest_error = 0;
  while (hits < 2000) {
    const double angle = std::numbers::pi * (1.5 * unit(random) - 0.5), range = unit(random);
    const Point q{range * std::cos(angle), range * std::sin(angle)};
    const bool at_corner = q[0] > 0 && q[1] > 0 && unit(random) < 0.3;
    const double way = 2 * unit(random), turn = 2 * std::numbers::pi * unit(random);
    const Point v = at_corner ? Point{-q[0] * (1 + way) / h, -q[1] * (1 + way) / h}
                              : Point{way * std::cos(turn), way * std::sin(turn)};
    // Times at which the lines of both faces are crossed, and what is left of the obstacle there.
    const double t_x = -q[0] / v[0], t_y = -q[1] / v[1];
    const bool hits_x = !at_corner && q[0] > 0 && t_x > 0 && t_x < h && q[1] + t_x * v[1] < 0;
    const bool hits_y = !at_corner && q[1] > 0 && t_y > 0 && t_y < h && q[0] + t_y * v[0] < 0;
    CollisionIntegrator point = shot({third_quadrant()}, h, q, v);
    point.step();
    ASSERT_EQ(point.impacts().size(), at_corner || hits_x || hits_y ? 1 : 0);
    if (point.impacts().empty()) continue;
    ++hits;
    corners += at_corner;
    const Impact& impact = point.impacts().front();
    const double t = at_corner ? h / (1 + way) : hits_x ? t_x : t_y, left = h - t;
    const Point end{q[0] + h * v[0], q[1] + h * v[1]};
    cuts += std::max(end[0], end[1]) > 0;  // a test of the end point alone misses it
    EXPECT_NEAR(impact.time, t, 1e-12);
    Point after = v;
    if (at_corner || hits_x) after[0] = -v[0];
    if (at_corner || hits_y) after[1] = -v[1];
    const Point place{q[0] + t * v[0], q[1] + t * v[1]};
    expect_state(point, {place[0] + left * after[0], place[1] + left * after[1]}, after, 1e-12);
    for (std::size_t i = 0; i < 2; ++i) {
      const double chord = (1 - t / h) * q[i] + t / h * point.position()[i];
      const double error = std::abs(impact.position[i] - std::min(chord, 0.0));
      EXPECT_LE(error, 1e-12);
      largest_error = std::max(largest_error, error);
    }
    EXPECT_LE(impact.closest_point_error, 1e-12);
  }
  report("closest_point_error", largest_error);
  report("cuts", cuts);
  report("impacts", hits);
  EXPECT_GT(cuts, 100);
  EXPECT_GT(corners, 100);
}

TEST(CollisionBilliard, B07_ConvexCornerTurnsBack) {
  double largest_error = 0;
  for (const Point& corner : {Point{0, 0}, Point{1, 0}, Point{0, 1}, Point{1, 1}}) {
    const Point q{0.7, 0.6}, v{(corner[0] - q[0]) * 3, (corner[1] - q[1]) * 3};
    CollisionIntegrator point = shot(unit_box(), 0.5, q, v);
    point.step();
    ASSERT_EQ(point.impacts().size(), 1);
    const Impact& impact = point.impacts().front();
    EXPECT_EQ(impact.parts.size(), 2);
    const double left = 0.5 - 1.0 / 3;
    expect_state(point, {corner[0] - left * v[0], corner[1] - left * v[1]}, {-v[0], -v[1]}, 1e-12);
    for (std::size_t i = 0; i < 2; ++i)
      largest_error = std::max(largest_error, std::abs(point.velocity()[i] + v[i]));
    EXPECT_NEAR(point.energy(), 0.5 * (v[0] * v[0] + v[1] * v[1]), 1e-12);
    EXPECT_LE(impact.closest_point_error, 1e-12);
  }
  report("error", largest_error);
}

// In a wedge of less than a quarter turn several impacts follow each other in one step. Unfolding the wedge makes
// the way straight: angles about its edge are folded back.
TEST(CollisionBilliard, WedgeAgainstItsUnfolding) {
  for (const double degrees : {11.0, 20.0, 37.0, 45.0, 77.0, 90.0}) {
    const double wedge = degrees * std::numbers::pi / 180;
    const std::vector<Wall> walls = {
        half_space_wall("lower", {{0, 1}, 0}),
        half_space_wall("upper", {{std::sin(wedge), -std::cos(wedge)}, 0})};
    for (const double aim : {-0.1, -0.3, 0.05, 0.21}) {
      const double start = 0.4 * wedge, direction = start + std::numbers::pi + aim;
      const Point q{std::cos(start), std::sin(start)};
      const Point v{3 * std::cos(direction), 3 * std::sin(direction)};
      CollisionIntegrator point = shot(walls, 1, q, v);
      point.step();
      double angle = std::atan2(q[1] + v[1], q[0] + v[0]);
      if (aim < 0 && angle < 0) angle += 2 * std::numbers::pi;  // it passes the edge on this side
      if (aim > 0 && angle > wedge) angle -= 2 * std::numbers::pi;
      const double range = std::hypot(q[0] + v[0], q[1] + v[1]);
      double folded = std::abs(std::remainder(angle, 2 * wedge));
      EXPECT_EQ(static_cast<double>(point.impacts().size()), std::abs(std::floor(angle / wedge)));
      EXPECT_NEAR(point.position()[0], range * std::cos(folded), 1e-12) << degrees << ' ' << aim;
      EXPECT_NEAR(point.position()[1], range * std::sin(folded), 1e-12) << degrees << ' ' << aim;
      EXPECT_LE(point.totals().largest_closest_point_error, 1e-12);
    }
  }
}

TEST(CollisionBilliard, TooManyImpactsAreReported) {
  const double wedge = 0.01;
  CollisionIntegrator point =
      shot({half_space_wall("lower", {{0, 1}, 0}),
            half_space_wall("upper", {{std::sin(wedge), -std::cos(wedge)}, 0})},
           1, {1, 0.004}, {-3, 0.1});
  try {
    point.step();
    FAIL() << "a wedge of 314 impacts";
  } catch (const TooManyImpacts& error) {
    EXPECT_NE(std::string(error.what()).find("more than 50 impacts"), std::string::npos);
  }
  EXPECT_EQ(point.time(), 0);
}

// Past a disk, nearer and nearer to its tangent: hit or missed by a billionth of its radius.
TEST(CollisionBilliard, TangentsOfADisk) {
  const Wall disk = quadric_wall("disk", {2, 0, 0, 2}, {0, 0}, -1);  // x^2 + y^2 >= 1
  for (const double miss : {1e-2, 1e-5, 1e-9, -1e-9, -1e-5, -1e-2}) {
    const double y = 1 + miss;
    CollisionIntegrator point = shot({disk}, 10, {-5, y}, {1, 0});
    point.step();
    if (miss > 0) {
      EXPECT_EQ(point.impacts().size(), 0) << miss;
      expect_state(point, {5, y}, {1, 0}, 1e-14);
      continue;
    }
    ASSERT_EQ(point.impacts().size(), 1) << miss;
    const double turn = 2 * std::acos(y);  // by which a disk turns a point at this distance
    EXPECT_NEAR(point.velocity()[0], std::cos(turn), 1e-7);
    EXPECT_NEAR(point.velocity()[1], std::sin(turn), 1e-7);
    EXPECT_NEAR(std::hypot(point.velocity()[0], point.velocity()[1]), 1, 1e-14);
  }
}

// A point slides along a wall that nothing presses it to.
TEST(CollisionBilliard, SlidingWithoutForcesIsNoImpact) {
  CollisionIntegrator point = shot(unit_box(), 0.1, {0.1, 0}, {1, 0});
  for (int i = 0; i < 5; ++i) point.step();
  expect_state(point, {0.6, 0}, {1, 0}, 1e-14);
  EXPECT_EQ(point.totals().impacts, 0);
}

}  // namespace
}  // namespace scree::physics
