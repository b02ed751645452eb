#pragma once
// The list of near pairs that is kept from step to step: contacts have the same bits with it as
// without, and it is rebuilt when it has to be and not before.

#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include "tests/collision/pair_candidates_fixture.h"

namespace scree {
namespace {

template <class Real>
class PairCandidatesTest : public NearPairsTest<Real> {};
TYPED_TEST_SUITE(PairCandidatesTest, Reals);

TYPED_TEST(PairCandidatesTest, SpheresOfOneSize) {
  auto s = this->bed(3000, 0.05, 0.05, 1);
  s.add_half_space({0, 0, 0}, {0, 0, 1});
  this->expect_reuse(s, 1);
}

TYPED_TEST(PairCandidatesTest, SizesOfTenToOne) {
  auto s = this->bed(3000, 0.02, 0.2, 2);
  s.add_half_space({0, 0, 0}, {0, 0, 1});
  this->expect_reuse(s, 0.4);
}

TYPED_TEST(PairCandidatesTest, MeshAndBoxWalls) {
  auto s = this->bed(2000, 0.06, 0.1, 3);
  s.add_half_space({0, 0, 0}, {0, 0, 1});
  s.add_box_wall({0.5, 0.5, 0.1}, {0.1, 0.1, 0.1});
  s.add_mesh_wall({0.5, 0.5, 0.02}, flat_floor(24, 0.05));
  this->expect_reuse(s, 1, 30);
}

TYPED_TEST(PairCandidatesTest, FreeBox) {
  auto s = this->bed(800, 0.05, 0.05, 4);
  s.add_free_box({0.5, 0.5, 0.15}, {0.15, 0.1, 0.05});
  s.add_half_space({0, 0, 0}, {0, 0, 1});
  this->expect_reuse(s, 1, 40, [](auto& scene, int k) {
    auto& turn = scene.angular_velocity[static_cast<std::size_t>(scene.owned_count - 1)];
    turn = {0, static_cast<TypeParam>(k % 3), 1};
  });
}

TYPED_TEST(PairCandidatesTest, PeriodicBox) {
  auto s = this->bed(2500, 0.04, 0.08, 5);
  s.settings.period = {1, 1.1, 0};
  this->expect_reuse(s, 1, 40, [](auto& scene, int k) {
    if (k % 5 != 4) return;  // as a body that passes a side
    for (std::size_t i = 0; i < 300; ++i) scene.position[i].x += i % 2 == 0 ? 1 : -1;
  });
}

TYPED_TEST(PairCandidatesTest, MovingFixedSpheres) {
  auto s = this->bed(1500, 0.05, 0.05, 6);
  std::mt19937 random(7);
  for (int k = 0; k < 60; ++k) {
    s.add(Vec3<double>{0.5, 0.5, 0.15} + 0.5 * this->random_vector(random), 0.06, {0, 2, 0});
  }
  this->expect_reuse(s, 1, 40, [](auto& scene, int) {
    for (auto i = static_cast<std::size_t>(scene.owned_count); i < scene.position.size(); ++i)
      scene.position[i].y += scene.h * 2;
  });
}

TYPED_TEST(PairCandidatesTest, MarginsAroundImpacts) {
  auto s = this->bed(2000, 0.06, 0.06, 8);
  s.add_half_space({0, 0, 0}, {0, 0, 1});
  s.settings.margin_limit = 0.25;
  s.settings.lift = 0.5;
  std::mt19937 random(9);
  this->drift(s, 2, random);
  auto without = s;
  without.settings.margin_limit = 0;
  ASSERT_GT(this->fresh_contacts(s).size(), this->fresh_contacts(without).size());
  this->expect_reuse(s, 2, 30);
}

TYPED_TEST(PairCandidatesTest, BothListingsOfAStepShareAList) {
  auto s = this->bed(2000, 0.06, 0.06, 9);
  s.settings.skin = 0.03;
  std::mt19937 random(10);
  for (auto& v : s.velocity) v = Vec3<TypeParam>(this->random_vector(random));
  const auto plain = this->fresh_contacts(s);
  s.settings.margin_limit = 0.25;
  CollisionRun<TestBackend, TypeParam> run(this->backend(), s);
  EXPECT_GT(run.detect().size(), plain.size());
  EXPECT_EQ(run.detector().list_builds(), 1);
}

TYPED_TEST(PairCandidatesTest, FastAndSpinningBodiesMeetAllThatALongListHas) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    auto s = this->bed(700, 0.03, 0.1, 41 + seed);
    std::mt19937 random(42 + seed);
    s.add_free_box({0.5, 0.5, 0.15}, {0.2, 0.15, 0.04});
    for (int k = 0; k < 10; ++k) {
      s.add(Vec3<double>{0.5, 0.5, 0.15} + 0.4 * this->random_vector(random), 0.05,
            20.0 * this->random_vector(random));
    }
    s.add_half_space({0, 0, 0}, {0, 0, 1});
    if (seed % 2 == 1) s.settings.period = {1, 1.1, 0};
    std::exponential_distribution<double> speed(1.0);
    for (std::size_t i = 0; i < static_cast<std::size_t>(s.owned_count); ++i) {
      s.velocity[i] = Vec3<TypeParam>(20 * speed(random) * this->random_vector(random));
      s.angular_velocity[i] = Vec3<TypeParam>(200 * speed(random) * this->random_vector(random));
    }
    for (const double limit : {0.0, 0.25}) {
      s.settings.margin_limit = limit;
      s.settings.skin = 10;  // all pairs
      const auto all = this->fresh_contacts(s);
      EXPECT_GT(std::count_if(all.begin(), all.end(),
                              [&](const HostContact& c) { return c.b == s.owned_count - 1; }),
                20)
          << "of the box";
      for (const double skin : {0.0, 1e-3, 0.02}) {
        s.settings.skin = skin;
        EXPECT_EQ(this->fresh_contacts(s), all) << "skin " << skin;
      }
    }
  }
}

TYPED_TEST(PairCandidatesTest, AListServesBodiesOnTheirCourse) {
  auto s = this->bed(2000, 0.05, 0.05, 43);
  std::mt19937 random(44);
  for (auto& v : s.velocity) v = Vec3<TypeParam>(1.7 * this->random_vector(random));
  s.settings.skin = 5e-4;  // a step is up to 2.9 mm
  CollisionRun<TestBackend, TypeParam> run(this->backend(), s);
  for (int k = 0; k < 4; ++k) {
    run.scene() = s;
    run.load();
    EXPECT_EQ(run.detect(), this->fresh_contacts(s));
    EXPECT_EQ(run.detector().list_builds(), 1) << "step " << k;
    EXPECT_EQ(run.detector().list_extensions(), 0) << "step " << k;
    for (std::size_t i = 0; i < s.position.size(); ++i) {
      s.position[i] += s.h * Vec3<double>(s.velocity[i]);
    }
  }
  // Suddenly they are three times as fast.
  for (auto& v : s.velocity) v = Vec3<TypeParam>(3.0 * Vec3<double>(v));
  run.scene() = s;
  run.load();
  EXPECT_EQ(run.detect(), this->fresh_contacts(s));
  EXPECT_EQ(run.detector().list_builds(), 2);
}

TYPED_TEST(PairCandidatesTest, InsertedBodies) {
  auto s = this->bed(1000, 0.06, 0.06, 11);
  const auto more = this->bed(50, 0.06, 0.06, 12);
  this->expect_reuse(s, 0.5, 40, [&](auto& scene, int k) {
    if (k % 10 != 3) return;
    for (int n = 0; n < 10; ++n)
      scene.add_free(more.position[static_cast<std::size_t>(k + n)], 0.03);
  });
}

TYPED_TEST(PairCandidatesTest, AsManyBodiesButFewerOfThemFree) {
  auto s = this->bed(1000, 0.06, 0.06, 13);
  CollisionRun<TestBackend, TypeParam> run(this->backend(), s);
  const auto all = run.detect();
  run.scene().owned_count = s.owned_count = 500;
  EXPECT_EQ(run.detect(), this->fresh_contacts(s));
  EXPECT_LT(run.detect().size(), all.size());
}

TYPED_TEST(PairCandidatesTest, RemappedBodies) {
  auto s = this->bed(1500, 0.06, 0.06, 14);
  CollisionRun<TestBackend, TypeParam> run(this->backend(), s);
  run.detect();
  std::vector<Index> new_of_old(1500);
  std::iota(new_of_old.begin(), new_of_old.end(), 0);
  std::shuffle(new_of_old.begin(), new_of_old.end(), std::mt19937(15));
  // Bodies change places with neighbors too near for their balls to tell.
  const auto old = s;
  for (std::size_t i = 0; i < 1500; ++i) {
    const auto n = static_cast<std::size_t>(new_of_old[i]);
    s.position[n] = old.position[i];
    s.radius[n] = old.radius[i];
  }
  Buffer<TestBackend, Index> order(this->backend());
  upload(this->backend(), new_of_old, order);
  run.scene() = s;
  run.load();
  run.detector().remap(this->backend(), run.bodies(), order.view());
  EXPECT_EQ(run.detect(), this->fresh_contacts(s));
  EXPECT_EQ(run.detector().list_builds(), 2);
  // Even where nothing moved, so that no run depends on what its list was.
  run.detector().remap(this->backend(), run.bodies(), order.view());
  run.detect();
  EXPECT_EQ(run.detector().list_builds(), 3);
  run.detector().restore(this->backend(), {}, {});
  run.detect();
  EXPECT_EQ(run.detector().list_builds(), 4);
}

TYPED_TEST(PairCandidatesTest, ListLastsUntilABodyLeavesItsBall) {
  auto s = this->bed(500, 0.06, 0.06, 16);
  s.settings.skin = 0.012;
  for (auto& x : s.position) x += {-3e5, 2e5, 1e5};  // far from the origin, but not from each other
  CollisionRun<TestBackend, TypeParam> run(this->backend(), s);
  const auto changes_after = [&](double way) {
    run.scene().position[123].z = s.position[123].z + way;
    run.load();
    EXPECT_EQ(run.detect(), this->fresh_contacts(run.scene()));
    return run.detector().list_builds() + run.detector().list_extensions();
  };
  for (int k = 0; k < 2; ++k) EXPECT_EQ(changes_after(0), 1) << "nothing moves";
  EXPECT_EQ(changes_after(0.0058), 1) << "within half the skin";
  EXPECT_EQ(changes_after(-0.0058), 1) << "of where the list was made, not of the last place";
  EXPECT_EQ(changes_after(0.0062), 2);
  EXPECT_EQ(changes_after(0.0062 - 0.0058), 2) << "the ball is about the new place";
  EXPECT_EQ(changes_after(0.0062 - 0.0118), 2) << "and has twice the room";
  EXPECT_EQ(changes_after(0.0062 - 0.0122), 3);
  EXPECT_EQ(run.detector().list_builds(), 1) << "one body calls for no new list";
}

TYPED_TEST(PairCandidatesTest, ManyNeighborsOfEachBodyAreAllFound) {
  for (const Index crowd : {Index(20), Index(50), Index(400)}) {  // in slots, in chunks, in neither
    CollisionScene<TypeParam> s;
    s.settings.envelope = 1e-4;
    s.settings.skin = 1e-4;
    std::mt19937 random(48);
    for (Index i = 0; i < crowd; ++i) s.add_free(0.02 * this->random_vector(random), 0.03);
    for (Index i = 0; i < 500; ++i) s.add_free({1 + 0.07 * i, 0, 0}, 0.03);
    std::size_t expected = 0;
    for (std::size_t i = 0; i < s.position.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j)
        expected += norm(s.position[i] - s.position[j]) < 0.06 + 1e-4;
    }
    const auto found = this->fresh_contacts(s);
    EXPECT_EQ(found.size(), expected) << crowd << " bodies";
    EXPECT_GT(found.size(), static_cast<std::size_t>(crowd * (crowd - 1) / 2 * 9 / 10));
    EXPECT_TRUE(this->is_ascending(found));
  }
}

TYPED_TEST(PairCandidatesTest, ListThatSoonEndsGetsMoreSkin) {
  auto s = this->bed(6000, 0.03, 0.03, 35);
  CollisionRun<TestBackend, TypeParam> run(this->backend(), s);
  const auto builds_for = [&](int steps) {
    const auto before = run.detector().list_builds();
    for (int k = 0; k < steps; ++k) {
      for (std::size_t i = 0; i < s.position.size(); ++i) {
        s.position[i].z += (i % 2 == 0 ? 0.25 : -0.25) * s.settings.skin;
      }
      run.scene() = s;
      run.load();
      EXPECT_EQ(run.detect(), this->fresh_contacts(s));
    }
    return run.detector().list_builds() - before;
  };
  const auto first = builds_for(12);
  EXPECT_GE(first, 2);
  EXPECT_LT(builds_for(12), first);
}

TYPED_TEST(PairCandidatesTest, SpeedIsPartOfTheReach) {
  auto s = this->bed(1500, 0.05, 0.05, 17);
  CollisionRun<TestBackend, TypeParam> run(this->backend(), s);
  run.detect();
  run.scene().velocity[7] = s.velocity[7] = {0, static_cast<TypeParam>(120), 0};
  run.load();
  EXPECT_EQ(run.detect(), this->fresh_contacts(s));
  EXPECT_EQ(run.detector().list_extensions(), 1);
  std::mt19937 random(18);
  for (auto& v : s.velocity) v = Vec3<TypeParam>(0.1 * this->random_vector(random));
  CollisionRun<TestBackend, TypeParam> slow(this->backend(), s);
  const auto before = slow.detect();
  slow.scene().h = s.h = 0.3;  // the same speeds, longer steps
  const auto after = slow.detect();
  EXPECT_EQ(after, this->fresh_contacts(s));
  EXPECT_GT(after.size(), before.size());
}

TYPED_TEST(PairCandidatesTest, LargerBodiesReachFarther) {
  auto s = this->bed(1000, 0.05, 0.05, 19);
  CollisionRun<TestBackend, TypeParam> run(this->backend(), s);
  const auto before = run.detect();
  for (auto& r : s.radius) r *= static_cast<TypeParam>(1.5);
  run.scene() = s;
  run.load();
  const auto after = run.detect();
  EXPECT_EQ(after, this->fresh_contacts(s));
  EXPECT_GT(after.size(), before.size());
}

TYPED_TEST(PairCandidatesTest, FastBodyMeetsNoneUnseen) {
  auto s = this->bed(2000, 0.05, 0.05, 20);
  s.h = 1;
  // Ten times its diameter a step, through all the others.
  s.add_free({-2, 0.4, 0.15}, 0.025, {0.5, 0.02, 0});
  CollisionRun<TestBackend, TypeParam> run(this->backend(), s);
  const auto last = static_cast<std::size_t>(s.owned_count - 1);
  std::size_t met = 0;
  for (int k = 0; k < 8; ++k) {
    s.position[last] =
        Vec3<double>{-2, 0.4, 0.15} + static_cast<double>(k) * Vec3<double>{0.5, 0.02, 0};
    run.scene() = s;
    run.load();
    const auto found = run.detect();
    ASSERT_EQ(found, this->fresh_contacts(s)) << "step " << k;
    const Vec3<double> v(s.velocity[last]);
    for (Index i = 0; i < s.owned_count - 1; ++i) {
      const Vec3<double> d = s.position[last] - s.position[static_cast<std::size_t>(i)];
      const double gap = norm(d) - 0.05;
      if (!(gap + std::min(0.0, dot(d, v) / norm(d)) < 0.9 * s.settings.envelope)) continue;
      ++met;
      EXPECT_TRUE(
          std::any_of(found.begin(), found.end(),
                      [&](const HostContact& c) { return c.a == i && c.b == s.owned_count - 1; }))
          << "step " << k << ", body " << i;
    }
  }
  EXPECT_GT(met, 50u);
}

TYPED_TEST(PairCandidatesTest, StatesThatAreNotFinite) {
  auto s = this->bed(600, 0.08, 0.08, 21);
  const auto all = this->fresh_contacts(s);
  const auto of = [](const std::vector<HostContact>& contacts, Index i) {
    return std::count_if(contacts.begin(), contacts.end(),
                         [&](const HostContact& c) { return c.a == i || c.b == i; });
  };
  ASSERT_GT(of(all, 17), 0);
  ASSERT_GT(of(all, 20), 0);
  CollisionRun<TestBackend, TypeParam> run(this->backend(), s);
  run.detect();
  const auto detect = [&] {
    run.load();
    return run.detect();
  };
  run.scene().position[17].y = std::nan("");
  run.scene().velocity[20].x = std::numeric_limits<TypeParam>::infinity();
  const auto without = detect();
  EXPECT_EQ(of(without, 17) + of(without, 20), 0);
  EXPECT_GT(without.size(), all.size() / 2);
  run.scene() = s;
  EXPECT_EQ(detect(), all);
}

TYPED_TEST(PairCandidatesTest, PassingAPeriodicSideIsNoMotion) {
  auto s = this->bed(500, 0.05, 0.05, 27);
  s.settings.period = {1, 1, 1};
  CollisionRun<TestBackend, TypeParam> run(this->backend(), s);
  const auto before = run.detect();
  for (auto& x : run.scene().position) x += {1, -2, 0};
  run.load();
  EXPECT_EQ(run.detect().size(), before.size());
  EXPECT_EQ(run.detector().list_builds(), 1);
}

TYPED_TEST(PairCandidatesTest, WithoutSkinEachListingMakesItsOwn) {
  CollisionScene<TypeParam>
      s;  // balls that float holds exactly: nothing but the rule ends the list
  for (int k = 0; k < 4; ++k) s.add_free({0.125 * k, 0, 0}, 1);
  s.add_half_space({0, 0, 0}, {0, 0, 1});
  s.settings.skin = 1e-3;
  const auto with = this->fresh_contacts(s);
  EXPECT_EQ(with.size(), 10u);
  s.settings.skin = 0;
  CollisionRun<TestBackend, TypeParam> run(this->backend(), s);
  for (int k = 1; k <= 3; ++k) {
    EXPECT_EQ(run.detect(), with);
    EXPECT_EQ(run.detector().list_builds(), k);
  }
}

TYPED_TEST(PairCandidatesTest, ListThatIsNotKept) {
  auto s = this->bed(3000, 0.06, 0.06, 23);
  s.settings.margin_limit = 0.25;
  s.settings.skin = 0.03;
  std::mt19937 random(24);
  for (auto& v : s.velocity) v = Vec3<TypeParam>(this->random_vector(random));
  TestBackend& b = this->backend();
  const std::size_t empty = b.allocated();
  std::size_t with = 0;
  std::vector<HostContact> expected;
  {
    CollisionRun<TestBackend, TypeParam> run(b, s);
    expected = run.detect();
    with = b.allocated() - empty;
  }
  s.settings.keep_candidates = false;
  CollisionRun<TestBackend, TypeParam> run(b, s);
  EXPECT_EQ(run.detect(), expected);
  EXPECT_EQ(run.detector().list_builds(), 1) << "shared within a step";
  EXPECT_LT(b.allocated() - empty, with - 3000 * 24);
  EXPECT_EQ(run.detect(), expected);
  EXPECT_EQ(run.detector().list_builds(), 2);
}

TYPED_TEST(PairCandidatesTest, OneBodyAmongThousands) {
  CollisionScene<TypeParam> s;
  s.settings.envelope = 0.002;
  s.settings.skin = 0.002;
  // Around the large body and before it, after it in storage: its candidates fill many pieces.
  std::mt19937 random(25);
  const auto on_surface = [&] {
    return 0.512 * normalized(this->random_vector(random) + Vec3<double>{1e-6, 0, 0});
  };
  for (int k = 0; k < 100; ++k) s.add_free(on_surface(), 0.012);
  const Index large = s.add_free({0, 0, 0}, 0.5);
  for (int k = 0; k < 3000; ++k) s.add_free(on_surface(), 0.012);
  s.add_half_space({0, 0, -0.5}, {0, 0, 1});
  const auto found = this->fresh_contacts(s);
  EXPECT_TRUE(this->is_ascending(found));
  const auto of_large = std::count_if(found.begin(), found.end(), [&](const HostContact& c) {
    return c.a == large || c.b == large;
  });
  EXPECT_EQ(of_large, 3101);
}

TYPED_TEST(PairCandidatesTest, ContactsWithOneMeshAreInOrder) {
  // Valleys in which spheres touch both sides; triangles listed in no order.
  MeshSource m;
  m.closed = false;
  for (int k = 0; k <= 16; ++k) {
    for (const double y : {-1.0, 1.0}) m.vertices.push_back({0.1 * k, y, k % 2 == 0 ? 0.1 : 0.0});
  }
  for (Index k = 0; k < 16; ++k) {
    const Index v = 2 * k;
    m.triangles.push_back({v, v + 2, v + 3});
    m.triangles.push_back({v, v + 3, v + 1});
  }
  std::shuffle(m.triangles.begin(), m.triangles.end(), std::mt19937(28));
  CollisionScene<TypeParam> s;
  s.settings.envelope = 1e-3;
  s.settings.skin = 0.01;
  for (int k = 0; k < 40; ++k) {
    s.add_free({0.1 + 0.2 * (k % 8), -0.5 + 0.2 * (k / 8), 0.05 * std::sqrt(2.0)}, 0.05);
  }
  s.add_mesh_wall({0, 0, 0}, m);
  s.add_half_space({0, 0, 0.05 * (std::sqrt(2.0) - 1)}, {0, 0, 1});
  const auto found = this->fresh_contacts(s);
  EXPECT_GE(found.size(), 120u) << "two sides and a plane each";
  EXPECT_TRUE(this->is_ascending(found));
}

TYPED_TEST(PairCandidatesTest, RefusesBadSkin) {
  CollisionScene<TypeParam> s;
  for (const double skin : {-0.1, std::nan(""), std::numeric_limits<double>::infinity()}) {
    s.settings.skin = skin;
    EXPECT_THROW((CollisionRun<TestBackend, TypeParam>(this->backend(), s)), std::runtime_error);
  }
}

}  // namespace
}  // namespace scree
