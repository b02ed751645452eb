// Solvers of the assembled operator on both backends, and matrix-free ones on a device.

#include <cmath>

#include "host/solve/matrix_free.h"
#include "solvers/solver.h"
#include "tests/assembled_samples.h"
#include "tests/parity/parity.h"

namespace scree::parity {
namespace {

BodyProblem pile(ContactLayout layout) {
  return fixtures::random_body_problem(
      {.layout = layout, .free_count = 300, .contact_count = 500, .seed = 5});
}

StoredProblem stored(const BodyProblem& p) {
  StoredProblem s;
  s.form = p;
  return s;
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return std::sqrt(sum);
}

std::string name_of_solver(const testing::TestParamInfo<std::string>& info) { return info.param; }

class ParityAssembled : public Parity, public testing::WithParamInterface<std::string> {};

/// Methods that do the same to all contacts at once, so that backends differ by rounding alone.
/// Sweeps visit contacts in an order of their own on each.
class ParityGradients : public ParityAssembled {};
INSTANTIATE_TEST_SUITE_P(All, ParityGradients,
                         testing::Values("jacobi", "extragradient", "apgd", "apgd_plain", "spg",
                                         "cpg", "cpg_box", "cpg_pyramid4", "cpg_pyramid8"),
                         name_of_solver);

TEST_P(ParityGradients, TenIterationsAreTheSameToRounding) {
  const ReadyProblem p = ready("pile", stored(pile(ContactLayout::general)));
  AssembledOptions options;
  const bool box = make_assembled_solver(GetParam())->traits().friction == "box";
  options.model = box ? AssembledModel::exact : AssembledModel::convex;
  options.tolerance = 0;
  options.max_iterations = 10;
  const AssembledResult cpu = run_solvers(p, {GetParam()}, options).front().result;
  const SolverRun run = run_solvers(p, {GetParam()}, options, {.cuda = true}).front();
  EXPECT_EQ(run.backend, "cuda");
  EXPECT_EQ(run.result.iterations, cpu.iterations);
  EXPECT_EQ(run.result.applications, cpu.applications);
  const std::vector<double> zero(cpu.r.size(), 0.0);
  EXPECT_GT(distance(cpu.r, zero), 0);
  EXPECT_LE(distance(run.result.r, cpu.r), 1e-9 * distance(cpu.r, zero));
}

/// Boxes have no convex model, and plain Newton may stall.
std::vector<std::string> convex_solvers() {
  std::vector<std::string> names = assembled_solver_names(true);
  std::erase_if(names, [](const std::string& name) {
    return make_assembled_solver(name)->traits().friction == "box" || name == "newton_krylov";
  });
  return names;
}
INSTANTIATE_TEST_SUITE_P(All, ParityAssembled, testing::ValuesIn(convex_solvers()), name_of_solver);

TEST_P(ParityAssembled, BothReachTheSameMinimum) {
  const ReadyProblem p = ready("pile", stored(pile(ContactLayout::general)));
  AssembledOptions options;
  options.model = AssembledModel::convex;
  options.tolerance = 1e-8;
  const AssembledResult cpu = run_solvers(p, {GetParam()}, options).front().result;
  const AssembledResult cuda = run_solvers(p, {GetParam()}, options, {.cuda = true}).front().result;
  EXPECT_EQ(cuda.status, cpu.status) << cuda.note;
  EXPECT_NEAR(cuda.residual.objective, cpu.residual.objective,
              1e-7 * std::abs(cpu.residual.objective));
}

class ParityNewton : public Parity {};

/// BiCGSTAB adds up in another order on each, so steps differ; what they lead to does not.
TEST_F(ParityNewton, BothSolveTheMinMaxFormOfBoxFriction) {
  const ReadyProblem p = ready("pile", stored(pile(ContactLayout::general)));
  AssembledOptions options;
  options.tolerance = 1e-12;
  const std::vector<std::string> solver{"newton_minmax_krylov"};
  const AssembledResult cpu = run_solvers(p, solver, options).front().result;
  const SolverRun run = run_solvers(p, solver, options, {.cuda = true}).front();
  EXPECT_EQ(run.backend, "cuda");
  EXPECT_EQ(cpu.note, "solved with box friction, not the cone");
  EXPECT_EQ(run.result.note, cpu.note);
  EXPECT_LE(std::abs(run.result.iterations - cpu.iterations), 3);
  EXPECT_LE(fixtures::box_friction_error(p.problem, run.result.r), 1e-9);
  const std::vector<double> u = fixtures::velocity(p.problem, cpu.r),
                            v = fixtures::velocity(p.problem, run.result.r);
  EXPECT_LE(distance(u, v), 1e-9 * distance(p.problem.q, std::vector<double>(u.size(), 0.0)));
}

class ParityMatrixFree : public Parity, public testing::WithParamInterface<ContactLayout> {};
INSTANTIATE_TEST_SUITE_P(Layouts, ParityMatrixFree,
                         testing::Values(ContactLayout::radial, ContactLayout::general),
                         [](const auto& p) { return std::string(to_string(p.param)); });

TEST_P(ParityMatrixFree, ReachesTheMinimumOfTheAssembledProblem) {
  const BodyProblem problem = pile(GetParam());
  const ReadyProblem p = ready("pile", stored(problem));
  AssembledOptions options;
  options.model = AssembledModel::convex;
  options.tolerance = 1e-9;
  const SolverRun reference = run_solvers(p, {"apgd"}, options).front();
  ASSERT_EQ(reference.result.status, AssembledStatus::converged);
  const double minimum = reference.result.residual.objective;
  for (const Precision precision : kPrecisions) {
    SCOPED_TRACE(name_of(precision));
    const bool in_double = precision == Precision::double_precision;
    options.tolerance = in_double ? 1e-7 : 1e-3;
    const WorldOptions target{.backend = BackendKind::cuda, .precision = precision};
    for (const SolverRun& run :
         run_matrix_free(problem, p, {"apgd", "gauss_seidel_colored", "jacobi"}, options, target)) {
      EXPECT_EQ(run.result.status, AssembledStatus::converged) << run.solver;
      EXPECT_EQ(run.backend, "cuda");
      EXPECT_NEAR(run.result.residual.objective, minimum,
                  (in_double ? 1e-6 : 1e-2) * std::abs(minimum))
          << run.solver;
    }
  }
}

}  // namespace
}  // namespace scree::parity
