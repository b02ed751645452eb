#pragma once
// Parts of bodies in storage of a rank: names, ghosts that come and go, room that grows, and how far bodies reach that
// others have to know.

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

#include "dynamics/rigid/body_loading.h"
#include "dynamics/rigid/part_store.h"
#include "dynamics/rigid/shared_constants.h"
#include "kernels/broad_phase/ghost_search.h"
#include "tests/backend_fixture.h"
#include "tests/physics/compound_scenes.h"

namespace scree {
namespace {

/// Adds a compound whose mass is that of its parts.
inline BodyDescription& add_parts(Scene& scene, const Vec3d& position, std::vector<ShapePart> parts,
                                  BodyKind kind = BodyKind::free) {
  return physics::add_compound(scene, position, std::move(parts), kind, SharedMass::each_part);
}

/// Bodies of a scene, all owned, and their parts, as a rank has them.
template <class Real>
struct BodiesWithParts {
  using B = TestBackend;

  BodiesWithParts(B& b, Scene described, Index room)
      : scene(std::move(described)),
        count(count_bodies(scene)),
        store(b, room, static_cast<Index>(count.fixed), shared_constants(scene), false),
        obstacles(b, scene, store.fixed_begin(), store.fixed_begin()),
        parts(b, obstacles.data(), obstacles.shapes(), static_cast<Index>(count.fixed),
              obstacles.fixed_part_begin(), {}) {
    store.before_fixed_move([&](Index shift) { obstacles.follow_fixed_bodies(*backend, shift); });
    parts.before_fixed_move([&](Index shift) { obstacles.follow_fixed_parts(*backend, shift); });
    BodyLoading<B, Real>(scene, store, obstacles).load_first();
  }
  std::vector<Index> names() { return parts.names(store.ids(), static_cast<Index>(count.all())); }

  B* backend = nullptr;
  Scene scene;
  BodyCounts count;
  BodyStore<B, Real> store;
  Obstacles<B, Real> obstacles;
  PartStore<B, Real> parts;
};

/// Free: a clump, a cross, a ball, a clump. Fixed: a cross and a ball.
inline Scene few_compounds() {
  Scene scene = physics::empty_scene(1e-3, 0);
  add_parts(scene, {0, 0, 0}, physics::three_balls(0.1, 0.1));
  add_parts(scene, {1, 0, 0}, physics::cross_of_bars(0.2, 0.05));
  physics::add_sphere(scene, {2, 0, 0}, 0.1, 1);
  add_parts(scene, {3, 0, 0}, physics::three_balls(0.1, 0.1));
  add_parts(scene, {4, 0, 0}, physics::cross_of_bars(0.2, 0.05), BodyKind::fixed);
  physics::add_sphere(scene, {5, 0, 0}, 0.1, 1).kind = BodyKind::fixed;
  return scene;
}

template <class Real>
class PartStoreTest : public BackendTest<Real> {};
TYPED_TEST_SUITE(PartStoreTest, Reals);

TYPED_TEST(PartStoreTest, RoomGrowsAndWallsFollow) {
  TestBackend& b = this->backend();
  BodiesWithParts<TypeParam> run(b, few_compounds(), 4);
  run.backend = &b;
  EXPECT_EQ(run.obstacles.fixed_part_begin(), 4);
  const BodyView<TypeParam> seen = run.parts.place(run.store.view());
  EXPECT_EQ(seen.owned_count, 10);
  EXPECT_GE(seen.fixed_begin, 10);
  EXPECT_EQ(seen.count - seen.fixed_begin, 4);
  EXPECT_EQ(run.obstacles.fixed_part_begin(), seen.fixed_begin);
  // Walls are where their parts are; the record of the compound tells the place of the body.
  const std::vector<Vec3d> position = download(b, seen.position);
  for (const Index wall : run.obstacles.data().walls) {
    const ShapeRecord<TypeParam>& record =
        run.obstacles.data().shapes[static_cast<std::size_t>(wall)];
    EXPECT_EQ(position[static_cast<std::size_t>(record.body)].x, 4) << wall;
  }
  const Index compound = run.obstacles.shape(4);
  EXPECT_EQ(run.obstacles.data().shapes[static_cast<std::size_t>(compound)].body, 4);
}

/// They are those of one rank, whatever room there is.
TYPED_TEST(PartStoreTest, NamesDoNotDependOnPlaces) {
  TestBackend& b = this->backend();
  for (const Index room : {4, 9}) {
    BodiesWithParts<TypeParam> run(b, few_compounds(), room);
    run.backend = &b;
    run.store.keep({3, 2, 0});
    run.store.clear_room();
    const BodyView<TypeParam> seen = run.parts.place(run.store.view());
    const std::vector<Index> names = run.names();
    const std::vector<Index> free(names.begin(), names.begin() + 7);
    EXPECT_EQ(free, (std::vector<Index>{3, 13, 14, 2, 0, 7, 8}));
    EXPECT_EQ(std::count(names.begin() + 7, names.begin() + seen.fixed_begin, -1),
              seen.fixed_begin - 7);
    const std::vector<Index> fixed(names.begin() + seen.fixed_begin, names.end());
    EXPECT_EQ(fixed, (std::vector<Index>{4, 16, 17, 5}));
  }
  const PartNames names{6, {0, 0, 0, 1, 1, 1, 3, 3, 3, 4, 4, 4}};
  EXPECT_EQ(names.body(13), 3);
  EXPECT_EQ(names.body(2), 2);
  EXPECT_EQ(names.body(18), -1);
  EXPECT_EQ(names.body(-1), -1);
}

TYPED_TEST(PartStoreTest, PartsOfGhostsFollowThem) {
  TestBackend& b = this->backend();
  BodiesWithParts<TypeParam> run(b, few_compounds(), 4);
  run.backend = &b;
  run.store.set_owned_count(2);
  run.store.set_ghost_count(2, 1);
  const BodyView<TypeParam> before = run.parts.place(run.store.view());
  EXPECT_EQ(before.owned_count, 6);
  EXPECT_EQ(before.higher_begin, 7);
  EXPECT_EQ(before.moving_count, 10);
  // The other way round, and then one is gone. There is no room for as many after it.
  run.store.set_owned_count(4);
  run.store.keep({0, 1, 3, 2});
  run.store.set_owned_count(2);
  run.store.set_ghost_count(2, 0);
  EXPECT_EQ(run.parts.follow_ghosts(run.store.view(), {3, 2}), (std::vector<Index>{9, 6, 7, 8}));
  run.store.set_owned_count(2);
  run.store.set_ghost_count(1, 0);
  EXPECT_EQ(run.parts.follow_ghosts(run.store.view(), {2, -1}), (std::vector<Index>{6, 7, 8, -1}));
  run.store.clear_room();
  const BodyView<TypeParam> after = run.parts.place(run.store.view());
  EXPECT_EQ(after.moving_count, 9);
  EXPECT_EQ(run.names()[9], -1);
}

/// How far the ball of a part sticks out of that by which its body is shown to other ranks, over the radius of that.
template <class Real>
struct PartBeyondReach {
  static constexpr const char* name = "part_beyond_reach";
  BodyBalls<Real> parts;
  ReachOfBody<Real> reach;
  Span<const Index> owner;

  SCREE_HD Largest<double> operator()(Index p) const {
    const Index i = owner[p];
    const double margin =
        2 * parts.range.margin_limit * static_cast<double>(reach.balls.bodies.radius[i]);
    const double own = reach.radius(i);
    const double far = norm(parts.center(p) - reach.balls.center(i)) + parts.radius(p) + margin;
    return {(far - own) / own};
  }
};

/// Without that a contact of two parts may be known to one of two owners only.
TYPED_TEST(PartStoreTest, BodiesReachAsFarAsTheirParts) {
  using Real = TypeParam;
  TestBackend& b = this->backend();
  Scene scene = physics::empty_scene(1e-2, 0);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> u(-1, 1);
  const auto vector = [&](double most) {
    const double x = u(random), y = u(random), z = u(random);
    return most * Vec3d{x, y, z};
  };
  for (int k = 0; k < 300; ++k) {
    std::vector<ShapePart> shape;
    if (k % 3 == 0) shape = physics::three_balls(0.01, 0.3);
    if (k % 3 == 1) shape = physics::cross_of_bars(0.4, 0.05);
    if (k % 3 == 2) shape = physics::two_halves(scene, 0.3);
    BodyDescription& body = add_parts(scene, vector(1), shape);
    body.orientation = exp_map(vector(3));
    body.velocity = vector(k % 2 == 0 ? 30 : 0);
    body.angular_velocity = vector(k % 5 == 0 ? 1 : 100);
    body.locks = static_cast<std::uint8_t>(k % 8);
  }
  BodiesWithParts<Real> run(b, scene, 300);
  run.backend = &b;
  const BodyView<Real> bodies = run.store.view(), seen = run.parts.place(bodies);
  ContactRange range{1e-3, 1e-2, {}, {}, {0, 0, -0.1}};
  range.fall = 1;  // more than any margin: its limit counts
  range.margin_limit = 0.2;
  Buffer<TestBackend, Largest<double>> largest(b, 1);
  const auto beyond = [&](const PartReach<Real>& reach) {
    reduce<Largest<double>>(
        b, seen.owned_count,
        PartBeyondReach<Real>{
            {seen, range, {}}, {{bodies, range, {}}, reach}, run.parts.of(bodies).owner},
        StoreResult<Largest<double>>{largest.data()});
    return fetch(b, largest.data()).value;
  };
  EXPECT_LE(beyond(run.parts.reach(run.obstacles.data())), this->tolerance(3e-7, 1e-6));
  EXPECT_GT(beyond({}), 0.01) << "spheres about bodies are enough";
}

}  // namespace
}  // namespace scree
