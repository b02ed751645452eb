// Contacts of capsules against distances that are searched for along both axes.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "kernels/narrow_phase/pairs/capsule_capsule.h"
#include "kernels/narrow_phase/pairs/capsule_half_space.h"
#include "kernels/narrow_phase/pairs/sphere_capsule.h"
#include "tests/kernels/narrow_phase/convex_oracle.h"

namespace scree {
namespace {

struct TestCapsule {
  Vec3d center;
  Quatd q;
  double radius;
  double half_length;

  PairSide side() const { return {0, q, {radius, radius, radius + half_length}, kNoShape, {}}; }
  Vec3d on_axis(double s) const { return center + rotate(q, Vec3d{0, 0, s}); }
};

TestCapsule random_capsule(std::mt19937& random, double spread) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> normal;
  TestCapsule c;
  c.center = spread * Vec3d{uniform(random), uniform(random), uniform(random)};
  c.q = normalized(Quatd{normal(random), normal(random), normal(random), normal(random)});
  c.radius = 0.3 + 0.1 * uniform(random);
  c.half_length = 0.8 + 0.5 * uniform(random);
  return c;
}

/// Least of a convex function on [-end, end].
template <class F>
double least_on(double end, F f) {
  double low = -end, high = end;
  for (int k = 0; k < 60; ++k) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    (f(a) < f(b) ? high : low) = f(a) < f(b) ? b : a;
  }
  return f(0.5 * (low + high));
}

/// Distance of two axes, by search along both.
double distance_of_axes(const TestCapsule& a, const TestCapsule& b) {
  return least_on(a.half_length, [&](double s) {
    return least_on(b.half_length, [&](double t) { return norm(a.on_axis(s) - b.on_axis(t)); });
  });
}

Manifold manifold(const TestCapsule& a, const TestCapsule& b, double reach) {
  return CapsuleCapsule::manifold(a.side(), b.side(), b.center - a.center, reach, IsWithin{reach});
}

void expect_sound(const ContactGeometry& g, const Vec3d& d) {
  EXPECT_NEAR(norm(g.normal), 1, 1e-12);
  EXPECT_LT(norm(d + g.arm_b - g.arm_a - g.gap * g.normal), 1e-12);
}

TEST(CapsuleCapsuleTest, NearestContactIsTheDistanceAndNoneIsNearer) {
  std::mt19937 random(1);
  int several = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const TestCapsule a = random_capsule(random, 1), b = random_capsule(random, 1);
    const double axes = distance_of_axes(a, b);
    if (axes < 1e-3) continue;
    const double gap = axes - a.radius - b.radius;
    const Manifold m = manifold(a, b, gap + 0.1);
    ASSERT_GE(m.count, 1) << trial;
    double least = INFINITY;
    for (int k = 0; k < m.count; ++k) {
      expect_sound(m.contact[k], b.center - a.center);
      const ContactGeometry again =
          CapsuleCapsule::contact(a.side(), b.side(), b.center - a.center, m.feature[k]);
      EXPECT_EQ(again.gap, m.contact[k].gap) << "a feature names its contact";
      EXPECT_LT(m.feature[k], 1u << CapsuleCapsule::kFeatureBits);
      if (k > 0) {
        EXPECT_LT(m.feature[k - 1], m.feature[k]);
      }
      least = std::min(least, m.contact[k].gap);
    }
    EXPECT_NEAR(least, gap, 1e-9) << trial;
    EXPECT_EQ(manifold(a, b, gap - 1e-6).count, 0) << trial;
    several += m.count > 1;
  }
  EXPECT_GT(several, 10);
}

TEST(CapsuleCapsuleTest, ThoseSideBySideHaveTwoContacts) {
  const TestCapsule a{{}, {}, 0.2, 1}, b{{0.5, 0, 0.7}, {}, 0.3, 1};
  const Manifold m = manifold(a, b, 0.01);
  ASSERT_EQ(m.count, 2);
  // The shared part of the axes goes from -0.3 to 1.
  double low = INFINITY, high = -INFINITY;
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(m.contact[k].gap, 0, 1e-12);
    EXPECT_NEAR(m.contact[k].normal.x, 1, 1e-12);
    low = std::min(low, m.contact[k].arm_a.z), high = std::max(high, m.contact[k].arm_a.z);
  }
  EXPECT_NEAR(low, -0.3, 1e-12);
  EXPECT_NEAR(high, 1, 1e-12);
}

TEST(CapsuleCapsuleTest, ThoseThatCrossOrMeetEndToEndHaveOne) {
  const Quatd across = exp_map(Vec3d{0.5 * 3.14159265358979, 0, 0});
  const TestCapsule a{{}, {}, 0.2, 1}, b{{0.55, 0, 0}, across, 0.3, 1};
  const Manifold crossed = manifold(a, b, 0.1);
  ASSERT_EQ(crossed.count, 1);
  EXPECT_NEAR(crossed.contact[0].gap, 0.05, 1e-12);
  const TestCapsule above{{0, 0, 2.6}, {}, 0.3, 1};
  const Manifold in_line = manifold(a, above, 0.2);
  ASSERT_EQ(in_line.count, 1);
  EXPECT_NEAR(in_line.contact[0].gap, 0.1, 1e-12);
  EXPECT_NEAR(in_line.contact[0].normal.z, 1, 1e-12);
}

TEST(CapsuleCapsuleTest, AxesThatMeetArePartedAcrossBoth) {
  const Quatd across = exp_map(Vec3d{0.5 * 3.14159265358979, 0, 0});
  const TestCapsule a{{}, {}, 0.2, 1}, b{{}, across, 0.3, 1};
  const Manifold m = manifold(a, b, 0);
  ASSERT_GE(m.count, 1);
  for (int k = 0; k < m.count; ++k) {
    expect_sound(m.contact[k], {});
    EXPECT_NEAR(m.contact[k].gap, -0.5, 1e-12);
    EXPECT_NEAR(std::abs(m.contact[k].normal.x), 1, 1e-9);
  }
}

TEST(SphereCapsuleTest, GapIsTheDistanceToTheAxis) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 200; ++trial) {
    const TestCapsule c = random_capsule(random, 1), s = random_capsule(random, 2);
    const Vec3d d = c.center - s.center;
    const ContactGeometry g = SphereCapsule::contact(ball(s.radius), c.side(), d, 0);
    expect_sound(g, d);
    const double axis =
        least_on(c.half_length, [&](double t) { return norm(c.on_axis(t) - s.center); });
    EXPECT_NEAR(g.gap, axis - s.radius - c.radius, 1e-9) << trial;
    EXPECT_NEAR(norm(g.arm_a), s.radius, 1e-12);
  }
  const TestCapsule c{{}, {}, 0.2, 1};
  const ContactGeometry inside = SphereCapsule::contact(ball(0.1), c.side(), {0, 0, -0.4}, 0);
  expect_sound(inside, {0, 0, -0.4});
  EXPECT_NEAR(inside.gap, -0.3, 1e-12) << "a center on the axis";
}

TEST(CapsuleHalfSpaceTest, EachEndIsASphere) {
  std::mt19937 random(3);
  const Vec3d normal = normalized(Vec3d{0.2, 0.1, 1}), wall{7, 8, 0};
  for (int trial = 0; trial < 50; ++trial) {
    const TestCapsule c = random_capsule(random, 2);
    const double height = dot(c.center - wall, normal);
    for (int end = 0; end < CapsuleHalfSpace::kCorners; ++end) {
      const ContactGeometry g =
          CapsuleHalfSpace::contact(c.side(), height, normal, wall - c.center, end);
      const Vec3d center = c.on_axis(end == 0 ? -c.half_length : c.half_length);
      EXPECT_NEAR(g.gap, dot(center - wall, normal) - c.radius, 1e-12);
      expect_sound(g, wall - c.center);
    }
  }
}

}  // namespace
}  // namespace scree
