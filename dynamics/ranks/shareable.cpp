#include "dynamics/ranks/shareable.h"

#include <string>

#include "host/error.h"
#include "solvers/solver_card.h"

namespace scree {

void require_shareable(const Scene& scene) {
  if (scene.dynamics.type != "rigid")
    throw InputError("dynamics.type: \"" + scene.dynamics.type +
                     "\" is not allowed: runs on one rank only");
  const SolverCard& solver = solver_card(scene.solver.name);
  if (solver.over_ranks) return;
  std::string known;
  for (const SolverCard& card : solver_cards())
    if (card.over_ranks) known += (known.empty() ? "\"" : ", \"") + std::string(card.name) + '"';
  throw InputError("solver.name: \"" + scene.solver.name +
                   "\" is not allowed: runs on one rank only; " + known + " run on several");
}

void throw_not_over_ranks(const char* call) {
  throw InputError(std::string(call) + " is for a World of one rank");
}

}  // namespace scree
