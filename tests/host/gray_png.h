#pragma once
// PNG files from nothing but the format's own rules, so that what reads them is not what wrote them.

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace scree::test {

inline void append_big_endian(std::string& bytes, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 255);
}

/// Cyclic redundancy check of a chunk.
inline std::uint32_t png_check(const std::string& bytes) {
  std::uint32_t crc = 0xffffffffu;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1u) != 0 ? 0xedb88320u ^ crc >> 1 : crc >> 1;
  }
  return ~crc;
}

inline std::string png_chunk(const std::string& type, const std::string& data) {
  std::string chunk;
  append_big_endian(chunk, static_cast<std::uint32_t>(data.size()));
  chunk += type + data;
  append_big_endian(chunk, png_check(type + data));
  return chunk;
}

/// The bytes as a zlib stream of stored blocks.
inline std::string zlib_stored(const std::string& bytes) {
  std::string out = "\x78\x01";
  std::uint32_t a = 1, b = 0;
  for (const char c : bytes) a = (a + static_cast<unsigned char>(c)) % 65521, b = (b + a) % 65521;
  for (std::size_t at = 0; at < bytes.size(); at += 65535) {
    const std::size_t length = std::min<std::size_t>(65535, bytes.size() - at);
    out += static_cast<char>(at + length == bytes.size());
    for (const std::size_t half : {length, ~length})
      for (const int shift : {0, 8}) out += static_cast<char>(half >> shift & 255);
    out += bytes.substr(at, length);
  }
  append_big_endian(out, b << 16 | a);
  return out;
}

struct PngKind {
  int depth = 8;
  int color_type = 0;  ///< 0 gray, 2 color, 3 palette, 4 gray with alpha
};

/// @param samples  row by row from the top; one a pixel, or as many as the color type has
inline std::string png_bytes(std::uint32_t width, std::uint32_t height,
                             const std::vector<int>& samples, PngKind kind = {}) {
  std::string header;
  append_big_endian(header, width);
  append_big_endian(header, height);
  for (const int value : {kind.depth, kind.color_type, 0, 0, 0}) header += static_cast<char>(value);
  std::string rows;
  for (std::uint32_t y = 0; y < height; ++y) {
    rows += '\0';  // no filter
    const std::size_t per_row = samples.size() / height;
    for (std::size_t k = 0; k < per_row; ++k) {
      const int sample = samples[y * per_row + k];
      if (kind.depth == 16) rows += static_cast<char>(sample >> 8 & 255);
      rows += static_cast<char>(sample & 255);
    }
  }
  return "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", header) + png_chunk("IDAT", zlib_stored(rows)) +
         png_chunk("IEND", "");
}

}  // namespace scree::test
