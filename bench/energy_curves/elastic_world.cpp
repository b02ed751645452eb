#include "bench/energy_curves/elastic_world.h"

#include "shapes/half_space.h"

namespace scree::bench {
namespace {

Scene floor_scene(double step, double height) {
  Scene scene;
  scene.precision = "double";
  scene.stepping.time_step = step;
  scene.materials[0].friction = 0;
  scene.materials[0].restitution = 1;
  scene.gravity = {0, 0, -kWeight};
  scene.solver.stop = {StopRule::Level::absolute, 1e-12};
  scene.solver.max_iterations = 20000;
  BodyDescription floor;
  floor.kind = BodyKind::fixed;
  floor.shape.kind = shapes::HalfSpace::kind;
  floor.shape.normal = {0, 0, 1};
  floor.position = {0, 0, height};
  scene.bodies.push_back(floor);
  return scene;
}

}  // namespace

EnergyTrace world_trace(const RunLength& length, const BodyDescription& body, double floor,
                        const std::function<double(Vec3d, Quatd)>& lowest) {
  Scene scene = floor_scene(length.step, floor);
  scene.bodies.push_back(body);
  WorldOptions options;
  options.backend = BackendKind::cpu;
  options.precision = Precision::double_precision;
  options.threads = 1;
  World world(scene, options);
  const Vec3d spin = body.angular_velocity, moment = body.inertia;
  const double turning =
      0.5 * (moment.x * spin.x * spin.x + moment.y * spin.y * spin.y + moment.z * spin.z * spin.z);
  const auto mean = [&](double v) { return v - 0.5 * length.step * kWeight; };
  const Vec3d v = body.velocity;
  const double moving = 0.5 * (v.x * v.x + v.y * v.y + mean(v.z) * mean(v.z));
  EnergyTrace trace("time steps", length, moving + turning + kWeight * body.position.z);
  double gap = lowest(body.position, body.orientation) - floor, rise = body.velocity.z;
  for (int i = 0; i < length.steps; ++i) {
    const StepReport report = world.step();
    const BodyStates s = world.states();
    const double up = s.velocity.back().z;
    const double kinetic = report.kinetic_energy + 0.5 * (mean(up) * mean(up) - up * up);
    trace.add(i, kinetic + kWeight * s.position.back().z);
    if (up > rise + 0.5 * length.step * kWeight) trace.add_turn(gap);
    gap = lowest(s.position.back(), s.orientation.back()) - floor;
    trace.add_gap(gap);
    rise = up;
  }
  return trace;
}

}  // namespace scree::bench
