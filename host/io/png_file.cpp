#include "host/io/png_file.h"

#include <fmt/format.h>
#include <png.h>

#include <cstring>
#include <string>

#include "host/error.h"
#include "host/io/atomic_file.h"

namespace scree {

void write_png(const std::filesystem::path& path, const Image& image) {
  const auto expected = static_cast<std::size_t>(image.width) *
                        static_cast<std::size_t>(image.height) * std::size_t{3};
  if (image.width <= 0 || image.height <= 0 || image.rgb.size() != expected)
    throw RunError(fmt::format("cannot write picture {}: {} bytes are no picture of {} x {} pixels",
                               path.string(), image.rgb.size(), image.width, image.height));
  png_image png;
  std::memset(&png, 0, sizeof png);
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&png, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr) == 0)
    throw RunError(fmt::format("cannot write picture {}: {}", path.string(), png.message));
  bytes.resize(size);
  write_file_atomically(path, bytes);
}

}  // namespace scree
