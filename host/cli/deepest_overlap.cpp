#include "host/cli/deepest_overlap.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "host/scene/body_name.h"

namespace scree {
namespace {

constexpr double kDeep = 0.1;  // of the thinner body, from which on users are told
constexpr std::int64_t kMostContacts = 2'000'000;  // that are copied to find the two bodies

}  // namespace

void DeepestOverlap::note(const World& world, const StepReport& report) {
  const bool is_first = report.step == 1;
  const std::int64_t before = std::exchange(body_count_, report.body_count);
  if (!(report.max_penetration > least_)) return;
  least_ = 1.5 * report.max_penetration;
  if (is_first || report.contact_count > kMostContacts) return;
  const Overlaps found = overlaps_among(world.contacts(), world.constants());
  if (found.fraction <= std::max(kDeep, deepest_.fraction)) return;
  deepest_ = found;
  step_ = report.step;
  time_ = report.time;
  has_joined_ = before >= 0 && report.body_count > before;
}

std::string DeepestOverlap::warning(const BodyConstants& bodies) const {
  if (deepest_.pairs == 0) return {};
  const char* const reason =
      has_joined_ ? "particles joined in this step, where other bodies were: a region that "
                    "particles come into has to be free of bodies by then"
                  : "they go too far in a step, or steps end before they are solved; a smaller "
                    "time step keeps them apart";
  return fmt::format(
      "{} (id {}) and {} (id {}) overlap by {:.3g} m in step {} at {:.6g} s, {:.3g} % of the "
      "thickness of the thinner one: {}",
      body_name(bodies, deepest_.body_a), deepest_.body_a, body_name(bodies, deepest_.body_b),
      deepest_.body_b, deepest_.depth, step_, time_, 100 * deepest_.fraction, reason);
}

}  // namespace scree
