#include "solvers/assembled/assembled_solver.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "solvers/assembled/backend_solver.h"
#include "solvers/assembled/de_saxce_loop.h"
#include "solvers/assembled/infeasibility.h"

namespace scree {

#define SCREE_ASSEMBLED_SOLVER(name) std::unique_ptr<AssembledSolver> make_assembled_##name();
#define SCREE_ASSEMBLED_BACKEND_SOLVER(name)
#include "solvers/assembled/solver_list.inc"
#undef SCREE_ASSEMBLED_BACKEND_SOLVER
#undef SCREE_ASSEMBLED_SOLVER

namespace {

void require(bool ok, const std::string& what) {
  if (!ok) throw AssembledError(what);
}

/// Products of rounding apart, W is symmetric below this.
constexpr double symmetric_to = 1e-12;

void check(const AssembledProblem& p, const AssembledOptions& o) {
  const std::size_t rows = 3 * static_cast<std::size_t>(p.contact_count);
  const auto require_rows = [&](const std::vector<double>& v, const char* name) {
    require(v.size() == rows, std::string(name) + " has " + std::to_string(v.size()) +
                                  " values, expected " + std::to_string(rows));
    require(std::all_of(v.begin(), v.end(), [](double x) { return std::isfinite(x); }),
            std::string(name) + " holds a value that is not finite");
  };
  require(p.contact_count > 0, "the problem has no contacts");
  require(p.mu.size() == static_cast<std::size_t>(p.contact_count), "mu does not fit the contacts");
  require_rows(p.q, "q");
  if (!o.guess.empty()) require_rows(o.guess, "guess");
  if (!o.reference_velocity.empty()) require_rows(o.reference_velocity, "reference_velocity");
  if (!o.reference_impulse.empty()) require_rows(o.reference_impulse, "reference_impulse");
  require(o.tolerance >= 0, "tolerance must not be negative, got " + std::to_string(o.tolerance));
  require(o.max_iterations >= 0,
          "max_iterations must not be negative, got " + std::to_string(o.max_iterations));
  require(o.check_every >= 0,
          "check_every must not be negative, got " + std::to_string(o.check_every));
  require(o.max_seconds >= 0,
          "max_seconds must not be negative, got " + std::to_string(o.max_seconds));
  require(o.relaxation >= 0 && o.relaxation < 2,
          "relaxation must lie in (0, 2), got " + std::to_string(o.relaxation));
}

/// Gives methods a relative tolerance to aim at where the one asked for is on another measure.
void aim(const AssembledProblem& p, AssembledOptions& o) {
  if (o.measure == AssembledMeasure::relative) return;
  o.goal = o.tolerance;
  double square = 0;
  for (const double x : p.q) square += x * x;
  if (o.measure == AssembledMeasure::absolute) {
    if (square > 0) o.tolerance /= std::sqrt(square);
  } else {
    // How the two compare is known when the problem is solved. What is too strict only
    // makes methods go on.
    o.tolerance *= 1e-3;
  }
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
  AssembledOptions o = options;
  if (o.max_iterations == 0) o.max_iterations = own.default_iterations;
  if (o.check_every == 0) o.check_every = own.default_check_every;
  if (o.guess.empty()) o.guess.assign(problem.q.size(), 0.0);

  const bool convex = o.model == AssembledModel::convex;
  const double unsymmetric = convex || !own.exact ? asymmetry(problem) : 0;
  AssembledProblem symmetric;
  const bool replace = convex && unsymmetric > symmetric_to;
  if (replace) symmetric = symmetrized(problem);
  const AssembledProblem& p = replace ? symmetric : problem;

  aim(p, o);
  AssembledMonitor monitor(p, o, curve);
  if (replace) {
    char text[80];
    std::snprintf(text, sizeof text, "W symmetrized (unsymmetric by %.1e)", unsymmetric);
    monitor.note(text);
  }
  if (const int hopeless = untouchable_contact(p); hopeless >= 0) {
    monitor.check(0, o.guess);
    monitor.fail(AssembledStatus::no_solution,
                 "contact " + std::to_string(hopeless) + " approaches and no impulse acts on it");
  } else if (convex ? own.convex : own.exact) {
    run(p, o, monitor);
  } else if (!convex && own.convex) {
    run_de_saxce_loop(*this, p, o, monitor);
  } else {
    monitor.fail(AssembledStatus::unsupported, "the method solves the exact model only");
  }
  if (!monitor.converged()) explain(p, own, monitor);
  return monitor.finish();
}

namespace {

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& n : names) text += (text.empty() ? "" : ", ") + n;
  return text;
}

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
