// Compounds in scene files: the pose of their parts, what bodies share, and what is refused_parts.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "host/scene/compound.h"
#include "host/scene_reader.h"
#include "host/world.h"
#include "tests/host/input_files.h"
#include "tests/host/scene_texts.h"

namespace scree {
namespace {

using test::parsed;
using test::with_body;
using testing::AllOf;
using testing::HasSubstr;

std::string compound(const std::string& parts, const std::string& more = R"(, "density": 1000)") {
  return R"({"shape": "compound", "parts": [)" + parts + "]" + more + "}";
}
constexpr const char* kBalls = R"({"shape": "sphere", "radius": 1},
  {"shape": "sphere", "radius": 1, "position": [1, 0, 0]})";

TEST(CompoundsOfScenes, AFreeOneHasThePoseOfItsCenterOfMass) {
  const Scene scene = parsed(with_body(compound(
      R"({"shape": "box", "size": [2, 4, 6], "position": [1, 2, 3]})",
      R"(, "density": 10, "position": [1, 0, 0], "rotation_deg": {"axis": [0, 0, 1], "angle": 90})")));
  const BodyDescription& body = scene.bodies.at(1);
  EXPECT_NEAR(body.mass, 480, 1e-9);
  EXPECT_LT(norm(body.position - Vec3d{1 - 2, 1, 3}), 1e-12);
  validate(scene);
}

TEST(CompoundsOfScenes, PartsHavePosesAndHullsTheirOwnFrames) {
  const Scene scene = parsed(with_body(compound(
      R"({"shape": "hull", "points": [[0,0,0],[2,0,0],[0,2,0],[2,2,0],[0,0,2],[2,0,2],[0,2,2],[2,2,2]],
          "position": [0, 0, 5], "rotation_deg": {"axis": [0, 0, 1], "angle": 90}})",
      R"(, "kind": "fixed")")));
  const std::vector<ShapePart> parts = parts_of(scene, scene.bodies.at(1).shape);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_LT(norm(parts[0].position - Vec3d{-1, 1, 6}), 1e-12);
}

/// An .obj file of a block.
std::string block_file(const std::string& name, const Vec3d& low, const Vec3d& high) {
  std::string text;
  for (int k = 0; k < 8; ++k)
    text += "v " + std::to_string(k & 1 ? high.x : low.x) + " " +
            std::to_string(k & 2 ? high.y : low.y) + " " + std::to_string(k & 4 ? high.z : low.z) +
            "\n";
  text += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  return test::write_file(name, text).string();
}

// An angle of two blocks: mass and moments in closed form, and what lies on its step is not held by the hull of it all.
TEST(CompoundsOfScenes, AFreeBodyOfMeshesOfConvexPieces) {
  const auto piece = [](const std::string& file) {
    return R"({"shape": "hull", "file": ")" + file + R"("})";
  };
  const std::string body =
      compound(piece(block_file("lower.obj", {0, 0, 0}, {2, 1, 1})) + "," +
                   piece(block_file("upper.obj", {0, 0, 1}, {1, 1, 2})),
               R"(, "density": 10)") +
      R"(, {"shape": "sphere", "radius": 0.4, "density": 10, "position": [1.5, 0.5, 1.42]},
          {"shape": "half_space"})";
  const Scene scene = parsed(R"({"time_step": 1e-3, "duration": 1, "bodies": [)" + body + "]}");
  const BodyDescription& angle = scene.bodies.at(0);
  EXPECT_NEAR(angle.mass, 30, 1e-9);
  EXPECT_LT(norm(angle.position - Vec3d{5.0 / 6, 0.5, 5.0 / 6}), 1e-9);
  std::vector<double> moments{angle.inertia.x, angle.inertia.y, angle.inertia.z};
  std::sort(moments.begin(), moments.end());
  EXPECT_NEAR(moments[0], 25.0 / 3, 1e-9);
  EXPECT_NEAR(moments[1], 15, 1e-9);
  EXPECT_NEAR(moments[2], 55.0 / 3, 1e-9);
  World world(scene, {});
  world.run(0.5);
  const BodyStates s = world.states();
  EXPECT_NEAR(s.position[1].z, 1.4, 2e-3);
  EXPECT_NEAR(s.position[0].z, 5.0 / 6, 2e-3);
}

TEST(CompoundsOfScenes, OverlapsCountOnceOrForEachPart) {
  const auto mass = [](const std::string& more) {
    return parsed(with_body(compound(kBalls, more))).bodies.at(1).mass;
  };
  const double ball = 4.0 / 3 * 3.14159265358979323846;
  EXPECT_NEAR(mass(R"(, "density": 1, "overlaps": "each")"), 2 * ball, 1e-9);
  EXPECT_NEAR(mass(R"(, "density": 1, "overlaps": "once")"), 27.0 / 16 * ball, 1e-4);
  EXPECT_EQ(mass(R"(, "density": 1)"), mass(R"(, "density": 1, "overlaps": "once")"));
}

TEST(CompoundsOfScenes, BodiesWithTheSamePartsShareThem) {
  const Scene scene = parsed(with_body(compound(kBalls) + "," + compound(kBalls)));
  EXPECT_EQ(scene.bodies.at(1).shape.mesh, scene.bodies.at(2).shape.mesh);
  EXPECT_EQ(scene.meshes.size(), 1u);
}

TEST(CompoundsOfScenes, ParticlesMayBeCompoundsOfManySizes) {
  const Scene scene = parsed(R"({"time_step": 1e-3, "duration": 1,
    "bodies": [{"shape": "half_space"}],
    "particles": [{"layout": "random", "count": 20, "region": {"min": [0, 0, 0], "max": [30, 30, 30]},
      "shape": "compound", "parts": [)" +
                             std::string(kBalls) + R"(], "density": 1,
      "scale": {"min": 0.5, "max": 1}, "orientation": "random"}]})");
  validate(scene);
  const ParticleSet& set = scene.particles.at(0);
  for (std::size_t i = 0; i < 20; ++i) {
    const double size = parts_of(scene, set.shape[i]).at(0).shape.radius;
    EXPECT_GE(size, 0.5);
    EXPECT_LE(size, 1);
    EXPECT_NEAR(set.radius[i], 1.5 * size, 1e-9);
  }
}

std::string refused_parts(const std::string& body) {
  try {
    parsed(with_body(body));
  } catch (const std::exception& error) {
    return error.what();
  }
  return "taken";
}

TEST(CompoundsOfScenes, WhatIsWrongIsNamed) {
  EXPECT_THAT(refused_parts(R"({"shape": "compound", "density": 1})"),
              HasSubstr("bodies[1].parts: missing: must be a list of shapes"));
  EXPECT_THAT(refused_parts(compound("")), HasSubstr("must hold one shape or more"));
  EXPECT_THAT(refused_parts(compound(R"({"shape": "sphere", "radius": -1})")),
              HasSubstr("bodies[1].parts[0].radius: -1 is not allowed"));
  EXPECT_THAT(refused_parts(compound(R"({"shape": "sphere", "radius": 1, "mass": 2})")),
              HasSubstr("bodies[1].parts[0].mass"));
  EXPECT_THAT(refused_parts(compound(R"({"shape": "compound"})")),
              HasSubstr("bodies[1].parts[0].shape: \"compound\" is not allowed"));
  EXPECT_THAT(refused_parts(compound(R"({"shape": "half_space"})")),
              HasSubstr("bodies[1].parts[0].shape: \"half_space\" is not allowed"));
  EXPECT_THAT(refused_parts(compound(kBalls, R"(, "density": 1, "overlaps": "twice")")),
              HasSubstr("bodies[1].overlaps: \"twice\" is not allowed"));
  EXPECT_THAT(refused_parts(R"({"shape": "sphere", "radius": 1, "density": 1, "parts": []})"),
              HasSubstr("a sphere has no such key"));
}

TEST(CompoundsOfScenes, MeshesWithoutPartsAreRefused) {
  Scene scene = parsed(with_body(compound(kBalls)));
  scene.meshes.at(0).parts.clear();
  EXPECT_THROW(validate(scene), std::exception);
}

}  // namespace
}  // namespace scree
