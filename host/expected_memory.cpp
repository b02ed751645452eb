#include <fmt/format.h>

#include "host/error.h"
#include "host/scene_summary.h"
#include "host/world.h"

namespace scree {
namespace {

/// Contacts a sphere has in a dense bed, listed ones that do not touch included.
constexpr double kContactsPerBody = 3.2;
/// Entries a sphere has there in the list of near pairs, with the default skin.
constexpr double kPairsPerBody = 5;

double bytes_per_body(const SceneSummary& s, const WorldOptions& options) {
  const double real = options.precision == Precision::double_precision ? 8 : 4;
  const double vec = 3 * real, twist = 6 * real;
  const bool radial = s.layout == ContactLayout::radial;
  const double vectors = vectors_per_contact(s.layout);
  // Per body: state (position 24, orientation, rates, mass, inertia, radius, five integers), bins
  // 56 and their sort space, list of near pairs, free velocity, inertia, four solver velocities,
  // starts of the contact lists.
  const double inertia = radial ? 2 * real : 16 * real;
  const double pairs = 24 + 4 * kPairsPerBody;
  const double body = 24 + 4 * real + 2 * vec + real + vec + real + 14 + 56 + 12 + pairs + twist +
                      inertia + 4 * twist + 8;
  // Per contact: key, ids, normal, gap and kept key; arms; bias; kept impulse, present one and
  // three of the solver; list of contacts as B with its sort space.
  const double contact =
      8 + 8 + vec + real + 8 + (radial ? 0 : 2 * vec) + real + 5 * vectors * vec + 8 + 24;
  return body + kContactsPerBody * contact;
}

double body_count(const SceneSummary& s) {
  return static_cast<double>(s.free_capacity) + static_cast<double>(s.fixed_count);
}

}  // namespace

std::size_t expected_memory(const Scene& scene, const WorldOptions& options) {
  const SceneSummary s = summarize(scene);
  return static_cast<std::size_t>(body_count(s) * bytes_per_body(s, options));
}

void require_memory(const Scene& scene, const WorldOptions& options) {
  const SceneSummary s = summarize(scene);
  const double bodies = body_count(s);
  const double needed = bodies * bytes_per_body(s, options);
  const double there = static_cast<double>(device_info(options.backend).memory_bytes);
  if (needed <= there) return;
  const double mib = 1024.0 * 1024.0;
  throw InputError(fmt::format(
      "{} bodies need about {:.0f} MiB of {} memory, there are {:.0f} MiB: about {:.0f} bodies "
      "fit",
      bodies, needed / mib, options.backend == BackendKind::cuda ? "device" : "host", there / mib,
      bodies * there / needed));
}

}  // namespace scree
