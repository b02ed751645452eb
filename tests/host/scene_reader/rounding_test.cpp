// Shapes of scene files that are rounded: sizes, masses, sets, parts, and what is refused_rounded.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "host/scene/compound.h"
#include "host/scene_reader.h"
#include "shapes/rounded.h"
#include "tests/host/input_files.h"
#include "tests/host/scene_texts.h"

namespace scree {
namespace {

using shapes::Rounded;
using test::parsed;
using test::with_body;
using testing::AllOf;
using testing::HasSubstr;

std::string refused_rounded(const std::string& body) {
  return test::refusal([&] { validate(parsed(with_body(body))); });
}

TEST(RoundingOfScenes, SizesAreThoseOfTheCore) {
  const Scene scene =
      parsed(with_body(R"({"shape": "box", "size": [2, 4, 6], "rounding": 0.5, "density": 10})"));
  validate(scene);
  const BodyDescription& body = scene.bodies.at(1);
  EXPECT_EQ(body.kind, BodyKind::free);
  EXPECT_EQ(body.shape.kind, Rounded::kind);
  EXPECT_EQ(body.shape.rounded.core, shapes::Box::kind);
  EXPECT_EQ(body.shape.half_extents, Vec3d(1.5, 2.5, 3.5));
  const double volume = 48 + 88 * 0.5 + std::numbers::pi * 12 * 0.25 +
                        4.0 / 3 * std::numbers::pi * 0.125;  // Steiner: V + S r + pi L r^2 + ...
  EXPECT_NEAR(body.mass, 10 * volume, 1e-10);
}

TEST(RoundingOfScenes, EveryShapeWithEdgesMayBeRoundedAndFixed) {
  for (const char* shape :
       {R"("box", "size": [1, 1, 1])", R"("cylinder", "radius": 1, "length": 1)",
        R"("cone", "radius": 1, "length": 1)", R"("ellipsoid", "size": [1, 2, 3])",
        R"("hull", "points": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]])"})
    for (const char* more : {R"(, "density": 1})", R"(, "kind": "fixed"})"}) {
      SCOPED_TRACE(std::string(shape) + more);
      const Scene scene =
          parsed(with_body(std::string(R"({"rounding": 0.25, "shape": )") + shape + more));
      validate(scene);
      EXPECT_EQ(scene.bodies.at(1).shape.kind, Rounded::kind);
      EXPECT_EQ(scene.bodies.at(1).shape.rounded.radius, 0.25);
    }
}

TEST(RoundingOfScenes, AFreeHullTurnsAboutTheCenterOfWhatIsRounded) {
  const std::string points = R"("points": [[0,0,0],[3,0,0],[0,2,0],[0,0,1]])";
  const auto body = [&](const std::string& more) {
    return parsed(with_body(R"({"shape": "hull", "density": 1, )" + points + more + "}"))
        .bodies.at(1);
  };
  const BodyDescription sharp = body(""), rounded = body(R"(, "rounding": 0.5)");
  EXPECT_LT(norm(sharp.position - Vec3d{0.75, 0.5, 0.25}), 1e-12);
  EXPECT_GT(norm(rounded.position - sharp.position), 0.01);
  const Scene both = parsed(
      with_body(R"({"shape": "hull", "density": 1, )" + points + R"(, "rounding": 0.5},)" +
                R"({"shape": "hull", "density": 1, "position": [9, 9, 9], )" + points + "}"));
  validate(both);
  EXPECT_EQ(both.meshes.size(), 2u) << "each in its own frame";
}

TEST(RoundingOfScenes, TheScaleOfParticlesMultipliesIt) {
  const Scene scene = parsed(R"({"time_step": 1e-3, "duration": 1,
    "bodies": [{"shape": "half_space"}],
    "particles": [{"layout": "random", "count": 20, "region": {"min": [0, 0, 0], "max": [30, 30, 30]},
      "shapes": [{"shape": "box", "size": [1, 1, 1], "rounding": 0.1},
                 {"shape": "hull", "points": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]], "rounding": 0.2}],
      "density": 1, "scale": {"min": 0.5, "max": 1}, "orientation": "random"}]})");
  validate(scene);
  const ParticleSet& set = scene.particles.at(0);
  int boxes = 0;
  for (std::size_t i = 0; i < 20; ++i) {
    const Shape& shape = set.shape[i];
    ASSERT_EQ(shape.kind, Rounded::kind);
    if (shape.rounded.core != shapes::Box::kind) continue;
    ++boxes;
    const double half = core_half_extents(shape).x;
    EXPECT_NEAR(shape.rounded.radius, 0.2 * half, 1e-12);
    EXPECT_NEAR(set.radius[i], std::sqrt(3.0) * half + shape.rounded.radius, 1e-12);
    EXPECT_NEAR(shape.volume, Rounded::of(Rounded::core(shape), shape.rounded.radius).volume,
                1e-12);
  }
  EXPECT_GT(boxes, 3);
}

TEST(RoundingOfScenes, PartsOfCompoundsMayBeRounded) {
  const Scene scene = parsed(with_body(R"({"shape": "compound", "density": 2, "parts": [
      {"shape": "box", "size": [1, 2, 3], "rounding": 0.2, "position": [5, 0, 0]},
      {"shape": "hull", "points": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]], "rounding": 0.3}]})"));
  validate(scene);
  const BodyDescription& body = scene.bodies.at(1);
  double volume = 0;
  for (const ShapePart& part : parts_of(scene, body.shape)) {
    EXPECT_EQ(part.shape.kind, Rounded::kind);
    volume += part.shape.volume;
  }
  EXPECT_NEAR(body.mass, 2 * volume, 1e-9);
}

TEST(RoundingOfScenes, WhatIsWrongIsNamed) {
  const auto box = [](const std::string& rounding) {
    return R"({"shape": "box", "size": [2, 4, 6], "density": 1, "rounding": )" + rounding + "}";
  };
  for (const char* value : {"0", "-0.1"})
    EXPECT_THAT(refused_rounded(box(value)),
                AllOf(HasSubstr("bodies[1].rounding"), HasSubstr(value),
                      HasSubstr("must be positive [m]")));
  EXPECT_THAT(refused_rounded(box(R"("0.1")")),
              AllOf(HasSubstr("bodies[1].rounding"), HasSubstr("must be")));
  EXPECT_THAT(refused_rounded(box("[0.1]")), HasSubstr("bodies[1].rounding"));
  EXPECT_THAT(refused_rounded(box("3001")),
              AllOf(HasSubstr("bodies[1].rounding"), HasSubstr("3001"),
                    HasSubstr("1000 times half the longest edge")));
  EXPECT_EQ(refused_rounded(box("2999")), "no error");
  EXPECT_THAT(refused_rounded(box("1e-13")),
              AllOf(HasSubstr("bodies[1].rounding"), HasSubstr("1e-12")));
  EXPECT_THAT(refused_rounded(R"({"shape": "hull", "points": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]],
                          "density": 1, "rounding": 1e9})"),
              HasSubstr("bodies[1].rounding"));
  EXPECT_THAT(refused_rounded(R"({"shape": "sphere", "radius": 1, "density": 1, "rounding": 0.1})"),
              AllOf(HasSubstr("bodies[1].rounding"), HasSubstr("a sphere has no such key")));
  EXPECT_THAT(
      refused_rounded(
          R"({"shape": "capsule", "radius": 1, "length": 1, "density": 1, "rounding": 0.1})"),
      HasSubstr("a capsule has no such key"));
  EXPECT_THAT(refused_rounded(R"({"shape": "half_space", "rounding": 0.1})"),
              HasSubstr("a half_space has no such key"));
  EXPECT_THAT(refused_rounded(R"({"shape": "rounded", "density": 1})"),
              HasSubstr("bodies[1].shape"));
}

}  // namespace
}  // namespace scree
