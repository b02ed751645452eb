#pragma once
// Contacts where some of the bodies are ghosts: copies of bodies that another world owns.

#include <algorithm>
#include <utility>

#include "tests/backend_fixture.h"
#include "tests/collision/divided_bed.h"

namespace scree {
namespace {

template <class Real>
class GhostTest : public BackendTest<Real> {
 protected:
  using Run = CollisionRun<TestBackend, Real>;
  using Named = std::multimap<ContactName, NamedContact>;

  /// Body A of a contact is owned, and so no contact is of ghosts alone or of one and a fixed body.
  static void expect_owned_a(const std::vector<HostContact>& contacts, const BodyRanges& bodies) {
    for (const HostContact& c : contacts) {
      EXPECT_TRUE(bodies.is_owned(c.a));
      EXPECT_TRUE(bodies.exists(c.b));
      EXPECT_LT(c.a, c.b);
    }
  }

  /// Contacts of a bed are those of its halves: those of bodies that one of them owns alone are in
  /// that one, those of two owners in both.
  /// @param part, run  of both halves and of the whole
  void expect_same_contacts(const Bed<Real>& bed, const Part<Real> (&part)[3], Run* (&run)[3]) {
    const auto listed = run[2]->detect();
    const Named all = by_name(listed, run[2]->detector().keys(), part[2]);
    Named found[2];
    std::size_t ghosts = 0;
    for (int side = 0; side < 2; ++side) {
      const auto contacts = run[side]->detect();
      const BodyRanges bodies = run[side]->bodies();
      expect_owned_a(contacts, bodies);
      found[side] = by_name(contacts, run[side]->detector().keys(), part[side]);
      for (const HostContact& c : contacts)
        if (bodies.moves(c.b) && !bodies.is_owned(c.b)) ++ghosts;
    }
    ASSERT_GT(all.size(), bed.free.size() / 2);
    ASSERT_GT(ghosts, 40u);
    std::size_t places = 0;
    for (const auto& [name, expected] : all) {
      const auto [a, b, feature] = name;
      const int of_a = bed.free[static_cast<std::size_t>(a)].owner;
      const bool has_two = b >= 0 && static_cast<std::size_t>(b) < bed.free.size();
      const int of_b = has_two ? bed.free[static_cast<std::size_t>(b)].owner : of_a;
      for (int side = 0; side < 2; ++side) {
        const bool is_here = side == of_a || side == of_b;
        ASSERT_EQ(found[side].count(name), is_here ? 1u : 0u) << a << " " << b << " side " << side;
        if (!is_here) continue;
        ++places;
        const NamedContact& c = found[side].find(name)->second;
        const double sign = c.is_turned == expected.is_turned ? 1 : -1;
        EXPECT_NEAR(c.contact.gap, expected.contact.gap, this->tolerance(1e-14, 1e-7));
        EXPECT_LT(norm(sign * c.contact.normal - expected.contact.normal),
                  this->tolerance(1e-12, 1e-5));
      }
    }
    EXPECT_EQ(places, found[0].size() + found[1].size());  // and no others
  }

  /// @param reach  of ghosts from the plane that divides the bed [m]
  void expect_divided(const Bed<Real>& bed, double reach) {
    const Part<Real> part[3] = {bed.half(0, reach), bed.half(1, reach), bed.whole()};
    Run left(this->backend(), part[0].scene), right(this->backend(), part[1].scene),
        whole(this->backend(), part[2].scene);
    Run* run[3] = {&left, &right, &whole};
    expect_same_contacts(bed, part, run);
  }
};
TYPED_TEST_SUITE(GhostTest, Reals);

TYPED_TEST(GhostTest, SpheresAmongThemselves) {
  this->expect_divided(bed_of_spheres<TypeParam>(2000, 0.05, 0.05, 1), 1);
}

TYPED_TEST(GhostTest, ALayerOfGhostsIsEnough) {
  const auto bed = bed_of_spheres<TypeParam>(2000, 0.05, 0.05, 2);
  const auto half = bed.half(0, 0.06);
  EXPECT_LT(half.scene.ghost_count, half.scene.owned_count / 4);
  this->expect_divided(bed, 0.06);
}

TYPED_TEST(GhostTest, SizesOfTenToOneWithPlanesAndFixedSpheres) {
  auto bed = bed_of_spheres<TypeParam>(2000, 0.02, 0.2, 3);
  bed.add_fixed = [](auto& s) {
    s.add_half_space({0, 0, 0}, {0, 0, 1});
    s.add_container({0.5, 0.5, 0.5}, {0.52, 0.52, 0.52}, 1u << 5);
    for (int k = 0; k < 10; ++k) s.add({0.1 * k + 0.05, 0.5, 0.1}, 0.04);
  };
  this->expect_divided(bed, 0.25);
}

TYPED_TEST(GhostTest, MeshAndBoxWalls) {
  auto bed = bed_of_spheres<TypeParam>(1500, 0.05, 0.1, 4);
  bed.add_fixed = [](auto& s) {
    s.add_box_wall({0.5, 0.5, 0.1}, {0.1, 0.1, 0.1});
    s.add_mesh_wall({0.5, 0.5, 0.02}, flat_floor(24, 0.05));
  };
  this->expect_divided(bed, 0.2);
}

TYPED_TEST(GhostTest, PeriodicBox) {
  auto bed = bed_of_spheres<TypeParam>(1500, 0.05, 0.1, 5);
  bed.settings.settings.period = {1, 1.1, 0};  // so that the halves touch at the sides, too
  this->expect_divided(bed, 1);
}

TYPED_TEST(GhostTest, BoxesAndGravity) {
  auto bed = bed_of_spheres<TypeParam>(1500, 0.06, 0.06, 6);
  bed.settings.gravity = {0, 0, -9.81};
  for (std::size_t i = 0; i < bed.free.size(); i += 100) {  // apart from each other
    bed.free[i].half = {0.02, 0.03, 0.025};
    bed.free[i].x = {0.04 + 0.06 * static_cast<double>(i / 100), 0.5, 0.15};
  }
  bed.divide();
  bed.add_fixed = [](auto& s) { s.add_half_space({0, 0, 0}, {0, 0, 1}); };
  this->expect_divided(bed, 1);
}

/// Lists of near pairs that are kept and extended know ghosts as well.
TYPED_TEST(GhostTest, KeptListsOfMovingBodies) {
  using Run = CollisionRun<TestBackend, TypeParam>;
  auto bed = bed_of_spheres<TypeParam>(2000, 0.05, 0.05, 7);
  // Where two ghosts meet beside the last owned body, a pair of the two among its own would show.
  std::vector<std::size_t> of_first, of_second;
  for (std::size_t i = 0; i < bed.free.size(); ++i)
    (bed.free[i].owner == 0 ? of_first : of_second).push_back(i);
  const auto put = [&](std::size_t i, Vec3<double> x) {
    bed.free[i].x = x;
    bed.free[i].v = {};
  };
  put(of_first.back(), {0.49, 0.5, 0.15});
  put(of_second.back(), {0.535, 0.5, 0.15});
  bed.add_fixed = [](auto& s) { s.add_half_space({0, 0, 0}, {0, 0, 1}); };
  Part<TypeParam> part[3] = {bed.half(0, 2), bed.half(1, 2), bed.whole()};
  Run left(this->backend(), part[0].scene), right(this->backend(), part[1].scene),
      whole(this->backend(), part[2].scene);
  Run* run[3] = {&left, &right, &whole};
  for (std::size_t k = 0; k < 12; ++k) {
    for (auto& body : bed.free) body.x += 2e-3 * body.v;
    bed.free[17 * k].x = bed.free[900 + k].x + Vec3<double>{0.01, 0, 0};  // far from its ball
    if (k == 3) put(of_second.front(), {0.51, 0.54, 0.15});
    part[0] = bed.half(0, 2), part[1] = bed.half(1, 2), part[2] = bed.whole();
    for (int p = 0; p < 3; ++p) {
      run[p]->scene() = part[p].scene;
      run[p]->load();
    }
    this->expect_same_contacts(bed, part, run);
  }
  for (Run* each : run) {
    EXPECT_LE(each->detector().list_builds(), 6);
    EXPECT_GT(each->detector().list_extensions(), 0);
  }
}

/// More or fewer ghosts than before make other contacts, with a list that was kept as without.
TYPED_TEST(GhostTest, OtherGhostsThanBefore) {
  const auto bed = bed_of_spheres<TypeParam>(2000, 0.05, 0.05, 8);
  CollisionRun<TestBackend, TypeParam> run(this->backend(), bed.half(0, 0.06).scene);
  for (const double reach : {0.06, 0.0, 1.0, 0.02}) {
    const Part<TypeParam> part = bed.half(0, reach);
    run.scene() = part.scene;
    run.load();
    CollisionRun<TestBackend, TypeParam> fresh(this->backend(), part.scene);
    EXPECT_EQ(run.detect(), fresh.detect()) << reach;
  }
}

/// Contacts with ghosts keep their impulses when owned bodies are put into another order.
TYPED_TEST(GhostTest, ReorderedOwnedBodies) {
  auto& b = this->backend();
  auto bed = bed_of_spheres<TypeParam>(1000, 0.06, 0.06, 9);
  for (auto& body : bed.free) body.v = body.w = {};
  CollisionRun<TestBackend, TypeParam> run(b, bed.half(1, 1).scene);
  const auto places = [&] { return download(b, run.bodies().position); };
  const auto along = [](const std::vector<HostContact>& contacts,
                        const std::vector<Vec3<double>>& x) {
    std::map<std::pair<double, double>, Vec3<double>> impulses;  // of pairs, by where they are
    for (const HostContact& c : contacts) {
      const double sign = x[c.b].x > x[c.a].x ? 1 : -1;
      impulses[std::minmax(x[c.a].x, x[c.b].x)] = sign * Vec3<double>{x[c.a].x + x[c.b].x, 1, 0};
    }
    return impulses;
  };
  const auto contacts = run.detect();
  const std::vector<Vec3<double>> before = places();
  const auto expected = along(contacts, before);
  std::vector<Vec3<TypeParam>> impulse;
  for (const HostContact& c : contacts)
    impulse.emplace_back(expected.at(std::minmax(before[c.a].x, before[c.b].x)));
  Buffer<TestBackend, Vec3<TypeParam>> gamma(b), matched(b);
  upload(b, impulse, gamma);
  run.detector().keep(1, std::move(gamma));
  run.reorder();
  const auto again = run.detect();
  const std::vector<Vec3<double>> after = places();
  ASSERT_EQ(again.size(), contacts.size());
  const auto wanted = along(again, after);
  const auto found = matched.resize_discard(static_cast<Offset>(again.size()));
  run.detector().match(b, 1, found);
  const std::vector<Vec3<TypeParam>> values = download(b, found);
  std::size_t moved = 0;
  for (std::size_t c = 0; c < again.size(); ++c)
    EXPECT_EQ(values[c],
              Vec3<TypeParam>(wanted.at(std::minmax(after[again[c].a].x, after[again[c].b].x))));
  const BodyRanges bodies = run.bodies();
  for (std::size_t i = 0; i < after.size(); ++i) {
    if (bodies.is_owned(static_cast<Index>(i))) {
      moved += after[i] == before[i] ? 0 : 1;
    } else {
      EXPECT_EQ(after[i], before[i]);
    }
  }
  EXPECT_GT(moved, 100u);
}

}  // namespace
}  // namespace scree
