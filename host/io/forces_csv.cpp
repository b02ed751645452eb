#include "host/io/forces_csv.h"

#include <fmt/format.h>

#include <charconv>
#include <fstream>
#include <iterator>
#include <map>
#include <utility>

#include "host/error.h"

namespace scree {
namespace {

constexpr const char* kHeader =
    "step,time_s,mean_of_steps,kind,name,force_x_N,force_y_N,force_z_N,torque_x_N_m,torque_y_N_m,"
    "torque_z_N_m";

/// A name as a field of a table (RFC 4180).
std::string field(const std::string& name) {
  if (name.find_first_of(",\"\r\n") == std::string::npos) return name;
  std::string out = "\"";
  for (const char c : name) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

/// Bytes of a file up to the last line of a step; 0: there is nothing to go on with.
std::uint64_t kept_bytes(const std::filesystem::path& path,
                         std::optional<std::int64_t> resume_step) {
  if (!resume_step || !std::filesystem::exists(path)) return 0;
  std::ifstream in(path, std::ios::binary);
  std::string line;
  std::uint64_t kept = 0, offset = 0;
  std::int64_t last = 0;
  for (std::size_t number = 1; std::getline(in, line) && !in.eof(); ++number) {
    offset += line.size() + 1;
    if (number == 1) {
      if (line != kHeader)
        throw InputError(fmt::format("{} line 1: found the columns \"{}\", expected \"{}\"",
                                     path.string(), line, kHeader));
    } else {
      std::int64_t step = 0;
      const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), step);
      if (error != std::errc() || *end != ',' || step < last)
        throw InputError(fmt::format("{} line {}: expected the number of a step from {} on",
                                     path.string(), number, last));
      if (step > *resume_step) break;
      last = step;
    }
    kept = offset;
  }
  return kept;
}

}  // namespace

ForceTargets::ForceTargets(const Scene& scene) {
  std::map<int, std::string> names;
  for (const auto& [name, id] : scene.body_names) names.emplace(id, field(name));
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    const BodyKind kind = scene.bodies[k].kind;
    if (kind == BodyKind::free) continue;
    const auto id = static_cast<int>(k);
    const auto named = names.find(id);
    const int number = scene.bodies[k].entry >= 0 ? scene.bodies[k].entry : id;
    bodies.push_back(fmt::format("{},{}", kind == BodyKind::fixed ? "fixed" : "kinematic",
                                 named == names.end() ? std::to_string(number) : named->second));
  }
  if (scene.groups.size() > 1)
    for (const std::string& name : scene.groups) groups.push_back("group," + field(name));
  for (std::size_t k = 0; k < scene.joints.size(); ++k)
    joints.push_back(fmt::format("joint,{}", k));
}

ForcesCsv::ForcesCsv(std::filesystem::path path, ForceTargets targets,
                     std::optional<std::int64_t> resume_step)
    : targets_(std::move(targets)) {
  const std::uint64_t kept = kept_bytes(path, resume_step);
  file_.emplace(std::move(path), kept, std::string(kHeader) + '\n');
}

void ForcesCsv::append(std::int64_t step, double time, const MeanForces& forces) {
  const std::string start = fmt::format("{},{},{},", step, time, forces.steps);
  append_part(start, targets_.bodies, forces.on_bodies);
  append_part(start, targets_.groups, forces.on_groups);
  append_part(start, targets_.joints, forces.on_joints);
}

void ForcesCsv::append_part(const std::string& start, const std::vector<std::string>& targets,
                            const std::vector<ForceRecord>& forces) {
  for (std::size_t k = 0; k < targets.size(); ++k) {
    const auto& [f, t] = forces[k];
    fmt::format_to(std::back_inserter(file_->pending()), "{}{},{},{},{},{},{},{}\n", start,
                   targets[k], f.x, f.y, f.z, t.x, t.y, t.z);
    file_->line_done();
  }
}

void check_forces_csv(const std::filesystem::path& path, std::int64_t resume_step) {
  kept_bytes(path, resume_step);
}

}  // namespace scree
