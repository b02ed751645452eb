// Bodies far heavier than those they rest on: steps end at the residual asked for,
// with default settings.

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/physics/scene_builder.h"

namespace scree::physics {
namespace {

/// Steps that ended at the tolerance, and their mean number of passes.
struct Ending {
  int steps = 0, converged = 0;
  double passes = 0, worst = 0;
  double share() const { return static_cast<double>(converged) / steps; }
};

Ending run(const Scene& scene, double duration) {
  World world(scene, cpu_options(1, Precision::single_precision));
  Ending e;
  for (int k = steps_for(scene, duration); k > 0; --k) {
    const StepReport report = world.step();
    ++e.steps;
    e.converged += report.converged;
    e.passes += report.applications;
    e.worst = std::max(e.worst, report.residual_relative);
  }
  e.passes /= e.steps;
  return e;
}

/// One light sphere carries a heavy one: both impulses in closed form, from no guess.
TEST(HeavyBodies, LightSphereUnderAHeavyOne) {
  Scene scene;
  scene.stepping.time_step = 1e-3;
  add_plane(scene);
  const double light = 1e-3, heavy = 1e3, impulse = kGravity * scene.stepping.time_step;
  add_sphere(scene, {0, 0, 0.01}, 0.01, light);
  const int light_id = last_id(scene);
  add_sphere(scene, {0, 0, 0.12}, 0.1, heavy);
  World world = reference_world(scene);
  const StepReport report = world.step();
  EXPECT_TRUE(report.converged) << report.residual_relative << " v*";
  EXPECT_NEAR(normal_impulse(world, last_id(scene)), heavy * impulse, 0.02 * heavy * impulse);
  EXPECT_NEAR(normal_impulse(world, light_id), (2 * heavy + light) * impulse,
              0.04 * heavy * impulse);
}

/// A thousand grains of `pile` in a box, and a plate of 5 kg that is laid on them at 0.4 s.
TEST(HeavyBodies, PlateOnAThousandGrains) {
  Scene scene;
  scene.stepping.time_step = 1e-3;
  scene.materials[0].friction = 0.4;
  add_tank(scene, -0.1, 0.1, -0.1, 0.1);
  add_lattice(scene, 1000, 8, 8, {-0.0875, -0.0875, 0.0125}, 0.025, 0.01, 2500, 1);
  {
    World grains(scene, cpu_options(1, Precision::single_precision));
    run_for(grains, scene, 0.4);
    const auto at_rest = grains.states().position;
    for (std::size_t i = 0; i < at_rest.size(); ++i) scene.bodies[i].position = at_rest[i];
  }
  double top = 0;
  for (const BodyDescription& body : scene.bodies) top = std::max(top, body.position.z);
  add_box(scene, {0, 0, top + 0.025}, {0.098, 0.098, 0.01}, 5);
  const Ending e = run(scene, 0.3);
  EXPECT_GE(e.share(), 0.95) << e.passes << " passes, " << e.worst << " v*";
  EXPECT_LT(e.passes, 200);
}

/// A sphere of a million times the mass sinks into 243 that lie on a floor.
TEST(HeavyBodies, MillionTimesTheMassOn243Spheres) {
  Scene scene;
  scene.stepping.time_step = 1e-3;
  scene.materials[0].friction = 0.5;
  add_plane(scene);
  add_lattice(scene, 243, 9, 9, {-0.04, -0.04, 0.005}, 0.01, 0.005, 2500, 1);
  const double light = scene.bodies.back().mass;
  add_sphere(scene, {0.003, 0.001, 0.0605}, 0.03, 1e6 * light);
  const Ending e = run(scene, 0.4);
  EXPECT_GE(e.share(), 0.95) << e.passes << " passes, " << e.worst << " v*";
}

}  // namespace
}  // namespace scree::physics
