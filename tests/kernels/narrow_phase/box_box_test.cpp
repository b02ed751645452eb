// Contacts of two boxes against closed forms, and against distances and depths that are found by
// other means: alternating projections, and a search over directions.

#include "kernels/narrow_phase/pairs/box_box.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "tests/kernels/narrow_phase/convex_oracle.h"

namespace scree {
namespace {

using TestBox = PosedBody;

BoxPair pair_of_boxes(const TestBox& a, const TestBox& b) {
  return {{BoxAxes(a.q, a.half), BoxAxes(b.q, b.half)}, b.center - a.center};
}

/// All contacts with gaps up to the envelope.
Manifold manifold(const TestBox& a, const TestBox& b, double envelope) {
  const BoxPair pair = pair_of_boxes(a, b);
  Manifold m;
  box_box(pair, {pair, envelope}, envelope, IsWithin{envelope},
          [&](std::uint32_t feature, const ContactGeometry& g) { m.add(feature, g); });
  return m;
}

/// How far a point is outside a box, over its faces; negative inside.
double outside(const TestBox& box, const Vec3d& x) {
  const Vec3d local = rotate_back(box.q, x - box.center);
  double most = -1e300;
  for (int k = 0; k < 3; ++k) most = std::max(most, std::abs(local[k]) - box.half[k]);
  return most;
}

/// Distance of two boxes by projections to and fro: zero when they meet.
double projected_distance(const TestBox& a, const TestBox& b) {
  Vec3d x = a.center, y;
  for (int k = 0; k < 20000; ++k) {
    y = nearest_in_box(b, x);
    x = nearest_in_box(a, y);
  }
  return norm(y - x);
}

void expect_sound(const TestBox& a, const TestBox& b, const Manifold& m) {
  const double slack = 1e-3 * std::max(norm(a.half), norm(b.half));
  for (int k = 0; k < m.count; ++k) {
    const ContactGeometry& g = m.contact[k];
    EXPECT_NEAR(norm(g.normal), 1, 1e-12);
    EXPECT_LT(norm(b.center + g.arm_b - a.center - g.arm_a - g.gap * g.normal), 1e-12);
    EXPECT_EQ(g.normal, m.contact[0].normal) << "one normal for all";
    if (k > 0) {
      EXPECT_LT(m.feature[k - 1], m.feature[k]);
    }
    EXPECT_LT(m.feature[k], 1u << BoxFeature::kBits);
    if (g.gap > 0) {
      EXPECT_NEAR(outside(a, a.center + g.arm_a), 0, slack);
      EXPECT_NEAR(outside(b, b.center + g.arm_b), 0, slack);
    }
  }
}

TestBox random_box(std::mt19937& random, double spread) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> normal;
  TestBox box;
  box.center = spread * Vec3d{uniform(random), uniform(random), uniform(random)};
  box.q = normalized(Quatd{normal(random), normal(random), normal(random), normal(random)});
  box.half = Vec3d{0.6, 0.6, 0.6} + 0.4 * Vec3d{uniform(random), uniform(random), uniform(random)};
  return box;
}

TEST(BoxBoxTest, BoxesApartAreListedUpToTheirDistance) {
  std::mt19937 random(1);
  int apart = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const TestBox a = random_box(random, 0.5), b = random_box(random, 2.5);
    const double distance = projected_distance(a, b);
    if (distance < 1e-3) continue;
    ++apart;
    const Manifold m = manifold(a, b, distance + 1e-6);
    ASSERT_GE(m.count, 1) << "trial " << trial << " at " << distance;
    expect_sound(a, b, m);
    for (int k = 0; k < m.count; ++k) EXPECT_GT(m.contact[k].gap, distance - 1e-3) << trial;
    EXPECT_EQ(manifold(a, b, 0.99 * distance - 1e-3).count, 0) << "trial " << trial;
  }
  EXPECT_GT(apart, 100);
}

TEST(BoxBoxTest, OverlapIsPushedOutTheShortestWay) {
  std::mt19937 random(2);
  int deep = 0, edges = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const TestBox a = random_box(random, 0.2), b = random_box(random, 1.4);
    if (projected_distance(a, b) > 1e-9) continue;
    const double depth = sampled_depth(corners(a), corners(b), random);
    if (depth < 1e-3) continue;
    ++deep;
    const Manifold m = manifold(a, b, 0);
    ASSERT_GE(m.count, 1) << "trial " << trial;
    expect_sound(a, b, m);
    const double along = overlap_along(corners(a), corners(b), m.contact[0].normal);
    EXPECT_GE(along, depth - 1e-3) << "the search found the least: trial " << trial;
    EXPECT_LE(along, depth + 2e-3) << "trial " << trial;
    double most = 0;
    for (int k = 0; k < m.count; ++k) most = std::max(most, -m.contact[k].gap);
    EXPECT_NEAR(most, along, 2e-3) << "trial " << trial;
    edges += m.feature[0] >= BoxFeature::kEdges && m.feature[0] < BoxFeature::kFaces;
  }
  EXPECT_GT(deep, 60);
  EXPECT_GT(edges, 5);
}

TEST(BoxBoxTest, ExchangeAndRotationChangeNothing) {
  std::mt19937 random(3);
  const Quatd turn = exp_map(Vec3d{0.4, -1.3, 0.7});
  int seen = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const TestBox a = random_box(random, 0.3), b = random_box(random, 1.6);
    const Manifold m = manifold(a, b, 0.1);
    const Manifold exchanged = manifold(b, a, 0.1);
    const auto turned = [&](const TestBox& x) {
      return TestBox{rotate(turn, x.center), turn * x.q, x.half};
    };
    const Manifold rotated = manifold(turned(a), turned(b), 0.1);
    ASSERT_EQ(m.count, exchanged.count) << trial;
    ASSERT_EQ(m.count, rotated.count) << trial;
    seen += m.count > 0;
    for (int k = 0; k < m.count; ++k) {
      EXPECT_EQ(m.feature[k], rotated.feature[k]);
      EXPECT_LT(norm(rotate(turn, m.contact[k].arm_a) - rotated.contact[k].arm_a), 1e-9);
      EXPECT_LT(norm(rotate(turn, m.contact[k].normal) - rotated.contact[k].normal), 1e-9);
      EXPECT_NEAR(m.contact[k].gap, rotated.contact[k].gap, 1e-9);
      double nearest = 1e300;
      for (int j = 0; j < m.count; ++j) {
        const ContactGeometry g = swapped(exchanged.contact[j]);
        nearest = std::min(nearest, norm(g.arm_a - m.contact[k].arm_a) +
                                        norm(g.arm_b - m.contact[k].arm_b) +
                                        norm(g.normal - m.contact[k].normal));
      }
      EXPECT_LT(nearest, 1e-9) << trial;
    }
  }
  EXPECT_GT(seen, 100);
}

/// The points halfway between the surfaces, sorted by x, then y.
std::vector<Vec3d> places(const TestBox& a, const Manifold& m) {
  std::vector<Vec3d> out;
  for (int k = 0; k < m.count; ++k) {
    out.push_back(a.center + m.contact[k].arm_a + 0.5 * m.contact[k].gap * m.contact[k].normal);
  }
  std::sort(out.begin(), out.end(), [](const Vec3d& p, const Vec3d& q) {
    return std::abs(p.x - q.x) > 1e-9 ? p.x < q.x : p.y < q.y;
  });
  return out;
}

TEST(BoxBoxTest, FaceOnFaceHasTheCornersOfTheCommonRectangle) {
  const TestBox low{{}, {}, {0.5, 0.5, 0.5}};
  for (const double gap : {1e-3, 0.0, -1e-3}) {
    for (const Vec3d& shift : {Vec3d{0, 0, 0}, Vec3d{0.3, 0.2, 0}, Vec3d{-0.7, 0.4, 0}}) {
      const TestBox top{shift + Vec3d{0, 0, 1 + gap}, {}, {0.5, 0.5, 0.5}};
      const Manifold m = manifold(low, top, 0.01);
      ASSERT_EQ(m.count, 4) << gap;
      expect_sound(low, top, m);
      const std::vector<Vec3d> p = places(low, m);
      const double x[] = {std::max(-0.5, shift.x - 0.5), std::min(0.5, shift.x + 0.5)};
      const double y[] = {std::max(-0.5, shift.y - 0.5), std::min(0.5, shift.y + 0.5)};
      for (int k = 0; k < 4; ++k) {
        EXPECT_NEAR(m.contact[k].gap, gap, 1e-12);
        EXPECT_LT(norm(m.contact[k].normal - Vec3d{0, 0, 1}), 1e-12);
        EXPECT_LT(norm(p[k] - Vec3d{x[k / 2], y[k % 2], 0.5 + gap / 2}), 1e-12) << k;
      }
    }
  }
}

TEST(BoxBoxTest, ASmallBoxStandsOnItsOwnCornersAndALargeOneOnTheOthers) {
  const TestBox large{{}, exp_map(Vec3d{0, 0, 0.3}), {2, 2, 0.5}};
  const TestBox small{{0.4, 0.1, 0.7}, exp_map(Vec3d{0, 0, 1.1}), {0.3, 0.2, 0.2}};
  for (const bool small_first : {false, true}) {
    const Manifold m = small_first ? manifold(small, large, 0.01) : manifold(large, small, 0.01);
    ASSERT_EQ(m.count, 4);
    for (int k = 0; k < 4; ++k) {
      const Vec3d arm = small_first ? m.contact[k].arm_a : m.contact[k].arm_b;
      const Vec3d local = rotate_back(small.q, arm);
      EXPECT_NEAR(std::abs(local.x), 0.3, 1e-12);
      EXPECT_NEAR(std::abs(local.y), 0.2, 1e-12);
      EXPECT_NEAR(m.contact[k].gap, 0, 1e-12);
    }
  }
}

TEST(BoxBoxTest, FourOfEightPointsHoldMostOfTheArea) {
  const TestBox low{{}, {}, {0.5, 0.5, 0.5}};
  for (const double angle : {std::numbers::pi / 4, 0.6, 0.2}) {
    const TestBox top{{0, 0, 1}, exp_map(Vec3d{0, 0, angle}), {0.5, 0.5, 0.5}};
    const Manifold m = manifold(low, top, 1e-3);
    ASSERT_EQ(m.count, 4) << angle;
    std::vector<Vec3d> p = places(low, m);
    std::sort(p.begin(), p.end(), [](const Vec3d& a, const Vec3d& b) {
      return std::atan2(a.y, a.x) < std::atan2(b.y, b.x);
    });
    double area = 0;
    for (int k = 0; k < 4; ++k) area += 0.5 * cross(p[k], p[(k + 1) % 4]).z;
    // Of either unit square four right triangles are cut off, with hypotenuse 1 / (1 + s + c).
    const double c = std::cos(angle), s = std::sin(angle);
    const double common = 1 - 2 * s * c / ((1 + s + c) * (1 + s + c));
    EXPECT_GT(area, 0.6 * common) << angle;
    EXPECT_LT(area, common + 1e-9) << angle;
    for (const Vec3d& x : p) {
      EXPECT_LT(outside(low, x), 1e-9);
      EXPECT_LT(outside(top, x), 1e-9);
    }
  }
}

TEST(BoxBoxTest, CrossedEdgesMeetInOnePoint) {
  // Each box stands on an edge: one along x, one along y above it.
  const double r = std::sqrt(0.5);
  for (const double gap : {1e-3, -1e-3}) {
    const TestBox low{{}, exp_map(Vec3d{std::numbers::pi / 4, 0, 0}), {1, 0.5, 0.5}};
    const TestBox top{
        {0.2, 0.3, 2 * r + gap}, exp_map(Vec3d{0, std::numbers::pi / 4, 0}), {0.5, 1, 0.5}};
    const Manifold m = manifold(low, top, 0.01);
    ASSERT_EQ(m.count, 1);
    expect_sound(low, top, m);
    EXPECT_NEAR(m.contact[0].gap, gap, 1e-12);
    EXPECT_LT(norm(m.contact[0].normal - Vec3d{0, 0, 1}), 1e-12);
    EXPECT_LT(norm(m.contact[0].arm_a - Vec3d{0.2, 0, r}), 1e-12);
    EXPECT_LT(norm(m.contact[0].arm_b - Vec3d{0, -0.3, -r}), 1e-12);
  }
}

TEST(BoxBoxTest, ACornerMeetsAFaceAndAnEdgeLiesOnIt) {
  const TestBox floor{{}, {}, {2, 2, 0.5}};
  // Stand a cube on its corner: its diagonal upright.
  const Vec3d diagonal = normalized(Vec3d{1, 1, 1}), up{0, 0, 1};
  const Vec3d axis = normalized(cross(diagonal, up));
  const Quatd on_corner = exp_map(std::acos(dot(diagonal, up)) * axis);
  const double height = 0.5 + 0.5 * std::sqrt(3.0) - 1e-3;
  const TestBox corner{{0.3, -0.2, height}, on_corner, {0.5, 0.5, 0.5}};
  const Manifold m = manifold(floor, corner, 0.01);
  ASSERT_EQ(m.count, 1);
  EXPECT_NEAR(m.contact[0].gap, -1e-3, 1e-12);
  EXPECT_LT(norm(m.contact[0].arm_a - Vec3d{0.3, -0.2, 0.5}), 1e-12);

  const TestBox edge{
      {0, 0, 0.5 + std::sqrt(0.5)}, exp_map(Vec3d{std::numbers::pi / 4, 0, 0}), {0.7, 0.5, 0.5}};
  const Manifold n = manifold(floor, edge, 0.01);
  ASSERT_EQ(n.count, 2);
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(n.contact[k].gap, 0, 1e-12);
    EXPECT_NEAR(std::abs(n.contact[k].arm_a.x), 0.7, 1e-12);
    EXPECT_NEAR(n.contact[k].arm_a.y, 0, 1e-12);
  }
}

TEST(BoxBoxTest, CornersApartHaveTheNormalBetweenThem) {
  const TestBox a{{}, {}, {0.5, 0.5, 0.5}};
  const TestBox b{{1.03, 1.04, 1.12}, {}, {0.5, 0.5, 0.5}};
  const Manifold m = manifold(a, b, 0.14);
  ASSERT_EQ(m.count, 1);
  EXPECT_NEAR(m.contact[0].gap, 0.13, 1e-12) << "3, 4 and 12";
  EXPECT_LT(norm(m.contact[0].normal - Vec3d{3, 4, 12} * (1.0 / 13)), 1e-12);
  expect_sound(a, b, m);
  EXPECT_EQ(manifold(a, b, 0.125).count, 0);
}

/// Where faces, edges and corners of both boxes coincide, rounding must not rename contacts.
TEST(BoxBoxTest, FeaturesOutliveRounding) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto noise = [&](double size) {
    return size * Vec3d{uniform(random), uniform(random), uniform(random)};
  };
  for (const Vec3d& shift : {Vec3d{0, 0, 1}, Vec3d{0.5, 0, 1}, Vec3d{0.5, 0.5, 1}}) {
    for (const double angle : {0.0, std::numbers::pi / 2, std::numbers::pi / 4}) {
      const TestBox low{{}, {}, {0.5, 0.5, 0.5}};
      const TestBox top{shift, exp_map(Vec3d{0, 0, angle}), {0.5, 0.5, 0.5}};
      const Manifold m = manifold(low, top, 1e-3);
      EXPECT_GE(m.count, 3);
      for (int trial = 0; trial < 200; ++trial) {
        TestBox moved = top;
        moved.center += noise(1e-7);
        moved.q = normalized(exp_map(noise(1e-7)) * top.q);
        const Manifold n = manifold(low, moved, 1e-3);
        ASSERT_EQ(m.count, n.count) << shift.x << ' ' << angle;
        for (int k = 0; k < m.count; ++k) EXPECT_EQ(m.feature[k], n.feature[k]) << angle;
      }
    }
  }
}

}  // namespace
}  // namespace scree
