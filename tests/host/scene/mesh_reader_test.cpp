#include "host/scene/mesh_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "tests/host/input_files.h"
#include "tests/mesh_volume.h"

namespace scree {
namespace {

using test::refusal;
using test::volume;
using test::write_file;
using testing::HasSubstr;
using testing::StartsWith;

const char* const kCube = R"(# a unit cube of quads
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
)";

/// Text of an ASCII STL file of a mesh.
std::string ascii_stl(const TriangleMesh& mesh) {
  std::string text = "solid cube\n";
  for (const auto& triangle : mesh.triangles) {
    text += "facet normal 0 0 0\n outer loop\n";
    for (const int v : triangle) {
      const Vec3d& p = mesh.vertices[static_cast<std::size_t>(v)];
      text += "  vertex " + std::to_string(p.x) + " " + std::to_string(p.y) + " " +
              std::to_string(p.z) + "\n";
    }
    text += " endloop\nendfacet\n";
  }
  return text + "endsolid cube\n";
}

std::string binary_stl(const TriangleMesh& mesh) {
  std::string bytes(80, ' ');
  bytes.replace(0, 5, "solid");  // as some programs write, though the file is binary
  const auto append = [&](const void* data, std::size_t size) {
    bytes.append(static_cast<const char*>(data), size);
  };
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  append(&count, 4);
  for (const auto& triangle : mesh.triangles) {
    float record[12] = {};
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 3; ++k)
        record[3 + 3 * c + k] = static_cast<float>(
            mesh.vertices[static_cast<std::size_t>(triangle[static_cast<std::size_t>(c)])][k]);
    append(record, sizeof(record));
    bytes.append(2, '\0');
  }
  return bytes;
}

void expect_cube(const TriangleMesh& mesh, double size = 1) {
  EXPECT_EQ(mesh.vertices.size(), 8u);
  EXPECT_EQ(mesh.triangles.size(), 12u);
  EXPECT_NEAR(volume(mesh), size * size * size, 1e-9);
}

TEST(MeshReader, ReadsObjWithPolygons) { expect_cube(read_mesh(write_file("cube.obj", kCube))); }

TEST(MeshReader, ScalesCoordinates) {
  expect_cube(read_mesh(write_file("cube.OBJ", kCube), {.scale = 2}), 2);
}

TEST(MeshReader, ReadsEverySlashFormAndNegativeIndices) {
  const TriangleMesh mesh = read_mesh(
      write_file("t.obj",
                 "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nvt 0 0\n"
                 "f 1/1 3/1 2/1\nf 1//1 2//1 4//1\nf 1/1/1 4/1/1 3/1/1\nf -3 -2 -1 # the last\n"));
  EXPECT_EQ(mesh.triangles.size(), 4u);
  EXPECT_NEAR(volume(mesh), 1.0 / 6, 1e-15);
}

TEST(MeshReader, ReadsAsciiAndBinaryStlAndWeldsVertices) {
  const TriangleMesh cube = read_mesh(write_file("cube.obj", kCube));
  expect_cube(read_mesh(write_file("ascii.stl", ascii_stl(cube))));
  expect_cube(read_mesh(write_file("binary.stl", binary_stl(cube))));
}

TEST(MeshReader, WeldsVerticesThatDifferByRounding) {
  std::string text = kCube;
  const TriangleMesh cube = read_mesh(write_file("cube.obj", text));
  std::string stl = ascii_stl(cube);
  const std::size_t first = stl.find("vertex 1.000000");
  stl.replace(first, 15, "vertex 1.0000000005");
  expect_cube(read_mesh(write_file("near.stl", stl)));
  stl.replace(first, 19, "vertex 1.0000001000");
  EXPECT_THAT(refusal([&] { read_mesh(write_file("far.stl", stl)); }), HasSubstr("is open"));
}

TEST(MeshReader, TurnsAMeshThatIsInsideOut) {
  TriangleMesh cube = read_mesh(write_file("cube.obj", kCube));
  for (auto& triangle : cube.triangles) std::swap(triangle[0], triangle[1]);
  expect_cube(read_mesh(write_file("inside_out.stl", binary_stl(cube))));
}

/// Adds a cube with one corner at a place. @param is_turned  inside out
void add_cube(std::string& text, int number, const Vec3d& at, double size, bool is_turned = false) {
  for (int k = 0; k < 8; ++k)
    text += "v " + std::to_string(at.x + size * ((k + 1) / 2 % 2)) + " " +
            std::to_string(at.y + size * (k / 2 % 2)) + " " +
            std::to_string(at.z + size * (k / 4)) + "\n";
  for (std::array<int, 4> face :
       {std::array{1, 4, 3, 2}, std::array{5, 6, 7, 8}, std::array{1, 2, 6, 5},
        std::array{2, 3, 7, 6}, std::array{3, 4, 8, 7}, std::array{4, 1, 5, 8}}) {
    if (is_turned) std::swap(face[1], face[3]);
    text += "f";
    for (const int v : face) text += " " + std::to_string(v + 8 * number);
    text += "\n";
  }
}

TEST(MeshReader, PartsInPartsAreCavitiesOrRefused) {
  struct Part {
    Vec3d at;
    double size;
    bool is_turned;
  };
  const auto text_of = [](const std::vector<Part>& parts) {
    std::string text;
    int number = 0;
    for (const Part& part : parts) add_cube(text, number++, part.at, part.size, part.is_turned);
    return text;
  };
  const auto volume_of = [&](const std::vector<Part>& parts) {
    return volume(read_mesh(write_file("parts.obj", text_of(parts))));
  };
  const Part large{{0, 0, 0}, 4, false}, cavity{{1, 1, 1}, 2, true},
      core{{1.5, 1.5, 1.5}, 1, false}, beside{{5, 0, 0}, 1, false};
  EXPECT_NEAR(volume_of({large, beside}), 65, 1e-9);
  EXPECT_NEAR(volume_of({large, cavity}), 56, 1e-9);
  EXPECT_NEAR(volume_of({core, cavity, beside, large}), 58, 1e-9);
  std::vector<Part> turned{large, cavity, core, beside};  // as a whole
  for (Part& part : turned) part.is_turned = !part.is_turned;
  EXPECT_NEAR(volume_of(turned), 58, 1e-9);
  EXPECT_NEAR(volume_of({large, {{1, 4, 1}, 1, false}}), 65, 1e-9);  // it lies on a face

  const auto refusal_of = [&](const std::vector<Part>& parts) {
    return refusal([&] { read_mesh(write_file("parts.obj", text_of(parts))); });
  };
  EXPECT_THAT(
      refusal_of({large, {{1, 1, 1}, 2, false}}),
      testing::AllOf(HasSubstr("parts.obj: the closed part with triangle 12 is inside of another"),
                     HasSubstr("count twice"), HasSubstr("\"closed\": false")));
  EXPECT_THAT(refusal_of({large, {{1, 3, 1}, 1, false}}),
              HasSubstr("count twice"));  // on its inside
  EXPECT_THAT(refusal_of({core, large}), HasSubstr("part with triangle 0 is inside"));
  EXPECT_THAT(refusal_of({large, cavity, {{1.5, 1.5, 1.5}, 1, true}}),
              HasSubstr("part with triangle 24 is in no other one and turned inside out"));
  EXPECT_THAT(refusal_of({large, {{5, 0, 0}, 1, true}}),
              HasSubstr("part with triangle 12 is in no other one and turned inside out"));
  EXPECT_EQ(read_mesh(write_file("parts.obj", text_of({core, large})), {.closed = false})
                .triangles.size(),
            24u);
}

TEST(MeshReader, AcceptsAnOpenSurfaceWhenToldSo) {
  const auto file = write_file("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(read_mesh(file, {.closed = false}).triangles.size(), 1u);
  EXPECT_EQ(refusal([&] { read_mesh(file); }),
            file.string() +
                ": edge (0, 0, 0) - (1, 0, 0) of triangle 0 is open: the surface must be "
                "closed, or the scene must say \"closed\": false");
}

struct BadMesh {
  const char* name;
  const char* file;
  std::string content;
  const char* message;  // after the file name
};
class BadMeshFile : public testing::TestWithParam<BadMesh> {};

TEST_P(BadMeshFile, IsRefusedByName) {
  const auto file = write_file(GetParam().file, GetParam().content);
  EXPECT_THAT(refusal([&] { read_mesh(file); }),
              StartsWith(file.string() + ": " + GetParam().message));
}

const char* const kTetra = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";

INSTANTIATE_TEST_SUITE_P(
    Mesh, BadMeshFile,
    testing::Values(
        BadMesh{"Kind", "m.ply", "ply", "unknown kind of mesh file"},
        BadMesh{"Empty", "m.obj", "", "holds no triangles"},
        BadMesh{"EmptyStl", "m.stl", "", "truncated: 0 bytes are too few"},
        BadMesh{"TruncatedBinary", "m.stl",
                std::string(80, 'x') + std::string("\x02\0\0\0", 4) + std::string(50, '\0'),
                "truncated: 2 triangles need 184 bytes, the file has 134"},
        BadMesh{"TruncatedAscii", "m.stl",
                "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n",
                "truncated: no \"endsolid\""},
        BadMesh{"NotANumber", "m.obj", "v 0 zero 0\n", "line 1: \"zero\" is not a finite number"},
        BadMesh{"Nan", "m.obj", "v 0 nan 0\n", "line 1: \"nan\" is not a finite number"},
        BadMesh{"ShortVertex", "m.obj", "v 0 0\n", "line 1: a vertex needs three numbers"},
        BadMesh{"ShortFace", "m.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n",
                "line 3: a face needs three vertices"},
        BadMesh{"IndexTooLarge", "m.obj", std::string(kTetra) + "f 1 2 5\n",
                "line 5: vertex 5 is out of range, 4 vertices"},
        BadMesh{"IndexZero", "m.obj", std::string(kTetra) + "f 0 1 2\n",
                "line 5: vertex 0 is out of range"},
        BadMesh{"IndexTooNegative", "m.obj", std::string(kTetra) + "f -5 1 2\n",
                "line 5: vertex -5 is out of range"},
        BadMesh{"Degenerate", "m.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n",
                "triangle 0 is degenerate: its corners (0, 0, 0), (1, 0, 0) and (2, 0, 0) lie on a "
                "line"},
        BadMesh{"Repeated", "m.obj", std::string(kTetra) + "f 1 3 2\nf 1 1 2\n",
                "triangle 1 is degenerate"},
        BadMesh{"Orientation", "m.obj",
                std::string(kTetra) + "f 1 3 2\nf 1 2 4\nf 1 3 4\nf 2 3 4\n",
                "triangles 0 and 2 have opposite orientations at their common edge (0, 0, 0) - (0, "
                "1, 0)"},
        BadMesh{
            "SharedByThree", "m.obj",
            std::string(kTetra) + "v 1 1 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\nf 1 2 5\nf 2 1 5\n",
            "edge (0, 0, 0) - (1, 0, 0) is shared by 4 triangles, must be 2"}),
    [](const auto& one) { return std::string(one.param.name); });

TEST(MeshReader, RefusesCornersTooFarOut) {
  for (const char* far : {"2e15", "1e200", "1e308"}) {
    const auto file = write_file(
        "far.obj", std::string("v -") + far + " 0 0\nv " + far + " 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_THAT(refusal([&] { read_mesh(file, {.closed = false}); }),
                HasSubstr("too far out, must be within 1e+15 m"));
  }
}

TEST(MeshReader, RefusesAMissingFile) {
  EXPECT_EQ(refusal([] { read_mesh("nowhere.stl"); }), "nowhere.stl: no such file");
}

TEST(MeshReader, ReadsTheMeshesOfTheScenes) {
  for (const auto& entry : std::filesystem::directory_iterator(SCREE_SCENE_DIR "/meshes"))
    EXPECT_GT(volume(read_mesh(entry.path())), 0) << entry.path();
}

}  // namespace
}  // namespace scree
