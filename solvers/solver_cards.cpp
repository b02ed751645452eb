#include <algorithm>
#include <cmath>
#include <cstdio>

#include "solvers/solver.h"
#include "solvers/solver_card.h"

namespace scree {
namespace {

std::string shortest(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g", value);
  return text.data();
}

}  // namespace

bool SolverParameter::allows(double value) const {
  if (choices.empty()) return value > low && value < high;
  return value >= 0 && value < static_cast<double>(choices.size()) && value == std::floor(value);
}

std::string SolverParameter::text(double value) const {
  if (choices.empty() || !allows(value)) return shortest(value);
  return std::string("\"") + choices[static_cast<std::size_t>(value)] + "\"";
}

std::string SolverParameter::expected() const {
  if (choices.empty())
    return "must be between " + shortest(low) + " and " + shortest(high) + ", both excluded";
  std::string list;
  for (const char* name : choices)
    list += (list.empty() ? "\"" : ", \"") + std::string(name) + "\"";
  return "must be one of " + list;
}

bool SolverCard::knows(ContactLayout layout) const {
  return std::find(layouts.begin(), layouts.end(), layout) != layouts.end();
}

std::string SolverCard::device_fault() const {
  if (cpu_only == nullptr) return "";
  return std::string("\"") + name + "\" runs on the cpu backend only: " + cpu_only;
}

const SolverCard& solver_card(const std::string& name) {
  std::string known;
  for (const SolverCard& card : solver_cards()) {
    if (name == card.name) return card;
    known += (known.empty() ? "" : ", ") + std::string(card.name);
  }
  throw InvalidParameter("solver.name \"" + name + "\" is unknown; known solvers: " + known);
}

std::vector<std::string> solver_names(bool on_device) {
  std::vector<std::string> names;
  for (const SolverCard& card : solver_cards())
    if (!on_device || card.cpu_only == nullptr) names.emplace_back(card.name);
  return names;
}

const std::vector<SharedParameter>& solver_parameters() {
  static const std::vector<SharedParameter> all = [] {
    std::vector<SharedParameter> found;
    for (const SolverCard& card : solver_cards()) {
      for (const SolverParameter& parameter : card.parameters) {
        const std::string key = parameter.key;
        auto same = std::find_if(found.begin(), found.end(),
                                 [&](const SharedParameter& f) { return key == f.parameter.key; });
        if (same == found.end()) same = found.insert(same, {parameter, {}});
        same->solvers.emplace_back(card.name);
      }
    }
    return found;
  }();
  return all;
}

}  // namespace scree
