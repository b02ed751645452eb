// Several worlds in one process, on one device or on two. On every backend there is.

#include <gmock/gmock.h>

#include "host/error.h"
#include "host/state_hash.h"
#include "tests/parity/parity.h"

namespace scree::parity {
namespace {

using ::testing::HasSubstr;

class Worlds : public ::testing::TestWithParam<std::tuple<BackendKind, Precision>> {
 protected:
  void SetUp() override {
    std::string reason;
    if (!backend_available(backend(), &reason)) GTEST_SKIP() << "no such backend: " << reason;
  }
  static BackendKind backend() { return std::get<0>(GetParam()); }
  /// On the last device of the backend where there are several.
  static WorldOptions options(bool on_last = false) {
    WorldOptions o;
    o.backend = backend();
    o.precision = std::get<1>(GetParam());
    o.threads = 2;
    o.device = on_last ? device_count(backend()) - 1 : 0;
    return o;
  }
};
INSTANTIATE_TEST_SUITE_P(All, Worlds,
                         ::testing::Combine(::testing::ValuesIn(kBackends),
                                            ::testing::ValuesIn(kPrecisions)),
                         [](const auto& info) {
                           return std::string(name_of(std::get<0>(info.param))) + "_" +
                                  name_of(std::get<1>(info.param));
                         });

/// Spheres that fall into a tank: contacts, impacts, and more than one reordering.
Scene falling_spheres(int count, std::uint32_t seed) {
  Scene scene = empty_scene(2e-3, 0.4);
  scene.solver.stop = {};
  scene.solver.max_iterations = 60;
  scene.materials[0].restitution = 0.3;
  add_tank(scene, -0.3, 0.3, -0.3, 0.3);
  add_lattice(scene, count, 5, 5, {-0.24, -0.24, 0.06}, 0.11, 0.05, 2500, seed);
  return scene;
}

constexpr int kSteps = 80;

std::vector<std::uint64_t> hashes_alone(const Scene& scene, const WorldOptions& options) {
  World world(scene, options);
  std::vector<std::uint64_t> hashes;
  for (int k = 0; k < kSteps; ++k) {
    world.step();
    hashes.push_back(state_hash(world.states()));
  }
  return hashes;
}

TEST_P(Worlds, SteppedInTurnHaveTheBitsOfEachAlone) {
  // Different numbers of bodies, so that the two ask for different memory and different launches.
  const Scene first = falling_spheres(150, 1), second = falling_spheres(70, 2);
  const auto alone_first = hashes_alone(first, options());
  const auto alone_second = hashes_alone(second, options(true));
  World a(first, options()), b(second, options(true));
  int contacts = 0;
  for (int k = 0; k < kSteps; ++k) {
    contacts = a.step().contact_count;
    b.step();
    ASSERT_EQ(state_hash(a.states()), alone_first[static_cast<std::size_t>(k)]) << "step " << k;
    ASSERT_EQ(state_hash(b.states()), alone_second[static_cast<std::size_t>(k)]) << "step " << k;
  }
  EXPECT_GT(contacts, 100);
}

TEST_P(Worlds, OneOutlivesTheOther) {
  const Scene scene = falling_spheres(40, 3);
  const auto alone = hashes_alone(scene, options());
  World kept(scene, options());
  for (int k = 0; k < kSteps; ++k) {
    World passing(falling_spheres(20, 4), options(true));
    passing.step();
    kept.step();
    ASSERT_EQ(state_hash(kept.states()), alone[static_cast<std::size_t>(k)]) << "step " << k;
  }
}

TEST_P(Worlds, AMissingDeviceIsRefusedWithThoseThere) {
  WorldOptions missing = options();
  missing.device = 999;
  const char* name = backend() == BackendKind::cuda ? "backend cuda: there is no CUDA device 999"
                                                    : "backend cpu: there is no device 999";
  const std::string there =
      backend() == BackendKind::cuda ? "0 " + device_info(backend(), 0).name : "device 0";
  try {
    const World world(falling_spheres(1, 5), missing);
    FAIL() << "not refused";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr(name));
    EXPECT_THAT(error.what(), HasSubstr(there));
  }
  std::string reason;
  EXPECT_FALSE(backend_available(backend(), &reason, -1));
  EXPECT_THAT(reason, HasSubstr("-1"));
}

}  // namespace
}  // namespace scree::parity
