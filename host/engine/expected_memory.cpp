#include "host/engine/expected_memory.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "dynamics/dynamics_card.h"
#include "dynamics/memory_room.h"
#include "host/error.h"
#include "host/scene/scene_summary.h"

namespace scree {
namespace {

std::string in_mib(double bytes) {
  const double mib = bytes / (1024.0 * 1024.0);
  return mib < 100 ? fmt::format("{:.3g} MiB", mib) : fmt::format("{:.0f} MiB", mib);
}

double body_count(const Scene& scene) { return static_cast<double>(count_bodies(scene).all()); }

}  // namespace

double least_bytes_per_body(const Scene& scene, const WorldOptions& options) {
  const DynamicsCard& card = dynamics_card(scene.dynamics.type);
  return (card.least_bytes_per_body != nullptr ? card.least_bytes_per_body : card.bytes_per_body)(
      scene, options);
}

std::size_t expected_memory(const Scene& scene, const WorldOptions& options) {
  const DynamicsCard& card = dynamics_card(scene.dynamics.type);
  return static_cast<std::size_t>(body_count(scene) * card.bytes_per_body(scene, options));
}

void require_memory_for(double all_bodies, double bytes_per_body, const WorldOptions& options) {
  const MemoryRoom room(options);
  const double bodies = room.share * all_bodies;
  const double needed = bodies * bytes_per_body;
  if (needed <= room.free) return;
  const char* where = options.backend == BackendKind::cuda ? "device" : "host";
  const std::string there =
      room.is_limited ? fmt::format("the limit is {}", in_mib(room.free))
                      : fmt::format("{} of {} are free", in_mib(room.free), in_mib(room.all));
  throw InputError(
      fmt::format("{:.0f} bodies{} need about {} of {} memory, {}: about {:.0f} "
                  "bodies fit",
                  bodies, room.share < 1 ? " of this device's ranks" : "", in_mib(needed), where,
                  there, std::floor(room.free / bytes_per_body)));
}

void require_memory(const Scene& scene, const WorldOptions& options) {
  require_memory_for(body_count(scene), least_bytes_per_body(scene, options), options);
}

double bodies_that_fit(const Scene& scene, const WorldOptions& options) {
  return std::floor(MemoryRoom(options).free / least_bytes_per_body(scene, options));
}

}  // namespace scree
