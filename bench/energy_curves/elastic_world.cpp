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
                        const std::function<double(Vec3d, Quatd)>& lowest,
                        const std::function<double(double)>& exact) {
  const double half_change = 0.5 * length.step * kWeight;  // of the velocity in half a step
  Scene scene = floor_scene(length.step, floor);
  scene.bodies.push_back(body);
  scene.bodies.back().velocity.z += half_change;
  WorldOptions options;
  options.backend = BackendKind::cpu;
  options.precision = Precision::double_precision;
  options.threads = 1;
  World world(scene, options);
  const Vec3d spin = body.angular_velocity, moment = body.inertia;
  const double turning =
      0.5 * (moment.x * spin.x * spin.x + moment.y * spin.y * spin.y + moment.z * spin.z * spin.z);
  const double moving = 0.5 * dot(body.velocity, body.velocity);
  EnergyTrace trace("time steps", length, moving + turning + kWeight * body.position.z);
  double gap = lowest(body.position, body.orientation) - floor, rise = body.velocity.z;
  for (int i = 0; i < length.steps; ++i) {
    const StepReport report = world.step();
    const BodyStates s = world.states();
    const double up = s.velocity.back().z, mean = up - half_change;
    const double kinetic = report.kinetic_energy + 0.5 * (mean * mean - up * up);
    trace.add(i, kinetic + kWeight * s.position.back().z);
    if (exact) trace.add_place(i, s.position.back().z - exact(report.time));
    if (up > rise + half_change) trace.add_turn(gap);
    gap = lowest(s.position.back(), s.orientation.back()) - floor;
    trace.add_gap(gap);
    rise = up;
  }
  return trace;
}

}  // namespace scree::bench
