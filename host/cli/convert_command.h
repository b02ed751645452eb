#pragma once
// scree convert: stored contact problems as FCLIB files, runs of scenes of rigid-ipc as its sim.json.

#include <filesystem>
#include <string>

namespace scree {

struct ConvertOptions {
  std::filesystem::path problem;  ///< file in any layout, or the folder of a run
  std::filesystem::path out;      ///< FCLIB file to write, or sim.json
  std::string kind = "local";     ///< local or global
  std::string storage;            ///< rows, columns or triplets; empty: as the collection has them
  bool force = false;             ///< replace a file that is there
};

/// @return exit code 0
/// @throws InputError before anything is written, RunError when the file cannot be written
int convert(const ConvertOptions& options);

}  // namespace scree
