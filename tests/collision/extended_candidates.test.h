#pragma once
// The list of near pairs is extended when few bodies leave their balls, and not when many do.

#include "tests/collision/pair_candidates_fixture.h"

namespace scree {
namespace {

template <class Real>
class ExtendedCandidatesTest : public NearPairsTest<Real> {};
TYPED_TEST_SUITE(ExtendedCandidatesTest, Reals);

TYPED_TEST(ExtendedCandidatesTest, OldListIsMadeAnew) {
  auto s = this->bed(500, 0.06, 0.06, 16);
  s.settings.skin = 0.012;
  CollisionRun<TestBackend, TypeParam> run(this->backend(), s);
  for (int k = 0; k < 20; ++k) run.detect();
  EXPECT_EQ(run.detector().list_builds(), 1);
  run.scene().position[123].z += 0.01;
  run.load();
  EXPECT_EQ(run.detect(), this->fresh_contacts(run.scene()));
  EXPECT_EQ(run.detector().list_builds(), 2);
  EXPECT_EQ(run.detector().list_extensions(), 0);
}

/// One body goes its way through a bed at rest: the step before it leaves its ball an old list is told to be spent.
TYPED_TEST(ExtendedCandidatesTest, ASpentListIsToldAStepAhead) {
  auto s = this->bed(500, 0.06, 0.06, 16);
  s.settings.skin = 0.012;
  CollisionRun<TestBackend, TypeParam> run(this->backend(), s), retired(this->backend(), s);
  for (int k = 0; k < 20; ++k) run.detect(), retired.detect();
  EXPECT_FALSE(run.detector().has_spent_list());  // nothing moves
  const auto go = [&](auto& moving) {
    moving.scene().velocity[123].z = TypeParam(0.3);
    moving.scene().position[123].z += 3e-4;
    moving.load();
    return moving.detect();
  };
  int steps = 0;
  while (!run.detector().has_spent_list() && steps < 100) {
    const auto found = go(run);
    EXPECT_TRUE(found == this->fresh_contacts(run.scene())) << steps;
    go(retired);
    ++steps;
  }
  EXPECT_GT(steps, 5);
  EXPECT_EQ(run.detector().list_builds(), 1);
  go(run);
  EXPECT_EQ(run.detector().list_builds(), 2);
  EXPECT_FALSE(run.detector().has_spent_list());  // a young one is extended
  retired.detector().renew_list();
  EXPECT_TRUE(retired.detect() == this->fresh_contacts(retired.scene()));
  EXPECT_EQ(retired.detector().list_builds(), 2);
  retired.detect();
  EXPECT_EQ(retired.detector().list_builds(), 2);
}

/// A body that is faster than others leaves its first ball after two steps, and its second one not within ten more.
TYPED_TEST(ExtendedCandidatesTest, ABodyThatLeavesHasRoomForTheRestOfTheList) {
  auto s = this->bed(500, 0.06, 0.06, 16);
  s.settings.skin = 0.012;
  CollisionRun<TestBackend, TypeParam> run(this->backend(), s);
  run.detect();
  for (int step = 0; step < 10; ++step) {
    run.scene().velocity[123].z = TypeParam(3);
    run.scene().position[123].z += 3e-3;
    run.load();
    EXPECT_TRUE(run.detect() == this->fresh_contacts(run.scene())) << step;
  }
  EXPECT_EQ(run.detector().list_builds(), 1);
  EXPECT_EQ(run.detector().list_extensions(), 1);
}

TYPED_TEST(ExtendedCandidatesTest, ManyBodiesThatLeaveCallForANewList) {
  auto s = this->bed(6000, 0.03, 0.03, 31);
  CollisionRun<TestBackend, TypeParam> run(this->backend(), s);
  run.detect();
  for (std::size_t i = 0; i < s.position.size(); i += 2) s.position[i].z += 0.01;
  run.scene() = s;
  run.load();
  EXPECT_EQ(run.detect(), this->fresh_contacts(s));
  EXPECT_EQ(run.detector().list_builds(), 2);
  EXPECT_EQ(run.detector().list_extensions(), 0);
}

TYPED_TEST(ExtendedCandidatesTest, BodiesThatReachTooMuchCallForANewList) {
  auto s = this->bed(4000, 0.03, 0.03, 36);  // in no order: each reaches all groups of others
  CollisionRun<TestBackend, TypeParam> run(this->backend(), s);
  run.detect();
  const std::size_t most = TestBackend::kIsDevice ? 400 : 100;
  for (std::size_t i = 0; i < most; ++i) s.position[9 * i].z += 0.01;
  run.scene() = s;
  run.load();
  EXPECT_EQ(run.detect(), this->fresh_contacts(s));
  EXPECT_EQ(run.detector().list_builds(), 2);
  EXPECT_EQ(run.detector().list_extensions(), 0);
}

TYPED_TEST(ExtendedCandidatesTest, BodiesThatLeaveMeetAllOthersAndEachOther) {
  for (const bool is_periodic : {false, true}) {
    auto s = this->bed(4000, 0.02, 0.2, 32);
    s.add_half_space({0, 0, 0}, {0, 0, 1});
    std::mt19937 random(33);
    for (int k = 0; k < 40; ++k)
      s.add(Vec3<double>{0.5, 0.5, 0.1} + 0.5 * this->random_vector(random), 0.03);
    if (is_periodic) s.settings.period = {1, 1, 0};
    CollisionRun<TestBackend, TypeParam> run(this->backend(), s);
    run.detect();
    std::uniform_real_distribution<double> uniform(0, 1);
    for (std::size_t k = 0; k < 5; ++k) {
      for (std::size_t i = 7 + k; i < s.position.size(); i += 173) {  // fixed spheres as well
        s.position[i] = {uniform(random), uniform(random), 0.3 * uniform(random)};
      }
      for (std::size_t i = 7 + k; i + 346 < s.position.size(); i += 346) {  // two that left meet
        s.position[i + 173] = s.position[i] + Vec3<double>{0.005, 0, 0};
        if (is_periodic) s.position[i + 173].y -= 1;
        // And one that left in an extension before.
        if (k > 0 && i % 692 < 346) s.position[i] = s.position[i - 1] + Vec3<double>{0, 0.004, 0};
      }
      run.scene() = s;
      run.load();
      const auto found = run.detect();
      ASSERT_EQ(found, this->fresh_contacts(s)) << "step " << k;
      EXPECT_TRUE(this->is_ascending(found));
      EXPECT_EQ(run.detector().list_builds(), 1);
      EXPECT_EQ(run.detector().list_extensions(), static_cast<int>(k) + 1);
    }
  }
}

TYPED_TEST(ExtendedCandidatesTest, MarginsExtendAListInTheMiddleOfAStep) {
  CollisionScene<TypeParam> s;
  s.settings.envelope = 4e-4;
  s.settings.skin = 1e-3;
  std::mt19937 random(51);
  for (unsigned n = 0; n < 4096; ++n) {  // a loose lattice in Morton order
    Vec3<double> cell;
    for (unsigned bit = 0; bit < 12; ++bit) cell[bit % 3] += (n >> bit & 1) << bit / 3;
    s.add_free(0.0612 * cell + 1e-3 * this->random_vector(random), 0.03);
  }
  CollisionRun<TestBackend, TypeParam> without(this->backend(), s);
  s.settings.margin_limit = 0.25;
  s.settings.lift = 1;
  CollisionRun<TestBackend, TypeParam> with(this->backend(), s);
  without.detect(), with.detect();
  for (std::size_t i = 0; i < s.position.size(); ++i) {
    if (norm(s.position[i] - Vec3<double>{0.5, 0.5, 0.5}) > 0.15) continue;
    const auto way = this->random_vector(random);
    s.velocity[i] = Vec3<TypeParam>(0.48 / norm(way) * way);
  }
  with.scene() = s;
  with.load();
  const auto found = with.detect();
  auto& plain = without.scene();
  plain.velocity = s.velocity;
  without.load();
  // Within the skin as they are, hit bodies reach farther: the list grew after it had served once.
  EXPECT_GT(found.size(), without.detect().size());
  EXPECT_EQ(without.detector().list_extensions(), 0);
  EXPECT_EQ(with.detector().list_builds(), 1);
  EXPECT_GE(with.detector().list_extensions(), 1);
  s.settings.skin = 0;  // a new list for each listing
  EXPECT_EQ(found, this->fresh_contacts(s));
}

TYPED_TEST(ExtendedCandidatesTest, BodiesThatLeaveMeetNeighborsInStorage) {
  for (const bool is_periodic : {false, true}) {
    CollisionScene<TypeParam> s;  // a row in the order of storage, and fixed spheres at its end
    s.settings.envelope = 4e-4;
    s.settings.skin = 4e-3;
    constexpr Index kCount = 2003;
    for (Index i = 0; i < kCount; ++i) s.add_free({0.02 * i, 0, 0}, 0.01);
    for (int k = 0; k < 5; ++k) s.add(Vec3<double>{0.02 * (kCount + k), 0, 0}, 0.01);
    const double length = 0.02 * (kCount + 5);
    if (is_periodic) s.settings.period = {length, 0, 0};
    CollisionRun<TestBackend, TypeParam> run(this->backend(), s);
    const auto row = run.detect();
    std::mt19937 random(47);
    std::uniform_real_distribution<double> uniform(0, length);
    for (int k = 0; k < 8; ++k) {
      for (std::size_t i = 5; i < kCount; i += 97) {
        s.position[i] = {uniform(random), i % 2 == 0 ? 0.0175 : -0.0175, 0};
      }
      s.position[5].x = 0.001;  // at both ends
      s.position[102].x = length - 0.001;
      run.scene() = s;
      run.load();
      const auto found = run.detect();
      ASSERT_EQ(found, this->fresh_contacts(s)) << "step " << k;
      // 21 bodies left two neighbors each, and most meet others.
      EXPECT_GT(found.size(), row.size() - 2 * 21 + 15);
      EXPECT_EQ(run.detector().list_builds(), 1);
      EXPECT_EQ(run.detector().list_extensions(), k + 1);
    }
  }
}

TYPED_TEST(ExtendedCandidatesTest, LargeBodyThatLeavesMeetsThousands) {
  auto s = this->bed(5000, 0.02, 0.03, 34);
  const Index large = s.add_free({0.5, 0.5, 3}, 0.4);
  CollisionRun<TestBackend, TypeParam> run(this->backend(), s);
  run.detect();
  s.position[static_cast<std::size_t>(large)].z = 0.2;
  run.scene() = s;
  run.load();
  const auto found = run.detect();
  EXPECT_EQ(found, this->fresh_contacts(s));
  EXPECT_GT(
      std::count_if(found.begin(), found.end(), [&](const HostContact& c) { return c.b == large; }),
      1000);
  EXPECT_EQ(run.detector().list_builds(), 1);
}

}  // namespace
}  // namespace scree
