// The search for near pairs against the boxes of all features of all bodies, worked out on the host.

#include <numeric>
#include <random>

#include "tests/backend_fixture.h"
#include "tests/box_mesh.h"
#include "tests/dynamics/affine/brute_pairs.h"

namespace scree::affine {
namespace {

/// A closed band with a wave: many triangles, none of them on an axis.
TriangleMesh wavy_ring(int around, int along) {
  TriangleMesh m;
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < along; ++j) {
      const double a = 2 * M_PI * i / around, b = 2 * M_PI * j / along;
      const double r = 1 + 0.4 * std::cos(b);
      m.vertices.push_back(
          {r * std::cos(a), r * std::sin(a), 0.4 * std::sin(b) + 0.1 * std::sin(3 * a)});
    }
  }
  const auto at = [&](int i, int j) { return (i % around) * along + j % along; };
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < along; ++j) {
      m.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      m.triangles.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return m;
}

class AffineNearPairsTest : public BackendTest<double> {
 protected:
  std::mt19937 random_{31};
  double uniform(double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random_);
  }
  Vec3d vector(double size) {
    return {uniform(-size, size), uniform(-size, size), uniform(-size, size)};
  }

  std::vector<std::shared_ptr<const Surface>> surfaces_;
  std::vector<int> surface_, group_;
  std::vector<std::array<int, 2>> held_;
  std::vector<AffineVec> from_, to_;

  void add_surface(const TriangleMesh& mesh) {
    surfaces_.push_back(std::make_shared<Surface>(make_surface(mesh, {})));
  }
  void add_shapes() {
    add_surface(scree::test::box_mesh({0.5, 0.7, 0.3}));
    add_surface(wavy_ring(9, 5));
    TriangleMesh tetrahedron;
    tetrahedron.vertices = {{1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}, {0, 0, 1.5}};
    tetrahedron.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    add_surface(tetrahedron);
  }
  /// A body on a straight way that turns, stretches and shears it.
  void add_body(int surface, const Vec3d& at, double size, double way) {
    surface_.push_back(surface);
    group_.push_back(-1);
    AffineVec q;
    q.node[0] = at;
    const Quat<double> turn = exp_map(vector(3));
    for (int k = 0; k < 3; ++k) {
      Vec3d axis;
      axis[k] = 1;
      q.node[k + 1] = size * rotate(turn, axis) + vector(0.1 * size);
    }
    from_.push_back(q);
    q.node[0] += vector(way);
    for (int k = 1; k < 4; ++k) q.node[k] += vector(0.3 * way * size);
    to_.push_back(q);
  }
  void add_bodies(int count, double space, double way) {
    for (int k = 0; k < count; ++k)
      add_body(k % static_cast<int>(surfaces_.size()), vector(space), uniform(0.3, 1), way);
  }

  /// Goes on with a backend of so many threads.
  void use(int threads) { own_ = std::make_unique<TestBackend>(threads); }
  TestBackend& backend() { return own_ ? *own_ : BackendTest<double>::backend(); }
  std::unique_ptr<TestBackend> own_;

  SurfaceTables<TestBackend> tables() {
    return SurfaceTables<TestBackend>(backend(), surfaces_, surface_, group_, held_);
  }
  template <bool kSplits>
  void build(NearPairs<TestBackend, kSplits>& near, const SurfaceTables<TestBackend>& tables,
             double distance) {
    TestBackend& b = backend();
    Buffer<TestBackend, AffineVec> from(b), to(b);
    upload(b, from_, from), upload(b, to_, to);
    const auto n = static_cast<Offset>(from_.size());
    near.build(b, tables, std::as_const(from).view(n), std::as_const(to).view(n), distance);
  }
  SearchedBodies searched() const { return {surfaces_, surface_, group_, held_}; }
  std::vector<NamedPair> named(const NearPairsView& view) {
    return named_pairs(backend(), view, searched());
  }
  template <bool kSplits = TestBackend::kIsDevice>
  std::vector<NamedPair> listed(double distance, Offset most_tests = 1 << 21) {
    const SurfaceTables<TestBackend> on = tables();
    NearPairs<TestBackend, kSplits> near(backend(), most_tests);
    build(near, on, distance);
    return named(near.view());
  }
  ExpectedPairs expected(double distance) {
    return expected_pairs(searched(), from_, to_, distance);
  }
  /// @return how many pairs there are
  std::size_t compare(double distance) {
    const std::vector<NamedPair> found = listed(distance);
    expect_pairs(found, expected(distance));
    // The other way to search, and with fewer tests of more blocks each.
    EXPECT_EQ(listed<!TestBackend::kIsDevice>(distance), found);
    for (const Offset most : {1, 300, 3000}) EXPECT_EQ(listed<true>(distance, most), found);
    return found.size();
  }
};

TEST_F(AffineNearPairsTest, AreThoseOfAllFeatures) {
  add_shapes();
  add_bodies(60, 4, 0.4);
  EXPECT_GT(compare(0.1), 8000u);
  EXPECT_GT(compare(0), 4000u);
  to_ = from_;  // bodies at rest
  EXPECT_GT(compare(0.01), 500u);
}

TEST_F(AffineNearPairsTest, OfFewBodiesAreThoseOfAllFeatures) {
  add_shapes();
  for (int count = 2; count <= 9; ++count) {
    surface_.clear(), group_.clear(), from_.clear(), to_.clear();
    add_bodies(count, 1, 0.2);
    EXPECT_GT(compare(0.05), 10u) << count;
  }
}

TEST_F(AffineNearPairsTest, OfManyBodiesAreThoseOfAllFeatures) {
  add_surface(scree::test::box_mesh({0.5, 0.7, 0.3}));
  for (const int count : {33, 64, 65, 257, 513}) {  // levels of the tree fill, and begin
    SCOPED_TRACE(count);
    surface_.clear(), group_.clear(), from_.clear(), to_.clear();
    add_bodies(count, 5, 0.2);
    EXPECT_GT(compare(0.05), 100u);
  }
}

TEST_F(AffineNearPairsTest, OfTwoDetailedBodiesAreThoseOfAllFeatures) {
  add_surface(wavy_ring(40, 16));
  add_body(0, {}, 1, 0.05);
  add_body(0, {0.9, 0.1, 0.2}, 1, 0.05);
  EXPECT_GT(compare(0.02), 500u);
}

/// Turns about any axes by up to 2.5 rad, flights and both: bodies are searched in coordinates of one that turns little, and in
/// the world where it turns far.
TEST_F(AffineNearPairsTest, OfBodiesThatTurnAreThoseOfAllFeatures) {
  add_shapes();
  for (const double angle : {0.05, 0.3, 0.8, 1.0, 2.5}) {
    SCOPED_TRACE(angle);
    surface_.clear(), group_.clear(), from_.clear(), to_.clear();
    add_bodies(40, 2, 0);
    for (std::size_t k = 0; k < to_.size(); ++k) {
      const Quat<double> turn = exp_map(angle * normalized(vector(1)));
      const Vec3d way = k % 3 == 0 ? Vec3d{} : vector(angle);
      for (int n = 1; n < 4; ++n) to_[k].node[n] = rotate(turn, to_[k].node[n]);
      to_[k].node[0] += way;
    }
    EXPECT_GT(compare(0.03), 1000u);
  }
}

/// Bodies that go and turn as one have the pairs that they have at rest, and few more where they slide along each other.
TEST_F(AffineNearPairsTest, OfBodiesThatGoTogetherAreFew) {
  add_surface(wavy_ring(20, 10));
  add_body(0, {}, 1, 0);
  from_[0].node[0] = {};
  for (int k = 0; k < 3; ++k) {
    from_[0].node[k + 1] = {};
    from_[0].node[k + 1][k] = 1;
  }
  add_body(0, {}, 1, 0);
  from_[1] = from_[0];
  from_[1].node[0] = {0.05, 0.03, 0.82};
  to_ = from_;
  const std::size_t at_rest = compare(0.02);
  EXPECT_GT(at_rest, 300u);
  const Vec3d axis{0.1, -0.2, 0.15}, away{3, -2, 1};
  for (int body = 0; body < 2; ++body) {
    AffineVec& q = to_[static_cast<std::size_t>(body)];
    const Quat<double> turn = exp_map(axis);
    for (Vec3d& node : q.node) node = rotate(turn, node);
    q.node[0] += away;
  }
  EXPECT_LT(static_cast<double>(compare(0.02)), 1.2 * static_cast<double>(at_rest));
  to_[1].node[0] += Vec3d{0.01, 0, 0};
  EXPECT_LT(compare(0.02), 2 * at_rest);
  to_[1].node[0] = from_[1].node[0];
  EXPECT_GT(compare(0.02), 10 * at_rest);
}

/// Large bodies of few and of many features among small ones, by a factor of a thousand and more.
TEST_F(AffineNearPairsTest, OfSmallBodiesOnLargeOnesAreThoseOfAllFeatures) {
  add_shapes();
  add_surface(scree::test::box_mesh({500, 500, 500}));
  add_surface(wavy_ring(30, 12));
  for (int k = 0; k < 90; ++k) add_body(k % 3, vector(3), uniform(0.1, 0.5), 0.1);
  add_body(3, {}, 1, 0.1);
  add_body(3, {0, 0, 1000}, 1, 0);
  add_body(4, {}, 2, 0.05);
  add_body(4, {100, 0, 0}, 100, 0.05);
  std::swap(surface_[0], surface_.back()), std::swap(from_[0], from_.back());
  std::swap(to_[0], to_.back());
  EXPECT_GT(compare(0.05), 3000u);
}

/// Boxes of a grid touch in their faces: a pair whose boxes are exactly as far apart as asked for is near.
TEST_F(AffineNearPairsTest, AtTheDistanceItselfCount) {
  add_surface(scree::test::box_mesh({0.5, 0.5, 0.5}));
  for (int k = 0; k < 36; ++k) {
    surface_.push_back(0), group_.push_back(-1);
    AffineVec q;
    q.node[0] = {1.25 * (k % 6), 1.25 * (k / 6), 0};
    for (int n = 0; n < 3; ++n) q.node[n + 1][n] = 1;
    from_.push_back(q), to_.push_back(q);
  }
  EXPECT_EQ(compare(0.2499), 0u);
  EXPECT_GT(compare(0.25), 1000u);
}

TEST_F(AffineNearPairsTest, FarFromTheOriginAreThoseOfAllFeatures) {
  add_shapes();
  add_bodies(40, 2, 0.1);
  for (std::size_t k = 0; k < from_.size(); ++k)
    from_[k].node[0] += Vec3d{1e4, -3e5, 5e3}, to_[k].node[0] += Vec3d{1e4, -3e5, 5e3};
  EXPECT_GT(compare(0.01), 1000u);
}

/// At the least distance at which a pair is near, no box of a tree loses it by rounding: the corner of one body that is
/// foremost along x is before the hindmost one of the other. Devices place corners with other rounding than the host, so there
/// it is a little more.
TEST_F(AffineNearPairsTest, AreNotLostByRounding) {
  add_surface(scree::test::box_mesh({0.5, 0.75, 0.25}));  // float holds its boxes as they are
  add_surface(scree::test::box_mesh({0.3, 0.7, 0.1}));    // and rounds those of this one
  const auto corner = [&](std::size_t body, double side) {
    const std::vector<Vec3d>& rest = surfaces_[static_cast<std::size_t>(surface_[body])]->vertices;
    Vec3d best = point_of(from_[body], rest[0]);
    for (const Vec3d& r : rest) {
      const Vec3d x = point_of(from_[body], r);
      if (side * x.x > side * best.x) best = x;
    }
    return best;
  };
  for (int k = 0; k < 200; ++k) {
    surface_.clear(), group_.clear(), from_.clear(), to_.clear();
    add_body(k % 2, vector(k % 2 == 0 ? 1e5 : 1), 1, 0);
    add_body(k % 2, {}, 1, 0);
    const Vec3d gap{uniform(0.1, 10), 0, 0}, way{0, uniform(0, 2), uniform(0, 2)};
    from_[1].node[0] += corner(0, 1) + gap - corner(1, -1);
    to_ = from_;
    for (AffineVec& q : to_) q.node[0] += way;
    double none = 0, some = 20;
    ASSERT_TRUE(expected(none).most.empty());
    while (std::nextafter(none, some) < some) {
      const double middle = none + (some - none) / 2;
      (expected(middle).most.empty() ? none : some) = middle;
    }
    EXPECT_NEAR(some, gap.x, 1e-9);
    EXPECT_GT(compare(TestBackend::kIsDevice ? some * (1 + 1e-9) : some), 0u);
  }
}

TEST_F(AffineNearPairsTest, LeaveBodiesOutThatDoNotTouch) {
  add_surface(scree::test::box_mesh({0.5, 0.7, 0.3}));
  for (const int count : {20, 40}) {
    group_.clear(), surface_.clear(), from_.clear(), to_.clear(), held_.clear();
    add_bodies(count, 1.5, 0.1);
    const std::size_t before = compare(0.1);
    for (std::size_t k = 0; k < 10; ++k) group_[k] = static_cast<int>(k % 2);
    const std::size_t grouped = compare(0.1);
    EXPECT_LT(grouped, before);
    const std::vector<NamedPair> found = listed(0.1);
    const NamedPair &first = found.front(), &last = found.back();
    held_ = {{last[1], last[0]}, {first[0], first[1]}, {0, 1}, {last[0], last[1]}};
    EXPECT_LT(compare(0.1), grouped);
  }
}

TEST_F(AffineNearPairsTest, OfNoneOneAndFarBodiesAreNone) {
  EXPECT_TRUE(listed(1).empty());
  add_surface(scree::test::box_mesh({0.5, 0.7, 0.3}));
  EXPECT_TRUE(listed(1).empty());
  add_body(0, {}, 1, 1);
  EXPECT_TRUE(listed(1).empty());
  add_body(0, {10, 0, 0}, 1, 1);
  EXPECT_TRUE(listed(1).empty());
}

/// Points, edges without triangles, and nothing at all are surfaces too.
TEST_F(AffineNearPairsTest, OfSurfacesWithoutTrianglesAreThoseOfAllFeatures) {
  add_surface(wavy_ring(7, 5));
  auto rods = std::make_shared<Surface>(), points = std::make_shared<Surface>();
  for (int k = 0; k < 12; ++k) {
    rods->vertices.push_back(vector(1));
    points->vertices.push_back(vector(1));
    if (k > 0) rods->edges.push_back({k - 1, k});
  }
  rods->points.resize(12), std::iota(rods->points.begin(), rods->points.end(), 0);
  points->points = rods->points;
  surfaces_.insert(surfaces_.end(), {rods, points, std::make_shared<Surface>()});
  add_bodies(12, 0.5, 0.1);
  EXPECT_GT(compare(0.05), 1000u);
}

/// The room of the lists grows with what is found, and what was found before leaves no trace.
TEST_F(AffineNearPairsTest, DoNotDependOnEarlierSearches) {
  add_shapes();
  add_bodies(40, 2, 0.1);
  const SurfaceTables<TestBackend> on = tables();
  NearPairs<TestBackend> near(backend());
  const std::vector<AffineVec> from = from_, to = to_;
  for (const double spread : {30.0, 1.0, 0.7, 5.0, 1.0}) {
    SCOPED_TRACE(spread);
    for (std::size_t k = 0; k < from.size(); ++k) {
      from_[k].node[0] = spread * from[k].node[0];
      to_[k].node[0] = spread * to[k].node[0];
    }
    build(near, on, 0.02);
    const std::vector<NamedPair> found = named(near.view());
    expect_pairs(found, expected(0.02));
    EXPECT_EQ(found, listed(0.02));
  }
}

/// However many threads search, the lists are the same bit for bit.
TEST_F(AffineNearPairsTest, HaveOneOrder) {
  add_shapes();
  add_bodies(90, 4, 0.3);
  const std::vector<NamedPair> found = listed(0.05);
  EXPECT_EQ(found, listed(0.05));
  if constexpr (!TestBackend::kIsDevice) {
    for (const int threads : {1, 4}) {
      use(threads);
      EXPECT_EQ(found, listed(0.05)) << threads;
    }
  }
}

TEST_F(AffineNearPairsTest, RefuseBodiesThatThereAreNot) {
  add_surface(scree::test::box_mesh({0.5, 0.7, 0.3}));
  add_body(0, {}, 1, 0);
  surface_[0] = 1;
  EXPECT_THROW(tables(), InvalidParameter);
  surface_[0] = 0;
  held_ = {{0, 1}};
  EXPECT_THROW(tables(), InvalidParameter);
  held_.clear(), group_.clear();
  EXPECT_THROW(tables(), InvalidParameter);
}

}  // namespace
}  // namespace scree::affine
