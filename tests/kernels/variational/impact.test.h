// Times of impact and what impacts do, against closed forms and against the laws of a projection.

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "kernels/variational/fixed_walls.h"
#include "kernels/variational/impact.h"
#include "tests/backend_fixture.h"

namespace scree {
namespace {

/// A falling sphere and a box about the origin.
struct Shot {
  Flight flight;
  Vec3d half;
  double radius = 0;
};

struct BoxTimes {
  static constexpr const char* name = "test_box_times";
  Span<const Shot> shot;
  Span<double> time;
  SCREE_HD void operator()(Index i) const {
    const Shot s = shot[i];
    const auto gap = [&s](const Vec3d& x, Vec3d& n) {
      const Vec3d offset = x - shapes::Box::nearest(s.half, x);
      const double distance = norm(offset);
      n = distance > 0 ? (1 / distance) * offset : Vec3d{0, 0, 1};
      return distance - s.radius;
    };
    time[i] = time_to_touch(s.flight, 10, 1e-14, gap);
  }
};

struct SphereTimes {
  static constexpr const char* name = "test_sphere_times";
  Span<const Vec3d> d, u;
  Span<double> time;
  SCREE_HD void operator()(Index i) const { time[i] = time_of_spheres(d[i], u[i], 1); }
};

struct Projections {
  static constexpr const char* name = "test_projections";
  Span<const NormalCone> cone;
  Span<const Vec3d> v;
  Span<Vec3d> part;
  SCREE_HD void operator()(Index i) const { part[i] = cone[i].project(v[i]); }
};

class VariationalImpact : public BackendTest<double> {
 protected:
  template <class T>
  Buffer<TestBackend, T> put(const std::vector<T>& values) {
    Buffer<TestBackend, T> buffer(backend());
    upload(backend(), values, buffer);
    return buffer;
  }
  std::vector<double> box_times(const std::vector<Shot>& shots) {
    const auto n = static_cast<Index>(shots.size());
    Buffer<TestBackend, Shot> shot = put(shots);
    Buffer<TestBackend, double> time(backend(), n);
    for_each(backend(), n, BoxTimes{shot.view(), time.view()});
    return download(backend(), time.view());
  }
};

TEST_F(VariationalImpact, MeetsFacesEdgesAndCornersOfABox) {
  const Vec3d half{1, 2, 3}, none{}, down{0, 0, -10};
  const double r = 0.5;
  const std::vector<Shot> shots{
      {{{5, 0, 0}, {-2, 0, 0}, none}, half, r},                // a face
      {{{4, 5, 0}, {-1, -1, 0}, none}, half, r},               // an edge: from (3, 3) to it
      {{{1 + 2, 2 + 2, 3 + 2}, {-1, -1, -1}, none}, half, r},  // a corner
      {{{0, 0, 3.5 + 0.8}, {0, 0, 0}, down}, half, r},         // falls on the top
      {{{0, 0, 3.5}, {0, 0, 3}, down}, half, r},               // leaves the top, and comes back
      {{{5, 0, 0}, {2, 0, 0}, none}, half, r},                 // goes away
      {{{5, 2.5001, 0}, {-2, 0, 0}, none}, half, r},           // passes by
      {{{1.5, 0, 0}, {-1, 0, 0}, none}, half, r},              // touches, and approaches
      {{{1.24, 2.18, 5}, {0, 0, -1000}, none}, half, r},       // fast, onto a corner
      {{{1.4, 1, 3.5}, {0, 0, -4}, none}, half, r},            // onto a long edge
  };
  const double edge = (std::sqrt(18.0) - r) / std::sqrt(2.0);
  const double corner = (std::sqrt(12.0) - r) / std::sqrt(3.0);
  // Above the corner (1, 2, 3): z = 3 + sqrt(r^2 - 0.24^2 - 0.18^2) = 3.4.
  const double onto_corner = 1.6 / 1000;
  // Above the edge x = 1, z = 3: z = 3 + sqrt(r^2 - 0.4^2) = 3.3.
  const double onto_edge = 0.2 / 4;
  const std::vector<double> expected{
      1.75, edge, corner, std::sqrt(2 * 0.8 / 10), 0.6, kNever, kNever, 0, onto_corner, onto_edge};
  const std::vector<double> found = box_times(shots);
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(found[i], expected[i], 1e-13 * (1 + expected[i])) << "shot " << i;
}

/// Never late: until the time found, the sphere keeps off the box. The steps of the check are far finer than the
/// search's.
TEST_F(VariationalImpact, PassesNoTouchUnderGravity) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Shot> shots(400);
  for (Shot& s : shots) {
    s.half = {0.4 + 0.3 * uniform(random), 0.4 + 0.3 * uniform(random),
              0.4 + 0.3 * uniform(random)};
    s.radius = 0.1;
    do {
      s.flight.x = {2 * uniform(random), 2 * uniform(random), 2 * uniform(random)};
    } while (norm(s.flight.x - shapes::Box::nearest(s.half, s.flight.x)) < 0.2);
    s.flight.v = Vec3d{uniform(random), uniform(random), uniform(random)} - s.flight.x;
    s.flight.g = {0, 0, -5};
  }
  const std::vector<double> times = box_times(shots);
  int hits = 0;
  for (std::size_t i = 0; i < shots.size(); ++i) {
    const Shot& s = shots[i];
    const auto gap = [&](double t) {
      const Vec3d x = s.flight.place(t);
      return norm(x - shapes::Box::nearest(s.half, x)) - s.radius;
    };
    const double end = times[i] < kNever ? times[i] : 3;
    for (int k = 0; k < 2000; ++k) ASSERT_GT(gap(end * k / 2000), -1e-13) << "shot " << i;
    if (!(times[i] < kNever)) continue;
    ++hits;
    EXPECT_NEAR(gap(end), 0, 1e-12) << "shot " << i;
  }
  EXPECT_GT(hits, 40);
  EXPECT_LT(hits, 360);
}

TEST_F(VariationalImpact, SpheresMeetWhereTheirWaysDo) {
  const std::vector<Vec3d> d{{3, 0, 0}, {3, 0, 0}, {3, 0.6, 0}, {3, 1.0000001, 0},
                             {1, 0, 0}, {1, 0, 0}, {0, 0, 1e6}};
  const std::vector<Vec3d> u{{-2, 0, 0}, {2, 0, 0}, {-1, 0, 0},  {-1, 0, 0},
                             {-1, 5, 0}, {0, 1, 0}, {0, 0, -1e6}};
  const std::vector<double> expected{1, kNever, 3 - 0.8, kNever, 0, kNever, 1 - 1e-6};
  Buffer<TestBackend, Vec3d> on_d = put(d), on_u = put(u);
  Buffer<TestBackend, double> time(backend(), static_cast<Offset>(d.size()));
  for_each(backend(), static_cast<Index>(d.size()),
           SphereTimes{on_d.view(), on_u.view(), time.view()});
  const std::vector<double> found = download(backend(), time.view());
  for (std::size_t i = 0; i < d.size(); ++i)
    EXPECT_NEAR(found[i], expected[i], 1e-14 * (1 + expected[i])) << "pair " << i;
}

/// Moreau: v is the sum of its projections on the cone and on the cone that is polar to it, which are at a right angle.
TEST_F(VariationalImpact, ProjectsOnNormalCones) {
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  const auto vector = [&] { return Vec3d{normal(random), normal(random), normal(random)}; };
  std::vector<NormalCone> cones(3000);
  std::vector<Vec3d> v(cones.size());
  for (std::size_t i = 0; i < cones.size(); ++i) {
    // Normals of walls that leave room: about a common direction.
    const Vec3d middle = normalized(vector());
    for (std::size_t k = 0; k <= i % NormalCone::kMost; ++k) {
      Vec3d n = normalized(vector());
      if (dot(n, middle) < 0) n = -n;
      cones[i].add(n);
    }
    v[i] = vector();
  }
  Buffer<TestBackend, NormalCone> on_cones = put(cones);
  Buffer<TestBackend, Vec3d> on_v = put(v), part(backend(), static_cast<Offset>(v.size()));
  for_each(backend(), static_cast<Index>(v.size()),
           Projections{on_cones.view(), on_v.view(), part.view()});
  const std::vector<Vec3d> found = download(backend(), part.view());
  int kinds[2] = {};
  for (std::size_t i = 0; i < cones.size(); ++i) {
    const Vec3d rest = v[i] - found[i];
    for (int k = 0; k < cones[i].count; ++k) EXPECT_GE(dot(cones[i].n[k], rest), -1e-11) << i;
    EXPECT_NEAR(dot(found[i], rest), 0, 1e-10) << i;
    // In the cone: against every direction of the polar one, of which rest and the middle are two.
    for (int k = 0; k < 50; ++k) {
      Vec3d w = vector();
      bool is_polar = true;
      for (int j = 0; j < cones[i].count; ++j) is_polar = is_polar && dot(cones[i].n[j], w) >= 0;
      if (is_polar) {
        EXPECT_LE(dot(found[i], w), 1e-10) << i;
      }
    }
    ++kinds[norm(found[i]) > 0];
  }
  EXPECT_GT(kinds[0], 100);
  EXPECT_GT(kinds[1], 100);
}

TEST_F(VariationalImpact, CornersOfABoxTurnVelocitiesBack) {
  NormalCone cone;
  cone.add({1, 0, 0}), cone.add({0, 1, 0}), cone.add({0, 0, 1}), cone.add({1, 0, 0});
  EXPECT_EQ(cone.count, 3);
  const Vec3d v{-1, -2, -3};
  EXPECT_EQ(cone.project(v), v);
  EXPECT_EQ(cone.project({-1, 2, -3}), (Vec3d{-1, 0, -3}));
  EXPECT_EQ(cone.project({1, 2, 3}), Vec3d{});
}

/// The discrete energy of a part of a step in a uniform field, from its definition, is the same before and after.
TEST_F(VariationalImpact, CarriesTheDiscreteEnergyAcross) {
  const double g = 9.81, h = 0.01;
  const auto energy = [&](double a, double b, double t) {
    const double v = (b - a) / t;
    return 0.5 * v * v + 0.5 * g * (a + b);
  };
  for (const double alpha : {0.05, 0.3, 0.5, 0.95}) {
    const double s = alpha * h, t = h - s, z = 0.7, down = 2;
    // A node before, from which it falls to z in s, with speed `down` there.
    const double before = z + s * down - 0.5 * g * s * s;
    const Rebound up = rebound(down, carried_square(g, s, t));
    const double after = z + t * up.speed - 0.5 * g * t * t;
    EXPECT_FALSE(up.is_grazing);
    EXPECT_NEAR(energy(before, z, s), energy(z, after, t), 1e-12) << alpha;
    EXPECT_NEAR(0.5 * (up.speed * up.speed - down * down), g * g * h * h * (1 - 2 * alpha) / 8,
                1e-14);
    // The same run backward.
    EXPECT_NEAR(rebound(up.speed, carried_square(g, t, s)).speed, down, 1e-14);
  }
}

TEST_F(VariationalImpact, GrazingImpactsKeepTheirSpeedBothWays) {
  const double carried = 0.04;
  EXPECT_TRUE(rebound(0.1, -carried).is_grazing) << "no speed at all";
  EXPECT_TRUE(rebound(0.21, -carried).is_grazing) << "less than half";
  EXPECT_EQ(rebound(0.21, -carried).speed, 0.21);
  EXPECT_TRUE(rebound(0.1, carried).is_grazing) << "more than twice";
  EXPECT_FALSE(rebound(0.3, -carried).is_grazing);
  EXPECT_NEAR(rebound(0.3, -carried).speed, std::sqrt(0.05), 1e-15);
  EXPECT_FALSE(rebound(0, 0).is_grazing);
}

}  // namespace
}  // namespace scree
