// Coulomb's law itself while a bed of grains lands, with the settings of a scene that says nothing
// of its solver: steps end at the residual asked for, whatever the friction is.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "host/scene/bed_scene.h"
#include "tests/physics/scene_builder.h"

namespace scree::physics {
namespace {

/// In the first half the grains gather speed, in the second they meet. With high friction
/// single steps may end above the tolerance: grains in the edges of the box jam where
/// they overlap both walls.
TEST(LandingBed, ExactStepsConvergeAtAnyFriction) {
  constexpr int kSteps = 30;
  for (const double mu : {1.0, 2.0, 5.0, 10.0}) {
    const std::string friction = "materials.grain.friction=" + std::to_string(mu);
    World world(bed_scene({.count = 1000, .layers = 10}, {"solver.model=exact", friction}),
                cpu_options(1, Precision::single_precision));
    int converged = 0;
    double passes = 0, worst = 0;
    for (int k = 0; k < kSteps; ++k) {
      const StepReport report = world.step();
      converged += report.converged;
      passes += report.applications;
      worst = std::max(worst, report.exact_residual_rms);
    }
    passes /= kSteps;
    EXPECT_GE(converged, 27) << mu << ": " << passes << " passes, residual " << worst << " m/s";
    EXPECT_LT(passes, 2000) << mu;
  }
}

}  // namespace
}  // namespace scree::physics
