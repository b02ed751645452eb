// The contact problem that a step hands out: it is the one that the step solves.
#include <gtest/gtest.h>

#include <algorithm>

#include "kernels/backend/cpu.h"
// After the backend.
#include "host/problems/matrix_form.h"
#include "host/problems/upload_problem.h"
#include "solvers/solver.h"
#include "tests/physics/scene_builder.h"
#include "tests/stored_problem_samples.h"

namespace scree {
namespace {

using namespace physics;

/// A heap of spheres in a tank, some of which join later than the steps that are checked.
Scene heap(ContactLayout layout) {
  Scene scene = empty_scene(1e-3, 0.4);
  scene.name = "heap";
  scene.materials[0].restitution = 0.2;
  scene.stepping.restitution_law = RestitutionLaw::newton;  // all impulses are of the one problem
  scene.materials[0].cohesion = 1e-4;
  add_tank(scene, -0.05, 0.05, -0.05, 0.05);
  add_lattice(scene, 60, 4, 4, {-0.03, -0.03, 0.011}, 0.0202, 0.01, 2500, 3);
  scene.insertions.push_back({10, {sphere({0, 0, 1}, 0.01, 0.01), sphere({0, 0, 2}, 0.01, 0.01)}});
  if (layout == ContactLayout::general) {
    BodyDescription& mixer =
        add_wall_box(scene, {0, 0, 0}, {0.01, 0.04, 0.004}, BodyKind::kinematic);
    Motion turn;
    turn.kind = Motion::Kind::rotating;
    turn.rate = 5;
    mixer.motion = turn;
    for (BodyDescription& body : scene.bodies)
      if (body.kind == BodyKind::free) body.position.z += 0.008;
    scene.bodies[7].locks = lock_x | lock_ry;
  }
  if (layout == ContactLayout::rolling) scene.materials[0].rolling_friction = 1e-4;
  scene.solver.name = "gauss_seidel";
  scene.solver.stop = {StopRule::Level::fixed_iterations, 0};
  scene.solver.max_iterations = 12;
  return scene;
}

constexpr int steps_before = 25;

template <class Real>
struct Dumped {
  explicit Dumped(const Scene& scene) : world(scene, options()) {
    for (int k = 0; k < steps_before; ++k) world.step();
    report = world.step(problem);
  }
  /// All contacts in one group: a problem of two is stored in another order than it was solved in.
  static WorldOptions options() {
    WorldOptions options =
        cpu_options(1, std::is_same_v<Real, double> ? Precision::double_precision
                                                    : Precision::single_precision);
    options.contact_groups = false;
    return options;
  }
  World world;
  StepReport report;
  BodyProblem problem;
};

template <class Real>
class DumpProblem : public ::testing::Test {};
using Reals = ::testing::Types<float, double>;
TYPED_TEST_SUITE(DumpProblem, Reals);

constexpr ContactLayout layouts[] = {ContactLayout::radial, ContactLayout::general,
                                     ContactLayout::rolling};

TYPED_TEST(DumpProblem, SolvesToTheBitsOfTheStep) {
  using Real = TypeParam;
  for (const ContactLayout layout : layouts) {
    SCOPED_TRACE(to_string(layout));
    const Scene scene = heap(layout);
    Dumped<Real> dumped(scene);
    ASSERT_EQ(dumped.problem.layout, layout);
    EXPECT_NO_THROW(validate(dumped.problem));

    Cpu cpu(1);
    UploadedProblem<Cpu, Real> uploaded(cpu, dumped.problem);
    SolverParams params;
    params.max_iterations = scene.solver.max_iterations;
    params.check_every = scene.solver.check_every;
    const auto solver = make_solver<Cpu, Real>(scene.solver.name, params);
    solver->solve(cpu, uploaded.problem(), uploaded.impulses(), 0);

    const std::vector<ContactRecord> contacts = dumped.world.contacts();
    ASSERT_EQ(contacts.size(), dumped.problem.body_a.size());
    ASSERT_GT(contacts.size(), 60u);
    const auto vectors = static_cast<std::size_t>(vectors_per_contact(layout));
    double largest_guess = 0;
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      const BodyProblem& p = dumped.problem;
      EXPECT_EQ(p.body_id[static_cast<std::size_t>(p.body_a[c])], contacts[c].body_a);
      EXPECT_EQ(p.body_id[static_cast<std::size_t>(p.body_b[c])], contacts[c].body_b);
      EXPECT_EQ(Vec3d(uploaded.impulses()[static_cast<Index>(c * vectors)]), contacts[c].impulse);
      largest_guess = std::max(largest_guess, norm(p.impulse[c * vectors]));
    }
    EXPECT_GT(largest_guess, 0);  // the warm start is there
  }
}

TYPED_TEST(DumpProblem, DoesNotChangeTheRun) {
  const Scene scene = heap(ContactLayout::general);
  Dumped<TypeParam> dumped(scene);
  World plain(scene, Dumped<TypeParam>::options());
  for (int k = 0; k < steps_before + 1; ++k) plain.step();
  EXPECT_EQ(dumped.world.states().position, plain.states().position);
  EXPECT_EQ(dumped.world.states().velocity, plain.states().velocity);
}

TEST(DumpedProblem, SaysWhereItComesFrom) {
  const Dumped<double> dumped(heap(ContactLayout::radial));
  const ProblemSource& s = dumped.problem.source;
  EXPECT_EQ(s.scene, "heap");
  EXPECT_EQ(s.backend, "cpu");
  EXPECT_EQ(s.precision, "double");
  EXPECT_EQ(s.step, steps_before + 1);
  EXPECT_EQ(s.step, dumped.report.step);
  EXPECT_DOUBLE_EQ(s.time, steps_before * 1e-3);
  EXPECT_EQ(s.time_step, 1e-3);
  EXPECT_DOUBLE_EQ(s.reference_speed, 9.81e-3);
}

/// W gamma + q of the exported problem, the matrix-free operator and the dense oracle.
TEST(DumpedProblem, ExportedMatricesAreTheOperator) {
  for (const ContactLayout layout : {ContactLayout::radial, ContactLayout::general}) {
    SCOPED_TRACE(to_string(layout));
    const Dumped<double> dumped(heap(layout));
    const BodyProblem& p = dumped.problem;
    const LocalProblem local = local_form(p);
    std::vector<double> gamma = to_rows(p, p.impulse);
    for (std::size_t c = 0; c < p.adhesion.size(); ++c) gamma[3 * c] += p.adhesion[c];
    std::vector<double> u = multiply(local.W, gamma);
    for (std::size_t k = 0; k < u.size(); ++k) u[k] += local.q[k];
    const std::vector<Vec3d> exported = to_world(p, u);

    Cpu cpu(1);
    UploadedProblem<Cpu, double> uploaded(cpu, p);
    Buffer<Cpu, Twist<double>> v(cpu, p.body_count());
    std::vector<Vec3d> matrix_free;
    with_rows<double>(layout, [&](auto rows) {
      using R = decltype(rows);
      const ContactProblem<double>& problem = uploaded.problem();
      for_each(cpu, p.body_count(), StartVelocity<double>{problem, v.view()});
      for_each(cpu, p.free_count, BodyVelocity<R, double>{problem, uploaded.impulses(), v.view()});
      if constexpr (R::kVectors == 1) {
        for (Index c = 0; c < p.contact_count(); ++c)
          matrix_free.push_back(
              R::velocity(problem, c, v.view()[problem.body_a[c]], v.view()[problem.body_b[c]])
                  .force);
      }
    });

    const oracle::Problem o = fixtures::oracle_of(p);
    std::vector<Eigen::Vector3d> impulse;
    for (const Vec3d& g : p.impulse) impulse.push_back(fixtures::to_eigen(g));
    const std::vector<Eigen::Vector3d> dense = oracle::world_from_rows(
        o, oracle::delassus(o) * oracle::rows_from_world(o, impulse) + oracle::right_side(o));

    double scale = 0, from_operator = 0, from_oracle = 0;
    ASSERT_EQ(exported.size(), matrix_free.size());
    for (std::size_t c = 0; c < exported.size(); ++c) {
      scale = std::max(scale, norm(matrix_free[c]));
      from_operator = std::max(from_operator, norm(exported[c] - matrix_free[c]));
      from_oracle = std::max(from_oracle, norm(exported[c] - fixtures::to_vec3<double>(dense[c])));
    }
    EXPECT_LE(from_operator, 1e-12 * scale);
    EXPECT_LE(from_oracle, 1e-12 * scale);
  }
}

}  // namespace
}  // namespace scree
