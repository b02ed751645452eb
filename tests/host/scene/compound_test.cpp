// Mass properties and frames of compounds, against shapes that have closed forms of their own.

#include "host/scene/compound.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "shapes/shape_card.h"
#include "tests/host/scene/shape_samples.h"

namespace scree {
namespace {

using test::ellipsoid_of;
using test::part;
using test::round_of;

void expect_same(const SolidMoments& a, const SolidMoments& b, double tolerance) {
  EXPECT_NEAR(a.volume, b.volume, tolerance * b.volume);
  const double size = std::sqrt(b.second[0][0] + b.second[1][1] + b.second[2][2]);
  EXPECT_LT(norm(a.center - b.center), tolerance * size);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      EXPECT_NEAR(a.second[i][j], b.second[i][j], tolerance * size * size) << i << j;
}

SolidMoments once(const std::vector<ShapePart>& parts) {
  return moments_of(Scene{}, parts, SharedMass::once);
}

const Quatd kTurn = exp_map(Vec3d{0.3, -0.8, 0.5});

TEST(Compounds, PartsThatDoNotOverlapAddUpExactly) {
  const std::vector<ShapePart> halves{part(test::box_of({1, 2, 3}), {-1, 0, 0}),
                                      part(test::box_of({1, 2, 3}), {1, 0, 0})};
  const SolidMoments whole = once({part(test::box_of({2, 2, 3}), {})});
  expect_same(once(halves), whole, 1e-12);
  expect_same(moments_of(Scene{}, halves, SharedMass::each_part), whole, 1e-12);
}

// Two balls of radius 1 at a distance of 1: their lens has the volume 5 pi / 12.
TEST(Compounds, WhatTwoBallsHaveInCommonIsALens) {
  const std::vector<ShapePart> balls{part(test::ball_of(1), {0, 0, 0}),
                                     part(test::ball_of(1), {0, 0, 1})};
  const double both = 8 * std::numbers::pi / 3, lens = 5 * std::numbers::pi / 12;
  EXPECT_NEAR(once(balls).volume, both - lens, 1e-5 * lens);
  EXPECT_NEAR(moments_of(Scene{}, balls, SharedMass::each_part).volume, both, 1e-12);
  EXPECT_NEAR(once(balls).center.z, 0.5, 1e-5);
}

TEST(Compounds, OverlapsCountOnceWhereTheUnionIsKnown) {
  // Two rods that overlap make a longer one, and a rod with two balls is a capsule.
  const Shape rod = round_of("cylinder", 0.5, 1.5);
  expect_same(once({part(rod, rotate(kTurn, {0, 0, -0.5}), kTurn),
                    part(rod, rotate(kTurn, {0, 0, 0.5}), kTurn)}),
              once({part(round_of("cylinder", 0.5, 2), {}, kTurn)}), 3e-5);
  expect_same(once({part(rod, {}, kTurn), part(test::ball_of(0.5), rotate(kTurn, {0, 0, -1.5})),
                    part(test::ball_of(0.5), rotate(kTurn, {0, 0, 1.5}))}),
              once({part(round_of("capsule", 0.5, 2), {}, kTurn)}), 3e-5);
  // Three boxes in one place, two of them larger than the third.
  expect_same(
      once({part(test::box_of({2, 1, 1}), {-1, 0, 0}), part(test::box_of({2, 1, 1}), {1, 0, 0}),
            part(test::box_of({1, 0.5, 0.5}), {})}),
      once({part(test::box_of({3, 1, 1}), {})}), 3e-5);
}

// Every shape that may be a part, twice in the same place, is there once: so its chords are those of its volume and moments.
TEST(Compounds, AShapeTwiceInOnePlaceIsThatShape) {
  Scene scene;
  for (const ShapePart& one : test::a_part_of_every_shape(scene, {0.2, -0.1, 0.4}, kTurn)) {
    SCOPED_TRACE(shape_card(one.shape.kind).name);
    expect_same(moments_of(scene, {one, one}, SharedMass::once),
                moments_of(scene, {one}, SharedMass::each_part), 3e-5);
  }
}

TEST(Compounds, AFreeOneHasItsPrincipalFrame) {
  Scene scene;
  BodyDescription body;
  body.position = {10, 0, 0};
  set_compound(scene, body,
               {part(test::ball_of(0.1), {0, 0, 0}), part(test::ball_of(0.1), {3, 3, 0}),
                part(test::ball_of(0.1), {0, 6, 0})});
  EXPECT_LT(norm(body.position - Vec3d{11, 3, 0}), 1e-12);
  set_mass_from_density(body, 1000);
  // Point masses and the moments of the balls; the frame has the axes in another order, so compare sorted.
  const double ball = 1000 * 4.0 / 3 * std::numbers::pi * 1e-3;
  std::array<double, 3> expected{ball * (4 + 1 + 1), ball * 18, ball * (4 + 1 + 1 + 18)};
  for (double& moment : expected) moment += 3 * 0.4 * ball * 0.01;
  std::array<double, 3> found{body.inertia.x, body.inertia.y, body.inertia.z};
  std::sort(found.begin(), found.end());
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(found[k], expected[k], 1e-9 * expected[k]);
  // The parts are where they were.
  const std::vector<ShapePart> parts = parts_of(scene, body.shape);
  const Vec3d far = body.position + rotate(body.orientation, parts.at(2).position);
  EXPECT_LT(norm(far - Vec3d{10, 6, 0}), 1e-12);
}

TEST(Compounds, AFixedOneKeepsTheFrameOfItsParts) {
  Scene scene;
  BodyDescription body;
  body.kind = BodyKind::fixed;
  set_compound(scene, body, {part(test::ball_of(0.1), {5, 0, 0})});
  EXPECT_EQ(body.position, Vec3d{});
  EXPECT_EQ(parts_of(scene, body.shape).at(0).position, (Vec3d{5, 0, 0}));
}

TEST(Compounds, ScaledOnesHaveScaledPartsAndMasses) {
  Scene scene;
  BodyDescription body;
  set_compound(scene, body,
               {part(round_of("cylinder", 0.5, 2), {}), part(test::ball_of(1), {0, 0, 1})});
  const ShapeCard& card = shape_card(body.shape.kind);
  const Shape twice = card.scaled(body.shape, 2);
  EXPECT_NEAR(card.mass(twice, 1).mass, 8 * card.mass(body.shape, 1).mass, 1e-9);
  EXPECT_NEAR(card.mass(twice, 1).inertia.x, 32 * card.mass(body.shape, 1).inertia.x, 1e-9);
  EXPECT_NEAR(parts_of(scene, twice).at(1).shape.radius, 2, 1e-12);
  const TriangleMesh& mesh = scene.meshes.at(0);
  EXPECT_NEAR(card.bounding_radius(twice, &mesh), 2 * card.bounding_radius(body.shape, &mesh),
              1e-12);
  EXPECT_NEAR(card.support(twice, &mesh, {0, 0, 1}).z,
              2 * card.support(body.shape, &mesh, {0, 0, 1}).z, 1e-12);
}

TEST(Compounds, PartsThatCannotBeAreNamed) {
  const auto refusal = [](const ShapePart& wrong) {
    Scene scene;
    BodyDescription body;
    try {
      set_compound(scene, body, {part(test::ball_of(1), {}), wrong});
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("taken");
  };
  using testing::HasSubstr;
  EXPECT_THAT(refusal(part(test::ball_of(-1), {})), HasSubstr("part 1 has radius -1"));
  EXPECT_THAT(refusal(part(test::shape_of("half_space"), {})), HasSubstr("part 1 is a half_space"));
  EXPECT_THAT(refusal(part(test::shape_of("compound"), {})), HasSubstr("part 1 is a compound"));
  EXPECT_THAT(refusal(part(test::shape_of("hull"), {})), HasSubstr("names mesh -1"));
  EXPECT_THAT(refusal(part(test::ball_of(1), {0, NAN, 0})), HasSubstr("three finite numbers"));
  EXPECT_THAT(refusal(part(test::ball_of(1), {}, Quatd(2, 0, 0, 0))), HasSubstr("not of length 1"));
  Scene scene;
  BodyDescription body;
  EXPECT_THROW(set_compound(scene, body, {}), std::invalid_argument);
}

}  // namespace
}  // namespace scree
