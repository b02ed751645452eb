// Contacts of boxes that move, against what boxes whose edges are parallel do: they overlap along each axis for a time of its own.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "kernels/narrow_phase/pairs/box_box.h"
#include "kernels/narrow_phase/pairs/convex_manifold.h"
#include "shapes/box.h"
#include "tests/kernels/narrow_phase/convex_oracle.h"

namespace scree {
namespace {

/// Two boxes with the same axes, in these axes.
struct Course {
  Vec3d half_a, half_b, d, way;

  double separation(int axis) const { return std::abs(d[axis]) - half_a[axis] - half_b[axis]; }
  /// When they reach each other along an axis, and leave it, in steps.
  std::pair<double, double> times(int axis) const {
    const double reach = half_a[axis] + half_b[axis], v = way[axis];
    const double one = (-reach - d[axis]) / v, two = (reach - d[axis]) / v;
    return {std::min(one, two), std::max(one, two)};
  }
  /// The axis that they reach last.
  int last() const {
    int k = 0;
    for (int axis = 1; axis < 3; ++axis) k = times(axis).first > times(k).first ? axis : k;
    return k;
  }
  bool meets() const {
    double leave = 1;
    for (int axis = 0; axis < 3; ++axis) leave = std::min(leave, times(axis).second);
    return times(last()).first < leave && times(last()).first >= 0;
  }
};

/// Boxes that are apart along two axes, and come nearer along both.
Course past_an_edge(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  Course c;
  for (int k = 0; k < 3; ++k) c.half_a[k] = 0.5 + unit(random), c.half_b[k] = 0.5 + unit(random);
  for (int k = 0; k < 2; ++k) {
    c.d[k] = c.half_a[k] + c.half_b[k] + 0.05 * unit(random);
    c.way[k] = -0.1 * unit(random);
  }
  c.d.z = 0.3 * unit(random);
  c.way.z = 0.1 * unit(random) - 0.05;
  return c;
}

using BoxesByCores = ConvexPair<shapes::Box, shapes::Box>;

template <class P>
Manifold contacts(const Course& c, const Quatd& turn) {
  const PosedBody a{{}, turn, c.half_a}, b{rotate(turn, c.d), turn, c.half_b};
  PairSide side = b.side();
  side.way = rotate(turn, c.way);
  Manifold m = P::manifold(a.side(), side, b.center, 1, IsWithin{1});
  for (int k = 0; k < m.count; ++k) {
    const ContactGeometry again = P::contact(a.side(), side, b.center, m.feature[k]);
    EXPECT_EQ(again.gap, m.contact[k].gap) << "a feature names its contact";
    EXPECT_EQ(again.arm_b, m.contact[k].arm_b);
    const ContactGeometry& g = m.contact[k];
    EXPECT_LT(norm(b.center + g.arm_b - g.arm_a - g.gap * g.normal), 1e-12);
  }
  return m;
}

template <class P>
void expect_last_planes() {
  std::mt19937 random(7);
  int hits = 0, passes = 0;
  for (int n = 0; n < 4000; ++n) {
    const Course c = past_an_edge(random);
    const double x = c.times(0).first, y = c.times(1).first;
    // Boxes count as parted until they overlap a little.
    const double slowest = std::min(std::abs(c.way.x), std::abs(c.way.y));
    if (std::abs(x - y) < 1e-3 + 1e-3 * 1.5 / slowest) continue;
    const Quatd turn = exp_map(any_vector(random));
    const Manifold m = contacts<P>(c, turn);
    const Vec3d way = rotate(turn, c.way);
    double least = 1e300;
    for (int k = 0; k < m.count; ++k)
      least = std::min(least, m.contact[k].gap + dot(m.contact[k].normal, way));
    if (!c.meets()) {
      EXPECT_GT(least, -2e-3) << n;
      ++passes;
      continue;
    }
    ++hits;
    ASSERT_GT(m.count, 0);
    EXPECT_LT(least, 0);
    for (int k = 0; k < m.count; ++k) {
      const Vec3d normal = rotate_back(turn, m.contact[k].normal);
      EXPECT_NEAR(std::abs(normal[c.last()]), 1, 1e-4) << n;
      EXPECT_GE(m.contact[k].gap, c.separation(c.last()) - 1e-12);
    }
  }
  EXPECT_GT(hits, 500);
  EXPECT_GT(passes, 500);
}

TEST(Ahead, BoxesTouchWhereTheyMeet) { expect_last_planes<BoxBox>(); }
TEST(Ahead, CoresTouchWhereTheyMeet) { expect_last_planes<BoxesByCores>(); }

// A way that ends before changes nothing, nor does one along a face.
TEST(Ahead, WhereNothingIsReachedContactsAreThoseOfTheStart) {
  Course c;
  c.half_a = {1, 1, 1}, c.half_b = {0.5, 0.5, 0.5};
  c.d = {0.3, 0.2, 1.5};
  const Manifold still = contacts<BoxBox>(c, {});
  for (const Vec3d& way : {Vec3d{0.2, 0.1, 0}, Vec3d{0, 0, -0.1}, Vec3d{0.1, 0.1, 0.1}}) {
    c.way = way;
    const Manifold m = contacts<BoxBox>(c, {});
    ASSERT_EQ(m.count, still.count);
    for (int k = 0; k < m.count; ++k) {
      EXPECT_EQ(m.feature[k], still.feature[k]);
      EXPECT_EQ(m.contact[k].gap, still.contact[k].gap);
      EXPECT_EQ(m.contact[k].arm_a, still.contact[k].arm_a);
    }
  }
}

}  // namespace
}  // namespace scree
