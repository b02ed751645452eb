#include "host/io/png_file.h"

#include <fmt/format.h>
#include <png.h>

#include <csetjmp>
#include <cstring>
#include <fstream>
#include <iterator>
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

namespace {

/// libpng reads from here. Its errors are jumps back to the functions of this class, which keep no objects of their
/// own: a C++ exception must not pass the frames of the library.
class PngSource {
 public:
  explicit PngSource(const std::string& bytes) : bytes_(bytes) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, keep_message, ignore_warning);
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
    if (info_ != nullptr) png_set_read_fn(png_, this, give);
  }
  ~PngSource() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngSource(const PngSource&) = delete;
  PngSource& operator=(const PngSource&) = delete;

  /// False: it failed, see message().
  bool read_header() {
    if (info_ == nullptr) return false;
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_read_info(png_, info_);
    return true;
  }
  /// @param rows  [height] each of row_bytes()
  bool read_rows(png_bytepp rows) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_interlace_handling(png_);
    png_read_image(png_, rows);
    png_read_end(png_, nullptr);
    return true;
  }
  std::size_t width() const { return png_get_image_width(png_, info_); }
  std::size_t height() const { return png_get_image_height(png_, info_); }
  int depth() const { return png_get_bit_depth(png_, info_); }
  int color_type() const { return png_get_color_type(png_, info_); }
  std::size_t row_bytes() const { return png_get_rowbytes(png_, info_); }
  const char* message() const { return message_; }

 private:
  static void give(png_structp png, png_bytep out, std::size_t count) {
    auto& self = *static_cast<PngSource*>(png_get_io_ptr(png));
    if (count > self.bytes_.size() - self.at_) png_error(png, "truncated");
    std::memcpy(out, self.bytes_.data() + self.at_, count);
    self.at_ += count;
  }
  [[noreturn]] static void keep_message(png_structp png, png_const_charp text) {
    auto& self = *static_cast<PngSource*>(png_get_error_ptr(png));
    std::strncpy(self.message_, text, sizeof self.message_ - 1);
    png_longjmp(png, 1);
  }
  static void ignore_warning(png_structp, png_const_charp) {}

  const std::string& bytes_;
  std::size_t at_ = 0;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  char message_[200] = "out of memory";
};

const char* name_of_colors(int type) {
  switch (type) {
    case PNG_COLOR_TYPE_GRAY:
      return "gray";
    case PNG_COLOR_TYPE_GRAY_ALPHA:
      return "gray with alpha";
    case PNG_COLOR_TYPE_PALETTE:
      return "one with a palette";
    default:
      return "in color";
  }
}

}  // namespace

GrayImage read_gray_png(const std::filesystem::path& path, std::size_t most_pixels) {
  const auto fail = [&](const std::string& text) { throw InputError(path.string() + ": " + text); };
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) fail("no such file");
  // No picture that is taken is larger, however badly it is compressed.
  const std::uintmax_t most_bytes = 8 * most_pixels + (1u << 20);
  if (const auto size = std::filesystem::file_size(path, error); error || size > most_bytes)
    fail(fmt::format(
        "a file of more than {} bytes, or of no size, is no picture of {} pixels at most",
        most_bytes, most_pixels));
  std::ifstream stream(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (!stream || stream.bad()) fail("cannot be read");
  PngSource png(bytes);
  if (!png.read_header()) fail(fmt::format("no PNG picture that can be read: {}", png.message()));
  if (png.color_type() != PNG_COLOR_TYPE_GRAY || (png.depth() != 8 && png.depth() != 16))
    fail(fmt::format("the picture is {} of {} bits, must be gray of 8 or 16 bits without alpha",
                     name_of_colors(png.color_type()), png.depth()));
  GrayImage image{
      png.width(), png.height(), png.depth() == 8 ? std::uint16_t{255} : std::uint16_t{65535}, {}};
  if (image.width > most_pixels / image.height)
    fail(fmt::format("{} x {} pixels, must be {} at most", image.width, image.height, most_pixels));
  std::vector<png_byte> pixels(png.row_bytes() * image.height);
  std::vector<png_bytep> rows(image.height);
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = pixels.data() + k * png.row_bytes();
  if (!png.read_rows(rows.data()))
    fail(fmt::format("no PNG picture that can be read: {}", png.message()));
  image.values.resize(image.width * image.height);
  for (std::size_t k = 0; k < image.values.size(); ++k)
    image.values[k] = png.depth() == 8
                          ? std::uint16_t{pixels[k]}
                          : static_cast<std::uint16_t>(pixels[2 * k] << 8 | pixels[2 * k + 1]);
  return image;
}

}  // namespace scree
