#include "bench/energy_curves/elastic_world.h"
#include "host/collision_integrator.h"
#include "host/collision_walls.h"
#include "shapes/box.h"

namespace scree::bench {
namespace {

// (x, y, angle) at the start, and their rates.
constexpr double kHeight = 1.5, kAngle = 0.3, kSpeed = 0.2, kSpin = 0.1;
constexpr double kMoment = 1.0 / 12;

MechanicalSystem rod_on_floor() {
  MechanicalSystem system;
  system.mass = {1, 0, 0, 0, 1, 0, 0, 0, kMoment};
  system.potential = [](std::span<const double> q) { return kWeight * q[1]; };
  system.potential_gradient = [](std::span<const double>, std::span<double> gradient) {
    gradient[0] = gradient[2] = 0;
    gradient[1] = kWeight;
  };
  for (const double end : {0.5, -0.5})
    system.walls.push_back(plane_body_wall("end", {.x = end}, 0, 1, 0));
  return system;
}

EnergyTrace variational_rod(const RunLength& length) {
  CollisionIntegrator rod(rod_on_floor(), {.step = length.step}, {0, kHeight, kAngle},
                          {kSpeed, 0, kSpin});
  EnergyTrace trace("variational", length, rod.energy());
  for (int i = 0; i < length.steps; ++i) {
    rod.step();
    trace.add(i, rod.energy());
    for (const Impact& impact : rod.impacts())
      trace.add_turn(impact.position[1] - 0.5 * std::abs(std::sin(impact.position[2])));
    trace.add_gap(rod.gap());
  }
  return trace;
}

/// A thin box that is held in the plane of x and z.
EnergyTrace world_rod(const RunLength& length) {
  constexpr double half = 0.002;
  BodyDescription body;
  body.shape.kind = shapes::Box::kind;
  body.shape.half_extents = {0.5, half, half};
  set_mass_from_density(body, 1 / (8 * 0.5 * half * half));
  body.position = {0, 0, kHeight};
  body.orientation = {std::cos(0.5 * kAngle), 0, -std::sin(0.5 * kAngle), 0};
  body.velocity = {kSpeed, 0, 0};
  body.angular_velocity = {0, -kSpin, 0};
  body.locks = lock_y | lock_rx | lock_rz;
  return world_trace(length, body, -half, [](Vec3d position, Quatd orientation) {
    const Vec3d along = rotate(orientation, {0.5, 0, 0}),
                across = rotate(orientation, {0, 0, half});
    return position.z - std::abs(along.z) - std::abs(across.z);
  });
}

/// Completes the step, lifts the rod until its lower end is on the floor, and turns the velocity of that end.
EnergyTrace clamped_rod(const RunLength& length) {
  const double h = length.step;
  double y = kHeight, angle = kAngle, v = 0, spin = kSpin;
  const auto energy = [&] {
    return 0.5 * (kSpeed * kSpeed + v * v + kMoment * spin * spin) + kWeight * y;
  };
  EnergyTrace trace("clamped leapfrog", length, energy());
  for (int i = 0; i < length.steps; ++i) {
    v -= 0.5 * h * kWeight;
    y += h * v;
    angle += h * spin;
    v -= 0.5 * h * kWeight;
    const double arm = (std::sin(angle) < 0 ? 0.5 : -0.5) * std::cos(angle);
    const double gap = y - 0.5 * std::abs(std::sin(angle));
    const double rate = v + arm * spin;
    if (gap < 0) {
      y -= gap;
      if (rate < 0) {
        trace.add_turn(gap);
        const double impulse = -2 * rate / (1 + arm * arm / kMoment);
        v += impulse;
        spin += impulse * arm / kMoment;
      }
    }
    trace.add(i, energy());
    trace.add_gap(y - 0.5 * std::abs(std::sin(angle)));
  }
  return trace;
}

}  // namespace

std::vector<EnergyTrace> rod_traces(const RunLength& length) {
  return {variational_rod(length), world_rod(length), clamped_rod(length)};
}

}  // namespace scree::bench
