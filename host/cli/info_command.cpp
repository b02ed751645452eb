#include "host/cli/info_command.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "dynamics/dynamics_card.h"
#include "host/cli/options.h"
#include "host/error.h"
#include "host/ranks/mpi_ranks.h"
#include "host/ranks/nccl_messages.h"
#include "host/scene_reader/scene_schema.h"
#include "host/version.h"
#include "host/world.h"
#include "solvers/assembled/assembled_solver.h"
#include "solvers/solver_card.h"

namespace scree {
namespace {

struct CudaDevice {
  DeviceInfo info;
  std::string fault;  ///< why it cannot be used; empty: it can
};

/// All of the machine, as `--device` counts them: one that cannot be used hides no other.
std::vector<CudaDevice> cuda_devices() {
  std::vector<CudaDevice> devices;
  for (int device = 0; device < device_count(BackendKind::cuda); ++device) {
    CudaDevice& each = devices.emplace_back();
    each.info = device_info(BackendKind::cuda, device);
    backend_available(BackendKind::cuda, &each.fault, device);
  }
  return devices;
}

nlohmann::json to_json(const CudaDevice& device) {
  nlohmann::json out = {{"name", device.info.name},
                        {"multiprocessors", device.info.threads},
                        {"memory_bytes", device.info.memory_bytes}};
  if (!device.fault.empty()) out["unavailable"] = device.fault;
  return out;
}

int print_schema() {
  const std::filesystem::path path = scene_folder() / "schema.json";
  std::ifstream file(path);
  if (!file) throw InputError(path.string() + ": cannot be read");
  const auto schema = reader::schema_with_cards(reader::Json::parse(file));
  fmt::print("{}\n", schema.dump(2));
  return 0;
}

}  // namespace

int print_info(const InfoOptions& options) {
  if (options.schema) return print_schema();
  const DeviceInfo cpu = device_info(BackendKind::cpu);
  const std::vector<CudaDevice> devices = cuda_devices();
  std::string reason;
  if (devices.empty()) backend_available(BackendKind::cuda, &reason);
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
  const std::string mpi = mpi_version().empty() ? "not built" : mpi_version();
  const std::string nccl = nccl_version().empty() ? "not built" : nccl_version();
  const std::vector<std::string> problem_solvers = assembled_solver_names();
  if (options.json) {
    nlohmann::json out = {
        {"version", version()},
        {"commit", commit()},
        {"compiler", __VERSION__},
        {"assertions", assertions},
        {"built_with_cuda", built_with_cuda},
        {"mpi", mpi},
        {"nccl", nccl},
        {"dynamics", dynamics_names()},
        {"solvers", solver_names()},
        {"problem_solvers", problem_solvers},
        {"cpu",
         {{"name", cpu.name}, {"threads", cpu.threads}, {"memory_bytes", cpu.memory_bytes}}}};
    if (!devices.empty()) {
      nlohmann::json list = nlohmann::json::array();
      for (const CudaDevice& device : devices) list.push_back(to_json(device));
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
  fmt::print("MPI         {}\n", mpi);
  fmt::print("NCCL        {}\n", nccl);
  const char* heading = "dynamics";
  for (const DynamicsCard& card : dynamics_cards())
    fmt::print("{:<12}{:<22}{}\n", std::exchange(heading, ""), card.name, card.description);
  heading = "solvers";
  for (const SolverCard& card : solver_cards())
    fmt::print("{:<12}{:<22}{}\n", std::exchange(heading, ""), card.name, card.description);
  fmt::print("            for scree solve: {}\n", fmt::join(problem_solvers, ", "));
  fmt::print("cpu         {}, {} threads, {:.1f} GiB\n", cpu.name, cpu.threads,
             static_cast<double>(cpu.memory_bytes) / gib);
  for (std::size_t number = 0; number < devices.size(); ++number) {
    const auto& [device, fault] = devices[number];
    fmt::print("cuda {:<6} {}, {} multiprocessors, {:.1f} GiB{}{}\n", number, device.name,
               device.threads, static_cast<double>(device.memory_bytes) / gib,
               fault.empty() ? "" : "; cannot be used: ", fault);
  }
  if (devices.empty()) fmt::print("cuda        not available: {}\n", reason);
  return 0;
}

}  // namespace scree
