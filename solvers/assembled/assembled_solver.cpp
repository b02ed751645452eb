#include "solvers/assembled/assembled_solver.h"

#include <algorithm>
#include <cstdio>

#include "kernels/joined.h"
#include "solvers/assembled/backend_solver.h"
#include "solvers/assembled/cone_vectors.h"
#include "solvers/assembled/de_saxce_loop.h"
#include "solvers/assembled/infeasibility.h"
#include "solvers/assembled/model_problem.h"
#include "solvers/assembled/solve_checks.h"

namespace scree {

#define SCREE_ASSEMBLED_SOLVER(name) std::unique_ptr<AssembledSolver> make_assembled_##name();
#define SCREE_ASSEMBLED_BACKEND_SOLVER(name)
#include "solvers/assembled/solver_list.inc"
#undef SCREE_ASSEMBLED_BACKEND_SOLVER
#undef SCREE_ASSEMBLED_SOLVER

namespace {

void check(const AssembledProblem& p, const AssembledOptions& o) {
  const auto contacts = static_cast<std::size_t>(std::max(0, p.contact_count));
  check_rows_and_options({.contact_count = p.contact_count,
                          .contact_rows = 3,
                          .q = p.q,
                          .coefficients = {{"mu", &p.mu}},
                          .matrix_rows = contacts,
                          .row_start = p.row_start,
                          .column = p.column,
                          .entry_count = p.block.size()},
                         o);
}

/// Gives methods a relative tolerance to aim at where the one asked for is on another measure.
void aim(const AssembledProblem& p, AssembledOptions& o) {
  if (o.measure == AssembledMeasure::relative) return;
  o.goal = o.tolerance;
  if (o.measure == AssembledMeasure::absolute) {
    if (const double size = norm(p.q); size > 0) o.tolerance /= size;
  } else {
    // How the two compare is known when the problem is solved. What is too strict only
    // makes methods go on.
    o.tolerance *= 1e-3;
  }
}

std::string contradiction_note(const HeldRows& held) {
  char text[120];
  std::snprintf(text, sizeof text,
                "bilateral rows contradict each other: row %d and others are left with %.3g m/s",
                held.worst_row(), held.left());
  return text;
}

/// Contacts up to which an interior-point solve costs next to nothing.
constexpr int cheap_contacts = 1000;

/// Says why a solve has not converged where more can be said than the method does.
void explain(const AssembledProblem& p, const AssembledTraits& traits, AssembledMonitor& monitor) {
  const AssembledStatus status = monitor.status();
  // Of another law, a stall is what its solution ends with.
  const bool broke = status == AssembledStatus::singular || status == AssembledStatus::diverged ||
                     (status == AssembledStatus::stalled && traits.friction == "cone");
  const bool grows =
      status != AssembledStatus::no_solution && grows_without_bound(p, monitor.last_impulses());
  if (!grows && !(broke && p.contact_count <= cheap_contacts)) return;
  if (!monitor.fail_if_unsolvable() && grows)
    monitor.fail(AssembledStatus::diverged,
                 "impulses grow without bound in a direction that W does not resist");
}

}  // namespace

AssembledResult AssembledSolver::solve(const AssembledProblem& problem,
                                       const AssembledOptions& options,
                                       std::vector<AssembledCurvePoint>* curve) const {
  check(problem, options);
  const AssembledTraits own = traits();
  if (problem.held && !own.holds_rows)
    throw AssembledError("solver \"" + own.name + "\" does not know bilateral rows");
  AssembledOptions o = options;
  if (o.max_iterations == 0) o.max_iterations = own.default_iterations;
  if (o.check_every == 0) o.check_every = own.default_check_every;
  if (o.guess.empty()) o.guess.assign(problem.q.size(), 0.0);

  const bool convex = o.model == AssembledModel::convex;
  const ModelProblem<AssembledProblem> solved(problem, o.model);
  const AssembledProblem& p = solved.get();

  aim(p, o);
  AssembledMonitor monitor(p, o, curve);
  monitor.note(solved.note());
  if (p.held && p.held->contradict()) {
    monitor.check(0, o.guess);
    monitor.fail(AssembledStatus::no_solution, contradiction_note(*p.held));
  } else if (const int hopeless = untouchable_contact(p); hopeless >= 0) {
    monitor.check(0, o.guess);
    monitor.fail(AssembledStatus::no_solution, untouchable_note(hopeless));
  } else if (convex ? own.convex : own.exact) {
    run(p, o, monitor);
  } else if (!convex && own.convex) {
    run_de_saxce_loop(*this, p, o, monitor);
  } else {
    monitor.check(0, o.guess);
    monitor.fail(AssembledStatus::unsupported, "the method solves the exact model only");
  }
  if (!monitor.converged()) explain(p, own, monitor);
  return monitor.finish();
}

namespace {

std::unique_ptr<AssembledSolver> make_host_solver(const std::string& name) {
#define SCREE_ASSEMBLED_SOLVER(known) \
  if (name == #known) return make_assembled_##known();
#define SCREE_ASSEMBLED_BACKEND_SOLVER(known)
#include "solvers/assembled/solver_list.inc"
#undef SCREE_ASSEMBLED_BACKEND_SOLVER
#undef SCREE_ASSEMBLED_SOLVER
  return nullptr;
}

std::unique_ptr<AssembledSolver> make_cuda_solver([[maybe_unused]] const std::string& name) {
#ifdef SCREE_HAS_CUDA
  return make_assembled_solver_on<Cuda>(name, make_assembled_backend<Cuda>(0));
#else
  throw AssembledError("this build has no CUDA");
#endif
}

}  // namespace

std::unique_ptr<AssembledSolver> make_assembled_solver(const std::string& name,
                                                       const AssembledTarget& target) {
  const std::vector<std::string> known = assembled_solver_names();
  if (std::find(known.begin(), known.end(), name) == known.end())
    throw AssembledError("solver \"" + name + "\" is not known; expected one of " + joined(known));
  if (target.cuda) {
    const std::vector<std::string> on_cuda = assembled_solver_names(true);
    if (std::find(on_cuda.begin(), on_cuda.end(), name) == on_cuda.end())
      throw AssembledError("solver \"" + name +
                           "\" has no CUDA form; those that have one: " + joined(on_cuda));
    return make_cuda_solver(name);
  }
  auto solver = make_host_solver(name);
  if (solver != nullptr) return solver;
  return make_assembled_solver_on<Cpu>(name, make_assembled_backend<Cpu>(target.threads));
}

std::vector<std::string> assembled_solver_names(bool cuda) {
  std::vector<std::string> names;
#define SCREE_ASSEMBLED_SOLVER(name) \
  if (!cuda) names.emplace_back(#name);
#define SCREE_ASSEMBLED_BACKEND_SOLVER(name) names.emplace_back(#name);
#include "solvers/assembled/solver_list.inc"
#undef SCREE_ASSEMBLED_BACKEND_SOLVER
#undef SCREE_ASSEMBLED_SOLVER
  return names;
}

}  // namespace scree
