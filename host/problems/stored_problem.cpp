#include "host/problems/stored_problem.h"

#include <fmt/format.h>

#include "host/error.h"

namespace scree {
namespace {

void check_points(const StoredProblem& stored, const BodyProblem&) {
  if (stored.solution || !stored.guesses.empty())
    throw InputError("a problem with bodies holds its guess itself and no solution");
}

template <class Form>
void check_points(const StoredProblem& stored, const Form& form) {
  if (stored.solution) validate(*stored.solution, form, "solution");
  for (std::size_t k = 0; k < stored.guesses.size(); ++k)
    validate(stored.guesses[k], form, fmt::format("guesses/{}", k + 1));
}

}  // namespace

void validate(const StoredProblem& stored) {
  std::visit(
      [&](const auto& form) {
        validate(form);
        check_points(stored, form);
      },
      stored.form);
}

}  // namespace scree
