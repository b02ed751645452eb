#pragma once

#include <filesystem>

#include "host/world.h"

namespace scree {

/// Writes the picture as an 8-bit RGB PNG, in one rename.
/// @throws RunError naming the file and the reason, also when the picture has no pixels
void write_png(const std::filesystem::path& path, const Image& image);

}  // namespace scree
