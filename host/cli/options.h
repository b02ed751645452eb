#pragma once
// Options that several commands share.

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "host/world.h"

namespace scree {

struct RunTarget {
  std::string scene;                   ///< file, or name of a scene in the scene folder
  std::string backend;                 ///< empty: what the scene says
  std::string precision;               ///< empty: what the scene says
  int threads = 0;                     ///< 0: all
  int device = -1;                     ///< CUDA device; negative: not given, the first
  double memory = 0;                   ///< limit [MiB]; 0: what is free
  std::string transport;               ///< between GPUs of ranks; empty: auto
  std::vector<std::string> overrides;  ///< key.path=value
  bool json = false;
};

/// The folder of the scenes that come with the program.
std::filesystem::path scene_folder();

/// The file of a scene given by path or by name. @throws InputError listing the known names
std::filesystem::path find_scene(const std::string& name_or_path);

/// Backend, device and precision to use: the command line before the scene; `auto` takes CUDA when
/// it is there.
/// @param notice  when given: what a user should know about the choice, or empty
/// @param ranks   that simulate the scene together, led by rank 0, or null. Those of one host share its devices and
///                processors where the command line does not say
/// @throws InputError when the backend or the device that was asked for is not available
WorldOptions resolve_options(const RunTarget& target, const Scene& scene,
                             std::string* notice = nullptr,
                             const std::shared_ptr<Ranks>& ranks = nullptr);

/// Does what may find a fault of a scene that was read, which then names its file. @throws InputError
void with_scene_file(const RunTarget& target, const std::function<void()>& what);

/// require_solver(), and over several ranks that they can share the scene; faults name its file.
void require_known_solver(const RunTarget& target, const Scene& scene, const WorldOptions& options,
                          bool over_ranks);

}  // namespace scree
