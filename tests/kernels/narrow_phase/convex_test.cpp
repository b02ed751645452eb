// Contacts of convex bodies by their cores, against distances and depths that are found by other means: convex searches
// along axes, alternating projections, and a search over directions.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "kernels/narrow_phase/pairs/box_cylinder.h"
#include "kernels/narrow_phase/pairs/capsule_box.h"
#include "kernels/narrow_phase/pairs/capsule_cylinder.h"
#include "kernels/narrow_phase/pairs/cylinder_cylinder.h"
#include "kernels/narrow_phase/pairs/cylinder_half_space.h"
#include "kernels/narrow_phase/pairs/sphere_cylinder.h"
#include "kernels/narrow_phase/pairs/sphere_triangle.h"
#include "tests/kernels/narrow_phase/convex_oracle.h"

namespace scree {
namespace {

using Body = PosedBody;

template <class P>
Manifold manifold(const Body& a, const Body& b, double reach) {
  return P::manifold(a.side(), b.side(), b.center - a.center, reach, IsWithin{reach});
}

using BoxesByCores = ConvexPair<shapes::Box, shapes::Box>;

Body random_body(std::mt19937& random, double spread, bool is_capsule) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> normal;
  Body b;
  b.center = spread * Vec3d{uniform(random), uniform(random), uniform(random)};
  b.q = normalized(Quatd{normal(random), normal(random), normal(random), normal(random)});
  b.half = Vec3d{0.6, 0.6, 0.6} + 0.4 * Vec3d{uniform(random), uniform(random), uniform(random)};
  if (is_capsule) {
    b.half.x = b.half.y = 0.2 + 0.1 * uniform(random);
    b.half.z += b.half.x;
  }
  return b;
}

/// Distance of the axis of a capsule from a box: a convex function along the axis.
double distance_of_axis(const Body& capsule, const Body& box) {
  const double end = capsule.half.z - capsule.half.x;
  const auto at = [&](double s) {
    const Vec3d x = capsule.center + rotate(capsule.q, Vec3d{0, 0, s});
    return norm(x - nearest_in_box(box, x));
  };
  double low = -end, high = end;
  for (int k = 0; k < 100; ++k) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    (at(a) < at(b) ? high : low) = at(a) < at(b) ? b : a;
  }
  return at(0.5 * (low + high));
}

template <class P>
void expect_sound(const Body& a, const Body& b, const Manifold& m) {
  const Vec3d d = b.center - a.center;
  for (int k = 0; k < m.count; ++k) {
    const ContactGeometry& g = m.contact[k];
    EXPECT_NEAR(norm(g.normal), 1, 1e-12);
    EXPECT_LT(norm(d + g.arm_b - g.arm_a - g.gap * g.normal), 1e-12);
    EXPECT_LT(m.feature[k], 1u << P::kFeatureBits);
    if (k > 0) {
      EXPECT_LT(m.feature[k - 1], m.feature[k]);
    }
    const ContactGeometry again = P::contact(a.side(), b.side(), d, m.feature[k]);
    EXPECT_EQ(again.gap, g.gap) << "a feature names its contact";
    EXPECT_EQ(again.arm_a, g.arm_a);
  }
}

double least_gap(const Manifold& m) {
  double least = INFINITY;
  for (int k = 0; k < m.count; ++k) least = std::min(least, m.contact[k].gap);
  return least;
}

TEST(CapsuleBoxTest, NearestContactIsTheDistanceAndNoneIsNearer) {
  std::mt19937 random(1);
  int several = 0, apart = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    const Body a = random_body(random, 1.2, true), b = random_body(random, 1.2, false);
    const double axis = distance_of_axis(a, b);
    if (axis < 1e-3) continue;
    ++apart;
    const double gap = axis - a.half.x;
    const Manifold m = manifold<CapsuleBox>(a, b, gap + 0.05);
    ASSERT_GE(m.count, 1) << trial;
    expect_sound<CapsuleBox>(a, b, m);
    EXPECT_NEAR(least_gap(m), gap, 1e-6) << trial;
    EXPECT_EQ(manifold<CapsuleBox>(a, b, gap - 1e-5).count, 0) << trial;
    for (int k = 0; k < m.count; ++k) {
      const Vec3d on_box = b.center + m.contact[k].arm_b;
      EXPECT_LT(norm(on_box - nearest_in_box(b, on_box)), 1e-4) << trial;
    }
    several += m.count > 1;
  }
  EXPECT_GT(apart, 2000);
  EXPECT_GT(several, 50);
}

TEST(CapsuleBoxTest, AnAxisInsideLeavesTheShortestWay) {
  std::mt19937 random(2);
  int deep = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const Body a = random_body(random, 0.3, true), b = random_body(random, 0.5, false);
    if (distance_of_axis(a, b) > 0) continue;
    const double end = a.half.z - a.half.x;
    const std::vector<Vec3d> axis{a.center + rotate(a.q, Vec3d{0, 0, end}),
                                  a.center - rotate(a.q, Vec3d{0, 0, end})};
    const double depth = sampled_depth(axis, corners(b), random);
    if (depth < 1e-3) continue;
    ++deep;
    const Manifold m = manifold<CapsuleBox>(a, b, 0);
    ASSERT_GE(m.count, 1) << trial;
    expect_sound<CapsuleBox>(a, b, m);
    const double along = overlap_along(axis, corners(b), m.contact[0].normal);
    EXPECT_NEAR(along, depth, 1e-3) << trial;
    EXPECT_NEAR(least_gap(m), -along - a.half.x, 1e-3) << trial;
  }
  EXPECT_GT(deep, 100);
}

TEST(CapsuleBoxTest, OneThatLiesOnAFaceHasTwoContactsWithinIt) {
  const Quatd along_x = exp_map(Vec3d{0, 0.5 * 3.14159265358979, 0});
  const Body box{{}, {}, {1, 1, 0.5}};
  for (const double gap : {1e-3, 0.0, -1e-3}) {
    const Manifold m =
        manifold<CapsuleBox>({{0.6, 0.2, 0.7 + gap}, along_x, {0.2, 0.2, 1}}, box, 0.01);
    ASSERT_EQ(m.count, 2);
    double low = INFINITY, high = -INFINITY;
    for (int k = 0; k < 2; ++k) {
      EXPECT_NEAR(m.contact[k].gap, gap, 1e-12);
      EXPECT_NEAR(m.contact[k].normal.z, -1, 1e-12);
      low = std::min(low, m.contact[k].arm_b.x), high = std::max(high, m.contact[k].arm_b.x);
    }
    EXPECT_NEAR(low, -0.2, 1e-12) << "an end of its axis";
    EXPECT_NEAR(high, 1, 1e-12) << "an edge of the box";
  }
}

TEST(CapsuleBoxTest, OneAlongAnEdgeHasTwoContacts) {
  const Body box{{}, {}, {1, 1, 1}};
  const double side = 1 + 0.3 / std::sqrt(2.0);
  const Quatd along_y = exp_map(Vec3d{-0.5 * 3.14159265358979, 0, 0});
  const Manifold m = manifold<CapsuleBox>({{side, 0.4, side}, along_y, {0.2, 0.2, 1}}, box, 0.2);
  ASSERT_EQ(m.count, 2);
  for (int k = 0; k < 2; ++k) EXPECT_NEAR(m.contact[k].gap, 0.1, 1e-9);
  EXPECT_NEAR(std::abs(m.contact[0].arm_b.y - m.contact[1].arm_b.y), 1.4, 1e-9);
}

// The closed form of two boxes, which has tests of its own, and cores must agree.
TEST(ConvexCoresTest, BoxesAreAsFarApartAsByTheirClosedForm) {
  std::mt19937 random(3);
  int apart = 0, deep = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const Body a = random_body(random, 0.5, false), b = random_body(random, 2, false);
    Vec3d x = a.center, y;
    for (int k = 0; k < 3000; ++k) {
      y = nearest_in_box(b, x);
      x = nearest_in_box(a, y);
    }
    const double distance = norm(y - x);
    const ConvexCore first = core_of<shapes::Box>(a.side(), a.center);
    const ConvexCore second = core_of<shapes::Box>(b.side(), b.center);
    const CoreDistance found = core_distance(first, second, 1e300);
    if (distance > 3e-2) {  // the projections end near it
      ++apart;
      EXPECT_TRUE(found.is_apart);
      EXPECT_NEAR(found.separation, distance, 1e-3) << trial;
      EXPECT_LE(found.separation, distance + 1e-9) << trial << ": projections come from above";
      EXPECT_NEAR(overlap_along(corners(a), corners(b), found.normal), -found.separation, 1e-9);
      continue;
    }
    if (found.is_apart) continue;
    ++deep;
    const BoxPair pair{{BoxAxes(a.q, a.half), BoxAxes(b.q, b.half)}, b.center - a.center};
    const box_box_parts::SeparatingAxis axis(pair, 1e300, 0, 0);
    EXPECT_NEAR(found.separation, axis.separation, 2e-4) << trial;
    EXPECT_NEAR(overlap_along(corners(a), corners(b), found.normal), -found.separation, 1e-9);
    const Manifold m = manifold<BoxesByCores>(a, b, 0);
    ASSERT_GE(m.count, 1);
    expect_sound<BoxesByCores>(a, b, m);
    EXPECT_NEAR(least_gap(m), axis.separation, 1e-3) << trial;
  }
  EXPECT_GT(apart, 500);
  EXPECT_GT(deep, 300);
}

TEST(ConvexCoresTest, BoxesOnEachOtherHaveTheCornersOfTheCommonRectangle) {
  const Body low{{}, {}, {0.5, 0.5, 0.5}};
  for (const double gap : {1e-3, 0.0, -1e-3}) {
    const Manifold m =
        manifold<BoxesByCores>(low, {{0.3, 0.2, 1 + gap}, {}, {0.5, 0.5, 0.5}}, 0.01);
    ASSERT_EQ(m.count, 4) << gap;
    double x = 0, y = 0;
    for (int k = 0; k < 4; ++k) {
      EXPECT_NEAR(m.contact[k].gap, gap, 1e-12);
      EXPECT_NEAR(m.contact[k].normal.z, 1, 1e-12);
      x += m.contact[k].arm_a.x / 4, y += m.contact[k].arm_a.y / 4;
    }
    EXPECT_NEAR(x, 0.15, 1e-12);
    EXPECT_NEAR(y, 0.1, 1e-12);
  }
}

TEST(ConvexCoresTest, BoxesAreAsFarFromTrianglesAsByProjections) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  int apart = 0, deep = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Body a = random_body(random, 0.5, false);
    const auto any = [&] { return Vec3d{normal(random), normal(random), normal(random)}; };
    const Vec3d p[3] = {1.2 * any(), 1.2 * any(), 1.2 * any()};
    const ConvexCore box = core_of<shapes::Box>(a.side(), a.center);
    const ConvexCore triangle =
        ConvexCore::triangle(p[0], p[1], p[2], normalized(cross(p[1] - p[0], p[2] - p[0])));
    Vec3d x = a.center, y;
    for (int k = 0; k < 3000; ++k) {
      y = closest_on_triangle(x, p[0], p[1], p[2]).point;
      x = nearest_in_box(a, y);
    }
    const CoreDistance found = core_distance(box, triangle, 1e300);
    const std::vector<Vec3d> points{p[0], p[1], p[2]};
    EXPECT_NEAR(overlap_along(corners(a), points, found.normal), -found.separation, 1e-9);
    if (norm(y - x) > 3e-2) {  // the projections end near it
      ++apart;
      EXPECT_NEAR(found.separation, norm(y - x), 1e-3) << trial;
      EXPECT_LE(found.separation, norm(y - x) + 1e-9) << trial;
    } else if (!found.is_apart && norm(y - x) < 1e-9 && deep < 150) {
      ++deep;
      EXPECT_NEAR(-found.separation, sampled_depth(corners(a), points, random), 1e-3) << trial;
    }
  }
  EXPECT_GT(apart, 300);
  EXPECT_GT(deep, 100);
}

/// Points of a cylinder: of both rims, dense enough that a line between two is as good as the arc.
std::vector<Vec3d> rims(const Body& c, int around) {
  std::vector<Vec3d> out;
  for (int k = 0; k < around; ++k) {
    const double angle = 2 * 3.14159265358979323846 * k / around;
    for (const double z : {-c.half.z, c.half.z})
      out.push_back(c.center +
                    rotate(c.q, Vec3d{c.half.x * std::cos(angle), c.half.x * std::sin(angle), z}));
  }
  return out;
}

Body random_cylinder(std::mt19937& random, double spread) {
  Body c = random_body(random, spread, true);
  c.half.z = 0.2 + 2 * c.half.x * (c.half.z - 0.2);
  return c;
}

/// Projections to and fro between a cylinder and what `nearest` gives end at the distance, from above.
template <class Nearest>
double projected_distance(const Body& c, Vec3d x, Nearest nearest) {
  Vec3d y;
  for (int k = 0; k < 2000; ++k) {
    y = c.center + rotate(c.q, shapes::Cylinder::nearest(c.half, rotate_back(c.q, x - c.center)));
    x = nearest(y);
  }
  return norm(y - x);
}

/// Distance and depth of all that meets cylinders.
template <class P, class Core, class Nearest, class Points>
void expect_meets_cylinder(unsigned seed, Core other_body, Nearest nearest, Points points,
                           double other_rounding_share) {
  std::mt19937 random(seed);
  int apart = 0, deep = 0;
  for (int trial = 0; trial < 350; ++trial) {
    const Body a = other_body(random), c = random_cylinder(random, 0.8);
    const double rounding = other_rounding_share * a.half.x;
    const auto onto = [&](const Vec3d& y) { return nearest(a, y); };
    const double distance = projected_distance(c, a.center, onto);
    if (distance > 3e-2) {
      ++apart;
      const Manifold m = manifold<P>(a, c, distance - rounding + 0.02);
      ASSERT_GE(m.count, 1) << trial;
      expect_sound<P>(a, c, m);
      EXPECT_NEAR(least_gap(m), distance - rounding, 2e-3) << trial;
      EXPECT_EQ(manifold<P>(a, c, distance - rounding - 2e-3).count, 0) << trial;
    } else if (distance < 1e-9 && deep < 100) {
      const std::vector<Vec3d> on_a = points(a), on_c = rims(c, 128);
      const double depth = sampled_depth(on_a, on_c, random);
      if (depth < 1e-2) continue;
      ++deep;
      const Manifold m = manifold<P>(a, c, 0);
      ASSERT_GE(m.count, 1) << trial;
      expect_sound<P>(a, c, m);
      const double along = overlap_along(on_a, on_c, m.contact[0].normal);
      EXPECT_NEAR(along, depth, 0.02 * depth + 2e-3) << trial;
    }
  }
  EXPECT_GT(apart, 80);
  EXPECT_GT(deep, 10);
}

TEST(CylindersTest, MeetBoxesAtTheirDistanceAndDepth) {
  expect_meets_cylinder<BoxCylinder>(
      11, [](std::mt19937& r) { return random_body(r, 0.8, false); }, nearest_in_box, corners, 0);
}

TEST(CylindersTest, MeetCapsulesAtTheirDistanceAndDepth) {
  const auto ends = [](const Body& a) {
    const Vec3d end = rotate(a.q, Vec3d{0, 0, a.half.z - a.half.x});
    return std::vector<Vec3d>{a.center + end, a.center - end};
  };
  const auto on_axis = [](const Body& a, const Vec3d& x) {
    const double end = a.half.z - a.half.x, z = rotate_back(a.q, x - a.center).z;
    return a.center + rotate(a.q, Vec3d{0, 0, std::clamp(z, -end, end)});
  };
  expect_meets_cylinder<CapsuleCylinder>(
      12, [](std::mt19937& r) { return random_body(r, 0.6, true); }, on_axis, ends, 1);
}

/// Points of a rim lie so near each other that four of them make a tetrahedron of nothing but rounding: the origin is not
/// inside of it. A pair of a pile, and its neighborhood.
TEST(CylindersTest, ACapsuleAtARimIsNotTakenForOneInside) {
  std::mt19937 random(14);
  std::normal_distribution<double> normal(0, 1e-6);
  const auto near = [&](const Quatd& q) {
    return normalized(Quatd{q.w + normal(random), q.x + normal(random), q.y + normal(random),
                            q.z + normal(random)});
  };
  for (int trial = 0; trial < 5000; ++trial) {
    Body a, c;
    a.half = {0.0170933, 0.0170933, 0.0408341};
    a.q = near({0.465864, -0.5536722, 0.63479716, -0.27101737});
    c.half = {0.0233159, 0.0233159, 0.0317945};
    c.q = near({-0.34623772, 0.2694514, 0.42868426, -0.78977555});
    c.center = {0.0136867, 0.0457102, -0.0395083};
    const auto distance = [&](double s) {
      const Vec3d x = rotate_back(c.q, rotate(a.q, Vec3d{0, 0, s}) - c.center);
      return norm(x - shapes::Cylinder::nearest(c.half, x));
    };
    double low = a.half.x - a.half.z, high = -low;
    for (int k = 0; k < 100; ++k) {
      const double s = low + (high - low) / 3, t = high - (high - low) / 3;
      (distance(s) < distance(t) ? high : low) = distance(s) < distance(t) ? t : s;
    }
    const Manifold m = manifold<CapsuleCylinder>(a, c, 1e-3);
    ASSERT_EQ(m.count, 1) << trial;
    ASSERT_NEAR(m.contact[0].gap, distance(low) - a.half.x, 1e-8) << trial;
  }
}

TEST(CylindersTest, MeetEachOtherAtTheirDistanceAndDepth) {
  const auto onto = [](const Body& a, const Vec3d& x) {
    return a.center +
           rotate(a.q, shapes::Cylinder::nearest(a.half, rotate_back(a.q, x - a.center)));
  };
  expect_meets_cylinder<CylinderCylinder>(
      13, [](std::mt19937& r) { return random_cylinder(r, 0.6); }, onto,
      [](const Body& a) { return rims(a, 128); }, 0);
}

TEST(CylindersTest, OneOnABoxStandsOnFourPointsOfItsRimAndLiesOnTwo) {
  const Body box{{}, {}, {1, 1, 0.5}};
  for (const double gap : {1e-3, 0.0, -1e-3}) {
    const Body standing{{0.2, 0.1, 0.8 + gap}, {}, {0.2, 0.2, 0.3}};
    const Manifold on_end = manifold<BoxCylinder>(box, standing, 0.01);
    ASSERT_EQ(on_end.count, 4) << gap;
    for (int k = 0; k < 4; ++k) {
      EXPECT_NEAR(on_end.contact[k].gap, gap, 1e-12);
      const Vec3d x = on_end.contact[k].arm_b;
      EXPECT_NEAR(std::sqrt(x.x * x.x + x.y * x.y), 0.2, 1e-12);
    }
    const Quatd along_x = exp_map(Vec3d{0, 0.5 * 3.14159265358979323846, 0});
    const Body lying{{0.2, 0.1, 0.7 + gap}, along_x, {0.2, 0.2, 0.3}};
    const Manifold on_side = manifold<BoxCylinder>(box, lying, 0.01);
    ASSERT_EQ(on_side.count, 2) << gap;
    for (int k = 0; k < 2; ++k) {
      EXPECT_NEAR(on_side.contact[k].gap, gap, 1e-12);
      EXPECT_NEAR(std::abs(on_side.contact[k].arm_b.x), 0.3, 1e-12);
    }
  }
}

TEST(CylindersTest, SpheresAreAsFarAsTheNearestPoint) {
  std::mt19937 random(14);
  for (int trial = 0; trial < 500; ++trial) {
    const Body c = random_cylinder(random, 1), s = random_body(random, 1, false);
    const Vec3d d = c.center - s.center;
    const ContactGeometry g = SphereCylinder::contact(ball(0.1), c.side(), d, 0);
    EXPECT_LT(norm(d + g.arm_b - g.arm_a - g.gap * g.normal), 1e-12);
    // Over points of its surface: lines of both ends and of the round side.
    double least = INFINITY;
    for (int k = 0; k < 200; ++k) {
      const double angle = 2 * 3.14159265358979323846 * k / 200;
      for (int j = 0; j <= 60; ++j) {
        const double part = j / 60.0;
        const Vec3d out{c.half.x * std::cos(angle), c.half.x * std::sin(angle), 0};
        const Vec3d on_side = out + Vec3d{0, 0, (2 * part - 1) * c.half.z};
        for (const Vec3d& local :
             {on_side, part * out + Vec3d{0, 0, c.half.z}, part * out - Vec3d{0, 0, c.half.z}})
          least = std::min(least, norm(c.center + rotate(c.q, local) - s.center));
      }
    }
    EXPECT_NEAR(std::abs(g.gap + 0.1), least, 0.02) << trial;
  }
}

TEST(CylindersTest, LowestPointsOfTheRimsAreContactsOnAPlane) {
  std::mt19937 random(15);
  const Vec3d normal = normalized(Vec3d{0.2, 0.1, 1});
  for (int trial = 0; trial < 200; ++trial) {
    const Body c = random_cylinder(random, 1);
    double lowest = INFINITY, least = INFINITY;
    for (const Vec3d& x : rims(c, 4000)) lowest = std::min(lowest, dot(x, normal));
    for (int corner = 0; corner < CylinderHalfSpace::kCorners; ++corner) {
      const ContactGeometry g =
          CylinderHalfSpace::contact(c.side(), dot(c.center, normal), normal, -c.center, corner);
      EXPECT_LT(norm(-c.center + g.arm_b - g.arm_a - g.gap * g.normal), 1e-12);
      const Vec3d local = rotate_back(c.q, g.arm_a);
      EXPECT_NEAR(std::sqrt(local.x * local.x + local.y * local.y), c.half.x, 1e-12);
      EXPECT_NEAR(std::abs(local.z), c.half.z, 1e-12);
      EXPECT_NEAR(g.gap, dot(c.center + g.arm_a, normal), 1e-12);
      least = std::min(least, g.gap);
    }
    EXPECT_NEAR(least, lowest, 1e-6) << trial;
  }
}

}  // namespace
}  // namespace scree
