#pragma once
// scree convert: stored contact problems as FCLIB files.

#include <filesystem>
#include <string>

namespace scree {

struct ConvertOptions {
  std::filesystem::path problem;  ///< file in any layout
  std::filesystem::path out;      ///< FCLIB file to write
  std::string kind = "local";     ///< local or global
  std::string storage;            ///< rows, columns or triplets; empty: as the collection has them
  bool force = false;             ///< replace a file that is there
};

/// @return exit code 0
/// @throws InputError before anything is written, RunError when the file cannot be written
int convert_problem(const ConvertOptions& options);

}  // namespace scree
