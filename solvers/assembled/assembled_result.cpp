#include "solvers/assembled/assembled_result.h"

namespace scree {

const char* to_string(AssembledStatus status) {
  switch (status) {
    case AssembledStatus::converged:
      return "converged";
    case AssembledStatus::iteration_limit:
      return "iteration limit";
    case AssembledStatus::time_limit:
      return "time limit";
    case AssembledStatus::stalled:
      return "stalled";
    case AssembledStatus::diverged:
      return "diverged";
    case AssembledStatus::singular:
      return "singular";
    case AssembledStatus::no_solution:
      return "no solution";
    case AssembledStatus::unsupported:
      break;
  }
  return "unsupported";
}

}  // namespace scree
