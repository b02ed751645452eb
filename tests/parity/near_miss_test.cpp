// Spheres that pass each other closely, at ways of a step that are not small beside their size. On
// every backend there is.

#include <cmath>

#include "tests/parity/parity.h"

namespace scree::parity {
namespace {

class NearMiss : public ::testing::TestWithParam<std::tuple<BackendKind, Precision>> {
 protected:
  void SetUp() override {
    std::string reason;
    if (!backend_available(backend(), &reason)) GTEST_SKIP() << "no such backend: " << reason;
  }
  BackendKind backend() const { return std::get<0>(GetParam()); }
  bool is_single() const { return std::get<1>(GetParam()) == Precision::single_precision; }
  double tolerance() const { return is_single() ? 1e-5 : 1e-9; }

  /// Two spheres of diameter 1, the second at rest; the first passes or meets it.
  /// @param offset  of its way from the center of the second [m]
  /// @param way     in a step [m]
  /// @param phase   part of a step by which it starts later
  BodyStates after(double offset, double way, double phase, double restitution, bool is_fixed) {
    Scene scene = empty_scene(0.01, 0);
    scene.gravity = {};
    scene.materials[0].restitution = restitution;
    scene.stepping.restitution_threshold = 0;
    solve_to(scene, is_single() ? 1e-5 : 1e-10);
    add_sphere(scene, {-2 - phase * way, offset, 0}, 0.5, 1).velocity = {way / 0.01, 0, 0};
    add_sphere(scene, {0, 0, 0}, 0.5, 1);
    if (is_fixed) {
      scene.bodies.back().kind = BodyKind::fixed;
      scene.bodies.back().mass = 0;
      scene.bodies.back().inertia = {};
    }
    World w = world_on(backend(), scene, std::get<1>(GetParam()));
    for (int k = 0; k < static_cast<int>(4 / way) + 3; ++k) w.step();
    return w.states();
  }
};
INSTANTIATE_TEST_SUITE_P(All, NearMiss,
                         ::testing::Combine(::testing::ValuesIn(kBackends),
                                            ::testing::ValuesIn(kPrecisions)),
                         [](const auto& info) {
                           return std::string(name_of(std::get<0>(info.param))) + "_" +
                                  name_of(std::get<1>(info.param));
                         });

TEST_P(NearMiss, WhatMissesIsNotDeflected) {
  for (const double way : {0.05, 0.2, 0.7, 3.0}) {
    for (const double offset : {1.001, 1.015, 1.1}) {
      for (int phase = 0; phase < 10; ++phase) {
        for (const double restitution : {0.0, 1.0}) {
          const auto v = after(offset, way, 0.1 * phase, restitution, phase % 3 == 0).velocity;
          EXPECT_NEAR(norm(v[0] - Vec3d{100 * way, 0, 0}), 0, 100 * way * tolerance())
              << "way " << way << " offset " << offset << " phase " << phase;
          EXPECT_NEAR(norm(v[1]), 0, 100 * way * tolerance());
        }
      }
    }
  }
}

TEST_P(NearMiss, WhatMissesABoxIsNotDeflected) {
  // Straight across an edge, and askew to it.
  for (const double askew : {0.0, 0.6}) {
    for (const double way : {0.05, 0.2, 0.5, 3.0}) {
      for (const double offset : {0.501, 0.515, 0.6, 0.49}) {
        for (int phase = 0; phase < 10; ++phase) {
          Scene scene = empty_scene(0.01, 0);
          scene.gravity = {};
          scene.materials[0].restitution = phase % 2;
          solve_to(scene, is_single() ? 1e-5 : 1e-10);
          add_wall_box(scene, {-4, 3, -4}, {4, 4, 4});
          const Vec3d slope = normalized(Vec3d{1, 0, -1}), out = normalized(Vec3d{1, 0, 1});
          const Vec3d along = normalized(slope + askew * Vec3d{0, 1, 0});
          add_sphere(scene, offset * out - (2 + phase * 0.1 * way) * along, 0.5, 1).velocity =
              (way / 0.01) * along;
          World w = world_on(backend(), scene, std::get<1>(GetParam()));
          for (int k = 0; k < static_cast<int>(4 / way) + 3; ++k) w.step();
          const double turned = norm(w.states().velocity[1] - (way / 0.01) * along);
          if (offset > 0.5) {
            EXPECT_LT(turned, 100 * way * tolerance())
                << "way " << way << " offset " << offset << " phase " << phase;
          } else {
            EXPECT_GT(turned, 0.01 * way) << "way " << way << " phase " << phase;
          }
        }
      }
    }
  }
}

TEST_P(NearMiss, WhatMeetsIsDeflected) {
  for (const double offset : {0.0, 0.5, 0.9, 0.98}) {
    const auto v = after(offset, 0.2, 0.3, 1, false).velocity;
    EXPECT_GT(v[1].x, 0);
    EXPECT_LE(v[1].y, 0);
    EXPECT_NEAR(v[0].x + v[1].x, 20, 20 * tolerance());
    EXPECT_NEAR(norm2(v[0]) + norm2(v[1]), 400, 400 * 2 * tolerance());
  }
}

}  // namespace
}  // namespace scree::parity
