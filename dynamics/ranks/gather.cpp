#include "dynamics/ranks/gather.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <variant>

#include "host/error.h"

namespace scree {
namespace {

constexpr std::size_t kMostSamples = 200'000;

/// Every stride-th place, so that there are not too many.
std::vector<WorkSample> sampled(std::vector<WorkSample> all) {
  const std::size_t stride = all.size() / kMostSamples + 1;
  if (stride == 1) return all;
  std::vector<WorkSample> some;
  for (std::size_t i = 0; i < all.size(); i += stride) some.push_back(all[i]);
  return some;
}

void add_samples(const std::vector<BodyDescription>& bodies, const std::vector<ParticleSet>& sets,
                 std::vector<WorkSample>& samples) {
  for (const BodyDescription& body : bodies)
    if (body.kind == BodyKind::free) samples.push_back({body.position});
  for (const ParticleSet& set : sets)
    for (const Vec3d& x : set.position) samples.push_back({x});
}

/// State of a body on its way.
struct StateRow {
  std::int32_t id = 0;
  Vec3d position;
  Quatd orientation;
  Vec3d velocity, angular_velocity;
};

template <class T>
std::vector<T> as_rows(const Bytes& bytes) {
  std::vector<T> rows(bytes.size() / sizeof(T));
  if (!rows.empty())
    std::memcpy(static_cast<void*>(rows.data()), bytes.data(), rows.size() * sizeof(T));
  return rows;
}

template <class T>
Bytes as_bytes(const std::vector<T>& rows) {
  const auto* first = reinterpret_cast<const unsigned char*>(rows.data());
  return Bytes(first, first + rows.size() * sizeof(T));
}

/// The rows with these numbers, in groups of neighbors.
template <class T>
std::vector<T> chosen(const std::vector<T>& values, const std::vector<std::size_t>& rows,
                      std::size_t group) {
  std::vector<T> some;
  if (values.empty()) return some;
  some.reserve(rows.size() * group);
  for (const std::size_t row : rows)
    for (std::size_t v = 0; v < group; ++v) some.push_back(values[row * group + v]);
  return some;
}

/// Adds the rows of every array whose name begins so to another state.
void choose(const WorldState& from, const std::string& prefix, std::size_t count,
            const std::vector<std::size_t>& rows, WorldState& to) {
  for (const StateArray& array : from.arrays) {
    if (!array.name.starts_with(prefix)) continue;
    std::visit(
        [&](const auto& values) {
          const std::size_t group = count > 0 ? std::max<std::size_t>(values.size() / count, 1) : 1;
          to.add(array.name, chosen(values, rows, group));
        },
        array.values);
  }
}

}  // namespace

std::vector<WorkSample> work_samples(const Scene& scene) {
  std::vector<WorkSample> samples;
  add_samples(scene.bodies, scene.particles, samples);
  if (samples.empty())
    for (const Insertion& insertion : scene.insertions)
      add_samples(insertion.bodies, insertion.particles, samples);
  return sampled(std::move(samples));
}

std::vector<WorkSample> work_samples(const std::vector<Vec3d>& positions) {
  std::vector<WorkSample> samples;
  samples.reserve(positions.size());
  for (const Vec3d& x : positions) samples.push_back({x});
  return sampled(std::move(samples));
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
    std::visit(
        [&](const auto& values) {
          using T = typename std::decay_t<decltype(values)>::value_type;
          std::vector<T> rows;
          for (const Bytes& of_rank : gather_bytes(ranks, as_bytes(values))) {
            const std::vector<T> more = as_rows<T>(of_rank);
            rows.insert(rows.end(), more.begin(), more.end());
          }
          all.add(array.name, std::move(rows));
        },
        array.values);
  return all;
}

void add_array(Ranks& ranks, const char* name, WorldState& state) {
  std::vector<Vec3d>& sums = state.at<Vec3d>(name);
  const std::vector<Bytes> all = gather_bytes(ranks, as_bytes(sums));
  std::fill(sums.begin(), sums.end(), Vec3d{});
  for (const Bytes& of_rank : all) {
    const std::vector<Vec3d> rows = as_rows<Vec3d>(of_rank);
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += rows[k];
  }
}

WorldState shared_part(const WorldState& state, const std::function<bool(const Vec3d&)>& owns) {
  const auto& id = state.at<std::int32_t>("body/id");
  const auto& x = state.at<Vec3d>("body/position");
  const std::int32_t id_end = id.empty() ? 0 : *std::max_element(id.begin(), id.end()) + 1;
  std::vector<std::uint8_t> is_own(static_cast<std::size_t>(id_end), 0);
  std::vector<std::size_t> bodies;
  for (std::size_t i = 0; i < id.size(); ++i) {
    if (!owns(x[i])) continue;
    bodies.push_back(i);
    is_own[static_cast<std::size_t>(id[i])] = 1;
  }
  const auto is_own_id = [&](std::int32_t body) {
    return body >= 0 && body < id_end && is_own[static_cast<std::size_t>(body)] != 0;
  };
  const auto& a = state.at<std::int32_t>("contact/body_a");
  const auto& b = state.at<std::int32_t>("contact/body_b");
  std::vector<std::size_t> contacts;
  for (std::size_t c = 0; c < std::min(a.size(), b.size()); ++c)
    if (is_own_id(a[c]) || is_own_id(b[c])) contacts.push_back(c);
  WorldState part;
  choose(state, "body/", id.size(), bodies, part);
  choose(state, "contact/", a.size(), contacts, part);
  return part;
}

WorldState contacts_of(const WorldState& state) {
  WorldState contacts;
  for (const StateArray& array : state.arrays)
    if (array.name.starts_with("contact/")) contacts.arrays.push_back(array);
  return contacts;
}

void require_rows(const WorldState& state, std::size_t bodies, std::size_t vectors) {
  const auto require = [](const char* name, std::size_t found, std::size_t expected) {
    if (found != expected)
      throw InputError(std::string("checkpoint: ") + name + " has " + std::to_string(found) +
                       " rows, expected " + std::to_string(expected));
  };
  require("body/position", state.at<Vec3d>("body/position").size(), bodies);
  require("body/orientation", state.at<Quatd>("body/orientation").size(), bodies);
  require("body/velocity", state.at<Vec3d>("body/velocity").size(), bodies);
  require("body/angular_velocity", state.at<Vec3d>("body/angular_velocity").size(), bodies);
  const std::size_t contacts = state.at<std::int32_t>("contact/body_a").size();
  require("contact/body_b", state.at<std::int32_t>("contact/body_b").size(), contacts);
  require("contact/feature", state.at<std::uint64_t>("contact/feature").size(), contacts);
  require("contact/impulse", state.at<Vec3d>("contact/impulse").size(), contacts * vectors);
  const std::size_t marks = state.at<std::int32_t>("contact/mark").size();
  if (marks > 0) require("contact/mark", marks, contacts);
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

void add_report(Ranks& ranks, std::int64_t own_ghosts, double own_max, StepReport& report) {
  struct Part {
    std::int64_t bodies = 0, ghosts = 0;
    double max = 0;
    std::int32_t body_a = -1, body_b = -1;
  };
  Part worst;
  std::int64_t bodies = 0, ghosts = 0, most = 0;
  for (const Part& part :
       gather(ranks, Part{report.body_count, own_ghosts, own_max, report.residual_max_body_a,
                          report.residual_max_body_b})) {
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
}

}  // namespace scree
