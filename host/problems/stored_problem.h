#pragma once
// What a file of a contact problem holds, whichever of the three forms it is in.

#include <optional>
#include <variant>
#include <vector>

#include "host/problems/body_problem.h"
#include "host/problems/matrix_problem.h"

namespace scree {

struct StoredProblem {
  std::variant<BodyProblem, GlobalProblem, LocalProblem> form;
  ProblemInfo info;                      ///< not with bodies
  std::optional<ProblemPoint> solution;  ///< not with bodies
  std::vector<ProblemPoint> guesses;     ///< not with bodies, which carry their own
};

/// Checks the form and the points. @throws InputError naming what is wrong and what was expected
void validate(const StoredProblem& problem);

}  // namespace scree
