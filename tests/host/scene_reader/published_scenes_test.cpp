// The scenes that rigid-ipc and Autodesk's program came with, against a table of what is in them that
// another reader made. They are not part of the source tree.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "host/scene/free_mesh.h"
#include "host/scene_reader.h"
#include "tests/host/scene_reader/ipc_support.h"
#include "tests/physics/shared_data.h"
#include "tests/refused_scenes.h"

namespace scree {
namespace {

using Row = std::map<std::string, std::string>;

std::vector<Row> rows_of(const std::filesystem::path& table) {
  std::vector<Row> rows;
  std::vector<std::string> head;
  std::ifstream file(table);
  for (std::string line; std::getline(file, line);) {
    std::vector<std::string> cells;
    std::istringstream text(line);
    for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
    if (head.empty()) {
      head = cells;
      continue;
    }
    Row& row = rows.emplace_back();
    for (std::size_t k = 0; k < head.size() && k < cells.size(); ++k) row[head[k]] = cells[k];
  }
  return rows;
}

const std::set<std::string> kRefused(std::begin(kRefusedScenes), std::end(kRefusedScenes));
/// The table counts this one before components become bodies.
constexpr const char* kSplit = "fixtures/3D/examples/split-components.json";

/// Triangles without area, which are left out.
const std::map<std::string, int> kFlat{
    {"fixtures/3D/examples/concave.json", 16},
    {"inputs/gear_assembly_offset/gear_offset_rotating.json", 16},
    {"inputs/peg/peg_insertion.json", 5}};

/// @return  how many were read
int compare_all(const std::filesystem::path& folder) {
  int read = 0;
  for (const Row& row : rows_of(folder / "scenes.csv")) {
    const std::string& name = row.at("scene");
    SCOPED_TRACE(name);
    const auto number = [&](const char* key) { return std::stod(row.at(key)); };
    const std::filesystem::path file = folder / name;
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    Scene scene;
    const std::string message = test::refusal(
        [&] { scene = test::ipc_scene(text.str(), file.parent_path(), nullptr, file.c_str()); });
    EXPECT_EQ(message != "no error", kRefused.count(name) == 1) << message;
    if (message != "no error") {
      EXPECT_THAT(message, testing::AnyOf(testing::HasSubstr("must enclose a volume"),
                                          testing::HasSubstr("edges or points alone")));
      continue;
    }
    ++read;
    std::size_t fixed = 0, moved = 0, vertices = 0, triangles = 0;
    for (const BodyDescription& body : scene.bodies) {
      fixed += body.kind == BodyKind::fixed ? 1 : 0;
      moved += body.kind == BodyKind::kinematic ? 1 : 0;
      const TriangleMesh& mesh = scene.meshes.at(static_cast<std::size_t>(body.shape.mesh));
      vertices += mesh.vertices.size();
      triangles += mesh.triangles.size();
      if (body.kind != BodyKind::free) continue;
      EXPECT_EQ(free_mesh_fault(mesh), std::nullopt);
      EXPECT_GT(body.mass, 0);
      // Moments of a solid: none is larger than the sum of the others.
      EXPECT_LT(std::max({body.inertia.x, body.inertia.y, body.inertia.z}),
                0.5 * (body.inertia.x + body.inertia.y + body.inertia.z));
    }
    EXPECT_EQ(static_cast<double>(scene.bodies.size()),
              number("bodies") + (name == kSplit ? 1 : 0));
    EXPECT_EQ(static_cast<double>(fixed), number("static"));
    EXPECT_EQ(static_cast<double>(moved), number("kinematic"));
    EXPECT_EQ(static_cast<double>(vertices), number("vertices"));
    const auto flat = kFlat.find(name);
    EXPECT_EQ(static_cast<double>(triangles) + (flat == kFlat.end() ? 0 : flat->second),
              number("triangles"));
    EXPECT_EQ(scene.stepping.time_step, number("dt"));
    EXPECT_EQ(std::llround(scene.stepping.duration / scene.stepping.time_step),
              std::llround(number("steps")));
    EXPECT_EQ(scene.materials.at(0).friction, number("mu"));
    const auto& p = scene.dynamics.parameters;
    EXPECT_EQ(p.at("reach"), number("dhat"));
    EXPECT_EQ(p.count("separation") == 1 ? p.at("separation") : 0, number("dmin"));
    EXPECT_EQ(p.at("slip_speed"), number("eps_v"));
    EXPECT_EQ(p.at("friction_solves"), std::max(0.0, number("friction_iterations")));
    EXPECT_EQ(static_cast<double>(scene.joints.size()), number("linear_constraints"));
    EXPECT_GT(p.at("tolerance"), 0);
  }
  return read;
}

TEST(PublishedScenes, ThoseOfRigidIpcAreReadAsTheyAre) {
  const auto folder = physics::shared_file("rigid_ipc");
  if (!std::filesystem::exists(folder / "scenes.csv")) GTEST_SKIP() << "no " << folder;
  EXPECT_EQ(compare_all(folder), 65 - static_cast<int>(kRefused.size()));
}

TEST(PublishedScenes, ThoseOfAutodeskAreReadAsTheyAre) {
  const auto folder = physics::shared_file("rigid_ipc") / "autodesk_abd";
  if (!std::filesystem::exists(folder / "scenes.csv")) GTEST_SKIP() << "no " << folder;
  EXPECT_EQ(compare_all(folder), 7);
}

}  // namespace
}  // namespace scree
