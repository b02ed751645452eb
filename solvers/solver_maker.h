#pragma once
// Makes a solver by its name. What names there are is in lists that CMake writes.

#include <span>

#include "solvers/solver.h"
#include "solvers/solver_card.h"

namespace scree {

template <class B, class Real>
struct SolverMaker {
  const char* name;
  std::unique_ptr<Solver<B, Real>> (*make)(const SolverParams&);
};

/// @throws InvalidParameter naming the known solvers when the name is none of them, for a solver
///         that does not run on the backend, and for a parameter out of its range
template <class B, class Real>
std::unique_ptr<Solver<B, Real>> make_one_of(std::span<const SolverMaker<B, Real>> makers,
                                             const std::string& name, const SolverParams& params) {
  const SolverCard& card = solver_card(name);
  if (B::kIsDevice && card.cpu_only != nullptr)
    throw InvalidParameter("solver.name " + card.device_fault());
  for (const SolverParameter& parameter : card.parameters) {
    const double value = parameter.of(params.own);
    if (!parameter.allows(value))
      throw InvalidParameter("solver." + std::string(parameter.key) + ": " + parameter.text(value) +
                             " is not allowed: " + parameter.expected());
  }
  for (const SolverMaker<B, Real>& maker : makers)
    if (name == maker.name) return maker.make(params);
  throw std::logic_error("no maker of solver " + name);
}

}  // namespace scree
