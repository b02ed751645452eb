// Saved states name bodies and contacts by ids, so a run may store its bodies in another order.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <random>

#include "host/error.h"
#include "host/state_hash.h"
#include "tests/physics/scene_builder.h"

namespace scree {
namespace {

using physics::cpu_options;
using testing::HasSubstr;

/// Spheres of two sizes in a tank, on which a fixed sphere and a fixed box stand.
Scene bed() {
  Scene scene = physics::empty_scene(1e-3, 0.4);
  physics::solve_to(scene, 1e-9);
  physics::add_lattice(scene, 150, 5, 5, {-0.02, -0.02, 0.0305}, 0.0101, 0.005, 2500, 3);
  physics::add_tank(scene, -0.0255, 0.0255, -0.0255, 0.0255);
  physics::add_wall_box(scene, {0, 0, 0.005}, {0.01, 0.01, 0.005});
  physics::add_sphere(scene, {0.018, 0.018, 0.02}, 0.006, 1).kind = BodyKind::fixed;
  return scene;
}

/// Spheres and a box among them: contacts of both groups.
Scene mixed() {
  Scene scene = bed();
  physics::add_box(scene, {0, 0, 0.024}, {0.006, 0.005, 0.004}, 1e-3);
  return scene;
}

/// Boxes on boxes, whose contacts have features.
Scene boxes() {
  Scene scene = physics::empty_scene(1e-3, 0.4);
  physics::solve_to(scene, 1e-9);
  for (int k = 0; k < 4; ++k)
    physics::add_box(scene, {0.01 * k, 0, 0.1 * (k + 0.5)}, {0.05, 0.05, 0.05}, 1);
  physics::add_plane(scene);
  return scene;
}

template <class T>
void permute(std::vector<T>& rows, const std::vector<std::size_t>& order) {
  if (rows.empty()) return;
  const std::size_t width = rows.size() / order.size();
  std::vector<T> moved;
  for (const std::size_t row : order)
    for (std::size_t k = 0; k < width; ++k) moved.push_back(rows[row * width + k]);
  rows = std::move(moved);
}

std::vector<std::size_t> random_order(std::size_t count, unsigned seed) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), std::mt19937(seed));
  return order;
}

/// The same state with the rows of bodies and of contacts in another order.
WorldState reordered(const WorldState& s) {
  WorldState other = s;
  const auto bodies = random_order(s.at<std::int32_t>("body/id").size(), 5);
  const auto contacts = random_order(s.at<std::int32_t>("contact/body_a").size(), 6);
  for (StateArray& array : other.arrays)
    std::visit(
        [&](auto& rows) {
          if (array.name.starts_with("body/")) permute(rows, bodies);
          if (array.name.starts_with("contact/")) permute(rows, contacts);
        },
        array.values);
  return other;
}

/// Impulses by names that do not depend on the order: on the body with the higher id, or by a wall.
using Name = std::array<std::int64_t, 3>;
std::map<Name, Vec3d> impulses(const WorldState& s) {
  const auto& a = s.at<std::int32_t>("contact/body_a");
  const auto& b = s.at<std::int32_t>("contact/body_b");
  const auto& feature = s.at<std::uint64_t>("contact/feature");
  const auto& impulse = s.at<Vec3d>("contact/impulse");
  std::map<Name, Vec3d> all;
  for (std::size_t c = 0; c < a.size(); ++c) {
    const bool turned = b[c] >= 0 && b[c] < a[c];
    all[{turned ? b[c] : a[c], turned ? a[c] : b[c], static_cast<std::int64_t>(feature[c])}] =
        turned ? -impulse[c] : impulse[c];
  }
  EXPECT_EQ(all.size(), a.size()) << "names are not unique";
  return all;
}

TEST(SavedState, NamesContactsAsTheWorldDoes) {
  World world(bed(), cpu_options());
  for (int k = 0; k < 100; ++k) world.step();  // bodies were sorted once
  const WorldState s = world.save();
  std::map<std::pair<int, int>, Vec3d> told;
  for (const ContactRecord& c : world.contacts())
    told[{c.body_a, c.body_b}] = c.impulse;  // of walls too, by the id of their body
  const auto& a = s.at<std::int32_t>("contact/body_a");
  const auto& b = s.at<std::int32_t>("contact/body_b");
  int between_bodies = 0;
  for (std::size_t c = 0; c < a.size(); ++c) {
    if (b[c] < 0) continue;
    ++between_bodies;
    ASSERT_EQ(told.count({a[c], b[c]}), 1u) << a[c] << " and " << b[c];
    // A mean of steps, unless the contact is open or was before.
    const Vec3d last = told.at({a[c], b[c]}), mean = s.at<Vec3d>("contact/impulse")[c];
    EXPECT_EQ(norm(mean) > 0, norm(last) > 0);
    if (norm(last) > 0) {
      EXPECT_GT(dot(mean, last), 0);
    }
  }
  EXPECT_GT(between_bodies, 100);
  EXPECT_LT(between_bodies, static_cast<int>(a.size()));
}

TEST(SavedState, BodiesMayBeStoredInAnotherOrder) {
  for (const Scene& scene : {bed(), mixed(), boxes()}) {
    World world(scene, cpu_options());
    for (int k = 0; k < 70; ++k) world.step();
    const WorldState s = world.save(), other = reordered(s);
    ASSERT_NE(other.at<std::int32_t>("body/id"), s.at<std::int32_t>("body/id"));
    World moved(scene, cpu_options());
    moved.restore(other);
    const WorldState back = moved.save();
    EXPECT_EQ(back.at<std::int32_t>("body/id"), other.at<std::int32_t>("body/id"));
    EXPECT_EQ(impulses(back), impulses(s));
    EXPECT_EQ(state_hash(moved.states()), state_hash(world.states()));
  }
}

TEST(SavedState, ARunGoesOnAlikeInAnotherOrder) {
  const Scene scene = bed();
  Scene rough = scene;
  physics::solve_to(rough, 1e-4);
  World settling(rough, cpu_options());
  for (int k = 0; k < 500; ++k) settling.step();  // the bed comes to rest
  World world(scene, cpu_options());
  world.restore(settling.save());
  for (int k = 0; k < 20; ++k) world.step();
  const WorldState saved = world.save(), moved = reordered(saved);
  WorldState cold = saved;
  for (Vec3d& impulse : cold.at<Vec3d>("contact/impulse")) impulse = {};
  Scene one_iteration = scene;  // its residual tells how good the guess was
  one_iteration.solver.stop.level = StopRule::Level::fixed_iterations;
  one_iteration.solver.max_iterations = 1;
  const auto residual_from = [&](const WorldState& s) {
    World w(one_iteration, cpu_options());
    w.restore(s);
    return w.step().residual_rms;
  };
  const double residual = residual_from(saved);
  EXPECT_NEAR(residual_from(moved), residual, 1e-6 * residual);
  EXPECT_GT(residual_from(cold), 2 * residual) << "the impulses would not matter";

  World other(scene, cpu_options());
  other.restore(moved);
  world.step();
  other.step();
  const BodyStates a = world.states(), b = other.states();
  for (std::size_t id = 0; id < a.velocity.size(); ++id)
    EXPECT_LT(norm(a.velocity[id] - b.velocity[id]), 1e-6) << id;
}

TEST(SavedState, MarksFollowTheirContacts) {
  Scene scene = bed();
  scene.solver.name = "gauss_seidel_colored";
  scene.solver.max_iterations = 50;
  World world(scene, cpu_options());
  for (int k = 0; k < 60; ++k) world.step();
  const auto marks = [](const WorldState& s) {
    std::map<Name, int> all;
    const auto& a = s.at<std::int32_t>("contact/body_a");
    const auto& b = s.at<std::int32_t>("contact/body_b");
    for (std::size_t c = 0; c < a.size(); ++c)
      all[{std::min(a[c], b[c]), std::max(a[c], b[c]),
           static_cast<std::int64_t>(s.at<std::uint64_t>("contact/feature")[c])}] =
          s.at<std::int32_t>("contact/mark").at(c);
    return all;
  };
  const WorldState s = world.save();
  World moved(scene, cpu_options());
  moved.restore(reordered(s));
  EXPECT_GT(marks(s).size(), 100u);
  EXPECT_EQ(marks(moved.save()), marks(s));
}

/// The state as the first version of checkpoints had it: contacts by places of storage.
WorldState of_first_version(const WorldState& s, std::uint64_t body_count) {
  const auto& id = s.at<std::int32_t>("body/id");
  std::map<std::int32_t, std::uint64_t> place;
  for (std::size_t i = 0; i < id.size(); ++i) place[id[i]] = i;
  std::vector<std::uint64_t> key;
  for (std::size_t c = 0; c < s.at<std::int32_t>("contact/body_a").size(); ++c) {
    const std::int32_t b = s.at<std::int32_t>("contact/body_b")[c];
    const std::uint64_t element =
        b >= 0 ? place.at(b) : body_count + s.at<std::uint64_t>("contact/feature")[c];
    key.push_back(place.at(s.at<std::int32_t>("contact/body_a")[c]) << 32 | element);
  }
  WorldState old;
  old.dynamics = s.dynamics;
  old.step = s.step;
  old.time = s.time;
  old.insertions_done = s.insertions_done;
  for (const StateArray& array : s.arrays)
    if (!array.name.starts_with("contact/") || array.name == "contact/impulse")
      old.arrays.push_back(array);
  old.add("contact/key", key);
  return old;
}

TEST(SavedState, ThoseOfTheFirstVersionGoOnBitForBit) {
  Scene scene = bed();
  scene.bodies.pop_back();  // the fixed sphere: every body b is a free one
  World world(scene, cpu_options()), old(scene, cpu_options());
  for (int k = 0; k < 100; ++k) world.step();
  old.restore(of_first_version(world.save(), static_cast<std::uint64_t>(world.body_count())));
  for (int k = 0; k < 10; ++k) {
    const StepReport a = world.step(), b = old.step();
    EXPECT_EQ(a.iterations, b.iterations);
    ASSERT_EQ(state_hash(world.states()), state_hash(old.states())) << k;
  }
}

TEST(SavedState, ContactsOfOtherBodiesAreRefused) {
  const Scene scene = bed();
  World world(scene, cpu_options());
  for (int k = 0; k < 60; ++k) world.step();
  const WorldState good = world.save();
  const auto& a = good.at<std::int32_t>("contact/body_a");
  const auto& b = good.at<std::int32_t>("contact/body_b");
  const auto pair = static_cast<std::size_t>(
      std::find_if(b.begin(), b.end(), [](int body) { return body >= 0; }) - b.begin());
  ASSERT_LT(pair, b.size());
  const int floor = 150, unknown = 1000;
  const auto refusal = [&](auto spoil) {
    WorldState bad = good;
    spoil(bad);
    try {
      world.restore(bad);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("it was taken");
  };
  const std::string which = "contact " + std::to_string(pair);
  for (const int body : {floor, unknown, -1, b[pair]})
    EXPECT_THAT(refusal([&](WorldState& s) { s.at<std::int32_t>("contact/body_a")[pair] = body; }),
                HasSubstr(which))
        << body;
  for (const int body : {unknown, a[pair]})
    EXPECT_THAT(refusal([&](WorldState& s) { s.at<std::int32_t>("contact/body_b")[pair] = body; }),
                HasSubstr(which))
        << body;
  EXPECT_THAT(refusal([&](WorldState& s) { s.at<std::uint64_t>("contact/feature")[pair] = 1; }),
              HasSubstr("feature 1"));
  EXPECT_THAT(refusal([&](WorldState& s) { s.at<Vec3d>("contact/impulse").pop_back(); }),
              HasSubstr("impulses"));
  EXPECT_THAT(refusal([&](WorldState& s) { s.at<std::int32_t>("contact/body_b").pop_back(); }),
              HasSubstr("rows"));
}

}  // namespace
}  // namespace scree
