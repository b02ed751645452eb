#include "host/scene_reader/scene_schema.h"

#include <fmt/format.h>

#include "host/scene.h"
#include "solvers/solver_card.h"

namespace scree::reader {
namespace {

Json name_schema() {
  std::string description = "Method.";
  for (const SolverCard& card : solver_cards())
    description += fmt::format(" {}: {}.", card.name, card.description);
  return {
      {"enum", solver_names()}, {"default", SolverSettings{}.name}, {"description", description}};
}

Json parameter_schema(const SharedParameter& shared) {
  const SolverParameter& parameter = shared.parameter;
  const std::string description =
      fmt::format("{}: {}", fmt::join(shared.solvers, ", "), parameter.description);
  if (parameter.choices.empty())
    return {{"type", "number"},
            {"exclusiveMinimum", parameter.low},
            {"exclusiveMaximum", parameter.high},
            {"default", parameter.standard},
            {"description", description}};
  const std::vector<std::string> names(parameter.choices.begin(), parameter.choices.end());
  return {{"enum", names},
          {"default", names.at(static_cast<std::size_t>(parameter.standard))},
          {"description", description}};
}

}  // namespace

Json schema_with_solvers(Json schema) {
  Json& properties = schema.at("$defs").at("solver").at("properties");
  properties["name"] = name_schema();
  for (const SharedParameter& shared : solver_parameters())
    properties[shared.parameter.key] = parameter_schema(shared);
  return schema;
}

}  // namespace scree::reader
