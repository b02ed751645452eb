#include "host/cli/info_command.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "dynamics/dynamics_card.h"
#include "host/cli/options.h"
#include "host/error.h"
#include "host/scene_reader/scene_schema.h"
#include "host/version.h"
#include "host/world.h"
#include "solvers/assembled/assembled_solver.h"
#include "solvers/solver_card.h"

namespace scree {
namespace {

int print_schema() {
  const std::filesystem::path path = scene_folder() / "schema.json";
  std::ifstream file(path);
  if (!file) throw InputError(path.string() + ": cannot be read");
  const auto schema = reader::schema_with_cards(reader::Json::parse(file));
  fmt::print("{}\n", schema.dump(2));
  return 0;
}

}  // namespace

CLI::App* add_info_command(CLI::App& app, InfoOptions& options) {
  CLI::App* command = app.add_subcommand("info", "Devices, build options, versions");
  CLI::Option* json = command->add_flag("--json", options.json, "print JSON");
  command
      ->add_flag(
          "--schema", options.schema,
          "print the JSON schema of scene files, with all solvers and models of this program")
      ->excludes(json);
  return command;
}

int print_info(const InfoOptions& options) {
  if (options.schema) return print_schema();
  const DeviceInfo cpu = device_info(BackendKind::cpu);
  std::string reason;
  const bool has_cuda = backend_available(BackendKind::cuda, &reason);
  std::vector<DeviceInfo> devices;
  for (int device = 0; has_cuda && device < device_count(BackendKind::cuda); ++device)
    devices.push_back(device_info(BackendKind::cuda, device));
#ifdef SCREE_HAS_CUDA
  const bool built_with_cuda = true;
#else
  const bool built_with_cuda = false;
#endif
#ifdef NDEBUG
  const char* assertions = "off";
#else
  const char* assertions = "on";
#endif
  const std::vector<std::string> problem_solvers = assembled_solver_names();
  if (options.json) {
    nlohmann::json out = {
        {"version", version()},
        {"commit", commit()},
        {"compiler", __VERSION__},
        {"assertions", assertions},
        {"built_with_cuda", built_with_cuda},
        {"dynamics", dynamics_names()},
        {"solvers", solver_names()},
        {"problem_solvers", problem_solvers},
        {"cpu",
         {{"name", cpu.name}, {"threads", cpu.threads}, {"memory_bytes", cpu.memory_bytes}}}};
    if (has_cuda) {
      nlohmann::json list = nlohmann::json::array();
      for (const DeviceInfo& device : devices)
        list.push_back({{"name", device.name},
                        {"multiprocessors", device.threads},
                        {"memory_bytes", device.memory_bytes}});
      out["cuda"] = list.front();
      out["cuda_devices"] = list;
    } else {
      out["cuda"] = {{"unavailable", reason}};
    }
    fmt::print("{}\n", out.dump(2));
    return 0;
  }
  const double gib = 1024.0 * 1024.0 * 1024.0;
  fmt::print("scree       {} ({})\n", version(), commit());
  fmt::print("compiler    {}; assertions {}; CUDA {}\n", __VERSION__, assertions,
             built_with_cuda ? "built in" : "not built in");
  const char* heading = "dynamics";
  for (const DynamicsCard& card : dynamics_cards())
    fmt::print("{:<12}{:<22}{}\n", std::exchange(heading, ""), card.name, card.description);
  heading = "solvers";
  for (const SolverCard& card : solver_cards())
    fmt::print("{:<12}{:<22}{}\n", std::exchange(heading, ""), card.name, card.description);
  fmt::print("            for scree solve: {}\n", fmt::join(problem_solvers, ", "));
  fmt::print("cpu         {}, {} threads, {:.1f} GiB\n", cpu.name, cpu.threads,
             static_cast<double>(cpu.memory_bytes) / gib);
  for (std::size_t device = 0; device < devices.size(); ++device)
    fmt::print("cuda {:<6} {}, {} multiprocessors, {:.1f} GiB\n", device, devices[device].name,
               devices[device].threads, static_cast<double>(devices[device].memory_bytes) / gib);
  if (!has_cuda) {
    fmt::print("cuda        not available: {}\n", reason);
  }
  return 0;
}

}  // namespace scree
