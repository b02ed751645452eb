#pragma once
// scree convert RUN sim.json: the states of a run of a scene of rigid-ipc as that program writes them.

#include <filesystem>

namespace scree {

/// @param folder  of the run
/// @return exit code 0
/// @throws InputError before anything is written, RunError when the file cannot be written
int convert_run(const std::filesystem::path& folder, const std::filesystem::path& out);

}  // namespace scree
