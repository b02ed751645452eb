#include "solvers/solver.h"

namespace scree {

std::vector<std::string> solver_names() {
  return {
#define SCREE_SOLVER(name) #name,
#include "solver_registry.inc"
#undef SCREE_SOLVER
  };
}

}  // namespace scree
