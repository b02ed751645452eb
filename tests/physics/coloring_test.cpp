// Colors of the parallel Gauss-Seidel solver, carried from step to step through a settling bed.
// They are read from saved states, where they are the marks of the contacts.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "host/state_hash.h"
#include "tests/physics/scene_builder.h"

namespace scree::physics {
namespace {

/// Spheres fall into a tank, and more are inserted while they settle.
Scene settling_bed() {
  Scene scene = empty_scene(1e-3, 0.4);
  scene.solver = SolverSettings{};
  scene.solver.name = "gauss_seidel_colored";
  scene.solver.stop.level = StopRule::Level::preview;
  add_lattice(scene, 1000, 10, 10, {-0.05, -0.05, 0.005}, 0.0101, 0.005, 2500, 4);
  for (BodyDescription& body : scene.bodies) body.velocity = {0, 0, -0.5};
  add_tank(scene, -0.057, 0.05, -0.057, 0.05);
  for (int k = 0; k < 2; ++k) {
    Scene batch;
    add_lattice(batch, 100, 10, 10, {-0.05, -0.05, 0.16}, 0.0106, 0.005, 2500, 50 + k);
    for (BodyDescription& body : batch.bodies) body.velocity = {0, 0, -1};
    scene.insertions.push_back({0.040 + 0.021 * k, batch.bodies});
  }
  return scene;
}

/// A body's id and what it touches: the other body's id, or a part of a wall above all ids.
using Touch = std::pair<std::uint64_t, std::uint64_t>;

std::map<Touch, int> colors_of(const WorldState& s) {
  const auto& body_a = s.at<std::int32_t>("contact/body_a");
  const auto& body_b = s.at<std::int32_t>("contact/body_b");
  const auto& feature = s.at<std::uint64_t>("contact/feature");
  const auto& mark = s.at<std::int32_t>("contact/mark");
  EXPECT_EQ(mark.size(), body_a.size());
  std::map<Touch, int> colors;
  for (std::size_t c = 0; c < mark.size(); ++c) {
    const auto a = static_cast<std::uint64_t>(body_a[c]);
    const auto b = body_b[c] >= 0 ? static_cast<std::uint64_t>(body_b[c]) : feature[c] + (1u << 20);
    colors[std::minmax(a, b)] = mark[c];
  }
  return colors;
}

bool is_valid(const std::map<Touch, int>& colors) {
  std::set<std::pair<std::uint64_t, int>> taken;
  for (const auto& [touch, color] : colors) {
    if (color < 0 || !taken.insert({touch.first, color}).second) return false;
    if (touch.second < 1u << 20 && !taken.insert({touch.second, color}).second) return false;
  }
  return true;
}

int count_of(const std::map<Touch, int>& colors) {
  int count = 0;
  for (const auto& [touch, color] : colors) count = std::max(count, color + 1);
  return count;
}

double share_kept(const std::map<Touch, int>& before, const std::map<Touch, int>& after) {
  double kept = 0;
  for (const auto& [touch, color] : after) {
    const auto last = before.find(touch);
    kept += last != before.end() && last->second == color;
  }
  return kept / static_cast<double>(after.size());
}

TEST(CarriedColors, StayValidFewAndMostlyTheSameInASettlingBed) {
  const Scene scene = settling_bed();
  const auto options = [](int threads) {
    return cpu_options(threads, Precision::single_precision);
  };
  World world(scene, options(1)), two_threads(scene, options(2)), fresh(scene, options(1));
  std::map<Touch, int> before;
  double settled_share = 1;
  int most = 0, most_fresh = 0, applications = 0, fresh_applications = 0;
  for (int step = 0; step < 200; ++step) {
    // The same step with all contacts colored from scratch.
    const bool compare = step % 8 == 7;
    if (compare) {
      WorldState state = world.save();
      state.at<std::int32_t>("contact/mark").clear();
      fresh.restore(state);
      fresh_applications += fresh.step().applications;
      most_fresh = std::max(most_fresh, count_of(colors_of(fresh.save())));
    }
    const StepReport report = world.step();
    two_threads.step();
    ASSERT_EQ(state_hash(world.states()), state_hash(two_threads.states())) << "step " << step;
    const std::map<Touch, int> colors = colors_of(world.save());
    ASSERT_TRUE(is_valid(colors)) << "step " << step;
    if (compare) {
      applications += report.applications;
      most = std::max(most, count_of(colors));
    }
    if (step >= 140) settled_share = std::min(settled_share, share_kept(before, colors));
    before = colors;
  }
  EXPECT_GT(before.size(), 2400u);
  EXPECT_GT(settled_share, 0.9);  // step 192 sorts the bodies again
  EXPECT_LE(most, most_fresh + 2);
  EXPECT_NEAR(applications, fresh_applications, 0.1 * fresh_applications);
  RecordProperty("colors", most);
  RecordProperty("colors_from_scratch", most_fresh);
  RecordProperty("applications", applications);
  RecordProperty("applications_from_scratch", fresh_applications);
  RecordProperty("smallest_share_kept", std::to_string(settled_share));
}

}  // namespace
}  // namespace scree::physics
