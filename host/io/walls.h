#pragma once

#include <filesystem>

#include "host/scene.h"

namespace scree {

/// Writes the fixed and kinematic bodies in their initial poses as a Wavefront OBJ file, which
/// ParaView opens beside frames.vtkhdf. One object per body, named by id and kind; half spaces
/// become squares as large as the scene. Nothing is written when the scene has no such bodies.
/// @return whether a file was written  @throws RunError naming the file and the reason
bool write_walls(const std::filesystem::path& path, const Scene& scene);

}  // namespace scree
