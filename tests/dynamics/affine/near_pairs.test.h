// The search for near pairs against all pairs of features of all bodies.

#include <random>
#include <set>

#include "dynamics/affine/near_pairs.h"
#include "dynamics/affine/pair_search.h"
#include "tests/backend_fixture.h"
#include "tests/box_mesh.h"

namespace scree::affine {
namespace {

using FeaturePair = std::array<int, 7>;  ///< bodies, kind, four corners in their surfaces

class NearPairsTest : public BackendTest<double> {
 protected:
  std::mt19937 random_{31};
  double uniform(double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random_);
  }
  Vec3d vector(double size) {
    return {uniform(-size, size), uniform(-size, size), uniform(-size, size)};
  }
  /// A wavy closed strip: many triangles, none of them on an axis.
  static TriangleMesh band(int around, int along) {
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

  /// Random ways of bodies of a few surfaces, some of them much larger than others.
  void place(int count, double space, double way) {
    for (int k = 0; k < count; ++k) {
      surface_.push_back(k % static_cast<int>(surfaces_.size()));
      group_.push_back(-1);
      AffineVec q;
      q.node[0] = vector(space);
      const double size = k % 9 == 8 ? 30 : uniform(0.5, 1.5);
      const Quat<double> turn = exp_map(vector(3));
      for (int n = 0; n < 3; ++n) {
        Vec3d axis;
        axis[n] = 1;
        q.node[n + 1] = size * rotate(turn, axis);
      }
      from_.push_back(q);
      q.node[0] += vector(way);
      for (int n = 1; n < 4; ++n) q.node[n] += vector(0.3 * way);
      to_.push_back(q);
    }
  }

  void upload_ways(Buffer<TestBackend, AffineVec>& from, Buffer<TestBackend, AffineVec>& to) {
    upload(backend(), from_, from);
    upload(backend(), to_, to);
  }
  /// Pairs that the search lists, in its order.
  std::vector<FeaturePair> listed(double distance) {
    TestBackend& b = backend();
    Buffer<TestBackend, AffineVec> from(b), to(b);
    upload_ways(from, to);
    const SurfaceTables<TestBackend> tables(b, surfaces_, surface_, group_, held_);
    NearPairs<TestBackend> near(b);
    const auto n = static_cast<Offset>(from_.size());
    near.build(b, tables, std::as_const(from).view(n), std::as_const(to).view(n), distance);
    const std::vector<NearPair> pairs = download(b, near.view().pairs);
    const std::vector<BodyPair> bodies = download(b, near.view().bodies);
    std::vector<FeaturePair> all;
    std::vector<int> first{0};
    for (const auto& s : surfaces_)
      first.push_back(first.back() + static_cast<int>(s->vertices.size()));
    std::size_t next = 0;
    for (std::size_t p = 0; p < bodies.size(); ++p) {
      EXPECT_LT(bodies[p].body[0], bodies[p].body[1]);
      if (p > 0)
        EXPECT_LT(std::pair(bodies[p - 1].body[0], bodies[p - 1].body[1]),
                  std::pair(bodies[p].body[0], bodies[p].body[1]));
      EXPECT_EQ(static_cast<std::size_t>(bodies[p].begin), next);
      next = static_cast<std::size_t>(bodies[p].end);
      for (Index k = bodies[p].begin; k < bodies[p].end; ++k) {
        const NearPair& pair = pairs[static_cast<std::size_t>(k)];
        EXPECT_EQ(static_cast<std::size_t>(pair.bodies), p);
        const int own = bodies[p].body[pair.is_swapped ? 1 : 0];
        const int other = bodies[p].body[pair.is_swapped ? 0 : 1];
        std::array<int, 4> v{};
        for (std::size_t i = 0; i < 4; ++i) {
          const int body = static_cast<int>(i) < first_points(pair.kind) ? own : other;
          v[i] = pair.vertex[i] -
                 first[static_cast<std::size_t>(surface_[static_cast<std::size_t>(body)])];
        }
        all.push_back(named(own, other, pair.kind, v));
      }
    }
    EXPECT_EQ(next, pairs.size());
    return all;
  }
  /// One name whichever edge comes first.
  static FeaturePair named(int own, int other, PairKind kind, std::array<int, 4> v) {
    if (kind == PairKind::edge_edge && own > other) {
      std::swap(own, other);
      std::swap(v[0], v[2]), std::swap(v[1], v[3]);
    }
    return {own, other, static_cast<int>(kind), v[0], v[1], v[2], v[3]};
  }
  /// The same of all pairs of bodies that may touch.
  std::set<FeaturePair> expected(double distance) {
    std::vector<AffineBody> bodies(surface_.size());
    for (std::size_t b = 0; b < bodies.size(); ++b)
      bodies[b].surface = surfaces_[static_cast<std::size_t>(surface_[b])];
    std::set<FeaturePair> all;
    for (const SurfacePair& p : pairs_near(bodies, from_, to_, distance)) {
      const auto a = static_cast<std::size_t>(p.body[0]), b = static_cast<std::size_t>(p.body[1]);
      if (group_[a] >= 0 && group_[a] == group_[b]) continue;
      bool is_held = false;
      for (const auto& h : held_)
        is_held = is_held || std::minmax(h[0], h[1]) == std::minmax(p.body[0], p.body[1]);
      if (!is_held) all.insert(named(p.body[0], p.body[1], p.kind, p.vertex));
    }
    return all;
  }
  std::size_t compare(double distance) {
    const std::vector<FeaturePair> found = listed(distance);
    const std::set<FeaturePair> unique(found.begin(), found.end()), all = expected(distance);
    EXPECT_EQ(unique.size(), found.size());
    EXPECT_EQ(unique, all);
    return all.size();
  }

  std::vector<std::shared_ptr<const Surface>> surfaces_;
  std::vector<int> surface_, group_;
  std::vector<std::array<int, 2>> held_;
  std::vector<AffineVec> from_, to_;

  void add_surface(const TriangleMesh& mesh) {
    surfaces_.push_back(std::make_shared<Surface>(make_surface(mesh, {})));
  }
};

TEST_F(NearPairsTest, AreThoseOfAllPairs) {
  add_surface(test::box_mesh({0.5, 0.7, 0.3}));
  add_surface(band(9, 5));
  place(40, 6, 0.5);
  EXPECT_GT(compare(0.1), 10000u);
  EXPECT_GT(compare(0), 5000u);
  to_ = from_;
  EXPECT_GT(compare(0.01), 1000u);
}

TEST_F(NearPairsTest, OfTwoDetailedBodiesAreThoseOfAllPairs) {
  add_surface(band(40, 16));
  place(2, 0.5, 0.05);
  EXPECT_GT(compare(0.02), 500u);
}

TEST_F(NearPairsTest, LeaveBodiesOutThatDoNotTouch) {
  add_surface(test::box_mesh({0.5, 0.7, 0.3}));
  place(30, 2, 0.1);
  const std::size_t before = compare(0.1);
  for (std::size_t k = 0; k < 10; ++k) group_[k] = static_cast<int>(k % 2);
  held_ = {{11, 14}, {20, 12}, {3, 25}};
  EXPECT_LT(compare(0.1), before);
}

TEST_F(NearPairsTest, OfNoneAndOfOneBodyAreNone) {
  add_surface(test::box_mesh({0.5, 0.7, 0.3}));
  EXPECT_EQ(compare(1), 0u);
  place(1, 1, 1);
  EXPECT_EQ(compare(1), 0u);
}

TEST_F(NearPairsTest, HaveOneOrder) {
  add_surface(band(9, 5));
  place(30, 4, 0.3);
  EXPECT_EQ(listed(0.1), listed(0.1));
}

}  // namespace
}  // namespace scree::affine
