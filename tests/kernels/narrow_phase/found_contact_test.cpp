// What is kept of a contact while all are counted.

#include <gtest/gtest.h>

#include <random>

#include "kernels/narrow_phase/near_pairs.h"

namespace scree {
namespace {

// Both lever arms come out of one of them, each with the rounding of its own length: that of a grain on a long plate, too.
TEST(FoundContact, ArmsAreRoundedByTheirOwnLength) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto any = [&] { return Vec3d{unit(random), unit(random), unit(random)}; };
  for (int trial = 0; trial < 1000; ++trial) {
    const double radius_a = trial % 2 == 0 ? 300 : 0.01, radius_b = trial % 3 == 0 ? 500 : 0.02;
    ContactGeometry g;
    g.normal = normalized(any());
    g.gap = 1e-3 * unit(random);
    g.arm_a = radius_a * any();
    g.arm_b = radius_b * any();
    const Vec3d d = g.arm_a + g.gap * g.normal - g.arm_b;
    const FoundContact<float> f(g, radius_b < radius_a);
    EXPECT_LT(norm(Vec3d(f.arm_a(d)) - g.arm_a), 2e-7 * radius_a);
    EXPECT_LT(norm(Vec3d(f.arm_b(d)) - g.arm_b), 2e-7 * radius_b);
    EXPECT_LT(norm(Vec3d(f.normal) - g.normal), 2e-7);
    EXPECT_NEAR(f.gap, g.gap, 1e-10);
  }
}

TEST(FoundContact, HasNoBytesThatAreNotWritten) {
  EXPECT_EQ(sizeof(FoundContact<float>), 8 * sizeof(float));
  EXPECT_EQ(sizeof(FoundContact<double>), 8 * sizeof(double));
}

TEST(PairFeatures, OfFourContactsAreKept) {
  PairFeatures features;
  const std::uint32_t of[] = {0, 65535, 7, 511};
  for (Index c = 0; c < 4; ++c) features.set(c, of[c]);
  for (Index c = 0; c < 4; ++c) EXPECT_EQ(features[c], of[c]);
}

}  // namespace
}  // namespace scree
