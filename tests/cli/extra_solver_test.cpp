// A solver of steps from outside the list, of one file and one line of CMake, is known to every
// part of the program: scene check, runs, schema, help, benchmarks and memory forecast.

#include <cmath>

#include "tests/cli/program.h"

namespace scree::test {
namespace {

using json = nlohmann::json;

Result with_extra_solver(const Scratch& scratch, const Arguments& arguments) {
  return Program(scratch.path(), arguments, 0, {}, SCREE_PROGRAM_WITH_EXTRA_SOLVER).wait();
}

/// Spheres that fall into a container, and nothing else.
json spheres() {
  json scene = small_scene();
  scene["bodies"].erase(scene["bodies"].begin() + 1, scene["bodies"].end());
  scene["solver"] = {{"name", "damped_jacobi"}, {"damping", 0.9}, {"max_iterations", 60}};
  return scene;
}

json capacity(const Scratch& scratch, const std::string& precision) {
  const Result run = with_extra_solver(scratch, {"bench",       "capacity",
                                                 "--sizes",     "3000",
                                                 "--layers",    "20",
                                                 "--warmup",    "60",
                                                 "--steps",     "2",
                                                 "--backend",   "cpu",
                                                 "--threads",   "1",
                                                 "--precision", precision,
                                                 "--set",       "solver.name=damped_jacobi",
                                                 "--json",      "capacity.json"});
  EXPECT_EQ(run.code, 0) << run.err;
  return json_file(scratch / "capacity.json").at("results").at(0);
}

TEST(CliExtraSolver, IsUnknownToTheProgramWithoutIt) {
  const Scratch scratch;
  const Result refused = scree(scratch, {"check", put_scene(scratch, spheres()).string()});
  EXPECT_EQ(refused.code, 2);
  EXPECT_TRUE(holds(refused.err, "damping") || holds(refused.err, "damped_jacobi")) << refused.err;
}

TEST(CliExtraSolver, ScenesWithItAreCheckedAndRun) {
  const Scratch scratch;
  const std::string scene = put_scene(scratch, spheres()).string();
  const Result check = with_extra_solver(scratch, {"check", scene, "--json"});
  ASSERT_EQ(check.code, 0) << check.err;
  EXPECT_EQ(json::parse(check.out).at("solver"), "damped_jacobi");
  for (const char* damping : {"0.9", "0.1"}) {
    const Result run = with_extra_solver(
        scratch, run_arguments(scene, scratch / damping,
                               {"--set", "solver.damping=" + std::string(damping)}));
    ASSERT_EQ(run.code, 0) << run.err;
  }
  EXPECT_NE(steps_without_times(scratch / "0.9" / "steps.csv"),
            steps_without_times(scratch / "0.1" / "steps.csv"))
      << "the parameter does nothing";
}

TEST(CliExtraSolver, ItsParameterIsChecked) {
  const Scratch scratch;
  const std::string scene = put_scene(scratch, spheres()).string();
  const Result range = with_extra_solver(scratch, {"check", scene, "--set", "solver.damping=1.5"});
  EXPECT_EQ(range.code, 2);
  EXPECT_TRUE(holds(
      range.err,
      "solver.damping (overridden): 1.5 is not allowed: must be between 0 and 1, both excluded"))
      << range.err;
  const Result name =
      with_extra_solver(scratch, {"check", scene, "--set", "solver.name=damped_jacob"});
  EXPECT_EQ(name.code, 2);
  EXPECT_TRUE(holds(name.err, "did you mean \"damped_jacobi\"")) << name.err;
}

TEST(CliExtraSolver, ContactsThatItDoesNotKnowAreRefused) {
  const Scratch scratch;
  json scene = spheres();
  scene["materials"]["m"]["rolling_friction"] = 1e-3;
  const std::string path = put_scene(scratch, scene).string();
  for (const char* command : {"check", "run"}) {
    const Result refused = with_extra_solver(scratch, {command, path});
    EXPECT_EQ(refused.code, 2) << command;
    EXPECT_TRUE(holds(refused.err, "solver.name: \"damped_jacobi\" is not allowed")) << refused.err;
    EXPECT_TRUE(holds(refused.err, "rolling")) << refused.err;
  }
}

TEST(CliExtraSolver, IsInTheSchema) {
  const Scratch scratch;
  const Result result = with_extra_solver(scratch, {"info", "--schema"});
  ASSERT_EQ(result.code, 0) << result.err;
  const json solver = json::parse(result.out).at("$defs").at("solver").at("properties");
  EXPECT_EQ(solver.at("name").at("enum").back(), "damped_jacobi");
  EXPECT_TRUE(holds(solver.at("name").at("description"), "Jacobi steps of one size, for spheres"));
  const json damping = {{"type", "number"},
                        {"exclusiveMinimum", 0},
                        {"exclusiveMaximum", 1},
                        {"default", 0.8},
                        {"description", "damped_jacobi: part of the safe step [-]."}};
  EXPECT_EQ(solver.at("damping"), damping);
}

TEST(CliExtraSolver, IsInTheHelp) {
  const Scratch scratch;
  for (const Arguments& command : {Arguments{"info"}, Arguments{"bench", "solvers", "--help"}}) {
    const Result result = with_extra_solver(scratch, command);
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_TRUE(holds(result.out, "damped_jacobi")) << result.out;
    EXPECT_TRUE(holds(result.out, "Jacobi steps of one size, for spheres")) << result.out;
  }
}

TEST(CliExtraSolver, IsBenchmarked) {
  const Scratch scratch;
  const Result result =
      with_extra_solver(scratch, {"bench", "solvers", "--sizes", "300", "--layers", "5", "--levels",
                                  "0.01", "--limit", "5", "--solvers", "damped_jacobi,apgd",
                                  "--backend", "cpu", "--threads", "1", "--json", "solvers.json"});
  ASSERT_EQ(result.code, 0) << result.err;
  const json document = json_file(scratch / "solvers.json");
  int rows = 0;
  for (const json& row : document.at("results")) {
    if (row.at("solver") != "damped_jacobi") continue;
    ++rows;
    EXPECT_EQ(row.at("reached"), true);
    const double least =
        88 * row.at("contacts").get<double>() + 88 * row.at("bodies").get<double>();
    EXPECT_NEAR(row.at("least_bytes_per_iteration").get<double>(), least, 1e-6 * least);
  }
  EXPECT_EQ(rows, 2);  // warm and cold
}

TEST(CliExtraSolver, ItsMemoryIsPredicted) {
  const Scratch scratch;
  for (const char* precision : {"float", "double"}) {
    const json result = capacity(scratch, precision);
    const double ratio = result.at("expected_memory_bytes").get<double>() /
                         result.at("peak_memory_bytes").get<double>();
    EXPECT_GE(ratio, 0.98) << precision;
    EXPECT_LE(ratio, 1.1) << precision;
  }
}

TEST(CliExtraSolver, ContactsOfTwoGroupsAreOneForASolverThatKnowsNoGroups) {
  const Scratch scratch;
  json scene = small_scene();  // with a wall that turns
  const std::string path = put_scene(scratch, scene).string();
  const Result groups = scree(scratch, {"check", path, "--json"});
  ASSERT_EQ(groups.code, 0) << groups.err;
  ASSERT_EQ(json::parse(groups.out).at("contact_layout"), "mixed");
  scene["solver"] = {{"name", "damped_jacobi"}, {"max_iterations", 60}};
  put_scene(scratch, scene);
  const Result check = with_extra_solver(scratch, {"check", path, "--json"});
  ASSERT_EQ(check.code, 0) << check.err;
  EXPECT_EQ(json::parse(check.out).at("contact_layout"), "general");
  const Result run =
      with_extra_solver(scratch, run_arguments(path, scratch / "a", {"--steps", "5"}));
  EXPECT_EQ(run.code, 0) << run.err;
}

}  // namespace
}  // namespace scree::test
