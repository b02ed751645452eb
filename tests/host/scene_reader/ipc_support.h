#pragma once
// Scenes of rigid-ipc as text, and what they are read as.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "host/scene_reader/ipc_scene.h"
#include "tests/host/input_files.h"

namespace scree::test {

/// A cube of edge 1 about the origin.
inline constexpr const char* kCubeObj = R"(v -0.5 -0.5 -0.5
v 0.5 -0.5 -0.5
v 0.5 0.5 -0.5
v -0.5 0.5 -0.5
v -0.5 -0.5 0.5
v 0.5 -0.5 0.5
v 0.5 0.5 0.5
v -0.5 0.5 0.5
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
)";
/// A square of edge 2 in the plane y = 0.
inline constexpr const char* kPlaneObj =
    "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 1 3 2\nf 1 4 3\n";

/// Reads a document of the dialects, without the checks of whole scenes.
inline Scene ipc_scene(const std::string& text, const std::filesystem::path& folder,
                       std::vector<std::string>* notes = nullptr, const char* name = "x.json") {
  const reader::Json json = reader::parse_json(text, name);
  const reader::Source source{name, folder, {}};
  std::vector<std::string> told;
  Scene scene = ipc::read_ipc_scene(reader::Node(json, "", source), told);
  if (notes != nullptr) *notes = told;
  return scene;
}

/// The folder of the test that is running, with meshes/cube.obj and meshes/plane.obj in it.
inline std::filesystem::path folder_with_meshes() {
  const std::filesystem::path folder = write_file("cube.obj", kCubeObj).parent_path();
  std::filesystem::create_directories(folder / "meshes");
  std::filesystem::rename(folder / "cube.obj", folder / "meshes" / "cube.obj");
  std::ofstream(folder / "meshes" / "plane.obj") << kPlaneObj;
  return folder;
}

/// A document with these entries of `rigid_bodies`, further keys of `rigid_body_problem` and of the
/// document.
inline std::string ipc_text(const std::string& bodies, const std::string& problem = "",
                            const std::string& root = "") {
  return R"({"rigid_body_problem": {"rigid_bodies": [)" + bodies + "]" +
         (problem.empty() ? "" : ", " + problem) + "}" + (root.empty() ? "" : ", " + root) + "}";
}

}  // namespace scree::test
