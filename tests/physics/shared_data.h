#pragma once
// Tables published elsewhere, which are not part of the source tree. Tests that need one are
// skipped when it is not there.

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace scree::physics {

/// A data file: below the folder named by SCREE_SHARED_DATA, else below "shared"
/// beside the source tree.
inline std::filesystem::path shared_file(const std::string& name) {
  const char* folder = std::getenv("SCREE_SHARED_DATA");
  if (folder != nullptr) return std::filesystem::path(folder) / name;
  return (std::filesystem::path(SCREE_SOURCE_DIR) / ".." / "shared" / name).lexically_normal();
}

/// Text of a file, unpacked when its name ends in .gz; empty when it cannot be read.
inline std::string shared_text(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return {};
  if (path.extension() != ".gz") {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
  }
  FILE* pipe = popen(("zcat '" + path.string() + "' 2>/dev/null").c_str(), "r");
  if (pipe == nullptr) return {};
  std::string text;
  char buffer[65536];
  while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, pipe)) text.append(buffer, n);
  return pclose(pipe) == 0 ? text : std::string{};
}

/// Rows of numbers of a table; lines that do not start with a number are headers.
inline std::vector<std::vector<double>> number_rows(const std::string& text) {
  std::vector<std::vector<double>> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::vector<double> row;
    const char* at = line.c_str();
    for (char* end = nullptr;; at = end + 1) {
      const double value = std::strtod(at, &end);
      if (end == at) break;
      row.push_back(value);
      if (*end != ',') break;
    }
    if (!row.empty()) rows.push_back(row);
  }
  return rows;
}

}  // namespace scree::physics
