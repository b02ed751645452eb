// Continuous collision detection against exact arithmetic: never late, and not early by more than
// it says.

#include <random>

#include "kernels/affine/first_contact.h"
#include "tests/backend_fixture.h"
#include "tests/exact_contact.h"

namespace scree::affine {
namespace {

struct FindFirstContact {
  static constexpr const char* name = "find_first_contact";
  PairKind kind;
  FirstContactParameters parameters;
  Span<const Four> from, to;
  Span<FirstContact> found;
  SCREE_HD void operator()(Index k) const {
    found[k] = first_contact(kind, from[k], to[k], parameters);
  }
};

class FirstContactTest : public BackendTest<double> {
 protected:
  std::vector<FirstContact> run(PairKind kind, const std::vector<Four>& from,
                                const std::vector<Four>& to,
                                const FirstContactParameters& parameters) {
    TestBackend& b = backend();
    const auto n = static_cast<Index>(from.size());
    Buffer<TestBackend, Four> starts(b), ends(b);
    Buffer<TestBackend, FirstContact> found(b, n);
    upload(b, from, starts);
    upload(b, to, ends);
    for_each(b, n,
             FindFirstContact{kind, parameters, std::as_const(starts).view(n),
                              std::as_const(ends).view(n), found.view()});
    return download(b, found.view());
  }
  FirstContact run(PairKind kind, const Four& from, const Four& to,
                   const FirstContactParameters& parameters = {}) {
    return run(kind, std::vector{from}, std::vector{to}, parameters)[0];
  }
  std::mt19937 random_{23};
  double uniform(double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random_);
  }
  Vec3d vector(double size = 1) {
    return {uniform(-size, size), uniform(-size, size), uniform(-size, size)};
  }
};

/// Random ways, thin features, edges that are nearly parallel, far from the origin.
TEST_F(FirstContactTest, IsNeverLaterThanExactContact) {
  for (const PairKind kind : {PairKind::point_triangle, PairKind::edge_edge}) {
    std::vector<Four> from, to;
    for (int k = 0; k < 400; ++k) {
      Four a, b;
      const Vec3d place = k % 4 == 1 ? 1e6 * vector() : Vec3d{};
      const double thin = k % 4 == 2 ? 1e-6 : 1;
      for (int i = 0; i < 4; ++i) {
        a[i] = place + vector();
        b[i] = place + vector();
      }
      if (k % 4 == 2 || k % 4 == 3) {
        const int last = 3, before = kind == PairKind::edge_edge ? 1 : 2;
        const int base = kind == PairKind::edge_edge ? 2 : 1;
        const Vec3d edge = a[before] - a[kind == PairKind::edge_edge ? 0 : 1];
        a[last] = a[base] + uniform(0.5, 1) * edge + vector(thin == 1 ? 1e-3 : thin);
        for (int i = 0; i < 4; ++i) b[i] = a[i] + vector(1e-7);
        const Vec3d way = 2.0 * vector();
        for (int i = 0; i < (kind == PairKind::edge_edge ? 2 : 1); ++i) b[i] += way;
      }
      // Two thirds are led through each other, at a random time.
      Four x;
      const double time = uniform(0.1, 0.9);
      for (int i = 0; i < 4; ++i) x[i] = a[i] + time * (b[i] - a[i]);
      const double s = uniform(0.05, 0.45), t = uniform(0.05, 0.45);
      const Vec3d miss = kind == PairKind::edge_edge
                             ? x[0] + s * (x[1] - x[0]) - (x[2] + t * (x[3] - x[2]))
                             : x[0] - (x[1] + s * (x[2] - x[1]) + t * (x[3] - x[1]));
      for (int i = 0; i < first_points(kind) && k % 3 != 0; ++i) a[i] -= miss, b[i] -= miss;
      from.push_back(a);
      to.push_back(b);
    }
    int touched = 0, reached = 0;
    const std::vector<FirstContact> coarse = run(kind, from, to, {});
    const std::vector<FirstContact> fine = run(kind, from, to, {0, 1e-8, 100000});
    for (std::size_t k = 0; k < from.size(); ++k) {
      const exact::FirstTouch truth = exact::first_touch(kind, from[k], to[k]);
      ASSERT_NE(truth.touch, exact::Touch::unclear) << k;
      if (truth.touch == exact::Touch::never) {
        if (k % 4 == 0) {
          EXPECT_FALSE(fine[k].hit) << k;
        }
        continue;
      }
      ++touched;
      const double apart = nearest_points(kind, from[k]).squared;
      EXPECT_FALSE(stays_apart(kind, from[k], to[k], apart, 0)) << k;
      for (const FirstContact& found : {coarse[k], fine[k]}) {
        EXPECT_TRUE(found.hit) << k;
        EXPECT_TRUE(exact::Number(found.time) <= truth.to) << k;
      }
      // In ordinary places the fine search ends within 1e-6 of the contact.
      if (k % 4 != 0) continue;
      ++reached;
      EXPECT_NEAR(fine[k].time, truth.from.approximately(), 1e-6) << k;
      EXPECT_LT(coarse[k].steps, 200);
    }
    EXPECT_GT(touched, 60);
    EXPECT_GT(reached, 10);
  }
}

/// At the time found the distance is at least that left by the search, at every time before too.
TEST_F(FirstContactTest, TheWayIsFreeUpToTheTimeFound) {
  for (const PairKind kind : {PairKind::point_triangle, PairKind::edge_edge}) {
    for (const double separation : {0.0, 0.01}) {
      std::vector<Four> from, to;
      for (int k = 0; k < 200; ++k) {
        Four a, b;
        for (int i = 0; i < 4; ++i) a[i] = vector(), b[i] = vector();
        if (nearest_points(kind, a).squared < 0.04) continue;
        from.push_back(a);
        to.push_back(b);
      }
      const std::vector<FirstContact> found = run(kind, from, to, {separation, 0.2, 1000});
      int hits = 0;
      for (std::size_t k = 0; k < from.size(); ++k) {
        const auto distance = [&](double time) {
          Four x;
          for (int i = 0; i < 4; ++i) x[i] = from[k][i] + time * (to[k][i] - from[k][i]);
          return std::sqrt(nearest_points(kind, x).squared);
        };
        const double least = separation, apart = nearest_points(kind, from[k]).squared;
        // Of a short way it is known without a search that it is free.
        Four near = from[k];
        for (int i = 0; i < 4; ++i)
          near[i] += 0.1 * std::sqrt(apart) * normalized(to[k][i] - from[k][i]);
        EXPECT_TRUE(stays_apart(kind, from[k], near, apart, separation)) << k;
        if (stays_apart(kind, from[k], to[k], apart, separation)) {
          EXPECT_FALSE(found[k].hit) << k;
        }
        for (int s = 0; s <= 100; ++s) EXPECT_GT(distance(0.01 * s * found[k].time), least) << k;
        if (!found[k].hit) {
          EXPECT_EQ(found[k].time, 1);
          continue;
        }
        ++hits;
        // No more than the share that may be left is left.
        EXPECT_LT(distance(found[k].time) - separation, 0.2001 * (distance(0) - separation));
      }
      EXPECT_GT(hits, 20);
    }
  }
}

TEST_F(FirstContactTest, HeadOnItIsTheQuotient) {
  Four from, to;
  from[0] = {0.2, 0.2, 3}, from[1] = {0, 0, 0}, from[2] = {1, 0, 0}, from[3] = {0, 1, 0};
  to = from;
  to[0].z = -7;
  const FirstContact r = run(PairKind::point_triangle, from, to, {0, 1e-9, 1000});
  EXPECT_TRUE(r.hit);
  EXPECT_NEAR(r.time, 0.3, 1e-8);
  EXPECT_LE(r.time, 0.3);
  const FirstContact thick = run(PairKind::point_triangle, from, to, {0.5, 1e-9, 1000});
  EXPECT_NEAR(thick.time, 0.25, 1e-8);
  EXPECT_LE(thick.time, 0.25);
}

/// Motion that both features share costs nothing, however fast it is.
TEST_F(FirstContactTest, CommonMotionIsNoApproach) {
  Four from, to;
  from[0] = {0.2, 0.2, 1e-3}, from[1] = {0, 0, 0}, from[2] = {1, 0, 0}, from[3] = {0, 1, 0};
  for (int i = 0; i < 4; ++i) to[i] = from[i] + Vec3d{100, -50, 20};
  const FirstContact r = run(PairKind::point_triangle, from, to);
  EXPECT_FALSE(r.hit);
  EXPECT_EQ(r.time, 1);
  EXPECT_EQ(r.steps, 1);
}

// Pairs of a plate that swings on its pin (double pendulum of rigid-ipc): a long edge slides past a corner, or past an edge, and the
// direction between them turns by some 70 degrees. Plane by plane each takes 21 distances.
TEST_F(FirstContactTest, FeaturesThatSlidePastAnEdgeTakeFewPlanes) {
  const Four corner{{{-0.027716, 0.188520, -0.012750},
                     {-0.375027, 0.179049, -0.012461},
                     {-0.022757, 0.189145, -0.012627},
                     {-0.376252, 0.174303, -0.012463}}};
  const Four corner_way{{{},
                         {0.000341, -0.006267, 0.000009},
                         {0.000172, -0.000353, 0.000002},
                         {0.000421, -0.006287, 0.000009}}};
  const Four edges{{{-0.376252, 0.174303, -0.012463},
                    {-0.022757, 0.189145, -0.012627},
                    {-0.029424, 0.194147, -0.025250},
                    {-0.027716, 0.188520, -0.012750}}};
  const Four edges_way{{{0.000421, -0.006287, 0.000009}, {0.000172, -0.000353, 0.000002}, {}, {}}};
  const auto expect_few = [&](PairKind kind, const Four& from, const Four& way) {
    Four to;
    for (int i = 0; i < 4; ++i) to[i] = from[i] + way[i];
    const FirstContact r = run(kind, from, to);
    EXPECT_FALSE(r.hit);
    EXPECT_EQ(r.time, 1);
    EXPECT_LT(r.steps, 15);  // 4 and 13
  };
  expect_few(PairKind::point_triangle, corner, corner_way);
  expect_few(PairKind::edge_edge, edges, edges_way);
}

TEST_F(FirstContactTest, PairsThatStartInContactDoNotMove) {
  Four from, to;
  from[0] = {0.2, 0.2, 0}, from[1] = {0, 0, 0}, from[2] = {1, 0, 0}, from[3] = {0, 1, 0};
  to = from;
  to[0].z = 1;
  for (const double height : {0.0, 1e-17, 0.005}) {
    from[0].z = height;
    const FirstContact r = run(PairKind::point_triangle, from, to, {0.01, 0.1, 1000});
    EXPECT_TRUE(r.hit);
    EXPECT_EQ(r.time, 0);
  }
}

/// Case A84: a needle crosses another at 100 m/s within a step of a millisecond.
TEST_F(FirstContactTest, A84CrossingNeedles) {
  Four from, to;
  from[0] = {-1, 0, 0.05}, from[1] = {1, 1e-3, 0.05};
  from[2] = {0, -1, 0}, from[3] = {1e-3, 1, 0};
  to = from;
  to[0].z = to[1].z = 0.05 - 100 * 1e-3;
  const FirstContact r = run(PairKind::edge_edge, from, to, {0, 1e-7, 1000});
  const exact::FirstTouch truth = exact::first_touch(PairKind::edge_edge, from, to);
  ASSERT_EQ(truth.touch, exact::Touch::within);
  EXPECT_NEAR(truth.from.approximately(), 0.5, 1e-12);
  EXPECT_TRUE(r.hit);
  EXPECT_NEAR(r.time, 0.5, 1e-6);
  EXPECT_TRUE(exact::Number(r.time) <= truth.to);
}

}  // namespace
}  // namespace scree::affine
