#pragma once
// Times of impact of convex bodies: closed forms, roots of scalar equations, and dense samples of random ways.

#include <functional>
#include <vector>

#include "collision/hull_tables.h"
#include "kernels/variational/convex_sweep.h"
#include "tests/backend_fixture.h"
#include "tests/box_separation.h"
#include "tests/kernels/variational/random_motion.h"

namespace scree {
namespace {

SweptShape swept(ShapeKind kind, const Vec3d& half) {
  SweptShape s;
  s.side.kind = kind;
  s.side.half_extents = half;
  s.side.radius = half.x;
  s.radius = kind == shapes::Sphere::kind || kind == shapes::Ellipsoid::kind
                 ? std::max({half.x, half.y, half.z})
             : kind == shapes::Capsule::kind ? half.z
                                             : norm(half);
  return s;
}
SweptShape ball(double radius) { return swept(shapes::Sphere::kind, {radius, radius, radius}); }
SweptShape box(const Vec3d& half) { return swept(shapes::Box::kind, half); }

RigidPath straight(const Vec3d& x, const Vec3d& v, const Vec3d& g = {}) {
  RigidPath p;
  p.node.position = x;
  p.velocity = v;
  p.acceleration = g;
  return p;
}

/// One that turns about a principal axis, or about any with equal moments.
RigidPath spinning(RigidPath p, const Quatd& q, const Vec3d& rate) {
  p.node.orientation = q;
  p.moments = {1, 1, 1};
  p.momentum = rotate_back(q, rate);
  p.bound_rotation(1);
  return p;
}

/// The first root of f by samples and bisection; negative: none.
double first_root(const std::function<double(double)>& f, double end) {
  constexpr int kSamples = 20000;
  for (int k = 1; k <= kSamples; ++k) {
    if (f(end * k / kSamples) > 0) continue;
    double low = end * (k - 1) / kSamples, high = end * k / kSamples;
    for (int turn = 0; turn < 60; ++turn) {
      const double middle = 0.5 * (low + high);
      (f(middle) > 0 ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }
  return -1;
}

constexpr double kTolerance = 1e-7;

TEST(ConvexSweepTest, SpheresMeetWhenTheirDistanceIsTheSumOfRadii) {
  std::mt19937 random(1);
  int hits = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const Vec3d d = 2.0 * normalized(normal_vector(random));
    const Vec3d v = -2.0 * d + normal_vector(random);
    const ConvexApproach pair{ball(0.5), ball(0.7), straight({}, {}, {0, 0, -9.81}),
                              straight(d, v, {0, 0, -9.81})};
    const Sweep found = sweep(pair, 0, 1, kTolerance);
    const double a = norm2(v), b = dot(d, v), c = norm2(d) - 1.44, inside = b * b - a * c;
    const double time = inside > 0 ? (-b - std::sqrt(inside)) / a : 2;
    if (std::abs(inside) < 1e-3) continue;
    ASSERT_EQ(found.outcome, time < 1 ? SweepOutcome::hit : SweepOutcome::apart) << trial;
    if (time > 1) continue;
    ++hits;
    const double speed = std::sqrt(inside) / 1.2;
    EXPECT_LE(found.time, time + 1e-14);
    EXPECT_GE(found.time, time - 1.1 * kTolerance / speed);
    EXPECT_LT(norm(found.near.normal - normalized(d + found.time * v)), 1e-9);
  }
  EXPECT_GT(hits, 200);
}

TEST(ConvexSweepTest, ABallFallsOnAPlane) {
  const PlaneApproach fall{ball(0.1), straight({0, 0, 1.1}, {3, 0, 0}, {0, 0, -10}), {}, {0, 0, 1}};
  const Sweep found = sweep(fall, 0, 1, kTolerance);
  ASSERT_EQ(found.outcome, SweepOutcome::hit);
  EXPECT_LE(found.time, std::sqrt(0.2));
  EXPECT_GE(found.time, std::sqrt(0.2) - kTolerance / 4);
  EXPECT_EQ(sweep(fall, 0, 0.44, kTolerance).outcome, SweepOutcome::apart);
  EXPECT_LT(norm(found.near.point - Vec3d{3 * found.time, 0, 0}), kTolerance);
}

TEST(ConvexSweepTest, ACornerOfATurningBoxMeetsAPlaneAtTheRoot) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int hits = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3d half{0.5 + 0.4 * uniform(random), 0.3, 0.3 + 0.2 * uniform(random)};
    const double rate = 12 * uniform(random), start = 3 * uniform(random), v = 2 * uniform(random);
    const double height = 1.2 + 0.2 * uniform(random);
    const RigidPath path = spinning(straight({0, 0, height}, {1, 2, v}, {0, 0, -9.81}),
                                    exp_map(Vec3d{0, start, 0}), {0, rate, 0});
    const Sweep found = sweep(PlaneApproach{box(half), path, {}, {0, 0, 1}}, 0, 1, kTolerance);
    const auto gap = [&](double t) {
      const double angle = start + rate * t;
      return height + v * t - 0.5 * 9.81 * t * t - half.x * std::abs(std::sin(angle)) -
             half.z * std::abs(std::cos(angle));
    };
    const double time = first_root(gap, 1);
    ASSERT_EQ(found.outcome, time > 0 ? SweepOutcome::hit : SweepOutcome::apart) << trial;
    if (time < 0) continue;
    ++hits;
    EXPECT_LE(found.time, time + 1e-13) << trial;
    EXPECT_GE(gap(found.time), 0.49 * kTolerance) << trial;
    EXPECT_LE(gap(found.time), kTolerance) << trial;
  }
  EXPECT_GT(hits, 100);
}

TEST(ConvexSweepTest, ATurningRodMeetsASphereAtTheRoot) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int hits = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const double start = 3 * uniform(random), rate = 10 * uniform(random), v = 2 + uniform(random);
    const RigidPath path = spinning(straight({}, {}), exp_map(Vec3d{0, start, 0}), {0, rate, 0});
    const ConvexApproach pair{swept(shapes::Capsule::kind, {0.05, 0.05, 1}), ball(0.2), path,
                              straight({0, 0, 2}, {0.1, 0, -v})};
    const auto gap = [&](double t) {
      const Vec3d axis{std::sin(start + rate * t), 0, std::cos(start + rate * t)};
      const Vec3d x{0.1 * t, 0, 2 - v * t};
      const double along = std::max(-0.95, std::min(0.95, dot(x, axis)));
      return norm(x - along * axis) - 0.25;
    };
    const double time = first_root(gap, 1);
    const Sweep found = sweep(pair, 0, 1, kTolerance);
    ASSERT_EQ(found.outcome, time > 0 ? SweepOutcome::hit : SweepOutcome::apart) << trial;
    if (time < 0) continue;
    ++hits;
    EXPECT_LE(found.time, time + 1e-13) << trial;
    EXPECT_NEAR(gap(found.time), 0.75 * kTolerance, 0.26 * kTolerance) << trial;
  }
  EXPECT_GT(hits, 100);
}

RigidPath tumbling(std::mt19937& random, const Vec3d& half, const Vec3d& x, const Vec3d& v,
                   double end) {
  RigidPath p = straight(x, v, random() % 2 == 0 ? Vec3d{0, 0, -9.81} : Vec3d{});
  p.node.orientation = random_turn(random);
  const Vec3d square = hadamard(half, half);
  p.moments = (1.0 / 3) * Vec3d{square.y + square.z, square.z + square.x, square.x + square.y};
  const double rate = 4 * std::uniform_real_distribution<double>(0, 1)(random);
  p.momentum = hadamard(p.moments, rate * normal_vector(random));
  p.bound_rotation(end);
  return p;
}

TEST(ConvexSweepTest, BoxesThatTumbleAreNeverMissed) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(0, 1);
  constexpr double kEnd = 0.2;
  int hits = 0, apart = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const auto half = [&] {
      const double x = uniform(random), y = uniform(random);
      return Vec3d{0.05 + 0.5 * x, 0.05 + 0.5 * y, 0.05 + 0.5 * uniform(random)};
    };
    const Vec3d half_a = half(), half_b = half(), way = normalized(normal_vector(random));
    const ConvexApproach pair{box(half_a), box(half_b),
                              tumbling(random, half_a, {}, normal_vector(random), kEnd),
                              tumbling(random, half_b, 1.8 * way,
                                       -10 * uniform(random) * way + normal_vector(random), kEnd)};
    const auto gap = [&](double t) {
      const BodyPose a = pair.path_a.pose(t), b = pair.path_b.pose(t);
      return test::box_separation(pair.a.side.half_extents, a.orientation, pair.b.side.half_extents,
                                  b.orientation, b.position - a.position);
    };
    if (gap(0) < 1e-3) continue;
    const Sweep found = sweep(pair, 0, kEnd, kTolerance);
    ASSERT_NE(found.outcome, SweepOutcome::undecided) << trial;
    const bool is_hit = found.outcome == SweepOutcome::hit;
    ++(is_hit ? hits : apart);
    if (is_hit) {
      EXPECT_GE(gap(found.time), 0.49 * kTolerance) << trial;
      EXPECT_LE(gap(found.time), kTolerance) << trial;
    }
    const double until = is_hit ? found.time : kEnd;
    for (int k = 0; k < 100; ++k) ASSERT_GT(gap(until * k / 100), 0) << trial << " at " << k;
    EXPECT_LT(found.steps, 100) << trial;
  }
  EXPECT_GT(hits, 500);
  EXPECT_GT(apart, 500);
}

/// An octahedron, askew.
class HullSample {
 public:
  HullSample() {
    MeshSource source;
    source.vertices = {{1, 0, 0},       {-1, 0, 0},      {0.2, 0.8, 0},
                       {-0.2, -0.8, 0}, {0.1, 0.2, 0.7}, {-0.1, -0.2, -0.7}};
    source.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                        {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    tables_ = build_hull_tables({source});
  }
  Hull hull() const { return view_of(tables_).hull(0, 1); }

 private:
  HullTables tables_;
};

TEST(ConvexSweepTest, EveryTwoConvexShapesMeetWithTheirDistanceWithinTheTolerance) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  const HullSample hulls;
  constexpr ShapeKind kKinds[] = {
      shapes::Sphere::kind, shapes::Box::kind,       shapes::Capsule::kind, shapes::Cylinder::kind,
      shapes::Cone::kind,   shapes::Ellipsoid::kind, shapes::Hull::kind,    shapes::Rounded::kind};
  const auto any_shape = [&](ShapeKind kind) {
    const double r = 0.2 + 0.3 * uniform(random), z = 0.6 + 0.3 * uniform(random);
    SweptShape s =
        swept(kind, {r, kind == shapes::Ellipsoid::kind || kind == shapes::Box::kind ? 0.3 : r, z});
    if (kind == shapes::Hull::kind) {
      s.side.hull = hulls.hull();
      s.radius = 1.1;
    }
    if (kind == shapes::Rounded::kind) {
      s.side.rounded = {shapes::Cylinder::kind, 0.1, 0};
      s.radius += 0.1;
    }
    return s;
  };
  const double tolerance = 1e-7;
  for (const ShapeKind kind_a : kKinds) {
    for (const ShapeKind kind_b : kKinds) {
      int hits = 0;
      for (int trial = 0; trial < 20; ++trial) {
        const Vec3d way = normalized(normal_vector(random));
        const SweptShape a = any_shape(kind_a), b = any_shape(kind_b);
        const ConvexApproach pair{a, b, tumbling(random, {0.3, 0.4, 0.9}, {}, {}, 0.2),
                                  tumbling(random, {0.3, 0.2, 0.6}, 2.5 * way, -12 * way, 0.2)};
        const Sweep found = sweep(pair, 0, 0.2, tolerance);
        ASSERT_NE(found.outcome, SweepOutcome::undecided);
        const bool is_hit = found.outcome == SweepOutcome::hit;
        const auto distance = [&](double t) {
          const ConvexCore ca = a.core_at(pair.path_a.pose(t), {}),
                           cb = b.core_at(pair.path_b.pose(t), {});
          return core_distance(ca, cb, 1e300).separation - ca.rounding - cb.rounding;
        };
        for (int k = 0; k < 50; ++k) EXPECT_GT(distance(found.time * k / 50), 0);
        const ConvexApproach turned{b, a, pair.path_b, pair.path_a};
        const Sweep other = sweep(turned, 0, 0.2, tolerance);
        EXPECT_EQ(other.outcome, found.outcome);
        if (!is_hit) continue;
        ++hits;
        // The largest separation of all directions, near the one that was found.
        const ConvexCore ca = a.core_at(pair.path_a.pose(found.time), {});
        const ConvexCore cb = b.core_at(pair.path_b.pose(found.time), {});
        Vec3d n = found.near.normal;
        double gap = ConvexApproach::separation_of(ca, cb, n);
        EXPECT_GE(gap, 0.49 * tolerance);
        for (double step = 1e-3; step > 1e-9; step *= 0.8) {
          for (int turn = 0; turn < 12; ++turn) {
            const Vec3d next = normalized(n + step * normal_vector(random));
            const double of_next = ConvexApproach::separation_of(ca, cb, next);
            if (of_next > gap) gap = of_next, n = next;
          }
        }
        EXPECT_LE(gap, 1.05 * tolerance);
        EXPECT_NEAR(other.time, found.time, tolerance) << "speeds are above one";
      }
      EXPECT_GT(hits, 10);
    }
  }
}

TEST(ConvexSweepTest, BodiesThatTouchMayLeave) {
  const double gap = 0.7 * kTolerance;
  // A plank that lies on the floor and is thrown up, turning: one end goes down at first against its center.
  for (const double rate : {0.0, 1.5, 3.0}) {
    RigidPath path =
        spinning(straight({0, 0, 0.1 + gap}, {0, 0, 1}, {0, 0, -9.81}), {}, {0, rate, 0});
    const Sweep found =
        sweep(PlaneApproach{box({0.5, 0.5, 0.1}), path, {}, {0, 0, 1}}, 0, 0.15, kTolerance);
    if (0.5 * rate < 1) {
      EXPECT_TRUE(found.outcome == SweepOutcome::apart || found.time > 0.01) << rate;
    } else {
      EXPECT_EQ(found.outcome, SweepOutcome::hit)
          << "an end goes down faster than the center goes up";
      EXPECT_EQ(found.time, 0) << rate;
    }
  }
  const ConvexApproach apart{box({0.5, 0.5, 0.5}), box({0.5, 0.5, 0.5}), straight({}, {}),
                             straight({1 + gap, 0.3, 0.2}, {1e-3, 1, 0})};
  EXPECT_EQ(sweep(apart, 0, 1, kTolerance).outcome, SweepOutcome::apart);
  ConvexApproach nearer = apart;
  nearer.path_b.velocity = {-1e-3, 1, 0};
  const Sweep found = sweep(nearer, 0, 1, kTolerance);
  EXPECT_EQ(found.outcome, SweepOutcome::hit);
  EXPECT_EQ(found.time, 0);
}

TEST(ConvexSweepTest, EdgesThatCrossMayLeaveEachOther) {
  // One along x below, one along y above; both turn, so that ends of one go toward the other's body.
  const double gap = 0.7 * kTolerance, diagonal = std::sqrt(0.5), quarter = std::atan(1.0);
  std::mt19937 random(7);
  int left = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const Vec3d rate_a = 2.0 * normal_vector(random), rate_b = 2.0 * normal_vector(random);
    const RigidPath lower = spinning(straight({}, {}), exp_map(Vec3d{quarter, 0, 0}), rate_a);
    RigidPath upper = spinning(straight({0.1, 0.05, 2 * diagonal + gap}, {}),
                               exp_map(Vec3d{0, quarter, 0}), rate_b);
    // The points that touch leave each other at 0.2.
    const Vec3d point{0.1, 0, diagonal};
    const Vec3d u = cross(rate_b, point - upper.node.position) - cross(rate_a, point);
    upper.velocity = {0, 0, 0.2 - u.z};
    const ConvexApproach pair{box({0.5, 0.5, 0.5}), box({0.5, 0.5, 0.5}), lower, upper};
    const Sweep found = sweep(pair, 0, 0.01, kTolerance);
    EXPECT_TRUE(found.outcome == SweepOutcome::apart || found.time > 1e-4) << trial;
    left += found.outcome == SweepOutcome::apart;
    // And the other way they meet at once.
    upper.velocity.z -= 0.4;
    const ConvexApproach back{pair.a, pair.b, lower, upper};
    EXPECT_EQ(sweep(back, 0, 0.01, kTolerance).time, 0) << trial;
  }
  EXPECT_GT(left, 50);
}

TEST(ConvexSweepTest, ABallMeetsATriangleAtItsFaceEdgeAndCorner) {
  Vec3d center;
  const SweptShape triangle = SweptShape::triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, center);
  const RigidPath wall = RigidPath::fixed(center, {});
  const auto hit = [&](const Vec3d& x, const Vec3d& v) {
    return sweep(ConvexApproach{ball(0.1), triangle, straight(x, v), wall}, 0, 2, kTolerance);
  };
  const Sweep face = hit({0.2, 0.2, 1}, {0, 0, -1});
  EXPECT_NEAR(face.time, 0.9, kTolerance);
  EXPECT_LT(norm(face.near.normal - Vec3d{0, 0, -1}), 1e-9);
  const Sweep edge = hit({0.5, -1, 0}, {0, 1, 0});
  EXPECT_NEAR(edge.time, 0.9, kTolerance);
  EXPECT_LT(norm(edge.near.normal - Vec3d{0, 1, 0}), 1e-7);
  const Sweep corner = hit({-1, -1, 0}, {1, 1, 0});
  EXPECT_NEAR(corner.time, 1 - 0.1 / std::sqrt(2.0), kTolerance);
  EXPECT_EQ(hit({-0.2, -0.2, 1}, {0, 0, -1}).outcome, SweepOutcome::apart);
}

TEST(ConvexSweepTest, PartsOfABodyTurnWithIt) {
  // A ball at the end of an arm of length 1 that turns about z meets a plane across y.
  SweptShape part = ball(0.1);
  part.offset = {1, 0, 0};
  part.radius = 0.1;
  const RigidPath path = spinning(straight({}, {}), {}, {0, 0, 2});
  const PlaneApproach turn{part, path, {0, 0.6, 0}, {0, -1, 0}};
  const Sweep found = sweep(turn, 0, 1, kTolerance);
  ASSERT_EQ(found.outcome, SweepOutcome::hit);
  EXPECT_NEAR(found.time, 0.5 * std::asin(0.5), kTolerance);
}

struct SweepMany {
  static constexpr const char* name = "sweep_many";
  Span<const ConvexApproach> pairs;
  Span<Sweep> found;
  SCREE_HD void operator()(Index i) const { found[i] = sweep(pairs[i], 0, 0.2, 1e-7); }
};

class ConvexSweepOnBackend : public BackendTest<double> {};

TEST_F(ConvexSweepOnBackend, RunsThere) {
  std::mt19937 random(6);
  std::vector<ConvexApproach> pairs;
  for (int k = 0; k < 300; ++k) {
    const Vec3d way = normalized(normal_vector(random));
    pairs.push_back({box({0.3, 0.4, 0.5}), swept(shapes::Cylinder::kind, {0.3, 0.3, 0.5}),
                     tumbling(random, {0.3, 0.4, 0.5}, {}, {}, 0.2),
                     tumbling(random, {0.3, 0.3, 0.5}, 2.0 * way, -8 * way, 0.2)});
  }
  Buffer<TestBackend, ConvexApproach> there(backend());
  Buffer<TestBackend, Sweep> result(backend());
  upload(backend(), pairs, there);
  for_each(backend(), 300, SweepMany{there.view(), result.resize_discard(300)});
  const std::vector<Sweep> found = download(backend(), result.view());
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const Sweep here = sweep(pairs[k], 0, 0.2, 1e-7);
    EXPECT_EQ(found[k].outcome, here.outcome) << k;
    EXPECT_NEAR(found[k].time, here.time, 1e-7) << k;
  }
}

}  // namespace
}  // namespace scree
