// The published schema, the reader and the scene files agree.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "dynamics/dynamics_card.h"
#include "host/error.h"
#include "host/scene_reader.h"
#include "host/scene_reader/keys.h"
#include "host/scene_reader/scene_schema.h"
#include "shapes/shape_card.h"
#include "solvers/solver_card.h"
#include "tests/urdf_support.h"

namespace scree {
namespace {

using Json = nlohmann::json;

Json schema() {
  std::ifstream file(SCREE_SCENE_DIR "/schema.json");
  return Json::parse(file);
}

/// The part of the schema that describes an object of a key table.
const Json& part(const Json& schema, const std::string& object) {
  return object == "scene" ? schema : schema.at("$defs").at(object);
}

TEST(Schema, KnowsTheKeysOfTheReaderAndNoOthers) {
  const Json document = schema();
  for (const KeyTable& table : scene_key_tables()) {
    const Json& object = part(document, table.object);
    std::set<std::string> described;
    for (const auto& [key, value] : object.at("properties").items()) described.insert(key);
    EXPECT_EQ(described, std::set<std::string>(table.keys.begin(), table.keys.end()))
        << table.object;
    EXPECT_EQ(object.at("additionalProperties"), Json(false)) << table.object;
  }
}

TEST(Schema, DescribesEveryObjectThatTheReaderKnows) {
  std::set<std::string> known;
  for (const KeyTable& table : scene_key_tables()) known.insert(table.object);
  const Json document = schema();
  for (const auto& [name, definition] : document.at("$defs").items())
    EXPECT_TRUE(known.count(name) == 1 || !definition.contains("properties")) << name;
}

TEST(Schema, DescribesEveryKey) {
  const Json document = schema();
  for (const KeyTable& table : scene_key_tables())
    for (const auto& [key, value] : part(document, table.object).at("properties").items()) {
      const bool itself = value.contains("description");
      const bool by_reference =
          value.contains("$ref") &&
          part(document, value["$ref"].get<std::string>().substr(8)).contains("description");
      EXPECT_TRUE(itself || by_reference) << table.object << "." << key;
    }
}

/// The lower bound of a number, or of each of a list.
bool is_bounded(const Json& value) {
  const Json& number = value.contains("items") ? value.at("items") : value;
  return number.value("exclusiveMinimum", -1.0) == 0;
}

TEST(Schema, BoundsWhatItCallsPositive) {
  const Json document = schema();
  int count = 0;
  for (const KeyTable& table : scene_key_tables())
    for (const auto& [key, value] : part(document, table.object).at("properties").items()) {
      if (value.value("description", "").find("], positive.") == std::string::npos) continue;
      EXPECT_TRUE(is_bounded(value)) << table.object << "." << key;
      ++count;
    }
  EXPECT_GE(count, 6);
}

/// The reader has the same bound.
TEST(Schema, WhatItBoundsIsRefused) {
  const auto refuses = [](const std::string& key, const std::string& entries) {
    try {
      parse_scene(R"({"time_step": 1e-3, "duration": 0, )" + entries + "}", "scene", ".");
    } catch (const InputError& error) {
      return std::string(error.what()).find(key) != std::string::npos;
    }
    return false;
  };
  const std::string sphere = R"({"shape": "sphere", "radius": 0.1)";
  for (const char* wrong : {"0", "-0.1"}) {
    const std::string size = std::string(R"("size": [0.1, )") + wrong + ", 0.1]";
    for (const std::string shape : {"box", "ellipsoid", "container"}) {
      const std::string body = R"({"shape": ")" + shape + R"(", "density": 1000, )" + size + "}";
      EXPECT_TRUE(refuses("size", R"("bodies": [)" + body + "]")) << body;
    }
    const std::string part = R"({"shape": "box", )" + size + "}";
    const std::string compound =
        R"({"shape": "compound", "density": 1000, "parts": [)" + part + "]}";
    EXPECT_TRUE(refuses("size", R"("bodies": [)" + compound + "]")) << compound;
    const std::string set =
        R"({"layout": "lattice", "shape": "box", "count": 1, "density": 1000, )" + size +
        R"(, "region": {"min": [0, 0, 0], "max": [1, 1, 1]}})";
    EXPECT_TRUE(refuses("size", R"("particles": [)" + set + "]")) << set;
    const std::string inertia = std::string(R"(, "mass": 1, "inertia": [1, )") + wrong + ", 1]}";
    EXPECT_TRUE(refuses("inertia", R"("bodies": [)" + sphere + inertia + "]")) << inertia;
  }
}

TEST(Schema, TellsSolversAndModelsAsTheirCardsDo) {
  std::ifstream file(SCREE_SCENE_DIR "/schema.json");
  const auto published = reader::Json::parse(file);
  const auto complete = reader::schema_with_cards(published);
  EXPECT_EQ(Json::parse(published.dump()), Json::parse(complete.dump()));
}

TEST(Schema, ParametersThatSolversShareAreTheSame) {
  for (const SolverCard& card : solver_cards())
    for (const SolverParameter& own : card.parameters)
      for (const auto& [shared, solvers] : solver_parameters()) {
        if (std::string(own.key) != shared.key) continue;
        EXPECT_EQ(std::string(own.description), shared.description) << card.name;
        EXPECT_EQ(own.standard, shared.standard) << card.name;
        EXPECT_EQ(own.expected(), shared.expected()) << card.name;
        EXPECT_TRUE(own.allows(own.standard)) << card.name;
      }
}

TEST(Schema, RequiredKeysOfTheDocumentAreThoseOfTheReader) {
  EXPECT_EQ(schema().at("required"), Json({"time_step", "duration"}));
}

TEST(SceneFiles, AllPassTheReader) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(SCREE_SCENE_DIR)) {
    const std::filesystem::path path = entry.path();
    if (path.extension() != ".json" || path.filename() == "schema.json") continue;
    if (path.stem() == "rover" && !test::reads_urdf()) continue;
    // A million bodies are a matter of seconds and memory; the layout is the same with fewer.
    std::vector<std::string> overrides;
    if (path.stem() == "million") overrides = {"particles.0.count=20000"};
    const Scene scene = read_scene(path, overrides);
    EXPECT_EQ(scene.name, path.stem().string());
    EXPECT_FALSE(scene.output.picture.camera.automatic) << path;
    ++count;
  }
  EXPECT_GE(count, 7);
}

TEST(SceneFiles, PileHasTenThousandSpheres) {
  const Scene scene = read_scene(SCREE_SCENE_DIR "/pile.json");
  std::size_t count = 0;
  for (const Insertion& insertion : scene.insertions)
    for (const ParticleSet& set : insertion.particles) count += set.position.size();
  EXPECT_EQ(count, 10000u);
}

/// What is thrown, or nothing.
template <class F>
std::string fault_of(F f) {
  try {
    f();
  } catch (const std::logic_error& error) {
    return error.what();
  }
  return {};
}

constexpr SolverParameter kFactor{
    .key = "factor", .description = "of it [-].", .standard = 0.5, .low = 0, .high = 1};
constexpr SolverParameter kWideFactor{
    .key = "factor", .description = "of it [-].", .standard = 0.5, .low = 0, .high = 10};

TEST(Schema, ModelsWithAKeyInCommonTakeTheSameValuesOfIt) {
  const std::vector<SolverParameter> narrow{kFactor}, wide{kWideFactor};
  const auto schemas = [&](const std::vector<SolverParameter>& second) {
    std::vector<DynamicsCard> cards(2, dynamics_card("rigid"));
    cards[0].name = "first";
    cards[0].parameters = narrow;
    cards[1].name = "second";
    cards[1].parameters = second;
    return reader::parameter_schemas(cards);
  };
  EXPECT_EQ(schemas(narrow).at("factor").at("description"), "first, second: of it [-].");
  EXPECT_EQ(schemas(narrow).at("factor").at("exclusiveMaximum"), 1);
  const std::string fault = fault_of([&] { schemas(wide); });
  for (const char* word : {"\"first\"", "\"second\"", "\"factor\""})
    EXPECT_NE(fault.find(word), std::string::npos) << fault;
}

TEST(Schema, ShapesWithAKeyInCommonReadTheSameType) {
  EXPECT_EQ(fault_of([] { reader::require_same_types(shape_cards()); }), "");
  std::vector<ShapeCard> cards = shape_cards();
  const ShapeKey radius[]{{"radius", ShapeKey::Type::vector, "three radii [m].", true}};
  ShapeCard ellipsoid = cards.front();
  ellipsoid.name = "ellipsoid";
  ellipsoid.keys = radius;
  cards.push_back(ellipsoid);
  const std::string fault = fault_of([&] { reader::require_same_types(cards); });
  for (const char* word : {"\"sphere\"", "\"ellipsoid\"", "\"radius\""})
    EXPECT_NE(fault.find(word), std::string::npos) << fault;
}

/// What a card says of a range, the reader and messages follow.
TEST(Schema, ValuesAtTheLowEndOfARangeAreReadWhereTheyAreInIt) {
  int allowed = 0;
  for (const DynamicsCard& card : dynamics_cards()) {
    for (const SolverParameter& parameter : card.parameters) {
      if (!parameter.choices.empty()) continue;
      const Json ball = {{"shape", "sphere"}, {"radius", 0.1}, {"density", 1000}};
      const Json scene = {{"time_step", 1e-3},
                          {"duration", 0},
                          {"bodies", {ball}},
                          {"dynamics", {{"type", card.name}, {parameter.key, parameter.low}}}};
      const auto read = [&] { return parse_scene(scene.dump(), "scene.json", "."); };
      if (!parameter.is_low_allowed) {
        EXPECT_THROW(read(), std::exception) << parameter.key;
        continue;
      }
      ++allowed;
      EXPECT_EQ(read().dynamics.parameters.at(parameter.key), parameter.low) << parameter.key;
    }
  }
  EXPECT_GE(allowed, 6);
}

}  // namespace
}  // namespace scree
