#include "host/cli/info_command.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "host/version.h"
#include "host/world.h"
#include "solvers/assembled/assembled_solver.h"
#include "solvers/solver.h"

namespace scree {

CLI::App* add_info_command(CLI::App& app, InfoOptions& options) {
  CLI::App* command = app.add_subcommand("info", "Devices, build options, versions");
  command->add_flag("--json", options.json, "print JSON");
  return command;
}

int print_info(const InfoOptions& options) {
  const DeviceInfo cpu = device_info(BackendKind::cpu);
  std::string reason;
  const bool has_cuda = backend_available(BackendKind::cuda, &reason);
  const DeviceInfo cuda = has_cuda ? device_info(BackendKind::cuda) : DeviceInfo{};
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
  const std::vector<std::string> solvers = solver_names();
  const std::vector<std::string> problem_solvers = assembled_solver_names();
  if (options.json) {
    nlohmann::json out = {
        {"version", version()},
        {"commit", commit()},
        {"compiler", __VERSION__},
        {"assertions", assertions},
        {"built_with_cuda", built_with_cuda},
        {"solvers", solvers},
        {"problem_solvers", problem_solvers},
        {"cpu",
         {{"name", cpu.name}, {"threads", cpu.threads}, {"memory_bytes", cpu.memory_bytes}}}};
    if (has_cuda) {
      out["cuda"] = {{"name", cuda.name},
                     {"multiprocessors", cuda.threads},
                     {"memory_bytes", cuda.memory_bytes}};
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
  fmt::print("solvers     {}\n", fmt::join(solvers, ", "));
  fmt::print("            for scree solve: {}\n", fmt::join(problem_solvers, ", "));
  fmt::print("cpu         {}, {} threads, {:.1f} GiB\n", cpu.name, cpu.threads,
             static_cast<double>(cpu.memory_bytes) / gib);
  if (has_cuda) {
    fmt::print("cuda        {}, {} multiprocessors, {:.1f} GiB\n", cuda.name, cuda.threads,
               static_cast<double>(cuda.memory_bytes) / gib);
  } else {
    fmt::print("cuda        not available: {}\n", reason);
  }
  return 0;
}

}  // namespace scree
