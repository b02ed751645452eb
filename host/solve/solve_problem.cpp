#include "host/solve/solve_problem.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <variant>

#include "host/error.h"
#include "host/problems/assembled_form.h"
#include "host/problems/body_measures.h"
#include "host/problems/matrix_form.h"
#include "solvers/rolling/rolling_solver.h"

namespace scree {

ReadyProblem ready(const std::string& name, const StoredProblem& stored) {
  // With bodies the guess has to be turned into contact rows too.
  if (const auto* bodies = std::get_if<BodyProblem>(&stored.form))
    return ready(name, as_matrices(*bodies, MatrixForm::local));
  ReadyProblem p;
  p.name = name;
  if (has_rolling_rows(stored)) {
    p.rolling = rolling_form(stored);
    p.problem.contact_count = p.rolling->contact_count;
    p.problem.dimension = 5;
    p.asymmetry = asymmetry(*p.rolling);
  } else {
    p.problem = assembled_form(stored);
    p.asymmetry = asymmetry(p.problem);
  }
  const int dimension = p.problem.dimension;
  if (!stored.guesses.empty() && !stored.guesses.front().r.empty())
    p.guess = to_three_rows(dimension, stored.guesses.front().r);
  if (stored.solution.has_value() && !stored.solution->u.empty())
    p.reference_velocity = to_three_rows(dimension, stored.solution->u);
  return p;
}

SolverRun find_reference(ReadyProblem& problem, const std::string& solver,
                         const AssembledOptions& options) {
  AssembledOptions o = options;
  o.tolerance = 1e-13;
  o.measure = AssembledMeasure::relative;
  o.max_iterations = 0;
  o.check_every = 0;
  problem.reference_velocity.clear();
  problem.reference_impulse.clear();
  SolverRun run = run_solvers(problem, {solver}, o).front();
  problem.reference_impulse = run.result.r;
  problem.reference_velocity = velocity_of(problem, o.model, run.result.r);
  problem.reference_model = o.model;
  return run;
}

ReadyProblem ready_matrix_free(const std::string& name, const StoredProblem& stored) {
  const auto* bodies = std::get_if<BodyProblem>(&stored.form);
  if (bodies != nullptr && !bodies->bilateral.empty())
    throw InputError("it has bilateral rows, which --matrix-free does not know: leave that out");
  if (bodies == nullptr || bodies->layout != ContactLayout::rolling) return ready(name, stored);
  ReadyProblem p;
  p.name = name;
  p.problem.contact_count = bodies->contact_count();
  p.guess = world_numbers(bodies->impulse);
  return p;
}

std::vector<double> velocity_of(const ReadyProblem& problem, AssembledModel model,
                                const std::vector<double>& r) {
  const bool symmetric = model == AssembledModel::convex;
  const auto of = [&](const auto& p) {
    return contact_velocity(symmetric ? symmetrized(p) : p, r);
  };
  return problem.rolling ? of(*problem.rolling) : of(problem.problem);
}

std::vector<std::string> solvers_that_hold_rows() {
  std::vector<std::string> names = assembled_solver_names();
  std::erase_if(names, [](const std::string& name) {
    return !make_assembled_solver(name)->traits().holds_rows;
  });
  return names;
}

namespace {

/// @throws AssembledError when a solver does not know bilateral rows, or none does on the target
void require_held_rows(const std::vector<std::string>& solvers, const AssembledTarget& target) {
  if (target.cuda)
    throw AssembledError("it has bilateral rows, which no solver knows on cuda; expected cpu");
  const std::vector<std::string> able = solvers_that_hold_rows();
  std::vector<std::string> rest = solvers;
  std::erase_if(rest, [&](const std::string& name) {
    return std::find(able.begin(), able.end(), name) != able.end();
  });
  if (!rest.empty())
    throw AssembledError(fmt::format("it has bilateral rows, which {} {} not know; these do: {}",
                                     fmt::join(rest, ", "), rest.size() == 1 ? "does" : "do",
                                     fmt::join(able, ", ")));
}

}  // namespace

std::vector<SolverRun> run_solvers(const ReadyProblem& problem,
                                   const std::vector<std::string>& solvers,
                                   const AssembledOptions& options,
                                   const AssembledTarget& target) try {
  if (problem.problem.held) require_held_rows(solvers, target);
  std::vector<SolverRun> runs;
  for (const std::string& name : solvers) {
    AssembledOptions o = options;
    if (o.model == problem.reference_model) {
      o.reference_velocity = problem.reference_velocity;
      o.reference_impulse = problem.reference_impulse;
    }
    SolverRun run;
    run.solver = name;
    run.backend = target.cuda ? "cuda" : "cpu";
    if (problem.rolling) {
      if (target.cuda)
        throw InputError(fmt::format(
            "{}: it has rolling friction, for which no solver runs on cuda; on cpu {} do",
            problem.name, fmt::join(rolling_solver_names(), ", ")));
      run.result = solve_rolling(name, *problem.rolling, o, &run.curve);
    } else {
      const auto solver = make_assembled_solver(name, target);
      run.friction = solver->traits().friction;
      run.result = solver->solve(problem.problem, o, &run.curve);
    }
    runs.push_back(std::move(run));
  }
  return runs;
} catch (const AssembledError& error) {
  throw InputError(fmt::format("{}: {}", problem.name, error.what()));
}

std::vector<std::string> without_cuda_form(const std::vector<std::string>& names) {
  const std::vector<std::string> on_cuda = assembled_solver_names(true);
  std::vector<std::string> rest = names;
  std::erase_if(rest, [&](const std::string& name) {
    return std::find(on_cuda.begin(), on_cuda.end(), name) != on_cuda.end();
  });
  return rest;
}

std::vector<std::string> with_relaxation(const std::vector<std::string>& names) {
  std::vector<std::string> rest = names;
  std::erase_if(
      rest, [](const std::string& name) { return !make_assembled_solver(name)->traits().relaxes; });
  return rest;
}

std::vector<std::string> parse_solver_list(const std::string& list,
                                           const std::vector<std::string>& known) {
  if (list == "all") return known;
  std::vector<std::string> names;
  std::size_t start = 0;
  for (;;) {
    const std::size_t comma = std::min(list.find(',', start), list.size());
    const std::string name = list.substr(start, comma - start);
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw InputError(fmt::format("--solver: \"{}\" is not a solver; expected all, or of {}", name,
                                   fmt::join(known, ", ")));
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    if (comma == list.size()) return names;
    start = comma + 1;
  }
}

}  // namespace scree
