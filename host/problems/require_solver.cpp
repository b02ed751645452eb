#include "host/problems/require_solver.h"

#include <fmt/format.h>

#include "host/error.h"
#include "host/problems/body_problem.h"
#include "solvers/solver_card.h"

namespace scree {

void require_solver(const std::string& where, const std::string& name, BackendKind backend,
                    ContactLayout layout) {
  const SolverCard& card = solver_card(name);
  if (backend == BackendKind::cuda && card.cpu_only != nullptr)
    throw InputError(where + ": " + card.device_fault());
  if (card.knows(layout)) return;
  if (layout == ContactLayout::jointed) {
    std::string others;
    for (const SolverCard& other : solver_cards())
      if (other.knows(layout))
        others += fmt::format("{}\"{}\"", others.empty() ? "" : ", ", other.name);
    throw InputError(fmt::format(
        "{}: \"{}\" is not allowed: the scene has joints, which it does not know; these do: {}",
        where, name, others));
  }
  std::string known;
  for (const ContactLayout each : card.layouts)
    known += (known.empty() ? "" : ", ") + std::string(to_string(each));
  throw InputError(
      fmt::format("{}: \"{}\" is not allowed: contacts are of layout {}, and it knows {} only",
                  where, name, to_string(layout), known));
}

}  // namespace scree
