#include "host/solve/solve_problem.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <variant>

#include "host/error.h"
#include "host/problems/assembled_form.h"
#include "host/problems/body_measures.h"
#include "host/problems/matrix_form.h"

namespace scree {

ReadyProblem ready(const std::string& name, const StoredProblem& stored) {
  // With bodies the guess has to be turned into contact rows too.
  if (const auto* bodies = std::get_if<BodyProblem>(&stored.form))
    return ready(name, as_matrices(*bodies, MatrixForm::local));
  ReadyProblem p;
  p.name = name;
  p.problem = assembled_form(stored);
  p.asymmetry = asymmetry(p.problem);
  const int dimension = p.problem.dimension;
  if (!stored.guesses.empty() && !stored.guesses.front().r.empty())
    p.guess = to_three_rows(dimension, stored.guesses.front().r);
  if (stored.solution.has_value() && !stored.solution->u.empty())
    p.reference_velocity = to_three_rows(dimension, stored.solution->u);
  return p;
}

ReadyProblem ready_matrix_free(const std::string& name, const StoredProblem& stored) {
  const auto* bodies = std::get_if<BodyProblem>(&stored.form);
  if (bodies == nullptr || bodies->layout != ContactLayout::rolling) return ready(name, stored);
  ReadyProblem p;
  p.name = name;
  p.problem.contact_count = bodies->contact_count();
  p.guess = world_numbers(bodies->impulse);
  return p;
}

std::vector<SolverRun> run_solvers(const ReadyProblem& problem,
                                   const std::vector<std::string>& solvers,
                                   const AssembledOptions& options) try {
  std::vector<SolverRun> runs;
  for (const std::string& name : solvers) {
    const auto solver = make_assembled_solver(name);
    AssembledOptions o = options;
    if (o.model == AssembledModel::exact) o.reference_velocity = problem.reference_velocity;
    SolverRun run;
    run.solver = name;
    run.friction = solver->traits().friction;
    run.result = solver->solve(problem.problem, o, &run.curve);
    runs.push_back(std::move(run));
  }
  return runs;
} catch (const AssembledError& error) {
  throw InputError(fmt::format("{}: {}", problem.name, error.what()));
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
    names.push_back(name);
    if (comma == list.size()) return names;
    start = comma + 1;
  }
}

}  // namespace scree
