#include "host/cli/convert_run.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "dynamics/dynamics_card.h"
#include "host/error.h"
#include "host/io/frame_reader.h"
#include "host/io/ipc_states.h"
#include "host/io/steps_csv.h"
#include "host/scene_reader.h"

namespace scree {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

Json run_record_of(const fs::path& folder) {
  const fs::path file = folder / "run.json";
  std::ifstream in(file);
  if (!in)
    throw InputError(fmt::format("{}: no such file: expected the folder of a run", file.string()));
  Json record = Json::parse(in, nullptr, /*allow_exceptions=*/false);
  if (!record.is_object() || !record.contains("scene") ||
      !record.value("scene_file", Json()).is_string())
    throw InputError(fmt::format("{}: is not the record of a run", file.string()));
  if (!record["scene"].is_object() || !record["scene"].contains("rigid_body_problem"))
    throw InputError(fmt::format(
        "{}: scene: is none of rigid-ipc's, with a rigid_body_problem: sim.json is for these",
        file.string()));
  return record;
}

}  // namespace

int convert_run(const fs::path& folder, const fs::path& out) {
  const Json record = run_record_of(folder);
  const fs::path file = record["scene_file"].get<std::string>();
  std::error_code error;
  if (!fs::is_regular_file(file, error))
    throw InputError(
        fmt::format("{}: scene_file: there is no {} from here: its meshes are looked for beside it",
                    (folder / "run.json").string(), file.string()));
  const Scene scene = parse_scene(record["scene"].dump(), file.string(), file.parent_path());
  const FrameReader frames(folder / "frames.vtkhdf");
  const std::vector<StepReport> steps =
      read_steps_csv(folder / "steps.csv", dynamics_card(scene.dynamics.type).report);
  try {
    write_ipc_states(out, {scene, record["scene"], frames, steps,
                           record.value("peak_memory_bytes", std::uint64_t{0})});
  } catch (const InputError& fault) {
    throw InputError(fmt::format("{}: {}", folder.string(), fault.what()));
  }
  fmt::print("{}: {} states of {} bodies\n", out.string(), frames.times().size(),
             frames.body_count());
  return 0;
}

}  // namespace scree
