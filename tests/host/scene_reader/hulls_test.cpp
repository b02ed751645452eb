// Hulls in scene files: the pose of their points, what bodies share, and what is refused.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "host/scene/convex_hull.h"
#include "host/scene_reader.h"
#include "shapes/hull.h"
#include "tests/host/input_files.h"
#include "tests/host/scene_texts.h"

namespace scree {
namespace {

using test::parsed;
using test::with_body;
using testing::AllOf;
using testing::HasSubstr;

/// A brick of edges 2, 4, 6 m whose corner is at the origin of its points.
constexpr const char* kBrick =
    "[[0,0,0],[2,0,0],[0,4,0],[2,4,0],[0,0,6],[2,0,6],[0,4,6],[2,4,6],[1,1,1]]";

std::string hull(const std::string& more) {
  return std::string(R"({"shape": "hull", "points": )") + kBrick + more + "}";
}

TEST(HullsOfScenes, AFreeOneHasThePoseOfItsCenterOfMass) {
  const Scene scene = parsed(with_body(hull(
      R"(, "density": 10, "position": [1, 0, 0], "rotation_deg": {"axis": [0, 0, 1], "angle": 90})")));
  const BodyDescription& body = scene.bodies.at(1);
  EXPECT_EQ(body.kind, BodyKind::free);
  EXPECT_NEAR(body.mass, 10 * 48, 1e-9);
  // The center of the brick, (1, 2, 3), after a quarter turn about z.
  EXPECT_LT(norm(body.position - Vec3d{1 - 2, 1, 3}), 1e-12);
  const Vec3d& e = body.shape.half_extents;
  EXPECT_NEAR(body.inertia.x, body.mass / 3 * (e.y * e.y + e.z * e.z), 1e-9);
  // Its corners are where the turned brick has them.
  const TriangleMesh& mesh = scene.meshes.at(static_cast<std::size_t>(body.shape.mesh));
  EXPECT_EQ(mesh.vertices.size(), 8u);
  Vec3d low{9, 9, 9}, high{-9, -9, -9};
  for (const Vec3d& v : mesh.vertices) {
    const Vec3d x = body.position + rotate(body.orientation, v);
    for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], x[k]), high[k] = std::max(high[k], x[k]);
  }
  EXPECT_LT(norm(low - Vec3d{-3, 0, 0}), 1e-12);
  EXPECT_LT(norm(high - Vec3d{1, 2, 6}), 1e-12);
}

TEST(HullsOfScenes, AFixedOneKeepsTheFrameOfItsPoints) {
  const Scene scene = parsed(with_body(hull(R"(, "kind": "fixed", "position": [5, 0, 0])")));
  const BodyDescription& body = scene.bodies.at(1);
  EXPECT_EQ(body.position, Vec3d(5, 0, 0));
  EXPECT_EQ(body.shape.half_extents, Vec3d(2, 4, 6));
  validate(scene);
}

TEST(HullsOfScenes, BodiesWithTheSamePointsShareThem) {
  const Scene scene = parsed(with_body(hull(R"(, "density": 1)") + "," +
                                       hull(R"(, "density": 2, "position": [9, 0, 0])") + "," +
                                       hull(R"(, "kind": "fixed", "position": [-9, 0, 0])")));
  EXPECT_EQ(scene.meshes.size(), 2u) << "the fixed one is in another frame";
  EXPECT_EQ(scene.bodies.at(1).shape.mesh, scene.bodies.at(2).shape.mesh);
  EXPECT_EQ(scene.bodies.at(2).mass, 2 * scene.bodies.at(1).mass);
}

TEST(HullsOfScenes, WhatIsWrongIsNamed) {
  const auto refused = [](const std::string& body) {
    return test::refusal([&] { parsed(with_body(body)); });
  };
  EXPECT_THAT(refused(R"({"shape": "hull", "density": 1})"),
              AllOf(HasSubstr("file"), HasSubstr("or give points")));
  EXPECT_THAT(
      refused(R"({"shape": "hull", "density": 1, "points": [[0,0,0],[1,0,0],[0,1,0],[1,1,0]]})"),
      AllOf(HasSubstr("points"), HasSubstr("one plane")));
  EXPECT_THAT(refused(R"({"shape": "hull", "density": 1, "points": [[0,0,0],[1,0,0],[0,1]]})"),
              HasSubstr("points[2]"));
  EXPECT_THAT(refused(hull(R"(, "density": 1, "file": "a.stl")")),
              HasSubstr("either points or a file"));
  EXPECT_THAT(refused(hull(R"(, "density": 1, "scale": 2)")), HasSubstr("either points or a file"));
  EXPECT_THAT(refused(R"({"shape": "box", "size": [1,1,1], "density": 1, "points": []})"),
              HasSubstr("a box has no such key"));
}

TEST(HullsOfScenes, MeshesThatAreNotThoseOfHullsAreRefused) {
  Scene scene = parsed(with_body(hull(R"(, "density": 1)")));
  validate(scene);
  Scene moved = scene;
  for (Vec3d& v : moved.meshes.back().vertices) v.x += 0.5;
  EXPECT_THAT(test::refusal([&] { validate(moved); }), HasSubstr("center of mass"));
  Scene dented = scene;
  dented.meshes.back().vertices[0] *= 0.1;
  EXPECT_THAT(test::refusal([&] { validate(dented); }), HasSubstr("is not convex"));
}

}  // namespace
}  // namespace scree
