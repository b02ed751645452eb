#pragma once
// Surfaces of bodies in scenes of rigid-ipc: files, scales and parts.

#include <filesystem>
#include <optional>
#include <vector>

#include "host/scene.h"

namespace scree::ipc {

/// The file of that name, with either separator, in the folder of the scene or in a folder `meshes`
/// there or in one of those around it.
std::optional<std::filesystem::path> find_mesh(const std::filesystem::path& scene_folder,
                                               const std::string& name);

struct Box {
  Vec3d low, high;
};
/// About vertices, of which there is one or more.
Box box_of(const std::vector<Vec3d>& vertices);

/// Takes out triangles without area. @return  how many
int drop_flat_triangles(TriangleMesh& mesh);

/// The parts that have no vertex in common, in the order of their first vertices. Vertices that no
/// triangle has are left out.
std::vector<TriangleMesh> components(const TriangleMesh& mesh);

}  // namespace scree::ipc
