#include "host/cli/options.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <thread>

#include "dynamics/ranks/shareable.h"
#include "host/error.h"
#include "host/ranks/mpi_ranks.h"
#include "host/ranks/nccl_messages.h"
#include "host/scene_reader.h"

namespace scree {
namespace fs = std::filesystem;

namespace {

/// The device of a rank: those of a host take turns.
int device_of(const Ranks& ranks) {
  return local_rank(ranks).rank % std::max(1, device_count(BackendKind::cuda));
}

/// CPU threads of a rank: a fair share of the processors of its host, and no more than a launcher bound it to. 0, what
/// OpenMP offers, where the environment says.
int threads_of(const Ranks& ranks) {
  if (std::getenv("OMP_NUM_THREADS") != nullptr) return 0;
  const auto processors = static_cast<int>(::sysconf(_SC_NPROCESSORS_ONLN));
  const auto bound_to = static_cast<int>(std::thread::hardware_concurrency());
  return std::max(1, std::min(bound_to, processors / local_rank(ranks).count));
}

Transport transport_of(const std::string& name) {
  for (const Transport each :
       {Transport::automatic, Transport::peer, Transport::nccl, Transport::hosts})
    if (name == to_string(each)) return each;
  throw InputError(
      fmt::format("--transport: \"{}\" is not allowed: expected auto, peer, nccl or hosts", name));
}

/// Sets how devices of ranks exchange data. @param ranks  or null
void set_transport(const std::string& name, BackendKind backend, Ranks* ranks) {
  if (name.empty()) return;
  const Transport transport = transport_of(name);
  if (backend != BackendKind::cuda)
    throw InputError(fmt::format("--transport {}: is for the backend cuda, this is cpu", name));
  if (transport == Transport::nccl && nccl_version().empty())
    throw InputError("--transport nccl: this scree is built without NCCL");
  if (ranks != nullptr) ranks->set_transport(transport);
}

}  // namespace

fs::path scene_folder() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  return (program.parent_path() / SCREE_SCENES_FROM_PROGRAM).lexically_normal();
}

fs::path find_scene(const std::string& name_or_path) {
  const bool is_directory =
      fs::is_directory(name_or_path);  // may be the output of the scene of that name
  if (fs::exists(name_or_path) && !is_directory) return name_or_path;
  const fs::path folder = scene_folder();
  fs::path by_name = folder / (name_or_path + ".json");
  if (name_or_path.find('/') == std::string::npos && fs::exists(by_name)) return by_name;
  if (is_directory)
    throw InputError(fmt::format("{}: is a directory, expected a scene file", name_or_path));
  std::vector<std::string> names;
  if (fs::is_directory(folder)) {
    for (const auto& entry : fs::directory_iterator(folder)) {
      if (entry.path().extension() == ".json" && entry.path().stem() != "schema") {
        names.push_back(entry.path().stem());
      }
    }
  }
  std::sort(names.begin(), names.end());
  throw InputError(fmt::format("{}: no such file, and no scene of that name; known scenes: {}",
                               name_or_path, fmt::join(names, ", ")));
}

WorldOptions resolve_options(const RunTarget& target, const Scene& scene, std::string* notice,
                             const std::shared_ptr<Ranks>& ranks) {
  const std::string backend = target.backend.empty() ? scene.backend : target.backend;
  const std::string precision = target.precision.empty() ? scene.precision : target.precision;
  WorldOptions options;
  options.bodies_may_change = false;
  options.threads = target.threads;
  options.memory_limit = static_cast<std::size_t>(target.memory * (1 << 20));
  if (precision == "double") {
    options.precision = Precision::double_precision;
  } else if (precision != "float") {
    throw InputError(
        fmt::format("--precision: \"{}\" is not allowed: expected float or double", precision));
  }
  const bool has_device = target.device >= 0;
  options.device = has_device ? target.device : 0;
  if (ranks != nullptr) {
    options.ranks = ranks;
    options.rank_calls = RankCalls::led;
    if (!has_device) options.device = device_of(*ranks);
  }
  std::string reason;
  if (backend == "cuda") {
    if (!backend_available(BackendKind::cuda, &reason, options.device)) {
      if (has_device) throw InputError(fmt::format("--device {}: {}", target.device, reason));
      throw InputError(fmt::format("--backend cuda: {}; use --backend cpu, or auto", reason));
    }
    options.backend = BackendKind::cuda;
  } else if (backend == "auto") {
    if (backend_available(BackendKind::cuda, &reason, options.device)) {
      options.backend = BackendKind::cuda;
    } else if (has_device) {
      throw InputError(fmt::format("--device {}: {}", target.device, reason));
    } else if (notice != nullptr) {
      *notice = fmt::format("no GPU in use ({}): running on the CPU", reason);
    }
  } else if (backend != "cpu") {
    throw InputError(
        fmt::format("--backend: \"{}\" is not allowed: expected cuda, cpu or auto", backend));
  } else if (has_device) {
    throw InputError(
        fmt::format("--device {}: is for the backend cuda, this is cpu", target.device));
  }
  if (options.backend == BackendKind::cpu) {
    options.device = 0;
    if (ranks != nullptr && options.threads == 0) options.threads = threads_of(*ranks);
  }
  set_transport(target.transport, options.backend, ranks.get());
  return options;
}

void with_scene_file(const RunTarget& target, const std::function<void()>& what) {
  try {
    what();
  } catch (const InputError& fault) {
    throw InputError(scene_fault(find_scene(target.scene), target.overrides, fault.what()));
  }
}

void require_known_solver(const RunTarget& target, const Scene& scene, const WorldOptions& options,
                          bool over_ranks) {
  with_scene_file(target, [&] {
    if (over_ranks) require_shareable(scene);
    require_solver(scene, options);
  });
}

}  // namespace scree
