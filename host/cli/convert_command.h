#pragma once
// scree convert: stored contact problems as FCLIB files.

#include <CLI/CLI.hpp>
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

CLI::App* add_convert_command(CLI::App& app, ConvertOptions& options);

/// @return exit code 0
/// @throws InputError before anything is written, RunError when the file cannot be written
int convert_problem(const ConvertOptions& options);

}  // namespace scree
