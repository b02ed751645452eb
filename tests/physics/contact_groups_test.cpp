// Contacts of spheres apart from those that need lever arms: the same physics as with all contacts
// in one group, whatever the law; equal bits for any number of threads and after a restart.

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <tuple>

#include "host/problems/body_problem.h"
#include "host/scene/scene_summary.h"
#include "host/state_hash.h"
#include "tests/physics/scene_builder.h"

namespace scree::physics {
namespace {

constexpr double kDiameter = 0.01;

Scene falling_spheres(double lowest) {
  Scene scene = empty_scene(1e-3, 0.4);
  solve_to(scene, 1e-9);
  add_lattice(scene, 192, 8, 8, {-0.037, -0.037, lowest}, 0.0104, kDiameter / 2, 2500, 6);
  for (BodyDescription& body : scene.bodies) body.velocity = {0.1, 0.05, -0.5};
  return scene;
}

void turn(BodyDescription& wall, const Vec3d& axis, double rate) {
  wall.kind = BodyKind::kinematic;
  Motion motion;
  motion.kind = Motion::Kind::rotating;
  motion.axis = (1 / norm(axis)) * axis;
  motion.rate = rate;
  wall.motion = motion;
}

/// A box wall that turns between walls that do not.
Scene paddle() {
  Scene scene = falling_spheres(0.006);
  add_tank(scene, -0.044, 0.044, -0.044, 0.044);
  turn(add_wall_box(scene, {0, 0, -0.001}, {0.04, 0.004, 0.003}), {0, 0, 1}, 20);
  return scene;
}

/// A mesh that turns about a slanted axis.
Scene turning_mesh() {
  Scene scene = falling_spheres(0.012);
  turn(add_valley(scene), {0.05, 0, 1}, 2);
  return scene;
}

/// Boxes among spheres, one of which turns about one axis only and so is none of the radial kind.
Scene boxes_among_spheres() {
  Scene scene = falling_spheres(0.03);
  add_box(scene, {0.003, 0.002, 0.014}, {0.03, 0.03, 0.01}, 0.2).velocity = {0, 0, -0.5};
  for (int k = 0; k < 4; ++k)
    add_box(scene, {0.02 * k - 0.03, 0.01, 0.068}, {0.006, 0.004, 0.005}, 2e-3).orientation =
        exp_map(Vec3d{0.3 * k, 0.2, 0.1});
  scene.bodies[20].locks = lock_rx | lock_ry;
  add_plane(scene);
  return scene;
}

WorldOptions in_one_group(WorldOptions options) {
  options.contact_groups = false;
  return options;
}

struct Case {
  const char* name;
  Scene (*make)();
  Model model;
  double restitution;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class ContactGroups : public ::testing::TestWithParam<Case> {
 protected:
  static Scene scene() {
    Scene scene = GetParam().make();
    scene.solver.exact_coulomb = GetParam().model == Model::exact;
    scene.materials[0].restitution = GetParam().restitution;
    return scene;
  }
};
INSTANTIATE_TEST_SUITE_P(
    All, ContactGroups,
    ::testing::Values(Case{"paddle", paddle, Model::convex, 0},
                      Case{"paddle_exact", paddle, Model::exact, 0},
                      Case{"paddle_bouncing", paddle, Model::convex, 0.5},
                      Case{"turning_mesh", turning_mesh, Model::convex, 0},
                      Case{"boxes", boxes_among_spheres, Model::convex, 0},
                      Case{"boxes_exact", boxes_among_spheres, Model::exact, 0},
                      Case{"boxes_bouncing", boxes_among_spheres, Model::convex, 0.5}),
    [](const auto& info) { return std::string(info.param.name); });

/// Largest difference of velocities, surface speeds included [m/s].
double difference(const BodyStates& a, const BodyStates& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.position.size(); ++i) {
    largest = std::max({largest, norm(a.velocity[i] - b.velocity[i]),
                        kDiameter / 2 * norm(a.angular_velocity[i] - b.angular_velocity[i])});
  }
  return largest;
}

TEST_P(ContactGroups, StepAsOneGroupDoes) {
  const Scene scene = this->scene();
  ASSERT_EQ(summarize(scene).layout, ContactLayout::mixed);
  World groups(scene, cpu_options()), one(scene, in_one_group(cpu_options()));
  int contacts = 0;
  for (int k = 0; k < 40; ++k) {
    one.restore(groups.save());
    const StepReport a = groups.step(), b = one.step();
    contacts = a.contact_count;
    ASSERT_EQ(a.contact_count, b.contact_count) << k;
    EXPECT_TRUE(a.converged && b.converged)
        << k << " residuals " << a.residual_rms << " " << b.residual_rms;
    EXPECT_LE(difference(groups.states(), one.states()), 1e-6) << k;
  }
  EXPECT_GT(contacts, 150);
}

/// What a step hands out for solving elsewhere.
TEST_P(ContactGroups, StoredProblemsAreThoseOfOneGroup) {
  const Scene scene = this->scene();
  World groups(scene, cpu_options()), one(scene, in_one_group(cpu_options()));
  for (int k = 0; k < 30; ++k) groups.step();
  one.restore(groups.save());
  BodyProblem a, b;
  groups.step(a);
  one.step(b);
  ASSERT_NO_THROW(validate(a));
  ASSERT_EQ(a.layout, ContactLayout::general);
  ASSERT_EQ(a.contact_count(), b.contact_count());
  EXPECT_EQ(a.body_id, b.body_id);
  const auto sorted = [](const BodyProblem& p) {
    std::vector<std::size_t> order(p.body_a.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t c, std::size_t d) {
      return std::tuple(p.body_a[c], p.body_b[c], p.bias[c], p.normal[c].x) <
             std::tuple(p.body_a[d], p.body_b[d], p.bias[d], p.normal[d].x);
    });
    return order;
  };
  const std::vector<std::size_t> of_a = sorted(a), of_b = sorted(b);
  // Impacts were solved before, each with its own rounding.
  const double solved = GetParam().restitution > 0 ? 1e-6 : 0;
  for (std::size_t k = 0; k < of_a.size(); ++k) {
    const std::size_t c = of_a[k], d = of_b[k];
    ASSERT_EQ(a.body_a[c], b.body_a[d]);
    ASSERT_EQ(a.body_b[c], b.body_b[d]);
    EXPECT_EQ(a.normal[c], b.normal[d]);
    EXPECT_EQ(a.bias[c], b.bias[d]);
    EXPECT_EQ(a.friction[c], b.friction[d]);
    EXPECT_LE(norm(a.arm_a[c] - b.arm_a[d]), 1e-15);
    // Where a radial contact meets a wall, which does not turn, its arm there does not matter.
    if (a.body_b[c] < a.free_count) {
      EXPECT_LE(norm(a.arm_b[c] - b.arm_b[d]), 1e-15);
    }
    if (!a.drift.empty()) {
      EXPECT_LE(norm(a.drift[c] - b.drift[d]), solved);
    }
  }
  for (std::size_t i = 0; i < a.free_velocity.size(); ++i) {
    const Twist<double>&v_a = a.free_velocity[i], &v_b = b.free_velocity[i];
    EXPECT_LE(norm(v_a.linear - v_b.linear), solved);
    EXPECT_LE(kDiameter / 2 * norm(v_a.angular - v_b.angular),
              solved + 1e-15 * kDiameter / 2 * norm(v_b.angular));
    const double stiffness = b.general_inertia[i].inv_inertia.trace();
    EXPECT_NEAR(a.general_inertia[i].inv_inertia.trace(), stiffness, 1e-14 * stiffness);
    EXPECT_EQ(a.general_inertia[i].inv_mass, b.general_inertia[i].inv_mass);
  }
}

/// With impulses of the step before, which sorting the bodies must not lose.
TEST_P(ContactGroups, NeedNoMoreIterations) {
  Scene scene = this->scene();
  scene.solver = SolverSettings{};
  scene.solver.exact_coulomb = GetParam().model == Model::exact;
  const auto options = cpu_options(1, Precision::single_precision);
  const auto iterations = [&](const WorldOptions& of) {
    World world(scene, of);
    int sum = 0;
    for (int k = 0; k < 140; ++k) {
      const int more = world.step().iterations;
      if (k >= 60) sum += more;
    }
    return sum;
  };
  EXPECT_LE(iterations(options), 1.1 * iterations(in_one_group(options)));
}

TEST_P(ContactGroups, GiveEqualBitsForAnyThreadCountAndAfterARestart) {
  Scene scene = this->scene();
  scene.solver = SolverSettings{};
  scene.solver.exact_coulomb = GetParam().model == Model::exact;
  for (const Precision precision : {Precision::single_precision, Precision::double_precision}) {
    World one(scene, cpu_options(1, precision)), three(scene, cpu_options(3, precision));
    World resumed(scene, cpu_options(1, precision));
    for (int k = 0; k < 80; ++k) {  // bodies are sorted before step 64
      if (k == 58) resumed.restore(one.save());
      one.step();
      three.step();
      if (k >= 58) resumed.step();
    }
    EXPECT_EQ(state_hash(one.states()), state_hash(three.states()));
    EXPECT_EQ(state_hash(one.states()), state_hash(resumed.states()));
  }
}

TEST(ContactLayouts, FollowFromTheBodies) {
  EXPECT_EQ(summarize(falling_spheres(0)).layout, ContactLayout::radial);
  EXPECT_EQ(summarize(paddle()).layout, ContactLayout::mixed);
  EXPECT_TRUE(summarize(paddle()).radial_bodies);
  EXPECT_EQ(summarize(boxes_among_spheres()).layout, ContactLayout::mixed);
  EXPECT_FALSE(summarize(boxes_among_spheres()).radial_bodies);
  Scene boxes = empty_scene(1e-3, 0.4);
  add_box(boxes, {0, 0, 1}, {0.1, 0.1, 0.1}, 1);
  EXPECT_EQ(summarize(boxes).layout, ContactLayout::general);
  Scene rolling = paddle();
  rolling.materials[0].rolling_friction = 1e-4;
  EXPECT_EQ(summarize(rolling).layout, ContactLayout::rolling);
}

}  // namespace
}  // namespace scree::physics
