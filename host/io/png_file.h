#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "host/world.h"

namespace scree {

/// Writes the picture as an 8-bit RGB PNG, in one rename.
/// @throws RunError naming the file and the reason, also when the picture has no pixels
void write_png(const std::filesystem::path& path, const Image& image);

/// Gray values of a picture.
struct GrayImage {
  std::size_t width = 0;
  std::size_t height = 0;
  std::uint16_t white = 0;            ///< the largest value: 255 or 65535
  std::vector<std::uint16_t> values;  ///< [width * height] as stored, row by row from the top
};

/// Reads a gray PNG of 8 or 16 bits a pixel without alpha. Values are those of the file: nothing is done for a gamma
/// or a color profile that it names.
/// @param most_pixels  of a picture that is read
/// @throws InputError naming the file: missing, unreadable, not a PNG, damaged, of another kind, or too large
GrayImage read_gray_png(const std::filesystem::path& path, std::size_t most_pixels);

}  // namespace scree
