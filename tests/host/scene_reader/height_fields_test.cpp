// Height fields in scene files: the ways to give heights, what bodies share, and what is refused.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/scene/scene_checks.h"
#include "host/scene_reader.h"
#include "shapes/mesh.h"
#include "tests/host/gray_png.h"
#include "tests/host/input_files.h"
#include "tests/host/scene_texts.h"

namespace scree {
namespace {

using test::parsed;
using test::refusal;
using test::with_body;
using test::write_file;
using testing::HasSubstr;

std::string field(const std::string& more) {
  return R"({"shape": "height_field", "extent": [4, 2], )" + more + "}";
}

/// The scene in a file, so that others are beside it.
Scene scene_beside(const std::string& body) {
  return read_scene(write_file("scene.json", with_body(body)));
}

double lowest(const TriangleMesh& mesh) {
  double z = INFINITY;
  for (const Vec3d& v : mesh.vertices) z = std::min(z, v.z);
  return z;
}

TEST(HeightFieldsOfScenes, AreFixedMeshes) {
  const Scene scene = parsed(with_body(field(R"("heights": [[1, 2, 3], [4, 5, 6]],
      "height_scale": 0.5, "height_offset": 10, "position": [7, 8, 9])")));
  const BodyDescription& body = scene.bodies.at(1);
  EXPECT_EQ(body.kind, BodyKind::fixed);
  EXPECT_EQ(body.shape.kind, shapes::Mesh::kind);
  EXPECT_EQ(body.position, Vec3d(7, 8, 9));
  const TriangleMesh& mesh = *mesh_of(scene, body.shape);
  EXPECT_TRUE(mesh.closed);
  EXPECT_EQ(mesh.vertices.at(0), Vec3d(-2, -1, 12)) << "the last row is at the lowest y";
  EXPECT_EQ(mesh.vertices.at(5), Vec3d(2, 1, 11.5));
  EXPECT_EQ(lowest(mesh), 10.5 - 0.4) << "a tenth of the longer edge";
  validate(scene);
}

TEST(HeightFieldsOfScenes, MoveAsOtherWalls) {
  const Scene scene = parsed(with_body(field(R"("heights": [[1, 2], [4, 5]], "thickness": 3,
      "kind": "kinematic", "motion": {"type": "linear", "velocity": [0, 0, 1]})")));
  EXPECT_EQ(scene.bodies.at(1).kind, BodyKind::kinematic);
  EXPECT_EQ(lowest(*mesh_of(scene, scene.bodies.at(1).shape)), 1 - 3);
  validate(scene);
}

TEST(HeightFieldsOfScenes, ComeFromTablesAndPicturesAsWell) {
  write_file("a.csv", "1,2,3\n4,5,6\n");
  write_file("a.PNG", test::png_bytes(3, 2, {0, 51, 102, 153, 204, 255}));
  const Scene inlined = scene_beside(field(R"("heights": [[1, 2, 3], [4, 5, 6]])"));
  const Scene table = scene_beside(field(R"("file": "a.csv")"));
  const Scene picture = scene_beside(field(R"("file": "a.PNG", "height_range": [1, 6])"));
  for (const Scene* scene : {&table, &picture}) {
    EXPECT_EQ(scene->meshes.at(0).vertices, inlined.meshes.at(0).vertices);
    EXPECT_EQ(scene->meshes.at(0).triangles, inlined.meshes.at(0).triangles);
  }
}

TEST(HeightFieldsOfScenes, BodiesWithTheSameHeightsShareThem) {
  const std::string heights = R"("heights": [[1, 2], [4, 5]])";
  const Scene scene = parsed(with_body(
      field(heights) + "," + field(heights + R"(, "position": [9, 0, 0])") + "," +
      field(heights + R"(, "thickness": 1)") + "," + field(heights + R"(, "height_scale": 2)") +
      "," + R"({"shape": "height_field", "extent": [2, 2], )" + heights + "}"));
  EXPECT_EQ(scene.meshes.size(), 4u);
  EXPECT_EQ(scene.bodies.at(1).shape.mesh, scene.bodies.at(2).shape.mesh);
}

TEST(HeightFieldsOfScenes, WhatIsWrongIsNamed) {
  const auto refused = [](const std::string& body) { return refusal([&] { scene_beside(body); }); };
  write_file("a.csv", "1,2,3\n4,5,6\n");
  write_file("ragged.csv", "1,2,3\n4,5\n");
  const auto text = write_file("text.png", "1,2,3\n4,5,6\n");
  write_file("a.png", test::png_bytes(2, 2, {0, 1, 2, 3}));
  const std::string heights = R"("heights": [[1, 2], [4, 5]])";
  EXPECT_THAT(refused(R"({"shape": "height_field", "heights": [[1, 2], [3, 4]]})"),
              HasSubstr("bodies[1].extent: missing: must be two full edge lengths [x, y], positive "
                        "[m]"));
  for (const char* extent : {"[1, 2, 3]", "[1]", "1"})
    EXPECT_THAT(refused(R"({"shape": "height_field", "extent": )" + std::string(extent) + ", " +
                        heights + "}"),
                HasSubstr("is not allowed: must be two full edge lengths [x, y], positive [m]"));
  EXPECT_THAT(refused(R"({"shape": "height_field", "extent": [1, 0], )" + heights + "}"),
              HasSubstr("bodies[1].extent[1]: 0 is not allowed: must be positive [m]"));
  EXPECT_THAT(refused(field(R"("thickness": 1)")),
              HasSubstr("bodies[1].file: missing: must be the name of a .csv or .png file, or give "
                        "heights [m]"));
  EXPECT_THAT(refused(field(R"("file": "a.csv", )" + heights)),
              HasSubstr("bodies[1].heights: give either heights or a file"));
  EXPECT_THAT(refused(field(R"("file": "none.csv")")),
              HasSubstr("bodies[1].file: \"none.csv\" is not allowed: no such file"));
  EXPECT_THAT(refused(field(R"("file": "scene.json")")),
              HasSubstr("bodies[1].file: \"scene.json\" is not allowed: the name must end in .csv "
                        "or .png"));
  EXPECT_THAT(refused(field(R"("file": "ragged.csv")")),
              HasSubstr("ragged.csv: line 2: 2 values, but the rows before have 3"));
  EXPECT_THAT(refused(field(R"("file": "text.png", "height_range": [0, 1])")),
              HasSubstr(text.string() + ": no PNG picture that can be read"));
  EXPECT_THAT(refused(field(R"("file": "a.png")")),
              HasSubstr("bodies[1].height_range: missing: must be the heights of black and of "
                        "white [m]"));
  EXPECT_THAT(refused(field(R"("file": "a.png", "height_range": [1, 1])")),
              HasSubstr("bodies[1].height_range: [1,1] is not allowed"));
  EXPECT_THAT(refused(field(R"("file": "a.png", "height_range": [0, 1], "height_scale": 2)")),
              HasSubstr("bodies[1].height_scale: only tables have this key"));
  EXPECT_THAT(refused(field(R"("file": "a.csv", "height_range": [0, 1])")),
              HasSubstr("bodies[1].height_range: only pictures have this key"));
  EXPECT_THAT(refused(field(heights + R"(, "height_scale": 0)")),
              HasSubstr("bodies[1].height_scale: 0 is not allowed: must be positive [m]"));
  EXPECT_THAT(refused(field(heights + R"(, "thickness": -1)")),
              HasSubstr("bodies[1].thickness: -1 is not allowed: must be positive [m]"));
  EXPECT_THAT(refused(field(R"("heights": [[1, 2], [3]])")),
              HasSubstr("bodies[1].heights[1]: 1 heights, but the rows before have 2"));
  EXPECT_THAT(refused(field(R"("heights": [[1, 2]])")),
              HasSubstr("bodies[1].heights: 1 x 2 heights, must be 2 x 2 or more"));
  EXPECT_THAT(refused(field(R"("heights": [[1, 2], [3, "x"]])")),
              HasSubstr("bodies[1].heights[1][1]: \"x\" is not allowed: must be a finite number"));
  EXPECT_THAT(refused(field(R"("heights": [[1, 2], [3, 1e300]])")),
              HasSubstr("bodies[1].heights: a point at"));
  EXPECT_THAT(refused(field(heights + R"(, "scale": 2)")),
              HasSubstr("bodies[1].scale: a height_field has no such key"));
  EXPECT_THAT(refused(field(heights + R"(, "kind": "free")")),
              HasSubstr("bodies[1].kind: \"free\" is not allowed: only sphere"));
}

}  // namespace
}  // namespace scree
