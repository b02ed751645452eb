#include "host/scene/tetrahedra_reader.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/scene/mesh_reader.h"
#include "host/scene/tetrahedra.h"
#include "host/scene_reader.h"
#include "tests/host/input_files.h"
#include "tests/mesh_volume.h"
#include "tests/tetrahedra_box.h"

namespace scree {
namespace {

using test::refusal;
using test::volume;
using test::write_file;
using testing::AllOf;
using testing::HasSubstr;

// An octahedron about a corner of its own: eight tetrahedra, one of them inside out, and a corner that none has.
constexpr int kTips[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};

std::vector<std::array<int, 4>> octahedron() {
  std::vector<std::array<int, 4>> tetrahedra;
  for (int x : {0, 1})
    for (int y : {2, 3})
      for (int z : {4, 5}) tetrahedra.push_back({6, x, y, z});
  return tetrahedra;
}

std::string gmsh_2() {
  std::string text =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n0\n$EndPhysicalNames\n$Nodes\n8\n";
  for (int v = 0; v < 6; ++v)
    text += fmt::format("{} {} {} {}\n", 10 + v, kTips[v][0], kTips[v][1], kTips[v][2]);
  text += "16 0 0 0\n99 5 5 5\n$EndNodes\n$Elements\n9\n1 2 2 0 1 10 12 14\n";
  int number = 2;
  for (const auto& t : octahedron())
    text += fmt::format("{} 4 2 0 1 {} {} {} {}\n", number++, 10 + t[0], 10 + t[1], 10 + t[2],
                        10 + t[3]);
  return text + "$EndElements\n";
}

std::string gmsh_4() {
  std::string text = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n2 8 1 8\n2 1 0 6\n";
  for (int v = 0; v < 6; ++v) text += fmt::format("{}\n", 1 + v);
  for (const auto& tip : kTips) text += fmt::format("{} {} {}\n", tip[0], tip[1], tip[2]);
  text += "3 1 0 2\n7\n8\n0 0 0\n5 5 5\n$EndNodes\n$Elements\n2 9 1 9\n2 1 2 1\n1 1 3 5\n3 1 4 8\n";
  int number = 2;
  for (const auto& t : octahedron())
    text += fmt::format("{} {} {} {} {}\n", number++, 1 + t[0], 1 + t[1], 1 + t[2], 1 + t[3]);
  return text + "$EndElements\n";
}

std::string vtk(bool is_new) {
  std::string text = fmt::format(
      "# vtk DataFile Version {}\nan octahedron\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 "
      "double\n",
      is_new ? "5.1" : "3.0");
  for (const auto& tip : kTips) text += fmt::format("{} {} {} ", tip[0], tip[1], tip[2]);
  text += "0\n0 0 5 5 5\n";
  const auto tetrahedra = octahedron();
  if (is_new) {
    text += "CELLS 10 35\nOFFSETS vtktypeint64\n0 3 ";
    for (int k = 1; k <= 8; ++k) text += fmt::format("{} ", 3 + 4 * k);
    text += "\nCONNECTIVITY vtktypeint64\n0 2 4\n";
  } else {
    text += "CELLS 9 44\n3 0 2 4\n";
  }
  for (const auto& t : tetrahedra)
    text += fmt::format("{}{} {} {} {}\n", is_new ? "" : "4 ", t[0], t[1], t[2], t[3]);
  text += "CELL_TYPES 9\n5\n10 10 10 10\n10 10 10 10\nCELL_DATA 9\nSCALARS x int 1\n";
  return text;
}

TEST(TetrahedraReader, AllFormatsAreOne) {
  int file = 0;
  for (const auto& [text, ending] :
       {std::pair{gmsh_2(), "msh"}, {gmsh_4(), "msh"}, {vtk(false), "vtk"}, {vtk(true), "vtk"}}) {
    SCOPED_TRACE(text.substr(0, 40));
    MeshOptions options;
    options.scale = 0.5;
    const TriangleMesh mesh =
        read_mesh(write_file(fmt::format("octahedron_{}.{}", file++, ending), text), options);
    EXPECT_EQ(mesh.vertices.size(), 6u);
    EXPECT_EQ(mesh.triangles.size(), 8u);
    ASSERT_EQ(mesh.inner.size(), 1u);
    EXPECT_EQ(norm(mesh.inner[0]), 0);
    ASSERT_EQ(mesh.tetrahedra.size(), 8u);
    EXPECT_NEAR(volume(mesh), 4.0 / 3 / 8, 1e-15);  // outward triangles
    const auto at = [&](int v) {
      return v < 6 ? mesh.vertices[static_cast<std::size_t>(v)]
                   : mesh.inner[static_cast<std::size_t>(v) - 6];
    };
    for (const auto& t : mesh.tetrahedra)
      EXPECT_NEAR(dot(at(t[1]) - at(t[0]), cross(at(t[2]) - at(t[0]), at(t[3]) - at(t[0]))),
                  1.0 / 8, 1e-15);
  }
}

TEST(TetrahedraReader, AFreeBodyHasThemInItsOwnFrame) {
  TriangleMesh mesh = test::tetrahedra_box({1, 2, 3}, {2, 2, 2});
  ASSERT_EQ(mesh.inner.size(), 1u);
  for (Vec3d& v : mesh.vertices) v += Vec3d{5, 6, 7};
  mesh.inner[0] += Vec3d{5, 6, 7};
  BodyDescription body;
  Scene scene;
  set_free_mesh(scene, body, mesh);
  EXPECT_LT(norm(scene.meshes[0].inner[0]), 1e-14);
  EXPECT_LT(norm(body.position - Vec3d{5, 6, 7}), 1e-14);
}

std::string refused(const std::string& text, const char* ending) {
  return refusal([&] { read_mesh(write_file(fmt::format("bad.{}", ending), text)); });
}
std::string replaced(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}

TEST(TetrahedraReader, FaultsAreNamed) {
  EXPECT_THAT(refused(replaced(gmsh_2(), "2.2 0 8", "2.2 1 8"), "msh"),
              HasSubstr("binary file of Gmsh"));
  EXPECT_THAT(refused(replaced(gmsh_2(), "2.2 0 8", "3.5 0 8"), "msh"),
              HasSubstr("must be 2.2 or 4.1"));
  EXPECT_THAT(refused("$Nodes\n0\n", "msh"), HasSubstr("$MeshFormat"));
  EXPECT_THAT(refused(replaced(gmsh_2(), "0 0 0\n99", "0 0 x\n99"), "msh"),
              HasSubstr("\"x\" is not a finite number"));
  EXPECT_THAT(refused(replaced(gmsh_2(), " 4 2 0 1 16", " 4 2 0 1 17"), "msh"),
              HasSubstr("there is no node 17"));
  EXPECT_THAT(refused(replaced(gmsh_2(), "$Elements\n9", "$Elements\n10"), "msh"),
              HasSubstr("line "));
  EXPECT_THAT(refused(replaced(gmsh_2(), "$Elements\n9", "$Elements\n5"), "msh"),
              HasSubstr("the count of $Elements is too low"));
  EXPECT_THAT(refused(replaced(gmsh_4(), "3 1 4 8", "3 1 4 7"), "msh"),
              HasSubstr("$EndElements expected"));
  EXPECT_THAT(refused(replaced(gmsh_2(), "$Elements\n9", "$Elements\n-1"), "msh"), HasSubstr("-1"));
  EXPECT_THAT(refused(gmsh_2().substr(0, gmsh_2().find("99 5 5 5")), "msh"),
              HasSubstr("truncated"));
  EXPECT_THAT(
      refused(replaced(gmsh_2(), "1 2 2 0 1 10 12 14", "1 11 0 10 11 12 13 14 15 16 10 11 12"),
              "msh"),
      HasSubstr("ten nodes"));
  EXPECT_THAT(refused("$MeshFormat\n4.1 0 8\n", "msh"), HasSubstr("holds no tetrahedra"));
  EXPECT_THAT(refused(replaced(vtk(false), "ASCII", "BINARY"), "vtk"),
              HasSubstr("binary file of VTK"));
  EXPECT_THAT(refused(replaced(vtk(false), "UNSTRUCTURED_GRID", "POLYDATA"), "vtk"),
              HasSubstr("UNSTRUCTURED_GRID"));
  EXPECT_THAT(refused(replaced(vtk(false), "4 6 0 2 4", "4 6 0 2 9"), "vtk"),
              HasSubstr("there is no point 9"));
  EXPECT_THAT(refused(replaced(vtk(true), "0 3 7 11", "0 3 8 11"), "vtk"),
              HasSubstr("must have four corners"));
  EXPECT_THAT(refused(replaced(vtk(false), "CELL_TYPES 9", "CELL_TYPES 8"), "vtk"),
              HasSubstr("9 cells and types of 8"));
  EXPECT_THAT(refused(replaced(vtk(false), "0\n0 0 5 5 5", "0\n0 1 5 5 5"), "vtk"),
              HasSubstr("is flat"));
}

TEST(TetrahedraReader, ScenesReadElasticBodies) {
  const auto file = write_file("bar.msh", gmsh_2());
  const std::string bodies =
      R"({"name": "soft", "shape": "mesh", "file": "bar.msh", "kind": "free", "density": 10,
    "elastic": {"young_modulus": 1e5, "poisson_ratio": 0.4}},
   {"shape": "mesh", "file": "bar.msh", "kind": "free", "density": 10, "position": [9, 0, 0],
    "elastic": {"young_modulus": 1e6}}, {"shape": "box", "size": [1, 1, 1], "kind": "fixed", "position": [0, 0, -3]})";
  const auto scene_of = [&](const std::string& attachments, const std::string& type = "affine") {
    return parse_scene(R"({"time_step": 0.01, "duration": 1, "dynamics": {"type": ")" + type +
                           R"("}, "bodies": [)" + bodies + "], \"attachments\": [" + attachments +
                           "]}",
                       "s.json", file.parent_path());
  };
  const Scene scene = scene_of(R"({"body": "soft", "to": 2, "box": [[-1, -1, -2], [1, 1, -0.9]]})");
  EXPECT_EQ(scene.bodies[0].elastic->young_modulus, 1e5);
  EXPECT_EQ(scene.bodies[0].elastic->poisson_ratio, 0.4);
  EXPECT_EQ(scene.bodies[1].elastic->poisson_ratio, 0.3);
  EXPECT_NE(scene.bodies[0].shape.mesh, scene.bodies[1].shape.mesh);
  ASSERT_EQ(scene.attachments.size(), 1u);
  EXPECT_EQ(scene.attachments[0].to, 2);
  EXPECT_EQ(scene.attachments[0].high.z, -0.9);
  EXPECT_THAT(
      refusal([&] { scene_of(R"({"body": 2, "to": "world", "box": [[0, 0, 0], [1, 1, 1]]})"); }),
      AllOf(HasSubstr("attachments[0].body"), HasSubstr("must be an elastic body")));
  EXPECT_THAT(refusal([&] { scene_of(R"({"body": "soft", "to": "world", "box": [[0, 0, 0]]})"); }),
              HasSubstr("two corners"));
  EXPECT_THAT(refusal([&] { scene_of(R"({"body": "soft", "box": [[0, 0, 0], [1, 1, 1]]})"); }),
              HasSubstr("to"));
  EXPECT_THAT(refusal([&] { scene_of("", "rigid"); }), HasSubstr("bodies[0]"));
  EXPECT_THAT(
      refusal([&] {
        parse_scene(
            R"({"time_step": 0.01, "duration": 1, "dynamics": {"type": "affine"}, "bodies": [
                  {"shape": "mesh", "file": "bar.msh", "kind": "free", "mass": 1, "inertia": [1, 1, 1],
                   "elastic": {"young_modulus": 1e5}}]})",
            "s.json", file.parent_path());
      }),
      AllOf(HasSubstr("bodies[0].inertia"), HasSubstr("moments of its tetrahedra")));
}

}  // namespace
}  // namespace scree
