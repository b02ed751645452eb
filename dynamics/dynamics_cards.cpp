#include <algorithm>

#include "dynamics/dynamics_card.h"
#include "host/error.h"

namespace scree {

bool DynamicsCard::has_column(const std::string& column) const {
  return std::any_of(report.begin(), report.end(),
                     [&](const ReportColumn& each) { return column == each.name; });
}

const DynamicsCard* find_dynamics(const std::string& name) {
  for (const DynamicsCard& card : dynamics_cards())
    if (name == card.name) return &card;
  return nullptr;
}

const DynamicsCard& dynamics_card(const std::string& name) {
  if (const DynamicsCard* card = find_dynamics(name)) return *card;
  std::string known;
  for (const DynamicsCard& card : dynamics_cards())
    known += (known.empty() ? "\"" : ", \"") + std::string(card.name) + "\"";
  throw InputError("dynamics.type: \"" + name + "\" is not allowed: must be one of " + known);
}

std::vector<std::string> dynamics_names() {
  std::vector<std::string> names;
  for (const DynamicsCard& card : dynamics_cards()) names.emplace_back(card.name);
  return names;
}

}  // namespace scree
