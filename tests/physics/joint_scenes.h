#pragma once
// What tests of joints share: joints in a line, worlds in both precisions, energy and periods.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "host/state_hash.h"
#include "tests/physics/scene_builder.h"

namespace scree::physics {

inline const std::vector<std::string> kJointSolvers{"apgd", "jacobi", "gauss_seidel",
                                                    "gauss_seidel_colored"};

inline Joint joint_of(JointKind kind, int a, int b, const Vec3d& anchor,
                      const Vec3d& axis = {0, 0, 1}) {
  Joint joint;
  joint.kind = kind;
  joint.bodies = {a, b};
  joint.anchor = anchor;
  joint.axis = axis;
  return joint;
}

/// A distance, cable or spring between a point of each body.
inline Joint line_of(JointKind kind, int a, int b, const Vec3d& from, const Vec3d& to) {
  Joint joint = joint_of(kind, a, b, from);
  joint.second_anchor = to;
  return joint;
}

/// Solved as far as the precision goes.
inline World joint_world(Scene scene, Precision precision) {
  if (precision == Precision::single_precision) solve_to(scene, 2e-6);
  return World(scene, cpu_options(1, precision));
}

/// One thread and two find the same.
inline void expect_same_bits_on_threads(const Scene& scene, int steps) {
  World one(scene, cpu_options(1)), two(scene, cpu_options(2));
  for (int k = 0; k < steps; ++k) {
    one.step();
    two.step();
  }
  EXPECT_EQ(state_hash(one.states()), state_hash(two.states()));
}

inline void run_converged(World& world, int steps) {
  for (int k = 0; k < steps; ++k) ASSERT_TRUE(world.step().converged) << k;
}

/// Tests of joints in both precisions.
class JointTest : public testing::TestWithParam<Precision> {
 protected:
  World world_of(const Scene& scene) const { return joint_world(scene, GetParam()); }
  bool is_double() const { return GetParam() == Precision::double_precision; }
  /// Relative error of what a solve takes to rounding.
  double exact() const { return is_double() ? 1e-9 : 2e-5; }
  /// Linear and angular momentum stay in a run.
  void expect_momentum_kept(World& world, const Scene& scene, int steps) const {
    const Momenta before = momenta_of(world.states(), scene);
    run_converged(world, steps);
    const Momenta after = momenta_of(world.states(), scene);
    EXPECT_LT(norm(after.linear - before.linear), is_double() ? 1e-10 : 2e-5);
    EXPECT_LT(norm(after.angular - before.angular),
              (is_double() ? 1e-5 : 1e-4) * norm(before.angular));
  }
};

/// Two boxes that fly and turn without gravity, with equal velocities at the origin, where a joint belongs.
inline Scene two_turning_boxes(double time_step, const Vec3d& second_turning) {
  Scene scene = empty_scene(time_step, 0);
  scene.gravity = {};
  BodyDescription& one = add_box(scene, {-0.4, 0, 0}, {0.3, 0.1, 0.05}, 2);
  one.velocity = {0.3, -0.2, 0.1};
  one.angular_velocity = {2, -3, 1};
  const Vec3d at_joint = one.velocity + cross(one.angular_velocity, {0.4, 0, 0});
  BodyDescription& other = add_box(scene, {0.3, 0, 0}, {0.2, 0.05, 0.1}, 1);
  other.angular_velocity = second_turning;
  other.velocity = at_joint + cross(second_turning, {0.3, 0, 0});
  return scene;
}

inline std::string name_of_precision(const testing::TestParamInfo<Precision>& one) {
  return one.param == Precision::double_precision ? "Double" : "Float";
}

/// Energy of the free bodies in the middle of each step, where velocities are at home [J].
class EnergyOfSteps {
 public:
  EnergyOfSteps(const World& world, const Scene& scene)
      : scene_(scene), place_(world.states().position) {
    start_ = energy(world.states(), place_);
  }
  double start() const { return start_; }
  double of_step(const World& world) {
    const BodyStates s = world.states();
    std::vector<Vec3d> middle;
    for (std::size_t i = 0; i < place_.size(); ++i)
      middle.push_back(0.5 * (place_[i] + s.position[i]));
    place_ = s.position;
    return energy(s, middle);
  }

 private:
  double energy(const BodyStates& s, const std::vector<Vec3d>& place) const {
    double sum = 0;
    for (std::size_t i = 0; i < place.size(); ++i) {
      const BodyDescription& body = scene_.bodies[i];
      if (body.kind != BodyKind::free) continue;
      const Vec3d w = rotate_back(s.orientation[i], s.angular_velocity[i]);
      const Vec3d spin{body.inertia.x * w.x, body.inertia.y * w.y, body.inertia.z * w.z};
      sum += 0.5 * body.mass * norm2(s.velocity[i]) + 0.5 * dot(w, spin) -
             body.mass * dot(scene_.gravity, place[i]);
    }
    return sum;
  }

  Scene scene_;
  std::vector<Vec3d> place_;
  double start_ = 0;
};

/// Mean time between rises of a quantity through zero [s]. @param seen  called with each report
template <class Value, class Seen>
double period_of(World& world, int steps, Value value, Seen seen) {
  double before = value(), first = 0, last = 0;
  int rises = 0;
  for (int k = 0; k < steps; ++k) {
    const StepReport report = world.step();
    seen(report);
    const double now = value();
    if (before < 0 && now >= 0) {
      const double h = report.time / static_cast<double>(report.step);
      last = report.time - h * now / (now - before);
      if (rises++ == 0) first = last;
    }
    before = now;
  }
  return rises > 1 ? (last - first) / (rises - 1) : 0;
}

/// A row of boxes along x, each joined to the next by another kind of joint, with all that drives and limits them, that falls
/// on a floor between loose balls. Its ends are held to the world and to a fixed body.
inline Scene row_of_joints(int boxes = 20, double restitution = 0) {
  constexpr double kSpacing = 0.12;
  Scene scene = empty_scene(1e-3, 0.4);
  scene.materials[0].restitution = restitution;
  scene.solver.max_iterations = 20000;
  add_plane(scene);
  for (int k = 0; k < boxes; ++k) {
    BodyDescription& box =
        add_box(scene, {kSpacing * k, 0, 0.09 + 0.01 * (k % 3)}, {0.04, 0.03, 0.02}, 0.2);
    box.angular_velocity = {0.3 * (k % 2), 0.2, -0.1 * k};
  }
  constexpr JointKind kKinds[] = {JointKind::hinge,       JointKind::ball,      JointKind::fixed,
                                  JointKind::slider,      JointKind::universal, JointKind::distance,
                                  JointKind::cylindrical, JointKind::cable,     JointKind::spring};
  for (int k = 0; k + 1 < boxes; ++k) {
    const int a = k + 1, b = k + 2;  // behind the plane
    const Vec3d from = scene.bodies[static_cast<std::size_t>(a)].position;
    const Vec3d to = scene.bodies[static_cast<std::size_t>(b)].position;
    const JointKind kind = kKinds[k % 9];
    const bool is_line =
        kind == JointKind::distance || kind == JointKind::cable || kind == JointKind::spring;
    // Some name their bodies the other way round.
    Joint joint = is_line
                      ? line_of(kind, a, b, from, to)
                      : joint_of(kind, k % 2 == 0 ? a : b, k % 2 == 0 ? b : a, 0.5 * (from + to),
                                 kind == JointKind::slider ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0});
    if (kind == JointKind::ball) {
      joint.swing = 0.3, joint.limits = {-0.2, 0.2}, joint.friction = 1e-3;
    }
    if (kind == JointKind::universal) {
      joint.second_axis = {0, 0, 1};
      joint.limits = {-0.2, 0.2}, joint.second_turn.friction = 1e-3;
    }
    if (kind == JointKind::hinge) joint.limits = {-0.1, 0.1}, joint.friction = 1e-3;
    if (kind == JointKind::slider) joint.motor = JointMotor{.speed = 0.3, .max_force = 2};
    if (kind == JointKind::cylindrical) {
      joint.limits = {-0.01, 0.01}, joint.friction = 0.1;
      joint.turn.limits = {-0.2, 0.2}, joint.turn.motor = JointMotor{.force = 2e-3};
    }
    if (kind == JointKind::spring) joint.stiffness = 200, joint.damping = 0.5;
    scene.joints.push_back(joint);
  }
  scene.joints.push_back(joint_of(JointKind::ball, kWorldBody, 1, {-0.05, 0, 0.09}));
  add_wall_box(scene, {kSpacing * boxes, 0, 0.2}, {0.03, 0.03, 0.03});
  scene.joints.push_back(
      joint_of(JointKind::ball, boxes, boxes + 1, {kSpacing * (boxes - 0.5), 0, 0.15}));
  for (int k = 0; k < boxes; ++k) add_sphere(scene, {kSpacing * k + 0.03, 0.01, 0.025}, 0.02, 0.1);
  return scene;
}

}  // namespace scree::physics
