#pragma once
// Text of mesh files: lines, words and numbers.

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "host/error.h"
#include "host/io/printable.h"
#include "kernels/math/vec3.h"

namespace scree::mesh_text {

/// @throws InputError  always. @param file  its name
[[noreturn]] inline void fail(const std::string& file, const std::string& text) {
  throw InputError(file + ": " + text);
}

/// @throws InputError naming a file that is missing or cannot be read
inline std::string read_bytes(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw InputError(file.string() + ": no such file");
  std::ifstream stream(file, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream || stream.bad()) throw InputError(file.string() + ": cannot be read");
  return bytes;
}

/// Words of one line after another, without comments.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}
  bool next() {
    if (rest_.empty()) return false;
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    ++number;
    words.clear();
    line = line.substr(0, line.find('#'));
    while (true) {
      const std::size_t start = line.find_first_not_of(" \t\r\f");
      if (start == std::string_view::npos) return true;
      line.remove_prefix(start);
      const std::size_t stop = std::min(line.find_first_of(" \t\r\f"), line.size());
      words.push_back(line.substr(0, stop));
      line.remove_prefix(stop);
    }
  }
  /// The next line that holds anything. @throws InputError where there is none
  void require(const std::string& file, const char* what) {
    do {
      if (!next()) fail(file, fmt::format("truncated: {} expected", what));
    } while (words.empty());
  }
  std::vector<std::string_view> words;
  long long number = 0;

 private:
  std::string_view rest_;
};

template <class T>
T parsed(const std::string& file, const Lines& lines, std::string_view word) {
  T value{};
  const char* start = word.data() + (!word.empty() && word.front() == '+' ? 1 : 0);
  const auto [end, error] = std::from_chars(start, word.data() + word.size(), value);
  bool good = error == std::errc{} && end == word.data() + word.size();
  if constexpr (std::is_floating_point_v<T>) good = good && std::isfinite(value);
  if (!good)
    fail(file, fmt::format("line {}: \"{}\" is not a {}", lines.number, printable(word, 40),
                           std::is_floating_point_v<T> ? "finite number" : "whole number"));
  return value;
}

inline Vec3<double> parsed_vector(const std::string& file, const Lines& lines, std::size_t first) {
  if (lines.words.size() < first + 3)
    fail(file, fmt::format("line {}: a vertex needs three numbers", lines.number));
  return {parsed<double>(file, lines, lines.words[first]),
          parsed<double>(file, lines, lines.words[first + 1]),
          parsed<double>(file, lines, lines.words[first + 2])};
}

}  // namespace scree::mesh_text
