#pragma once
// Warm-start impulses: matched by key, and carried through a reordering of the bodies.

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "collision/body_order.h"
#include "tests/backend_fixture.h"
#include "tests/collision/collision_scene.h"

namespace scree {
namespace {

template <class Real>
class PersistentContactsTest : public BackendTest<Real> {
 protected:
  template <class T>
  Buffer<TestBackend, T> buffer(const std::vector<T>& values) {
    Buffer<TestBackend, T> out(this->backend());
    upload(this->backend(), values, out);
    return out;
  }
  static Vec3<Real> stamp(double k) {
    return {static_cast<Real>(k), static_cast<Real>(k + 0.25), static_cast<Real>(-k)};
  }
  /// A bed of spheres on a floor, several contacts a body.
  static CollisionScene<Real> bed(Index count, unsigned seed) {
    CollisionScene<Real> s;
    s.settings.envelope = 0.01;
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (Index i = 0; i < count; ++i)
      s.add_free({uniform(random), uniform(random), 0.3 * uniform(random)}, 0.06);
    s.add({0.5, 0.5, 0.1}, 0.2);
    s.add_half_space({0, 0, 0}, {0, 0, 1});
    s.add_mesh_wall({0.5, 0.5, 0.02}, flat_floor(8, 0.2));
    return s;
  }
};
TYPED_TEST_SUITE(PersistentContactsTest, Reals);

TYPED_TEST(PersistentContactsTest, AMeanGoesOnWhereAContactCarriesAgain) {
  using Vec = Vec3<TypeParam>;
  const Vec zero{}, before{1, 0, 4}, found{3, 2, 8};
  Buffer<TestBackend, Vec> impulse = this->buffer(std::vector<Vec>{found, found, zero, zero});
  Buffer<TestBackend, Vec> guess = this->buffer(std::vector<Vec>{before, zero, before, zero});
  for_each(this->backend(), 4,
           AverageImpulses<TypeParam>{std::as_const(impulse).view(4), guess.view(4)});
  const std::vector<Vec> mean = download(this->backend(), std::as_const(guess).view(4));
  EXPECT_EQ(mean[0], Vec(2, 1, 6));
  EXPECT_EQ(mean[1], found) << "new, or open before";
  EXPECT_EQ(mean[2], zero) << "open now";
  EXPECT_EQ(mean[3], zero);
}

TYPED_TEST(PersistentContactsTest, MatchFindsOldImpulsesAndZeroForNew) {
  for (const int vectors : {1, 2}) {
    PersistentContacts<TestBackend, TypeParam> memory(this->backend());
    std::mt19937_64 random(3);
    std::set<std::uint64_t> all;
    while (all.size() < 5000) all.insert(random() % 40000);
    std::vector<std::uint64_t> old_keys, new_keys;
    for (const std::uint64_t key : all) {
      if (random() % 4 != 0) old_keys.push_back(key);
      if (random() % 4 != 0) new_keys.push_back(key);
    }
    std::vector<Vec3<TypeParam>> old_impulses;
    for (const std::uint64_t key : old_keys) {
      for (int v = 0; v < vectors; ++v)
        old_impulses.push_back(this->stamp(static_cast<double>(key) + 0.5 * v));
    }
    auto old_key = this->buffer(old_keys), new_key = this->buffer(new_keys);
    auto old_impulse = this->buffer(old_impulses);
    Buffer<TestBackend, Vec3<TypeParam>> warm(this->backend(),
                                              static_cast<Offset>(new_keys.size()) * vectors);
    memory.match(this->backend(), new_key.view(), vectors, warm.view());
    for (const auto& g : download(this->backend(), warm.view())) EXPECT_EQ(g, Vec3<TypeParam>{});

    memory.keep(std::move(old_key), static_cast<Index>(old_keys.size()), vectors,
                std::move(old_impulse));
    memory.match(this->backend(), new_key.view(), vectors, warm.view());
    const auto found = download(this->backend(), warm.view());
    for (std::size_t c = 0; c < new_keys.size(); ++c) {
      const bool known = std::binary_search(old_keys.begin(), old_keys.end(), new_keys[c]);
      for (int v = 0; v < vectors; ++v) {
        const Vec3<TypeParam> expected =
            known ? this->stamp(static_cast<double>(new_keys[c]) + 0.5 * v) : Vec3<TypeParam>{};
        EXPECT_EQ(found[c * vectors + v], expected);
      }
    }
  }
}

TYPED_TEST(PersistentContactsTest, MatchOfEmptyLists) {
  PersistentContacts<TestBackend, TypeParam> memory(this->backend());
  Buffer<TestBackend, std::uint64_t> none(this->backend());
  Buffer<TestBackend, Vec3<TypeParam>> nothing(this->backend());
  memory.match(this->backend(), none.view(), 1, nothing.view());
  memory.keep(Buffer<TestBackend, std::uint64_t>(this->backend()), 0, 1,
              Buffer<TestBackend, Vec3<TypeParam>>(this->backend()));
  auto one = this->buffer(std::vector<std::uint64_t>{7});
  Buffer<TestBackend, Vec3<TypeParam>> warm(this->backend(), 1);
  memory.match(this->backend(), one.view(), 1, warm.view());
  EXPECT_EQ(download(this->backend(), warm.view())[0], Vec3<TypeParam>{});
}

TYPED_TEST(PersistentContactsTest, UnchangedSceneKeepsAllImpulses) {
  CollisionRun<TestBackend, TypeParam> run(this->backend(), this->bed(400, 1));
  const auto contacts = run.detect();
  std::vector<Vec3<TypeParam>> impulses;
  for (std::size_t c = 0; c < contacts.size(); ++c)
    impulses.push_back(this->stamp(static_cast<double>(c)));
  auto gamma = this->buffer(impulses);
  run.detector().keep(1, this->buffer(impulses));
  run.detect();
  fill(this->backend(), gamma.view(), Vec3<TypeParam>{});
  run.detector().match(this->backend(), 1, gamma.view());
  EXPECT_EQ(download(this->backend(), gamma.view()), impulses);
}

TYPED_TEST(PersistentContactsTest, ReorderedBodiesKeepTheirImpulses) {
  auto& b = this->backend();
  CollisionRun<TestBackend, TypeParam> run(b, this->bed(400, 2));
  const auto before = run.detect();
  // An impulse that acts on the body of the pair with the larger x is positive.
  const auto toward = [&](const HostContact& c, const std::vector<Vec3<double>>& x) {
    return c.b >= run.scene().owned_count || x[c.b].x > x[c.a].x ? 1.0 : -1.0;
  };
  std::vector<Vec3<TypeParam>> impulses;
  std::map<std::pair<double, double>, double> expected;  // by the places of the two bodies
  const auto place = [&](const HostContact& c, const std::vector<Vec3<double>>& x) {
    // Contacts of one sphere with one wall share a place; their sum is compared.
    return std::pair{std::min(x[c.a].x, x[c.b].x), std::max(x[c.a].x, x[c.b].x)};
  };
  for (std::size_t c = 0; c < before.size(); ++c) {
    const double value = 1.0 + static_cast<double>(c % 97);
    const double signed_value = toward(before[c], run.scene().position) * value;
    impulses.push_back({static_cast<TypeParam>(signed_value), 0, 0});
    impulses.push_back({0, static_cast<TypeParam>(signed_value), 0});
    expected[place(before[c], run.scene().position)] += value;
  }
  run.detector().keep(2, this->buffer(impulses));

  run.reorder();

  const auto after = run.detect();
  ASSERT_EQ(after.size(), before.size());
  Buffer<TestBackend, Vec3<TypeParam>> warm(b, static_cast<Offset>(after.size()) * 2);
  run.detector().match(b, 2, warm.view());
  const auto found = download(b, warm.view());
  for (std::size_t c = 0; c < after.size(); ++c) {
    const double sign = toward(after[c], run.scene().position);
    expected[place(after[c], run.scene().position)] -= sign * static_cast<double>(found[2 * c].x);
    EXPECT_EQ(found[2 * c].x, found[2 * c + 1].y);
    EXPECT_NE(found[2 * c].x, 0);
  }
  for (const auto& [bodies_of_pair, rest] : expected) EXPECT_EQ(rest, 0);
}

TYPED_TEST(PersistentContactsTest, MarksFollowTheirContacts) {
  auto& b = this->backend();
  CollisionRun<TestBackend, TypeParam> run(b, this->bed(400, 2));
  const auto before = run.detect();
  const auto count = static_cast<Offset>(before.size());
  Buffer<TestBackend, Index> mark(b, count);
  run.detector().match_marks(b, mark.view());  // nothing is known yet
  EXPECT_EQ(download(b, mark.view()), std::vector<Index>(before.size(), -1));

  // A contact is known by the places of its bodies; those of one sphere with one wall share it.
  const auto place = [&](const HostContact& c) {
    const auto& x = run.scene().position;
    return std::pair{std::min(x[c.a].x, x[c.b].x), std::max(x[c.a].x, x[c.b].x)};
  };
  std::map<std::pair<double, double>, std::multiset<Index>> expected;
  std::vector<Index> values;
  for (std::size_t c = 0; c < before.size(); ++c) {
    values.push_back(static_cast<Index>(c % 13));
    expected[place(before[c])].insert(values.back());
  }
  upload(b, values, mark);
  auto gamma = this->buffer(std::vector<Vec3<TypeParam>>(before.size()));
  run.detector().keep(1, std::move(gamma));
  run.detector().keep_marks(std::move(mark));
  EXPECT_EQ(run.detector().save_marks(b), values);

  run.reorder();
  const auto after = run.detect();
  Buffer<TestBackend, Index> matched(b, count);
  run.detector().match_marks(b, matched.view());
  const auto found = download(b, matched.view());
  std::map<std::pair<double, double>, std::multiset<Index>> actual;
  for (std::size_t c = 0; c < after.size(); ++c) actual[place(after[c])].insert(found[c]);
  EXPECT_EQ(actual, expected);

  // Marks that are not kept again are forgotten.
  run.detector().keep(1, this->buffer(std::vector<Vec3<TypeParam>>(after.size())));
  EXPECT_TRUE(run.detector().save_marks(b).empty());
}

/// Ghosts behind 10 owned bodies: one stays, one goes, two change places.
TYPED_TEST(PersistentContactsTest, GhostsKeepTheirImpulsesInNewPlaces) {
  ContactKeys rule;
  rule.feature_bits = 1;
  rule.wall_begin = 200;
  const auto key = [&](Index a, Index b, std::uint32_t feature) {
    return make_key(a, rule.body_element(b, feature));
  };
  const std::vector<std::uint64_t> before{key(0, 3, 0),     key(0, 10, 1), key(0, 11, 0),
                                          make_key(0, 205), key(2, 12, 0), key(2, 13, 1)};
  std::vector<Vec3<TypeParam>> impulses;
  for (std::size_t k = 0; k < before.size(); ++k)
    impulses.push_back(this->stamp(static_cast<double>(k)));
  PersistentContacts<TestBackend, TypeParam> memory(this->backend());
  memory.keep(this->buffer(before), static_cast<Index>(before.size()), 1, this->buffer(impulses));
  memory.rename_ghosts(this->backend(), rule, 10, {10, -1, 14, 11});
  const std::vector<std::uint64_t> expected{key(0, 3, 0), key(0, 10, 1), make_key(0, 205),
                                            key(2, 11, 1), key(2, 14, 0)};
  EXPECT_EQ(download(this->backend(), memory.keys()), expected);
  const auto moved = download(this->backend(), memory.impulses());
  ASSERT_EQ(moved.size(), expected.size());
  const double of[] = {0, 1, 3, 5, 4};
  for (std::size_t k = 0; k < moved.size(); ++k) EXPECT_EQ(moved[k].x, this->stamp(of[k]).x) << k;
}

TYPED_TEST(PersistentContactsTest, SavedMemoryRestores) {
  auto& b = this->backend();
  CollisionRun<TestBackend, TypeParam> run(b, this->bed(200, 4)), other(b, this->bed(200, 4));
  const auto contacts = run.detect();
  std::vector<Vec3<TypeParam>> impulses;
  for (std::size_t c = 0; c < contacts.size(); ++c)
    impulses.push_back(this->stamp(0.1 * static_cast<double>(c)));
  run.detector().keep(1, this->buffer(impulses));
  std::vector<std::uint64_t> keys;
  std::vector<Vec3<double>> values;
  run.detector().save(b, keys, values);
  other.detector().restore(b, keys, values);
  other.detect();
  Buffer<TestBackend, Vec3<TypeParam>> gamma(b, static_cast<Offset>(impulses.size()));
  other.detector().match(b, 1, gamma.view());
  EXPECT_EQ(download(b, gamma.view()), impulses);
}

template <class Real>
class BodyOrderTest : public PersistentContactsTest<Real> {};
TYPED_TEST_SUITE(BodyOrderTest, Reals);

TYPED_TEST(BodyOrderTest, IsAPermutationThatBringsNeighborsTogether) {
  auto& b = this->backend();
  std::mt19937 random(8);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Vec3<double>> x;
  for (int k = 0; k < 5000; ++k) x.push_back({uniform(random), uniform(random), uniform(random)});
  x[10] = {1e6, -1e6, 3};  // a body far away does not spoil the order of the others
  auto position = this->buffer(x);
  BodyOrder<TestBackend> order(b);
  order.compute(b, position.view());
  const auto forward = download(b, order.order()), back = download(b, order.new_of_old());
  std::vector<bool> seen(x.size());
  for (std::size_t k = 0; k < x.size(); ++k) {
    seen[static_cast<std::size_t>(forward[k])] = true;
    EXPECT_EQ(back[static_cast<std::size_t>(forward[k])], static_cast<Index>(k));
  }
  EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](bool s) { return s; }));

  order.apply(b, position.view());
  const auto moved = download(b, position.view());
  std::size_t close = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    EXPECT_EQ(moved[k], x[static_cast<std::size_t>(forward[k])]);
    close += k > 0 && norm(moved[k] - moved[k - 1]) < 0.15;
  }
  EXPECT_GT(close, x.size() * 9 / 10);
}

TYPED_TEST(BodyOrderTest, LateBodiesComeLastAndLeaveTheOrderOfTheOthers) {
  auto& b = this->backend();
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Vec3<double>> x;
  std::vector<Index> id;
  for (Index k = 0; k < 3000; ++k) {
    x.push_back({uniform(random), uniform(random), uniform(random)});
    id.push_back(k);
  }
  BodyOrder<TestBackend> order(b);
  auto before = this->buffer(x);
  order.compute(b, before.view());
  const auto alone = download(b, order.order());
  for (Index k = 0; k < 1000; ++k) {
    x.push_back({30 + uniform(random), uniform(random), uniform(random)});
    id.push_back(5000 + k);
  }
  auto after = this->buffer(x);
  auto ids = this->buffer(id);
  order.compute(b, after.view(), {ids.view(), 5000, 1000});
  const auto together = download(b, order.order());
  EXPECT_EQ(std::vector<Index>(together.begin(), together.begin() + 3000), alone);
  double way = 0;
  for (std::size_t k = 3001; k < 4000; ++k) {
    EXPECT_GE(together[k], 3000);
    way += norm(x[static_cast<std::size_t>(together[k])] -
                x[static_cast<std::size_t>(together[k - 1])]);
  }
  EXPECT_LT(way / 1000, 0.25) << "they are neighbors among themselves";
}

TYPED_TEST(BodyOrderTest, SpreadTellsSortedFromShuffled) {
  auto& b = this->backend();
  std::mt19937 random(9);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Vec3<double>> x;
  for (int k = 0; k < 3000; ++k) x.push_back({uniform(random), uniform(random), uniform(random)});
  auto position = this->buffer(x);
  BodyOrder<TestBackend> order(b);
  const double shuffled = order.spread(b, position.view());
  order.compute(b, position.view());
  order.apply(b, position.view());
  EXPECT_LT(order.spread(b, position.view()), 0.25 * shuffled);
  EXPECT_EQ(order.spread(b, position.view().first(1)), 0);
}

}  // namespace
}  // namespace scree
