#pragma once
// Closed forms of the narrow phase, case by case and against sampling.

#include <cmath>
#include <random>

#include "kernels/narrow_phase/pairs/box_half_space.h"
#include "kernels/narrow_phase/pairs/sphere_box.h"
#include "kernels/narrow_phase/pairs/sphere_half_space.h"
#include "kernels/narrow_phase/pairs/sphere_sphere.h"
#include "kernels/narrow_phase/pairs/sphere_triangle.h"
#include "tests/backend_fixture.h"

namespace scree {
namespace {

constexpr double kRounding = 1e-13;

void expect_near(const Vec3d& a, const Vec3d& b, double tolerance = kRounding) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

/// The two contact points lie `gap` apart along the normal.
void expect_consistent(const ContactGeometry& g, const Vec3d& d) {
  EXPECT_NEAR(norm(g.normal), 1, kRounding);
  expect_near(d + g.arm_b - g.arm_a, g.gap * g.normal, 1e-12);
}

const Quatd kTurned = exp_map(Vec3d{0.3, -1.1, 0.8});

TEST(SphereSphereTest, GapNormalAndArms) {
  const Vec3d d{0, 3, 4};
  const ContactGeometry g = sphere_sphere(d, 1, 2.5);
  EXPECT_NEAR(g.gap, 1.5, kRounding);
  expect_near(g.normal, {0, 0.6, 0.8});
  expect_consistent(g, d);
}

TEST(SphereSphereTest, CoincidingCentersStillHaveANormal) {
  const ContactGeometry g = sphere_sphere({0, 0, 0}, 1, 2);
  EXPECT_EQ(g.gap, -3);
  EXPECT_EQ(norm(g.normal), 1);
}

TEST(SphereSphereTest, WhatMissesHasThePlaneOfItsNearestPass) {
  const auto met = [](const Vec3d& d, const Vec3d& way) {
    return spheres_on_way(sphere_sphere(d, 0.5, 0.5), d, way, 0.5, 0.5);
  };
  const auto same = [](const ContactGeometry& a, const ContactGeometry& b) {
    EXPECT_EQ(a.normal, b.normal);
    EXPECT_EQ(a.gap, b.gap);
    EXPECT_EQ(a.arm_a, b.arm_a);
    EXPECT_EQ(a.arm_b, b.arm_b);
  };
  // A miss: where they pass, or where the step ends.
  expect_near(met({0.15, 1.015, 0}, {-0.2, 0, 0}).normal, {0, 1, 0});
  EXPECT_NEAR(met({0.15, 1.015, 0}, {-0.2, 0, 0}).gap, 0.015, kRounding);
  const Vec3d end = normalized(Vec3d{0.02, 1.015, 0});
  expect_near(met({0.22, 1.015, 0}, {-0.2, 0, 0}).normal, end);
  // As at the start: hits, overlap, short ways, ways that do not cut the plane,
  // ways that lead apart.
  const std::vector<std::pair<Vec3d, Vec3d>> unchanged{{{1.3, 0.6, 0}, {-1, 0, 0}},
                                                       {{0.7, 0.6, 0}, {-1, 0, 0}},
                                                       {{0.81, 0.6, 0}, {-0.015, 0, 0}},
                                                       {{1.3, 0.6, 0}, {-0.2, 0, 0}},
                                                       {{1.3, 0.6, 0}, {1, 1, 0}}};
  for (const auto& [d, way] : unchanged) same(met(d, way), sphere_sphere(d, 0.5, 0.5));
}

TEST(SphereHalfSpaceTest, NormalPointsIntoTheWall) {
  const Vec3d d{5, 5, -2};  // the wall body sits below and far to the side
  const ContactGeometry g = sphere_half_space(2, {0, 0, 1}, d, 0.5);
  EXPECT_NEAR(g.gap, 1.5, kRounding);
  expect_near(g.normal, {0, 0, -1});
  expect_consistent(g, d);
}

TEST(SphereBoxTest, FaceEdgeAndCorner) {
  const Vec3d half{1, 2, 3};
  expect_near(sphere_box({-1.5, 0.5, 0.5}, 0.2, {}, half).normal, {-1, 0, 0});
  EXPECT_NEAR(sphere_box({-1.5, 0.5, 0.5}, 0.2, {}, half).gap, 0.3, kRounding);
  EXPECT_NEAR(sphere_box({-4, -6, 0}, 1, {}, half).gap, 4, kRounding) << "edge: hypot(3, 4) - 1";
  EXPECT_NEAR(sphere_box({2, 4, 5}, 0.5, {}, half).gap, 2.5, kRounding) << "corner: 3 - 0.5";
}

TEST(SphereBoxTest, CenterInsideLeavesThroughTheNearestFace) {
  const ContactGeometry g = sphere_box({0, 0, -2.75}, 0.5, {}, {1, 2, 3});
  EXPECT_NEAR(g.gap, -0.75, kRounding);
  expect_near(g.normal, {0, 0, -1});
  const ContactGeometry center = sphere_box({0, 0, 0}, 0.5, {}, {1, 2, 3});
  EXPECT_NEAR(center.gap, -1.5, kRounding);
  EXPECT_NEAR(std::abs(center.normal.x), 1, kRounding);
}

TEST(SphereBoxTest, TurnedBoxAgreesWithSampling) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Vec3d half{0.5, 0.8, 0.3};
  for (int trial = 0; trial < 30; ++trial) {
    const Vec3d d{2 * uniform(random), 2 * uniform(random), 2 * uniform(random)};
    const ContactGeometry g = sphere_box(d, 0.25, kTurned, half);
    expect_consistent(g, d);
    if (g.gap < -0.25) continue;  // center inside
    double nearest = 1e300;
    constexpr int n = 40;
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; j <= n; ++j) {
        for (int k = 0; k <= n; ++k) {
          const Vec3d p = hadamard(half, {2.0 * i / n - 1, 2.0 * j / n - 1, 2.0 * k / n - 1});
          nearest = std::min(nearest, norm(d + rotate(kTurned, p)));
        }
      }
    }
    EXPECT_LE(g.gap, nearest - 0.25 + kRounding);
    EXPECT_GE(g.gap, nearest - 0.25 - 0.04);
  }
}

TEST(BoxHalfSpaceTest, EachCornerIsAContact) {
  const Vec3d half{1, 2, 3}, normal = normalized(Vec3d{0.2, 0.1, 1});
  const Vec3d center{0.3, 0.4, 5}, wall{7, 8, 0};
  for (int corner = 0; corner < kBoxCorners; ++corner) {
    const double height = dot(center - wall, normal);
    const ContactGeometry g = box_half_space(height, normal, wall - center, kTurned, half, corner);
    const Vec3d p = center + rotate(kTurned, box_corner(half, corner));
    EXPECT_NEAR(g.gap, dot(p - wall, normal), 1e-12);
    expect_near(g.arm_a, p - center);
    expect_consistent(g, wall - center);
  }
}

TEST(TriangleTest, ClosestPointAndFeature) {
  const Vec3d a{0, 0, 0}, b{2, 0, 0}, c{0, 2, 0};
  const auto at = [&](Vec3d p) { return closest_on_triangle(p, a, b, c); };
  EXPECT_EQ(at({0.5, 0.5, 1}).feature, TriangleFeature::face);
  expect_near(at({0.5, 0.5, 1}).point, {0.5, 0.5, 0});
  EXPECT_EQ(at({1, -1, 1}).feature, TriangleFeature::edge);
  EXPECT_EQ(at({1, -1, 1}).index, 0);
  expect_near(at({2, 2, 1}).point, {1, 1, 0});
  EXPECT_EQ(at({2, 2, 1}).index, 1);
  EXPECT_EQ(at({-1, 1, 0}).index, 2);
  for (const auto& [p, v] :
       {std::pair{Vec3d{-1, -1, 0}, 0}, {Vec3d{4, -1, 0}, 1}, {Vec3d{-1, 4, 1}, 2}}) {
    EXPECT_EQ(at(p).feature, TriangleFeature::vertex);
    EXPECT_EQ(at(p).index, v);
  }
}

TEST(TriangleTest, ClosestPointAgreesWithSampling) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto vector = [&] { return Vec3d{uniform(random), uniform(random), uniform(random)}; };
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3d a = vector(), b = vector(), c = vector(), p = 2.0 * vector();
    double nearest = 1e300;
    constexpr int n = 60;
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; i + j <= n; ++j) {
        const double s = static_cast<double>(i) / n, t = static_cast<double>(j) / n;
        nearest = std::min(nearest, norm(p - (a + s * (b - a) + t * (c - a))));
      }
    }
    const double found = norm(p - closest_on_triangle(p, a, b, c).point);
    EXPECT_LE(found, nearest + kRounding);
    EXPECT_GE(found, nearest - 0.05);
  }
}

TEST(ContactGeometryTest, SwappingExchangesTheBodies) {
  const Vec3d d{0.3, 1.2, -0.4};
  const ContactGeometry g = swapped(sphere_box(d, 0.2, kTurned, {0.5, 0.5, 0.5}));
  expect_consistent(g, -d);
}

TEST(ContactGeometryTest, ListingLooksOneStepAhead) {
  EXPECT_TRUE(is_listed(0.1, 5, 0.1, 1));
  EXPECT_FALSE(is_listed(0.11, 0, 0.1, 1));
  EXPECT_TRUE(is_listed(0.5, -0.4, 0.1, 1));
  EXPECT_FALSE(is_listed(0.5, -0.39, 0.1, 1));
}

}  // namespace
}  // namespace scree
