#pragma once
// Contacts of many spheres against brute force, written from the definition of a contact.

#include <algorithm>
#include <cmath>

#include "tests/backend_fixture.h"
#include "tests/collision/collision_scene.h"

namespace scree {
namespace {

template <class Real>
class BroadPhaseTest : public BackendTest<Real> {
 protected:
  using Scene = CollisionScene<Real>;

  using Pairs = std::vector<std::pair<Index, Index>>;

  /// Where body i would be at the end of the step without contacts.
  static Vec3<double> end_of(const Scene& s, Index i) {
    const auto at = static_cast<std::size_t>(i);
    Vec3<double> x = s.position[at];
    for (int k = 0; k < 3; ++k) {
      const bool is_free = i < s.owned_count;
      const bool is_locked = at < s.locks.size() && (s.locks[at] >> k & 1) != 0;
      if (is_free && is_locked) continue;
      x[k] += s.h * (static_cast<double>(s.velocity[at][k]) + (is_free ? s.h * s.gravity[k] : 0));
    }
    return x;
  }

  /// Compares all with all. @param meets  meets(d, end, sum): whether a pair counts whose centers
  /// are d apart at the start of the step and `end` at its end, and whose radii have this sum
  template <class Meets>
  static Pairs brute_force(const Scene& s, Meets&& meets) {
    Pairs pairs;
    const auto n = static_cast<Index>(s.position.size());
    for (Index i = 0; i < s.owned_count; ++i) {
      for (Index j = i + 1; j < n; ++j) {
        if (s.shape[j] >= 0) continue;
        Vec3<double> d = s.position[j] - s.position[i];
        const Vec3<double> moved = (end_of(s, j) - s.position[j]) - (end_of(s, i) - s.position[i]);
        for (int k = 0; k < 3; ++k) {
          if (s.settings.period[k] > 0) d[k] = std::remainder(d[k], s.settings.period[k]);
        }
        if (meets(d, d + moved, static_cast<double>(s.radius[i]) + s.radius[j])) {
          pairs.emplace_back(i, j);
        }
      }
    }
    return pairs;
  }

  /// Pairs that come within the envelope on the straight ways of the step: these may not be missed.
  static Pairs meeting(const Scene& s) {
    return brute_force(s, [&](const Vec3<double>& d, const Vec3<double>& end, double sum) {
      const Vec3<double> way = end - d;
      const double part = norm2(way) > 0 ? std::clamp(-dot(d, way) / norm2(way), 0.0, 1.0) : 0;
      return norm(d + part * way) <= sum + s.settings.envelope;
    });
  }

  /// Pairs (a, b) with a contact: one sphere ends beyond the plane that touches the other between
  /// them, or is within the envelope at the start.
  static Pairs brute_force(const Scene& s) {
    return brute_force(s, [&](const Vec3<double>& d, const Vec3<double>& end, double sum) {
      const double reach = sum + s.settings.envelope;
      return norm(d) <= reach || dot(end, d) <= reach * norm(d);
    });
  }

  /// Runs the scene and compares pairs, order, normals and gaps.
  void expect_brute_force(const Scene& scene) {
    CollisionRun<TestBackend, Real> run(this->backend(), scene);
    const auto contacts = run.detect();
    const auto expected = brute_force(scene);
    ASSERT_EQ(contacts.size(), expected.size());
    for (const auto& pair : meeting(scene)) {
      ASSERT_TRUE(std::binary_search(expected.begin(), expected.end(), pair))
          << pair.first << " " << pair.second;
    }
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      const HostContact& found = contacts[c];
      ASSERT_EQ(found.a, expected[c].first) << "contact " << c;
      ASSERT_EQ(found.b, expected[c].second) << "contact " << c;
      ASSERT_TRUE(c == 0 || contacts[c - 1].key < found.key);
      Vec3<double> d = scene.position[found.b] - scene.position[found.a];
      for (int k = 0; k < 3; ++k) {
        if (scene.settings.period[k] > 0) d[k] = std::remainder(d[k], scene.settings.period[k]);
      }
      const double distance = norm(d),
                   sum = static_cast<double>(scene.radius[found.a]) + scene.radius[found.b];
      const double rounding = this->tolerance(1e-14, 1e-6) * (sum + std::abs(found.gap));
      EXPECT_NEAR(norm(found.normal), 1, this->tolerance(1e-14, 1e-6));
      if (distance > 0) {
        EXPECT_NEAR(found.gap, dot(found.normal, d) - sum, rounding);
      }
      const Vec3<double> way = (end_of(scene, found.b) - scene.position[found.b]) -
                               (end_of(scene, found.a) - scene.position[found.a]);
      expect_normal(found, d, way, sum, rounding);
    }
  }

  /// The normal leads from center to center: at the start, or where the spheres pass each other, if
  /// they miss, move far, and the plane at the start is in their way.
  void expect_normal(const HostContact& c, const Vec3<double>& d, const Vec3<double>& way,
                     double sum, double rounding) {
    const double distance = norm(d);
    if (!(distance > 0)) return;
    const double cut = sum - dot(d + way, d) / distance, turning = norm(way) / sum - 0.02;
    const double nearest = norm2(way) > 0 ? std::clamp(-dot(d, way) / norm2(way), 0.0, 1.0) : 0.0;
    const double miss = norm(d + nearest * way) - sum;
    if (std::min({std::abs(cut), std::abs(turning), std::abs(miss)}) < 1e-12) return;
    if (miss < 0 || cut < 0 || turning < 0) {
      EXPECT_NEAR(dot(c.normal, d) / distance, 1, this->tolerance(1e-14, 1e-6));
    } else {
      EXPECT_GE(dot(c.normal, d + way), sum - 4 * rounding) << "what misses is not in the way";
    }
  }

  /// Spheres at random places in a box, sizes from small to large with as much volume in each size.
  static Scene random_scene(Index count, double extent, double small, double large, unsigned seed) {
    Scene s;
    s.settings.envelope = 0.02 * small;
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (Index i = 0; i < count; ++i) {
      const double a = std::pow(small, -2), b = std::pow(large, -2);
      const double r = std::pow(a + (b - a) * uniform(random), -0.5);
      s.add_free({extent * uniform(random), extent * uniform(random), extent * uniform(random)}, r);
    }
    return s;
  }
};
TYPED_TEST_SUITE(BroadPhaseTest, Reals);

TYPED_TEST(BroadPhaseTest, EqualSpheres) {
  this->expect_brute_force(this->random_scene(3000, 1.0, 0.04, 0.04, 1));
}

TYPED_TEST(BroadPhaseTest, SizesUpToOneHundredToOne) {
  for (const double ratio : {1.5, 10.0, 100.0}) {
    auto scene = this->random_scene(2500, 1.0, 0.004, 0.004 * ratio, 2);
    scene.add_free({0.5, 0.5, 0.5}, 0.002 * ratio);  // the largest meets the smallest
    this->expect_brute_force(scene);
  }
}

TYPED_TEST(BroadPhaseTest, EitherOfTwoSizesSearches) {
  for (const bool is_periodic : {false, true}) {
    for (const double large_share : {0.01, 0.2, 0.8}) {
      for (const double ratio : {1.7, 3.0, 7.9, 20.0}) {
        const auto large = static_cast<Index>(900 * large_share);
        auto scene = this->random_scene(900 - large, 1.0, 0.01, 0.01, 21);
        const auto more = this->random_scene(large, 1.0, 0.01 * ratio, 0.01 * ratio, 22);
        for (std::size_t i = 0; i < more.position.size(); ++i)
          scene.add_free(more.position[i], more.radius[i], {0, 0, -0.5});
        if (is_periodic) scene.settings.period = {1.01, 1, 1};
        this->expect_brute_force(scene);
      }
    }
  }
}

TYPED_TEST(BroadPhaseTest, LargeBodyWithMoreNeighborsThanSlots) {
  auto scene = this->random_scene(1000, 2.0, 0.01, 0.01, 23);
  for (auto& x : scene.position) {
    x = x - Vec3<double>{1, 1, 1};
    x = (0.09 / norm(x)) * x;
  }
  scene.add_free({0, 0, 0}, 0.08);
  this->expect_brute_force(scene);
}

TYPED_TEST(BroadPhaseTest, MoreLevelsThanTheHierarchyHas) {
  auto scene = this->random_scene(500, 1.0, 0.01, 0.02, 3);
  for (int k = 0; k < 24; ++k) scene.add_free({0.3, 0.4, 0.5 + 0.01 * k}, std::ldexp(0.01, -k));
  this->expect_brute_force(scene);
}

TYPED_TEST(BroadPhaseTest, EmptySceneAndOneBody) {
  CollisionScene<TypeParam> scene;
  this->expect_brute_force(scene);
  scene.add_free({1, 2, 3}, 0.5);
  this->expect_brute_force(scene);
  scene.add({1, 2, 3.9}, 0.5);
  this->expect_brute_force(scene);
}

TYPED_TEST(BroadPhaseTest, OnlyFixedBodies) {
  CollisionScene<TypeParam> scene;
  for (int k = 0; k < 40; ++k) scene.add({0.1 * k, 0, 0}, 0.5);
  this->expect_brute_force(scene);
}

TYPED_TEST(BroadPhaseTest, AllBodiesInOneCell) {
  auto scene = this->random_scene(200, 0.01, 0.5, 0.5, 4);
  this->expect_brute_force(scene);  // 199 contacts a body: more than the slots a body has
  for (auto& x : scene.position) x = {1, 1, 1};
  this->expect_brute_force(scene);
}

TYPED_TEST(BroadPhaseTest, TouchingExactlyIsAContact) {
  CollisionScene<TypeParam> scene;
  for (int k = 0; k < 5; ++k) scene.add_free({static_cast<double>(k), 0, 0}, 0.5);
  CollisionRun<TestBackend, TypeParam> run(this->backend(), scene);
  const auto contacts = run.detect();
  ASSERT_EQ(contacts.size(), 4u);
  for (const auto& c : contacts) EXPECT_EQ(c.gap, 0);
}

TYPED_TEST(BroadPhaseTest, FarOutliers) {
  auto scene = this->random_scene(1500, 1.0, 0.03, 0.06, 5);
  const std::vector<Vec3<double>> far{
      {1e6, 1e6, -1e6}, {1e6, 1e6, -1e6 + 0.05}, {-1e6, 0, 0.3}, {0, 1e9, 0}};
  for (const auto& x : far) scene.add_free(x, 0.03);
  this->expect_brute_force(scene);
  CollisionRun<TestBackend, TypeParam> run(this->backend(), scene);
  EXPECT_EQ(run.detect().back().a, 1500) << "the two far bodies that touch";
}

TYPED_TEST(BroadPhaseTest, FarFromTheOrigin) {
  auto scene = this->random_scene(800, 1.0, 0.05, 0.05, 6);
  for (auto& x : scene.position) x += {-3e5, 2e5, 1e5};
  this->expect_brute_force(scene);
}

TYPED_TEST(BroadPhaseTest, ThinLayersAndLongRows) {
  auto scene = this->random_scene(2000, 1.0, 0.01, 0.01, 7);
  for (auto& x : scene.position) x = {50 * x.x, x.y * 0.05, 0.001 * x.z};
  this->expect_brute_force(scene);
  for (auto& x : scene.position) x = {x.y, 4000 * x.x, x.z};  // longer than an axis has cells
  this->expect_brute_force(scene);
}

TYPED_TEST(BroadPhaseTest, PeriodicDirections) {
  for (int axes = 1; axes < 8; ++axes) {
    auto scene = this->random_scene(1200, 1.0, 0.02, 0.1, 10 + axes);
    for (int k = 0; k < 3; ++k) {
      if (axes >> k & 1) scene.settings.period[k] = 1.0 + 0.01 * k;
    }
    this->expect_brute_force(scene);
  }
}

TYPED_TEST(BroadPhaseTest, PeriodicPositionsOutsideTheBox) {
  auto scene = this->random_scene(700, 1.0, 0.04, 0.08, 20);
  scene.settings.period = {1, 1, 1};
  for (std::size_t i = 0; i < scene.position.size(); ++i) {
    scene.position[i] += {static_cast<double>(i % 3) - 1.0, 2.0 * static_cast<double>(i % 2), -5};
  }
  this->expect_brute_force(scene);
}

TYPED_TEST(BroadPhaseTest, PeriodOfFewCells) {
  for (const double period :
       {0.05, 0.11, 0.17, 0.23, 0.31}) {  // 0, 1, 2, 3, 4 cells of the largest
    auto scene = this->random_scene(150, 1.0, 0.01, 0.035, 30);
    scene.settings.period = {period, period, 0};
    this->expect_brute_force(scene);
  }
}

TYPED_TEST(BroadPhaseTest, SparsePeriodicBox) {
  auto scene = this->random_scene(300, 100.0, 0.01, 0.01, 31);
  scene.settings.period = {100, 100, 100};
  for (int k = 0; k < 300; k += 2)
    scene.position[k + 1] = scene.position[k] + Vec3<double>{0.005, 0.01, 0.01};
  scene.position[0] = {0.001, 50, 50};
  scene.position[1] = {99.99, 50, 50};
  this->expect_brute_force(scene);
}

TYPED_TEST(BroadPhaseTest, FixedSpheresMeetFreeOnesOnly) {
  auto scene = this->random_scene(600, 1.0, 0.04, 0.08, 40);
  const auto fixed = this->random_scene(600, 1.0, 0.02, 0.3, 41);
  for (std::size_t i = 0; i < 600; ++i) scene.add(fixed.position[i], fixed.radius[i]);
  this->expect_brute_force(scene);
}

TYPED_TEST(BroadPhaseTest, MovingBodiesAreListedBeforeTheyMeet) {
  auto scene = this->random_scene(1500, 1.0, 0.01, 0.03, 50);
  std::mt19937 random(51);
  std::exponential_distribution<double> speed(1.0);
  std::normal_distribution<double> direction;
  for (auto& v : scene.velocity) {
    const Vec3<double> d =
        normalized(Vec3<double>{direction(random), direction(random), direction(random)});
    v = Vec3<TypeParam>(20 * speed(random) * d);
  }
  scene.velocity[7] = {static_cast<TypeParam>(900), 0, 0};  // crosses the whole box in one step
  const auto count_at_rest = [&] {
    auto rest = scene;
    for (auto& v : rest.velocity) v = {};
    return this->brute_force(rest).size();
  }();
  EXPECT_GT(this->brute_force(scene).size(), count_at_rest);
  this->expect_brute_force(scene);
}

TYPED_TEST(BroadPhaseTest, LoadsCountForTheWayOfTheStep) {
  auto scene = this->random_scene(800, 1.0, 0.01, 0.03, 55);
  const auto fixed = this->random_scene(400, 1.0, 0.02, 0.06, 56);
  for (std::size_t i = 0; i < 400; ++i) scene.add(fixed.position[i], fixed.radius[i]);
  const std::size_t without = this->brute_force(scene).size();
  scene.gravity = {1, -2, -9.81};
  for (const double h : {0.005, 0.05, 0.3}) {
    scene.h = h;
    scene.locks = {};
    this->expect_brute_force(scene);
    for (int i = 0; i < 300; ++i) scene.locks.push_back(static_cast<std::uint8_t>(i % 8));
    this->expect_brute_force(scene);
    EXPECT_GT(this->brute_force(scene).size(), without);
    scene.settings.period = {1.1, 0, 0};
    this->expect_brute_force(scene);
    scene.settings.period = {};
  }
}

TYPED_TEST(BroadPhaseTest, BodiesThatAreNotFiniteAreLeftOut) {
  auto scene = this->random_scene(300, 1.0, 0.05, 0.05, 60);
  auto expected = this->brute_force(scene);
  scene.position[17].y = std::nan("");
  scene.velocity[20].x = std::numeric_limits<TypeParam>::infinity();
  std::erase_if(expected, [](const auto& p) {
    return p.first == 17 || p.second == 17 || p.first == 20 || p.second == 20;
  });
  CollisionRun<TestBackend, TypeParam> run(this->backend(), scene);
  EXPECT_EQ(run.detect().size(), expected.size());
}

TYPED_TEST(BroadPhaseTest, RepeatedStepsGiveEqualBits) {
  const auto scene = this->random_scene(4000, 1.0, 0.02, 0.06, 70);
  CollisionRun<TestBackend, TypeParam> run(this->backend(), scene);
  const auto first = run.detect();
  EXPECT_EQ(run.detect(), first);
  if constexpr (!TestBackend::kIsDevice) {
    for (const int threads : {1, 2, 3}) {
      TestBackend other(threads);
      CollisionRun<TestBackend, TypeParam> again(other, scene);
      EXPECT_EQ(again.detect(), first) << threads << " threads";
    }
  }
}

TYPED_TEST(BroadPhaseTest, BuffersAreReused) {
  const auto scene = this->random_scene(2000, 1.0, 0.03, 0.06, 80);
  CollisionRun<TestBackend, TypeParam> run(this->backend(), scene);
  run.detect();
  const std::size_t peak = this->backend().peak();
  run.detect();
  EXPECT_EQ(this->backend().peak(), peak);
}

TYPED_TEST(BroadPhaseTest, RefusesBadSettings) {
  CollisionScene<TypeParam> scene;
  scene.settings.envelope = -1;
  EXPECT_THROW((CollisionRun<TestBackend, TypeParam>(this->backend(), scene)), std::runtime_error);
  scene.settings.envelope = 0;
  scene.settings.period.y = std::nan("");
  EXPECT_THROW((CollisionRun<TestBackend, TypeParam>(this->backend(), scene)), std::runtime_error);
}

}  // namespace
}  // namespace scree
