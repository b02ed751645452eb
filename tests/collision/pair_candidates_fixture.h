#pragma once
// What tests of the list of near pairs have in common.

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "tests/backend_fixture.h"
#include "tests/collision/collision_scene.h"

namespace scree {
namespace {

template <class Real>
class NearPairsTest : public BackendTest<Real> {
 protected:
  using Scene = CollisionScene<Real>;
  using Run = CollisionRun<TestBackend, Real>;

  std::vector<HostContact> fresh_contacts(const Scene& scene) {
    Run run(this->backend(), scene);
    return run.detect();
  }

  static Vec3<double> random_vector(std::mt19937& random) {
    std::uniform_real_distribution<double> uniform(-1, 1);
    return {uniform(random), uniform(random), uniform(random)};
  }

  /// Spheres that overlap here and there, diameters from small to large, on a floor.
  static Scene bed(Index count, double small, double large, unsigned seed) {
    Scene s;
    s.settings.envelope = 0.02 * small;
    s.settings.skin = 0.2 * small;
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (Index i = 0; i < count; ++i) {
      const double size = std::pow(large / small, std::pow(uniform(random), 4));
      s.add_free({uniform(random), uniform(random), 0.3 * uniform(random)}, 0.5 * small * size);
    }
    return s;
  }

  /// Moves the free bodies by h v and turns their velocities a little.
  static void drift(Scene& s, double speed, std::mt19937& random) {
    for (Index i = 0; i < s.owned_count; ++i) {
      auto& v = s.velocity[static_cast<std::size_t>(i)];
      s.position[static_cast<std::size_t>(i)] += s.h * Vec3<double>(v);
      v = Vec3<Real>(0.7 * Vec3<double>(v) + speed * random_vector(random));
    }
  }

  static bool is_ascending(const std::vector<HostContact>& contacts) {
    return std::is_sorted(contacts.begin(), contacts.end(),
                          [](const auto& x, const auto& y) { return x.key < y.key; });
  }

  /// In each step a detector that keeps its list finds what a new one finds; the list has to last
  /// for some steps, and must not for all.
  /// @param speed  of the bodies: per step they move about this times h
  void expect_reuse(Scene s, double speed, int steps = 40,
                    const std::function<void(Scene&, int)>& change = {}) {
    Run run(this->backend(), s);
    std::mt19937 random(99);
    std::size_t contacts = 0;
    for (int k = 0; k < steps; ++k) {
      drift(s, speed, random);
      if (change) change(s, k);
      run.scene() = s;
      run.load();
      const auto found = run.detect();
      ASSERT_EQ(found, fresh_contacts(s)) << "step " << k;
      ASSERT_TRUE(is_ascending(found)) << "step " << k;
      contacts += found.size();
    }
    EXPECT_GT(contacts, 100u * static_cast<unsigned>(steps));
    EXPECT_GT(run.detector().list_builds() + run.detector().list_extensions(), 1);
    EXPECT_LE(run.detector().list_builds(), steps / 2);
  }
};

}  // namespace
}  // namespace scree
