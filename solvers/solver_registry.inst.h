// Compiled once per backend: make_solver over the names CMake collected.
#include "solvers/solver.h"

namespace scree {

#define SCREE_SOLVER(name)       \
  template <class B, class Real> \
  std::unique_ptr<Solver<B, Real>> make_##name(const SolverParams&);
#include "solver_registry.inc"
#undef SCREE_SOLVER

template <class B, class Real>
std::unique_ptr<Solver<B, Real>> make_solver(const std::string& name, const SolverParams& params) {
#define SCREE_SOLVER(known) \
  if (name == #known) return make_##known<B, Real>(params);
#include "solver_registry.inc"
#undef SCREE_SOLVER
  std::string known;
  for (const std::string& n : solver_names()) known += (known.empty() ? "" : ", ") + n;
  throw InvalidParameter("solver.name \"" + name + "\" is unknown; known solvers: " + known);
}

template std::unique_ptr<Solver<BuildBackend, float>> make_solver(const std::string&,
                                                                  const SolverParams&);
template std::unique_ptr<Solver<BuildBackend, double>> make_solver(const std::string&,
                                                                   const SolverParams&);

}  // namespace scree
