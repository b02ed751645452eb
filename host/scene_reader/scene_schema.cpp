#include "host/scene_reader/scene_schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "dynamics/dynamics_card.h"
#include "host/scene.h"
#include "host/scene_reader/keys.h"
#include "shapes/shape_card.h"
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

Json type_schema() {
  std::string description = "What a step is.";
  for (const DynamicsCard& card : dynamics_cards())
    description += fmt::format(" {}: {}.", card.name, card.description);
  return {{"enum", dynamics_names()},
          {"default", DynamicsSettings{}.type},
          {"description", description}};
}

/// @param owners  names of what takes it
Json parameter_schema(const SolverParameter& parameter, const std::string& owners) {
  const std::string description = fmt::format("{}: {}", owners, parameter.description);
  if (parameter.choices.empty())
    return {{"type", parameter.is_whole ? "integer" : "number"},
            {parameter.is_low_allowed ? "minimum" : "exclusiveMinimum", parameter.low},
            {"exclusiveMaximum", parameter.high},
            {"default", parameter.standard},
            {"description", description}};
  const std::vector<std::string> names(parameter.choices.begin(), parameter.choices.end());
  return {{"enum", names},
          {"default", names.at(static_cast<std::size_t>(parameter.standard))},
          {"description", description}};
}

Json schema_of(ShapeKey::Type type) {
  switch (type) {
    case ShapeKey::Type::length:
      return {{"type", "number"}, {"exclusiveMinimum", 0}};
    case ShapeKey::Type::vector:
      return {{"$ref", "#/$defs/vector"}};
    case ShapeKey::Type::points:
      return {{"type", "array"}, {"minItems", 4}, {"items", {{"$ref", "#/$defs/vector"}}}};
    case ShapeKey::Type::faces:
      return {{"type", "array"}, {"items", {{"enum", {"-x", "+x", "-y", "+y", "-z", "+z"}}}}};
    case ShapeKey::Type::file:
      return {{"type", "string"}, {"minLength", 1}};
    case ShapeKey::Type::scale:
      return {{"type", "number"}, {"exclusiveMinimum", 0}, {"default", 1}};
    case ShapeKey::Type::flag:
      return {{"type", "boolean"}, {"default", true}};
    case ShapeKey::Type::parts:
      return {{"type", "array"}, {"minItems", 1}, {"items", {{"$ref", "#/$defs/shape_part"}}}};
    case ShapeKey::Type::overlaps:
      return {{"enum", {"once", "each"}}, {"default", "once"}};
    case ShapeKey::Type::heights:
      return {{"type", "array"},
              {"minItems", 2},
              {"items", {{"type", "array"}, {"minItems", 2}, {"items", {{"type", "number"}}}}}};
    case ShapeKey::Type::extent:
      return {{"type", "array"},
              {"minItems", 2},
              {"maxItems", 2},
              {"items", {{"type", "number"}, {"exclusiveMinimum", 0}}}};
    case ShapeKey::Type::offset:
      return {{"type", "number"}, {"default", 0}};
    case ShapeKey::Type::range:
      return {{"type", "array"}, {"minItems", 2}, {"maxItems", 2}, {"items", {{"type", "number"}}}};
  }
  return {};
}

/// A vector whose text says so has positive components.
Json schema_of(const ShapeKey& key) {
  Json schema = schema_of(key.type);
  if (key.type == ShapeKey::Type::vector && std::string_view(key.text).ends_with(" positive."))
    schema["items"] = {{"exclusiveMinimum", 0}};
  return schema;
}

bool may_be_part(const ShapeCard& card) { return card.may_be_part(); }
bool is_any(const ShapeCard&) { return true; }
bool may_be_free(const ShapeCard& card) { return card.may_be_free(); }

/// "box, container: full edge lengths [m], positive.": what the shapes that have a key say of it.
std::string text_of_key(const std::string& key, bool (*fits)(const ShapeCard&)) {
  std::vector<std::pair<std::string, std::string>> texts;  // of one or more shapes, their names
  for (const ShapeCard& card : shape_cards()) {
    if (!fits(card)) continue;
    for (const ShapeKey& own : card.keys) {
      if (key != own.key) continue;
      if (!texts.empty() && texts.back().first == own.text)
        texts.back().second += fmt::format(", {}", card.name);
      else
        texts.emplace_back(own.text, card.name);
    }
  }
  std::string all;
  for (const auto& [text, names] : texts)
    all += fmt::format("{}{}: {}", all.empty() ? "" : " ", names, text);
  return all;
}

Json shape_condition(const ShapeCard& card) {
  Json required = Json::array();
  for (const ShapeKey& key : card.keys)
    if (key.is_required) required.push_back(key.key);
  if (required.empty()) return {};
  return {
      {"if",
       {{"properties", {{"shape", {{"const", card.name}}}}}, {"required", Json::array({"shape"})}}},
      {"then", {{"required", required}}}};
}

/// Takes the place of what the schema says of the shapes that an object may name, but for the keys
/// that mean something else there.
void put_shapes(Json& object, bool (*fits)(const ShapeCard&),
                const std::vector<std::string>& kept = {}) {
  Json& properties = object.at("properties");
  std::vector<std::string> names;
  std::string description;
  for (const ShapeCard& card : shape_cards()) {
    if (!card.is_named || !fits(card)) continue;
    names.emplace_back(card.name);
    description +=
        fmt::format("{}{}: {}.", description.empty() ? "" : " ", card.name, card.description);
    for (const ShapeKey& key : card.keys) {
      if (std::find(kept.begin(), kept.end(), key.key) != kept.end()) continue;
      properties[key.key] = schema_of(key);
      properties[key.key]["description"] = text_of_key(key.key, fits);
    }
  }
  properties["shape"] = {{"enum", names}, {"description", description}};
  Json conditions = Json::array();
  for (const ShapeCard& card : shape_cards())
    if (Json condition = shape_condition(card); fits(card) && !condition.is_null())
      conditions.push_back(condition);
  for (const Json& condition : object.at("allOf"))
    if (!condition.contains("if") || !condition.at("if").at("properties").contains("shape"))
      conditions.push_back(condition);
  object["allOf"] = conditions;
}

void put_shapes_of_bodies(Json& body) {
  put_shapes(body, is_any);
  body.at("properties")["kind"]["description"] = fmt::format(
      "free: moves by forces. fixed: never moves. kinematic: follows its motion. "
      "Default: free for {}, fixed for the others, which cannot be free.",
      shape_names(&ShapeCard::may_be_free));
}

}  // namespace

Json parameter_schemas(const std::vector<DynamicsCard>& cards) {
  struct Shared {
    const SolverParameter* parameter;
    std::string owners;
    const DynamicsCard* first;
  };
  std::map<std::string, Shared> all;
  for (const DynamicsCard& card : cards)
    for (const SolverParameter& parameter : card.parameters) {
      const auto [at, is_new] = all.emplace(parameter.key, Shared{&parameter, card.name, &card});
      if (is_new) continue;
      if (!at->second.parameter->takes_as(parameter))
        throw std::logic_error(fmt::format(
            "dynamics \"{}\" and \"{}\" have a parameter \"{}\" that takes other values or has "
            "another default; parameters of one key must be the same",
            at->second.first->name, card.name, parameter.key));
      at->second.owners += fmt::format(", {}", card.name);
    }
  Json out = Json::object();
  for (const auto& [key, shared] : all)
    out[key] = parameter_schema(*shared.parameter, shared.owners);
  return out;
}

void require_same_types(const std::vector<ShapeCard>& cards) {
  std::map<std::string, std::pair<ShapeKey::Type, const char*>> all;
  for (const ShapeCard& card : cards)
    for (const ShapeKey& key : card.keys) {
      const auto& [type, name] = all.emplace(key.key, std::pair{key.type, card.name}).first->second;
      if (type != key.type)
        throw std::logic_error(
            fmt::format("shapes \"{}\" and \"{}\" have a key \"{}\" of two types; keys of one name "
                        "must be the same",
                        name, card.name, key.key));
    }
}

Json schema_with_cards(Json schema) {
  require_same_types(shape_cards());
  put_shapes_of_bodies(schema.at("$defs").at("body"));
  put_shapes(schema.at("$defs").at("particles"), may_be_free, own_particle_keys());
  put_shapes(schema.at("$defs").at("particle_shape"), may_be_free);
  put_shapes(schema.at("$defs").at("shape_part"), may_be_part);
  Json& dynamics = schema.at("$defs").at("dynamics").at("properties");
  dynamics["type"] = type_schema();
  dynamics.update(parameter_schemas(dynamics_cards()));
  Json& solver = schema.at("$defs").at("solver").at("properties");
  solver["name"] = name_schema();
  for (const SharedParameter& shared : solver_parameters())
    solver[shared.parameter.key] =
        parameter_schema(shared.parameter, fmt::format("{}", fmt::join(shared.solvers, ", ")));
  return schema;
}

}  // namespace scree::reader
