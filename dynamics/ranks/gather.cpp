#include "dynamics/ranks/gather.h"

#include <algorithm>
#include <limits>
#include <variant>

namespace scree {
namespace {

constexpr std::size_t kMostSamples = 200'000;

/// Calls f with the place of every free body.
template <class F>
void for_each_place(const std::vector<BodyDescription>& bodies,
                    const std::vector<ParticleSet>& sets, const F& f) {
  for (const BodyDescription& body : bodies)
    if (body.kind == BodyKind::free) f(body.position);
  for (const ParticleSet& set : sets)
    for (const Vec3d& x : set.position) f(x);
}

/// Every stride-th place, so that there are not too many, and never a copy of all.
/// @param visit  visit(f) calls f with each place
template <class Visit>
std::vector<WorkSample> sampled(const Visit& visit) {
  std::size_t all = 0;
  visit([&](const Vec3d&) { ++all; });
  const std::size_t stride = all / kMostSamples + 1;
  std::vector<WorkSample> samples;
  samples.reserve(all / stride + 1);
  std::size_t i = 0;
  visit([&](const Vec3d& x) {
    if (i++ % stride == 0) samples.push_back({x});
  });
  return samples;
}

/// State of a body on its way.
struct StateRow {
  std::int32_t id = 0;
  Vec3d position;
  Quatd orientation;
  Vec3d velocity, angular_velocity;
};

}  // namespace

std::vector<WorkSample> work_samples(const Scene& scene) {
  std::vector<WorkSample> samples =
      sampled([&](const auto& f) { for_each_place(scene.bodies, scene.particles, f); });
  if (!samples.empty()) return samples;
  return sampled([&](const auto& f) {
    for (const Insertion& insertion : scene.insertions)
      for_each_place(insertion.bodies, insertion.particles, f);
  });
}

std::vector<WorkSample> work_samples(const std::vector<Vec3d>& positions) {
  return sampled([&](const auto& f) {
    for (const Vec3d& x : positions) f(x);
  });
}

std::int64_t count_free_bodies(const std::vector<BodyDescription>& bodies,
                               const std::vector<ParticleSet>& sets,
                               const std::function<bool(const Vec3d&)>& here) {
  std::int64_t count = 0;
  for_each_place(bodies, sets, [&](const Vec3d& x) { count += here(x) ? 1 : 0; });
  return count;
}

void gather_states(Ranks& ranks, const std::vector<std::int32_t>& owned, BodyStates& states) {
  std::vector<StateRow> rows;
  rows.reserve(owned.size());
  for (const std::int32_t id : owned) {
    const auto i = static_cast<std::size_t>(id);
    rows.push_back({id, states.position[i], states.orientation[i], states.velocity[i],
                    states.angular_velocity[i]});
  }
  gather_rows(ranks, rows);
  if (ranks.rank() != 0) return;
  for (const StateRow& row : rows) {
    const auto i = static_cast<std::size_t>(row.id);
    states.position[i] = row.position;
    states.orientation[i] = row.orientation;
    states.velocity[i] = row.velocity;
    states.angular_velocity[i] = row.angular_velocity;
  }
}

WorldState gather_arrays(Ranks& ranks, const WorldState& own) {
  WorldState all;
  for (const StateArray& array : own.arrays)
    std::visit([&](const auto& values) { all.add(array.name, gather_values(ranks, values)); },
               array.values);
  return all;
}

void add_array(Ranks& ranks, const char* name, WorldState& state) {
  std::vector<Vec3d>& sums = state.at<Vec3d>(name);
  const std::vector<Vec3d> all = gather_values(ranks, sums);
  const std::size_t n = sums.size();
  std::fill(sums.begin(), sums.end(), Vec3d{});
  for (std::size_t k = 0; k < all.size(); ++k) sums[k % n] += all[k];
}

ForceRecord added_over_ranks(Ranks& ranks, const ForceRecord& own) {
  ForceRecord sum;
  for (const ForceRecord& of_rank : gather(ranks, own)) {
    sum.force += of_rank.force;
    sum.torque += of_rank.torque;
  }
  return sum;
}

void add_over_ranks(Ranks& ranks, MeanForces& means) {
  for (std::vector<ForceRecord>* records : {&means.on_bodies, &means.on_groups, &means.on_joints})
    for (ForceRecord& record : *records) record = added_over_ranks(ranks, record);
}

bool add_report(Ranks& ranks, std::int64_t own_ghosts, double own_max, bool is_fine,
                StepReport& report) {
  struct Part {
    std::int64_t bodies = 0, ghosts = 0;
    double max = 0;
    std::int32_t body_a = -1, body_b = -1, joint = -1;
    std::int32_t is_fine = 1;
  };
  Part worst;
  std::int64_t bodies = 0, ghosts = 0, most = 0;
  bool are_fine = true;
  for (const Part& part : gather(
           ranks, Part{report.body_count, own_ghosts, own_max, report.residual_max_body_a,
                       report.residual_max_body_b, report.residual_max_joint, is_fine ? 1 : 0})) {
    are_fine = are_fine && part.is_fine != 0;
    bodies += part.bodies;
    ghosts += part.ghosts;
    most = std::max(most, part.bodies);
    if (part.body_a >= 0 && (worst.body_a < 0 || part.max > worst.max)) worst = part;
  }
  report.body_count =
      static_cast<int>(std::min<std::int64_t>(bodies, std::numeric_limits<int>::max()));
  if (bodies > 0) {
    report.largest_share = static_cast<double>(most * ranks.count()) / static_cast<double>(bodies);
    report.ghost_share = static_cast<double>(ghosts) / static_cast<double>(bodies);
  }
  report.residual_max = worst.max;
  report.residual_max_body_a = worst.body_a;
  report.residual_max_body_b = worst.body_b;
  report.residual_max_joint = worst.joint;
  return are_fine;
}

}  // namespace scree
