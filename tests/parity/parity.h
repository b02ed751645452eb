#pragma once
// The same scene on two backends in one process.

#include <gtest/gtest.h>

#include "tests/physics/scene_builder.h"

namespace scree::parity {

using namespace scree::physics;

/// Test cases that need both backends; skipped with the reason where CUDA is not there.
class Parity : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string reason;
    if (!backend_available(BackendKind::cuda, &reason))
      GTEST_SKIP() << "no CUDA backend: " << reason;
  }
};

inline World world_on(BackendKind backend, const Scene& scene,
                      Precision precision = Precision::single_precision) {
  WorldOptions options;
  options.backend = backend;
  options.precision = precision;
  return World(scene, options);
}

inline constexpr BackendKind kBackends[] = {BackendKind::cpu, BackendKind::cuda};
inline constexpr Precision kPrecisions[] = {Precision::single_precision,
                                            Precision::double_precision};
inline const char* name_of(BackendKind backend) {
  return backend == BackendKind::cpu ? "cpu" : "cuda";
}
inline const char* name_of(Precision p) {
  return p == Precision::single_precision ? "float" : "double";
}

/// RMS of b - a over the RMS of a, in velocities and surface speeds r w together.
inline double relative_rms(const BodyStates& a, const BodyStates& b, double radius) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < a.velocity.size(); ++i) {
    difference += norm2(a.velocity[i] - b.velocity[i]) +
                  norm2(radius * (a.angular_velocity[i] - b.angular_velocity[i]));
    size += norm2(a.velocity[i]) + norm2(radius * a.angular_velocity[i]);
  }
  return std::sqrt(difference / size);
}

}  // namespace scree::parity
