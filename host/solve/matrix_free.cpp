#include "host/solve/matrix_free.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/error.h"
#include "host/io/checkpoint.h"
#include "host/problems/body_measures.h"
#include "host/problems/matrix_form.h"
#include "host/problems/require_solver.h"

namespace scree {

class Cpu;
class Cuda;

namespace {

constexpr int kMostIterations = 10'000;
constexpr int kMostOuterIterations = 100;

/// The next limit of a curve: about 1.4 times as many, and at least one more.
int next_limit(int limit, int most) {
  const long long longer = (7LL * limit + 4) / 5;
  return static_cast<int>(std::clamp<long long>(longer, limit + 1, most));
}

AssembledStatus status_of(const AssembledResidual& residual, const AssembledOptions& options,
                          bool out_of_time) {
  if (!std::isfinite(residual.relative)) return AssembledStatus::diverged;
  if (value_of(residual, options.measure) <= options.tolerance) return AssembledStatus::converged;
  return out_of_time ? AssembledStatus::time_limit : AssembledStatus::iteration_limit;
}

SolverRun run(MatrixFreeProblem& uploaded, const BodyProblem& problem, const ReadyProblem& ready,
              const std::string& solver, const AssembledOptions& options,
              const WorldOptions& world) {
  const bool exact = options.model == AssembledModel::exact;
  const int inner = options.max_iterations > 0 ? options.max_iterations : kMostIterations;
  const int most = exact ? kMostOuterIterations : inner;
  const std::vector<Vec3d> guess = options.guess.empty() ? std::vector<Vec3d>{} : problem.impulse;
  SolverRun out;
  out.solver = solver;
  double spent = 0;
  for (int limit = 0; limit < most;) {
    limit = next_limit(limit, most);
    const MatrixFreeSolution s = uploaded.solve(solver, options.model, guess, limit, inner);
    spent += s.seconds;
    // Moments have no rows in W.
    const bool rolling = problem.layout == ContactLayout::rolling;
    std::vector<double> r = rolling ? world_numbers(s.impulse) : impulse_rows(problem, s.impulse);
    AssembledCurvePoint point;
    point.iteration = s.iterations;
    point.applications = s.applications;
    point.seconds = s.seconds;
    point.residual = rolling ? measure(problem, options.model, s.impulse)
                             : measure(ready.problem, options.model, r);
    out.curve.push_back(point);
    const bool out_of_time = options.max_seconds > 0 && spent > options.max_seconds;
    const AssembledStatus status = status_of(point.residual, options, out_of_time);
    const bool is_best = out.result.r.empty() || value_of(point.residual, options.measure) <
                                                     value_of(out.result.residual, options.measure);
    if (is_best) {
      out.result.r = std::move(r);
      out.result.residual = point.residual;
    }
    out.result.iterations = s.iterations;
    out.result.applications = s.applications;
    out.result.seconds = s.seconds;
    out.result.status = status;
    if (status != AssembledStatus::iteration_limit) break;
  }
  out.backend = world.backend == BackendKind::cuda ? "cuda" : "cpu";
  out.result.note = fmt::format("{}, {}", out.backend, to_string(world.precision));
  return out;
}

}  // namespace

std::unique_ptr<MatrixFreeProblem> upload_matrix_free(const BodyProblem& problem,
                                                      const WorldOptions& world) {
  std::string reason;
  if (!backend_available(world.backend, &reason, world.device))
    throw InputError("backend cuda: " + reason);
#ifdef SCREE_HAS_CUDA
  if (world.backend == BackendKind::cuda) return upload_matrix_free_on<Cuda>(problem, world);
#endif
  return upload_matrix_free_on<Cpu>(problem, world);
}

std::vector<SolverRun> run_matrix_free(const BodyProblem& problem, const ReadyProblem& ready,
                                       const std::vector<std::string>& solvers,
                                       const AssembledOptions& options, const WorldOptions& world) {
  for (const std::string& solver : solvers)
    require_solver("--solver", solver, world.backend, problem.layout);
  const auto uploaded = upload_matrix_free(problem, world);
  std::vector<SolverRun> runs;
  runs.reserve(solvers.size());
  for (const std::string& solver : solvers)
    runs.push_back(run(*uploaded, problem, ready, solver, options, world));
  return runs;
}

}  // namespace scree
