#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "kernels/joined.h"
#include "solvers/solver.h"
#include "solvers/solver_card.h"

namespace scree {
namespace {

std::string shortest(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g", value);
  return text.data();
}

std::string described(const SolverParameter& p) {
  return p.expected() + ", default " + p.text(p.standard);
}

}  // namespace

bool SolverParameter::allows(double value) const {
  if (choices.empty())
    return (value > low || (is_low_allowed && value >= low)) && value < high &&
           !(is_whole && value != std::floor(value));
  return value >= 0 && value < static_cast<double>(choices.size()) && value == std::floor(value);
}

std::string SolverParameter::text(double value) const {
  if (choices.empty() || !allows(value)) return shortest(value);
  return std::string("\"") + choices[static_cast<std::size_t>(value)] + "\"";
}

std::string SolverParameter::expected() const {
  if (choices.empty())
    return std::string("must be ") + (is_whole ? "a whole number, " : "") +
           (is_low_allowed
                ? shortest(low) + " or more, and below " + shortest(high)
                : "between " + shortest(low) + " and " + shortest(high) + ", both excluded");
  return "must be one of " + joined(choices, "\"");
}

bool SolverParameter::takes_as(const SolverParameter& other) const {
  const auto same_name = [](const char* a, const char* b) { return std::string(a) == b; };
  const auto same = [](double a, double b) { return !(a < b) && !(b < a); };
  return same(standard, other.standard) && same(low, other.low) && same(high, other.high) &&
         is_low_allowed == other.is_low_allowed && is_whole == other.is_whole &&
         std::equal(choices.begin(), choices.end(), other.choices.begin(), other.choices.end(),
                    same_name);
}

bool SolverCard::knows(ContactLayout layout) const {
  return std::find(layouts.begin(), layouts.end(), layout) != layouts.end();
}

std::string SolverCard::device_fault() const {
  if (cpu_only == nullptr) return "";
  return std::string("\"") + name + "\" runs on the cpu backend only: " + cpu_only;
}

const SolverCard& solver_card(const std::string& name) {
  for (const SolverCard& card : solver_cards())
    if (name == card.name) return card;
  throw InvalidParameter("solver.name \"" + name +
                         "\" is unknown; known solvers: " + joined(solver_names()));
}

std::vector<std::string> solver_names(bool on_device) {
  std::vector<std::string> names;
  for (const SolverCard& card : solver_cards())
    if (!on_device || card.cpu_only == nullptr) names.emplace_back(card.name);
  return names;
}

std::vector<SharedParameter> shared_parameters(const std::vector<SolverCard>& cards) {
  std::vector<SharedParameter> found;
  for (const SolverCard& card : cards) {
    for (const SolverParameter& parameter : card.parameters) {
      const std::string key = parameter.key;
      auto same = std::find_if(found.begin(), found.end(),
                               [&](const SharedParameter& f) { return key == f.parameter.key; });
      if (same == found.end()) {
        same = found.insert(same, {parameter, {}});
      } else if (!same->parameter.takes_as(parameter)) {
        throw std::logic_error("solvers \"" + same->solvers.front() + "\" and \"" + card.name +
                               "\" have a parameter \"" + key +
                               "\": " + described(same->parameter) + ", and " +
                               described(parameter) + "; parameters of one key must be the same");
      }
      same->solvers.emplace_back(card.name);
    }
  }
  return found;
}

const std::vector<SharedParameter>& solver_parameters() {
  static const std::vector<SharedParameter> all = shared_parameters(solver_cards());
  return all;
}

}  // namespace scree
