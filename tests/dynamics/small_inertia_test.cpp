// Grains far below a millimeter: the products of their moments of inertia are smaller than any
// number of single precision.

#include <gtest/gtest.h>

#include <cmath>

#include "host/world.h"
#include "kernels/math/sym3.h"
#include "shapes/container.h"

namespace scree {
namespace {

/// Diagonal and tilted moments from those of dust to those of moons, against the definition.
TEST(InverseOnAxes, HoldsAtEveryScale) {
  const Quat<float> turn(Quat<double>(exp_map(Vec3<double>{0.3, -0.8, 0.5})));
  for (float scale = 1e-30f; scale < 1e31f; scale *= 1e3f)
    for (const unsigned free : {7u, 3u, 5u, 6u}) {
      const Sym3<float> m = rotated_diagonal(turn, Vec3<float>{1 * scale, 2 * scale, 4 * scale});
      const Sym3<float> inverse = inverse_on_axes(m, free);
      for (int k = 0; k < 3; ++k) {
        if ((free >> k & 1) == 0) continue;
        Vec3<float> axis;
        axis[k] = 1;
        const Vec3<float> there = inverse * axis;
        const Vec3<float> back = m * there;
        for (int j = 0; j < 3; ++j)
          if ((free >> j & 1) != 0) {
            EXPECT_NEAR(back[j], axis[j], 3e-6) << scale << " " << free;
          }
      }
    }
}

/// Sand in a box that turns: the layout of contacts is the general one.
Scene turning_sand(double radius) {
  Scene scene;
  scene.stepping.time_step = 1e-4;
  scene.solver.max_iterations = 2000;
  BodyDescription box;
  box.kind = BodyKind::kinematic;
  box.shape.kind = shapes::Container::kind;
  box.shape.half_extents = radius * Vec3d{5, 5, 5};
  Motion motion;
  motion.kind = Motion::Kind::rotating;
  motion.axis = {0, 1, 0};
  motion.rate = 30;
  box.motion = motion;
  scene.bodies.push_back(box);
  ParticleSet sand;
  for (int i = 0; i < 27; ++i)
    sand.position.push_back(radius * Vec3d{2.2 * (i % 3) - 2.2 + 0.1 * (i / 9),
                                           2.2 * (i / 3 % 3) - 2.2, 2.2 * (i / 9) - 3.9});
  sand.radius = radius;
  sand.density = 2600.0;
  scene.particles.push_back(sand);
  return scene;
}

TEST(SmallGrains, RollInFloatAsInDouble) {
  const auto energy = [](Precision precision) {
    World world(turning_sand(1e-4), {BackendKind::cpu, precision, 1, 0});
    StepReport report;
    for (int i = 0; i < 40; ++i) report = world.step();
    EXPECT_TRUE(report.converged);
    EXPECT_GT(report.contact_count, 20);
    return report.kinetic_energy;
  };
  const double in_double = energy(Precision::double_precision);
  EXPECT_GT(in_double, 0);
  EXPECT_NEAR(energy(Precision::single_precision), in_double, 0.1 * in_double);
}

}  // namespace
}  // namespace scree
