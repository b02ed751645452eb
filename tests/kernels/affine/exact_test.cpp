// The oracles without rounding, against whole numbers and figures whose answer is known.
#include <gtest/gtest.h>

#include <random>

#include "tests/exact_contact.h"
#include "tests/exact_triangles.h"

namespace scree::exact {
namespace {

TEST(ExactNumberTest, AgreesWithWholeNumbers) {
  std::mt19937_64 random(1);
  for (int k = 0; k < 2000; ++k) {
    const auto draw = [&] { return static_cast<std::int64_t>(random()) >> (random() % 62); };
    // Of at most 62 bits: as sums of two doubles that hold them.
    const auto number = [](std::int64_t v) {
      const auto low = static_cast<double>(v % (std::int64_t{1} << 31));
      return Number(static_cast<double>(v - v % (std::int64_t{1} << 31))) + Number(low);
    };
    const std::int64_t a = draw() / 2, b = draw() / 2;
    EXPECT_EQ((number(a) + number(b) - number(a + b)).sign(), 0);
    EXPECT_EQ((number(a) - number(b) - number(a - b)).sign(), 0);
    const std::int64_t c = a >> 31, d = b >> 31;
    EXPECT_EQ((number(c) * number(d) - number(c * d)).sign(), 0);
    EXPECT_EQ(number(a) < number(b), a < b);
    // (a + b) (a - b) = a a - b b, beyond any double.
    const Number x = number(a), y = number(b);
    EXPECT_EQ(((x + y) * (x - y) - (x * x - y * y)).sign(), 0);
  }
  const Number tiny = Number(1).scaled(-900), one = 1;
  EXPECT_EQ((one + tiny - one - tiny).sign(), 0);
  EXPECT_EQ((one + tiny - one).sign(), 1);
  EXPECT_EQ((one - tiny - one).sign(), -1);
  EXPECT_EQ(Number(-0.375).approximately(), -0.375);
  EXPECT_EQ(Number(0.0).sign(), 0);
}

TEST(ExactNumberTest, PolynomialsAreMovedAndBounded) {
  const Polynomial p{{Number(3), Number(-2), Number(0.5)}};  // 3 - 2 t + t^2 / 2
  const auto at = [](const Polynomial& f, double t) {
    double sum = 0, power = 1;
    for (const Number& c : f.c) sum += c.approximately() * power, power *= t;
    return sum;
  };
  EXPECT_EQ(at(p.lower_half(), 0.5), at(p, 0.25));
  EXPECT_EQ(at(p.moved_by_one(), 0.5), at(p, 1.5));
  EXPECT_EQ(p.bernstein().front().approximately(), at(p, 0));
  EXPECT_EQ(p.bernstein().back().approximately(), at(p, 1));
  EXPECT_EQ(p.bernstein()[1].approximately(), 2 * 3 - 2.0);
}

TEST(ExactContactTest, KnowsWhenAndWhether) {
  affine::Four from, to;
  from[0] = {0.25, 0.25, 1}, from[1] = {0, 0, 0}, from[2] = {1, 0, 0}, from[3] = {0, 1, 0};
  to = from;
  to[0].z = -2;
  const auto touch = [&](affine::PairKind kind) { return first_touch(kind, from, to); };
  const FirstTouch hit = touch(affine::PairKind::point_triangle);
  EXPECT_EQ(hit.touch, Touch::within);
  EXPECT_LE(hit.from.approximately(), 1.0 / 3);
  EXPECT_GE(hit.to.approximately(), 1.0 / 3);
  EXPECT_LT((hit.to - hit.from).approximately(), 1e-14);
  from[0].x = to[0].x = 0.8;  // past the long side
  EXPECT_EQ(touch(affine::PairKind::point_triangle).touch, Touch::never);
  from[0].x = to[0].x = 0.75;  // along it
  EXPECT_EQ(touch(affine::PairKind::point_triangle).touch, Touch::unclear);
  from[0].x = to[0].x = 0.25;
  to[0].z = 0.125;
  EXPECT_EQ(touch(affine::PairKind::point_triangle).touch, Touch::never);

  from[0] = {-1, 0, 1}, from[1] = {1, 0, 1}, from[2] = {0, -1, 0}, from[3] = {0, 1, 0};
  to = from;
  to[0].z = to[1].z = -1;
  EXPECT_EQ(touch(affine::PairKind::edge_edge).touch, Touch::within);
  EXPECT_LE(touch(affine::PairKind::edge_edge).from.approximately(), 0.5);
  for (int i = 2; i < 4; ++i) from[i].x = to[i].x = 1.25;
  EXPECT_EQ(touch(affine::PairKind::edge_edge).touch, Touch::never);
}

/// In all orders and turned through the axes.
void expect_touch(bool expected, const Triangle& a, const Triangle& b) {
  const auto turned = [](const Triangle& t, int axes, std::size_t start, bool mirrored) {
    Triangle r;
    for (std::size_t k = 0; k < 3; ++k) {
      const Point& p = t[(start + (mirrored ? 3 - k : k)) % 3];
      r[k] = {p[axes], p[(axes + 1) % 3], p[(axes + 2) % 3]};
    }
    return r;
  };
  for (int axes = 0; axes < 3; ++axes)
    for (std::size_t s = 0; s < 3; ++s)
      for (const bool mirrored : {false, true}) {
        const Triangle x = turned(a, axes, s, mirrored), y = turned(b, axes, (s + 1) % 3, false);
        EXPECT_EQ(triangles_touch(x, y), expected);
        EXPECT_EQ(triangles_touch(y, x), expected);
      }
}

TEST(ExactTrianglesTest, TouchToTheLastBit) {
  const Triangle flat{Point{0, 0, 0}, Point{1, 0, 0}, Point{0, 1, 0}};
  const double up = 1e-300;
  expect_touch(true, flat, {Point{0.25, 0.25, -1}, Point{0.25, 0.25, 1}, Point{2, 2, 1}});
  expect_touch(true, flat, {Point{0.25, 0.25, 0}, Point{0.3, 0.25, 1}, Point{2, 2, 1}});
  expect_touch(false, flat, {Point{0.25, 0.25, up}, Point{0.3, 0.25, 1}, Point{2, 2, 1}});
  // A plane that both cross, but beside each other.
  expect_touch(false, flat, {Point{0.6, 0.6, -1}, Point{0.6, 0.6, 1}, Point{2, 2, 1}});
  // An edge against an edge, and past it by the smallest number.
  expect_touch(true, flat, {Point{0.5, 0, -1}, Point{0.5, 0, 1}, Point{0.5, -1, 0}});
  expect_touch(false, flat, {Point{0.5, -up, -1}, Point{0.5, -up, 1}, Point{0.5, -1, 0}});
  // In one plane: crossing, one inside the other, a shared corner, apart.
  expect_touch(true, flat, {Point{0.5, -1, 0}, Point{0.5, 1, 0}, Point{3, 0, 0}});
  expect_touch(true, flat, {Point{0.2, 0.2, 0}, Point{0.3, 0.2, 0}, Point{0.2, 0.3, 0}});
  expect_touch(true, flat, {Point{1, 0, 0}, Point{2, 0, 0}, Point{2, 1, 0}});
  expect_touch(true, flat, {Point{0.5, 0.5, 0}, Point{2, 0.5, 0}, Point{0.5, 2, 0}});
  expect_touch(false, flat, {Point{0.5, 0.5 + 1e-16 * 3, 0}, Point{2, 0.5, 0}, Point{0.6, 2, 0}});
  expect_touch(false, flat, {Point{1.1, 0, 0}, Point{2, 0, 0}, Point{2, 1, 0}});
  // In planes that are parallel.
  expect_touch(false, flat, {Point{0, 0, up}, Point{1, 0, up}, Point{0, 1, up}});
}

/// Random triangles, against whether the nearest points of one of their pairs coincide: they touch
/// if and only if an edge passes through, so all distances of pairs are above zero if not.
TEST(ExactTrianglesTest, AgreesWithSolvedEquations) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto triangle = [&] {
    Triangle t;
    for (Point& p : t) p = {unit(random), unit(random), unit(random)};
    return t;
  };
  int touching = 0;
  for (int k = 0; k < 2000; ++k) {
    const Triangle a = triangle(), b = triangle();
    bool expected = false, near = false;
    const auto edge_through = [&](const Point& p, const Point& q, const Triangle& t) {
      // p + s (q - p) = t0 + u e + v f by Cramer's rule.
      const Point e = t[1] - t[0], f = t[2] - t[0], way = p - q, d = p - t[0];
      const double whole = dot(way, scree::cross(e, f));
      const double s = dot(d, scree::cross(e, f)) / whole;
      const double u = dot(way, scree::cross(d, f)) / whole;
      const double v = dot(way, scree::cross(e, d)) / whole;
      const double inside = std::min({s, 1 - s, u, v, 1 - u - v});
      near = near || std::abs(inside) < 1e-9;
      expected = expected || inside >= 0;
    };
    for (std::size_t i = 0; i < 3; ++i) {
      edge_through(a[i], a[(i + 1) % 3], b);
      edge_through(b[i], b[(i + 1) % 3], a);
    }
    if (near) continue;
    touching += expected ? 1 : 0;
    EXPECT_EQ(triangles_touch(a, b), expected) << k;
  }
  EXPECT_GT(touching, 200);
}

}  // namespace
}  // namespace scree::exact
