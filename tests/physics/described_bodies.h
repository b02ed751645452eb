#pragma once
// Bodies for scenes in code, from their keys in a scene file.

#include <string>

#include "host/scene_reader.h"
#include "tests/host/input_files.h"
#include "tests/physics/scene_builder.h"

namespace scree::physics {

/// A scene of bodies, of which one is free. @param bodies  as a scene file lists them
inline Scene scene_of(const std::string& bodies) {
  return read_scene(test::write_file(
      "bodies.json", R"({"time_step": 1, "duration": 1, "bodies": [)" + bodies + "]}"));
}

/// Adds a free body of the density of water. @param shape  keys of its shape
inline BodyDescription& add_described(Scene& scene, const std::string& shape) {
  const Scene read = scene_of("{" + shape + R"(, "density": 1000})");
  scene.bodies.push_back(read.bodies.at(0));
  if (!read.meshes.empty()) {
    scene.bodies.back().shape.mesh = static_cast<int>(scene.meshes.size());
    scene.meshes.push_back(read.meshes.at(0));
  }
  return scene.bodies.back();
}

}  // namespace scree::physics
