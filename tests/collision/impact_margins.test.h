#pragma once
// Contacts around impacts: bodies that are hit within the step and those behind them.

#include <set>

#include "tests/backend_fixture.h"
#include "tests/collision/collision_scene.h"

namespace scree {
namespace {

template <class Real>
class ImpactMarginTest : public BackendTest<Real> {
 protected:
  using Scene = CollisionScene<Real>;
  using Pairs = std::set<std::pair<Index, Index>>;

  /// Spheres of diameter one, envelope 1 % of it, steps of one second.
  static Scene unit_scene() {
    Scene s;
    s.h = 1;
    s.settings.envelope = 0.01;
    s.settings.margin_limit = 0.25;
    return s;
  }

  std::vector<HostContact> contacts(const Scene& scene) {
    CollisionRun<TestBackend, Real> run(this->backend(), scene);
    return run.detect();
  }
  Pairs pairs(const Scene& scene) {
    Pairs out;
    for (const HostContact& c : contacts(scene)) out.emplace(c.a, c.b);
    return out;
  }

  /// A cubic lattice at rest, 5 % of a diameter between neighbors, and a sphere that comes down on
  /// the middle of its top layer. @return index of the sphere that is hit
  static Index add_hit_lattice(Scene& s, int n, double speed) {
    constexpr double kSpacing = 1.05;
    for (int k = 0; k < n * n * n; ++k) {
      s.add_free({kSpacing * (k % n), kSpacing * (k / n % n), kSpacing * (k / (n * n))}, 0.5);
    }
    const Index hit = n / 2 + n * (n / 2) + n * n * (n - 1);
    s.add_free(s.position[static_cast<std::size_t>(hit)] + Vec3<double>{0, 0, kSpacing}, 0.5,
               {0, 0, -speed});
    return hit;
  }
};
TYPED_TEST_SUITE(ImpactMarginTest, Reals);

TYPED_TEST(ImpactMarginTest, RowBehindAHitSphereIsListed) {
  auto s = this->unit_scene();
  for (int k = 0; k < 8; ++k) s.add_free({1.05 * k, 0, 0}, 0.5);
  s.velocity[0] = {static_cast<TypeParam>(0.2), 0, 0};
  // What is left of the way of 0.2 after each gap of 0.05 reaches three spheres on.
  EXPECT_EQ(this->pairs(s), (typename TestFixture::Pairs{{0, 1}, {1, 2}, {2, 3}}));
  s.settings.margin_limit = 0;
  EXPECT_EQ(this->pairs(s), (typename TestFixture::Pairs{{0, 1}}));
}

TYPED_TEST(ImpactMarginTest, AllNeighborsOfAHitSphereAndOfItsNeighborsAreListed) {
  auto s = this->unit_scene();
  const Index hit = this->add_hit_lattice(s, 7, 0.2);
  const auto found = this->pairs(s);
  const auto near = [&](Index i) {
    std::vector<Index> out;
    for (Index j = 0; j < s.owned_count; ++j) {
      if (j != i && norm(s.position[j] - s.position[i]) < 1.06) out.push_back(j);
    }
    return out;
  };
  for (const Index i : near(hit)) {
    EXPECT_TRUE(found.contains(std::minmax(i, hit))) << i;
    if (i == s.owned_count - 1) continue;  // the one that hits
    for (const Index j : near(i)) EXPECT_TRUE(found.contains(std::minmax(i, j))) << i << " " << j;
  }
  EXPECT_LT(found.size(), 60u) << "far from the impact nothing is added";
}

TYPED_TEST(ImpactMarginTest, MarginsEndAtTheirLimit) {
  auto s = this->unit_scene();
  s.add_free({0, 0, 0}, 0.5, {0.4, 0, 0});
  s.add_free({1.1, 0, 0}, 0.5);
  s.add_free({1.1, 1.28, 0}, 0.5);   // beyond the margin of 0.25 and the envelope of 0.01
  s.add_free({1.1, -1.25, 0}, 0.5);  // not beyond
  EXPECT_EQ(this->pairs(s), (typename TestFixture::Pairs{{0, 1}, {1, 3}}));
}

TYPED_TEST(ImpactMarginTest, BodiesSideBySideGetNoMargin) {
  auto s = this->unit_scene();
  this->add_hit_lattice(s, 6, 0);
  for (auto& v : s.velocity) v = {0, 0, -20};
  EXPECT_TRUE(this->contacts(s).empty());
}

TYPED_TEST(ImpactMarginTest, SlowContactsChangeNothing) {
  auto s = this->unit_scene();
  this->add_hit_lattice(s, 6, 0);
  for (auto& x : s.position) x = (1.0 / 1.05) * x;  // all touch
  for (std::size_t i = 0; i < s.velocity.size(); ++i) {
    s.velocity[i] = {0, 0, static_cast<TypeParam>(i % 2 == 0 ? 0.002 : -0.002)};
  }
  const auto with = this->contacts(s);
  s.settings.margin_limit = 0;
  EXPECT_EQ(with, this->contacts(s));
  EXPECT_GT(with.size(), 100u);
}

TYPED_TEST(ImpactMarginTest, WallsBehindAHitSphereAreListed) {
  auto s = this->unit_scene();
  s.add_free({0, 0, 1.62}, 0.5, {0, 0, -0.2});
  s.add_free({0, 0, 0.57}, 0.5);
  s.add_free({3, 0, 0.57}, 0.5);  // is not hit
  s.add_half_space({0, 0, 0}, {0, 0, 1});
  EXPECT_EQ(this->pairs(s), (typename TestFixture::Pairs{{0, 1}, {1, 3}}));
  s.obstacles = {};
  s.position.pop_back();
  s.shape.pop_back();
  s.add_mesh_wall({0, 0, 0}, flat_floor(2, 10));
  s.velocity.resize(s.position.size());
  EXPECT_TRUE(this->pairs(s).contains({1, 3}));
}

TYPED_TEST(ImpactMarginTest, LiftOfSlidingContactsPushes) {
  auto s = this->unit_scene();
  s.add_free({0, 0, 0}, 0.5);
  s.add_free({1.005, 0, 0}, 0.5, {0, 0.4, 0});  // slides past the first
  s.add_free({-1.08, 0, 0}, 0.5);
  EXPECT_EQ(this->pairs(s), (typename TestFixture::Pairs{{0, 1}}));
  s.settings.lift = 0.5;
  EXPECT_EQ(this->pairs(s), (typename TestFixture::Pairs{{0, 1}, {0, 2}}));
  s.settings.layout = ContactLayout::radial;
  EXPECT_EQ(this->pairs(s), (typename TestFixture::Pairs{{0, 1}, {0, 2}}));
  s.angular_velocity[1] = {0, 0, static_cast<TypeParam>(0.8)};  // rolls off: no sliding
  EXPECT_EQ(this->pairs(s), (typename TestFixture::Pairs{{0, 1}}));
  s.settings.layout = ContactLayout::general;
  EXPECT_EQ(this->pairs(s), (typename TestFixture::Pairs{{0, 1}}));
}

TYPED_TEST(ImpactMarginTest, BodiesThatFallOntoOthersWhichAreHeldUpAreListed) {
  auto s = this->unit_scene();  // the envelope is 0.01
  s.gravity = {0, 0, -9.81};
  s.add_free({0, 0, 0.5}, 0.5);
  s.add_free({0, 0, 1.55}, 0.5);
  s.add_half_space({0, 0, 0}, {0, 0, 1});
  const auto are_listed = [&] { return this->pairs(s).contains({0, 1}); };
  s.h = 0.02;  // 4 mm: half the envelope is enough
  EXPECT_FALSE(are_listed());
  s.h = 0.07;  // 48 mm
  EXPECT_TRUE(are_listed());
  s.h = 10;
  s.position[1].z = 2.02;  // farther than the envelope and two margins of a quarter
  EXPECT_FALSE(are_listed());
}

TYPED_TEST(ImpactMarginTest, BoxesGetMargins) {
  auto s = this->unit_scene();
  s.add_free({0, 0, 1.62}, 0.5, {0, 0, -0.2});
  s.add_free_box({0, 0, 0.57}, {0.5, 0.5, 0.5});
  s.add_half_space({0, 0, 0}, {0, 0, 1});
  EXPECT_EQ(this->contacts(s).size(), 5u) << "the sphere on the box, four corners on the floor";
}

TYPED_TEST(ImpactMarginTest, PeriodicNeighborsAreListed) {
  auto s = this->unit_scene();
  s.settings.period = {8 * 1.05, 0, 0};
  for (int k = 0; k < 8; ++k) s.add_free({1.05 * k, 0, 0}, 0.5);
  s.velocity[6] = {static_cast<TypeParam>(0.2), 0, 0};
  EXPECT_EQ(this->pairs(s), (typename TestFixture::Pairs{{4, 5}, {5, 6}, {6, 7}, {0, 7}, {0, 1}}));
}

TYPED_TEST(ImpactMarginTest, EqualBitsOnEveryRunAndForAnyNumberOfThreads) {
  auto s = this->unit_scene();
  this->add_hit_lattice(s, 14, 0.2);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-0.1, 0.1);
  for (auto& v : s.velocity) v += {TypeParam(uniform(random)), TypeParam(uniform(random)), 0};
  CollisionRun<TestBackend, TypeParam> run(this->backend(), s);
  const auto first = run.detect();
  const std::size_t peak = this->backend().peak();
  EXPECT_EQ(run.detect(), first);
  EXPECT_EQ(this->backend().peak(), peak) << "buffers are reused";
  if constexpr (!TestBackend::kIsDevice) {
    for (const int threads : {1, 2, 3}) {
      TestBackend other(threads);
      CollisionRun<TestBackend, TypeParam> again(other, s);
      EXPECT_EQ(again.detect(), first) << threads << " threads";
    }
  }
  s.settings.margin_limit = 0;
  EXPECT_LT(this->contacts(s).size(), first.size());
}

}  // namespace
}  // namespace scree
