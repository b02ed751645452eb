#include "bench/energy_curves/elastic_world.h"
#include "host/collision_integrator.h"
#include "host/collision_walls.h"
#include "shapes/sphere.h"

namespace scree::bench {
namespace {

constexpr double kRadius = 0.1;

/// Height of a ball let go at 1 m that bounces elastically.
double exact_height(double time) {
  const double since_apex = std::remainder(time, 2 * std::sqrt(2 / kWeight));
  return 1 - 0.5 * kWeight * since_apex * since_apex;
}

EnergyTrace variational_ball(const RunLength& length) {
  MechanicalSystem system;
  system.mass = {1};
  system.potential = [](std::span<const double> q) { return kWeight * q[0]; };
  system.potential_gradient = [](std::span<const double>, std::span<double> gradient) {
    gradient[0] = kWeight;
  };
  system.walls = {half_space_wall("floor", {{1}, 0})};
  CollisionIntegrator ball(std::move(system), {.step = length.step}, {1}, {0});
  EnergyTrace trace("variational", length, ball.energy());
  for (int i = 0; i < length.steps; ++i) {
    ball.step();
    trace.add(i, ball.energy());
    trace.add_place(i, ball.position()[0] - exact_height(ball.time()));
    for (const Impact& impact : ball.impacts()) trace.add_turn(impact.position[0]);
    trace.add_gap(ball.gap());
  }
  return trace;
}

EnergyTrace world_ball(const RunLength& length) {
  BodyDescription body;
  body.shape.kind = shapes::Sphere::kind;
  body.shape.radius = kRadius;
  body.position = {0, 0, 1};
  body.mass = 1;
  body.inertia = {0.4 * kRadius * kRadius, 0.4 * kRadius * kRadius, 0.4 * kRadius * kRadius};
  const auto lowest = [](Vec3d position, Quatd) { return position.z - kRadius; };
  return world_trace(length, body, -kRadius, lowest, exact_height);
}

EnergyTrace clamped_ball(const RunLength& length) {
  const double h = length.step;
  double q = 1, v = 0;
  EnergyTrace trace("clamped leapfrog", length, kWeight);
  for (int i = 0; i < length.steps; ++i) {
    v -= 0.5 * h * kWeight;
    q += h * v;
    v -= 0.5 * h * kWeight;
    if (q < 0) {
      trace.add_turn(q);
      q = 0;
      v = std::abs(v);
    }
    trace.add(i, 0.5 * v * v + kWeight * q);
    trace.add_place(i, q - exact_height((i + 1) * h));
    trace.add_gap(q);
  }
  return trace;
}

}  // namespace

std::vector<EnergyTrace> ball_traces(const RunLength& length) {
  return {variational_ball(length), world_ball(length), clamped_ball(length)};
}

}  // namespace scree::bench
