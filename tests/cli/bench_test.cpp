// scree bench: every benchmark on tiny beds, its JSON file, and bad options.

#include <cmath>

#include "dynamics/dynamics_card.h"
#include "tests/cli/program.h"

namespace scree::test {
namespace {

using json = nlohmann::json;

/// Runs a benchmark on one CPU thread and returns its JSON file.
json bench(const Scratch& scratch, const Arguments& arguments) {
  Arguments all{"bench"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  all.insert(all.end(), {"--backend", "cpu", "--threads", "1", "--json", "bench.json"});
  const Result result = scree(scratch, all);
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_NE(result.out.find("bodies"), std::string::npos) << result.out;
  const json document = json_file(scratch / "bench.json");
  EXPECT_EQ(document.at("benchmark"), arguments.at(0));
  EXPECT_EQ(document.at("backend"), "cpu");
  EXPECT_EQ(document.at("precision"), "float");
  EXPECT_EQ(document.at("threads"), 1);
  for (const char* key : {"device", "commit", "date"})
    EXPECT_FALSE(document.at(key).get<std::string>().empty()) << key;
  return document;
}

/// Expected over held memory of a result of `capacity`.
double expected_over_peak(const json& result) {
  return result.at("expected_memory_bytes").get<double>() /
         result.at("peak_memory_bytes").get<double>();
}

/// What holds for the figures of steps of any benchmark.
void expect_sound_steps(const json& result) {
  EXPECT_GT(result.at("contacts"), 0.0);
  EXPECT_GE(result.at("applications"), result.at("iterations"));
  EXPECT_GT(result.at("residual_rms_m_per_s"), 0.0);
  const double v_star = 5e-4 * 9.81;
  EXPECT_NEAR(result.at("residual_rms_m_per_s").get<double>(),
              v_star * result.at("residual_relative").get<double>(), 1e-6 * v_star);
  double stages = 0;
  for (const char* stage : {"collision", "setup", "solve", "integrate"}) {
    const json& ms = result.at("ms").at(stage);
    EXPECT_LE(ms.at("min"), ms.at("median")) << stage;
    EXPECT_LE(ms.at("median"), ms.at("max")) << stage;
    stages += ms.at("mean").get<double>();
  }
  EXPECT_NEAR(result.at("ms").at("total").at("mean").get<double>(), stages, 1e-6 * stages);
  // A step at rest may need none.
  const double iterations = result.at("iterations");
  EXPECT_EQ(result.at("contact_iterations_per_s") > 0.0, iterations > 0);
  EXPECT_GT(result.at("body_seconds_per_s"), 0.0);
  EXPECT_NEAR(result.at("memory_bytes_per_body").get<double>() * result.at("bodies").get<double>(),
              result.at("peak_memory_bytes").get<double>(), 1);
}

TEST(CliBench, Iteration) {
  const Scratch scratch;
  const json document = bench(scratch, {"iteration", "--sizes", "300,6e2", "--layers", "5",
                                        "--steps", "2", "--set", "solver.max_iterations=30"});
  EXPECT_GT(document.at("copy_bandwidth_bytes_per_s"), 1e8);
  ASSERT_EQ(document.at("results").size(), 2u);
  EXPECT_EQ(document.at("results")[0].at("bodies"), 300);
  for (const json& result : document.at("results")) {
    expect_sound_steps(result);
    EXPECT_EQ(result.at("applications"), 30.0);
    const double least =
        56 * result.at("contacts").get<double>() + 112 * result.at("bodies").get<double>();
    EXPECT_NEAR(result.at("least_bytes_per_iteration").get<double>(), least, 1e-6 * least);
    EXPECT_GT(result.at("of_copy_bandwidth"), 0.0);
    EXPECT_LT(result.at("start_rms_speed_relative"), 10.0) << "the bed has not settled";
  }
}

TEST(CliBench, IterationsOfEverySolverTellTheBytesTheyMove) {
  const Scratch scratch;
  struct Bytes {
    const char* solver;
    double contact, body;
  };
  for (const Bytes& each : {Bytes{"jacobi", 60 + 28, 24 + 64}, Bytes{"gauss_seidel", 60, 56},
                            Bytes{"gauss_seidel_colored", 60, 56}, Bytes{"schwarz", 60, 72}}) {
    const json document = bench(
        scratch, {"iteration", "--sizes", "300", "--layers", "5", "--steps", "2", "--set",
                  "solver.max_iterations=20", "--set", std::string("solver.name=") + each.solver});
    const json& result = document.at("results").at(0);
    const double least = each.contact * result.at("contacts").get<double>() +
                         each.body * result.at("bodies").get<double>();
    EXPECT_NEAR(result.at("least_bytes_per_iteration").get<double>(), least, 1e-6 * least)
        << each.solver;
    const double rate = least * result.at("applications").get<double>() /
                        (1e-3 * result.at("ms").at("solve").at("mean").get<double>());
    EXPECT_NEAR(result.at("bytes_per_s").get<double>(), rate, 1e-6 * rate) << each.solver;
  }
}

TEST(CliBench, CollisionOfEqualAndOfMixedSpheres) {
  const Scratch scratch;
  for (const bool mixed : {false, true}) {
    Arguments arguments{"collision", "--sizes", "400", "--layers", "4", "--steps", "2"};
    if (mixed) arguments.insert(arguments.end(), {"--polydisperse", "--warmup", "20"});
    const json result = bench(scratch, arguments).at("results").at(0);
    expect_sound_steps(result);
    EXPECT_EQ(result.at("polydisperse"), mixed);
    EXPECT_NEAR(
        result.at("collision_ns_per_contact").get<double>() * result.at("contacts").get<double>(),
        1e6 * result.at("ms").at("collision").at("median").get<double>(), 1);
  }
}

TEST(CliBench, StepsOfABedAndOfAColumn) {
  const Scratch scratch;
  for (const char* scene : {"bed", "column"}) {
    const json document = bench(
        scratch, {"step", "--sizes", "300", "--layers", "6", "--steps", "2", "--kind", scene});
    ASSERT_EQ(document.at("results").size(), 2u);
    double level = 0.01;
    for (const json& result : document.at("results")) {
      expect_sound_steps(result);
      EXPECT_EQ(result.at("scene"), scene);
      if (std::string(scene) == "bed") {
        EXPECT_LE(result.at("start_rms_speed_relative"), 0.3);
      }
      EXPECT_EQ(result.at("stop"), level < 0.02 ? "quality" : "preview");
      EXPECT_TRUE(result.at("converged"));
      EXPECT_LE(result.at("residual_relative"), 1.01 * level);
      level = 0.03;
      const double share = result.at("bytes_per_s").get<double>() /
                           document.at("copy_bandwidth_bytes_per_s").get<double>();
      EXPECT_NEAR(result.at("of_copy_bandwidth").get<double>(), share, 1e-6 * share);
    }
  }
}

TEST(CliBench, StepsToALevelOfYourOwn) {
  const Scratch scratch;
  // While it still sinks: a bed at rest may meet a level without an iteration.
  const Arguments bed{"step", "--sizes", "300", "--layers", "6", "--steps", "2", "--warmup", "40"};
  std::vector<std::string> states;
  for (const char* level : {"preview", "1e-4", "quality"}) {
    Arguments arguments = bed;
    arguments.insert(arguments.end(), {"--set", std::string("solver.stop=") + level});
    const json document = bench(scratch, arguments);
    ASSERT_EQ(document.at("results").size(), 1u);
    const json& result = document.at("results").at(0);
    EXPECT_EQ(result.at("stop"), level);
    expect_sound_steps(result);
    states.push_back(result.at("state_hash"));
  }
  // The bed before is not the same: the warm-up goes to that level too.
  const json both = bench(scratch, bed);
  EXPECT_EQ(both.at("results").at(0).at("state_hash"), states[2]);
  EXPECT_NE(both.at("results").at(1).at("state_hash"), states[0]);
  EXPECT_NE(states[0], states[1]);
}

TEST(CliBench, StepsOfMixedSpheres) {
  const Scratch scratch;
  for (const char* kind : {"bed", "column"}) {
    const json document = bench(scratch, {"step", "--sizes", "700", "--steps", "1", "--warmup",
                                          "10", "--polydisperse", "--kind", kind});
    ASSERT_EQ(document.at("results").size(), 2u);
    for (const json& result : document.at("results")) {
      expect_sound_steps(result);
      EXPECT_EQ(result.at("polydisperse"), true);
      EXPECT_EQ(result.at("layers"), std::string(kind) == "bed" ? 20 : 1);
    }
  }
}

TEST(CliBench, SolversReachTheSameAnswer) {
  const Scratch scratch;
  const json document = bench(scratch, {"solvers", "--sizes", "200", "--layers", "4", "--levels",
                                        "1e-2,1e-3", "--limit", "20"});
  const json& results = document.at("results");
  ASSERT_EQ(results.size(), 5u * 2u * 2u);  // solvers, warm and cold, levels
  double lowest = 0, highest = -1;
  for (const json& result : results) {
    EXPECT_EQ(result.at("contacts"), results[0].at("contacts"));
    ASSERT_TRUE(result.at("reached")) << result;
    const double level = result.at("level");
    EXPECT_LE(result.at("residual_relative"), 1.01 * level) << result;
    EXPECT_NEAR(result.at("residual_rms_m_per_s").get<double>(),
                result.at("residual_relative").get<double>() * 5e-4 * 9.81, 1e-9);
    EXPECT_GT(result.at("solve_ms"), 0.0);
    expect_sound_steps(result);
    EXPECT_EQ(result.at("ms").at("solve").at("mean"), result.at("solve_ms"));
    if (level < 5e-3) {
      const double objective = result.at("objective_J");
      lowest = highest < lowest ? objective : std::min(lowest, objective);
      highest = highest < lowest ? objective : std::max(highest, objective);
    }
  }
  EXPECT_LT(lowest, 0.0);
  EXPECT_NEAR(lowest, highest, 1e-2 * std::abs(lowest));  // they solve one problem
}

TEST(CliBench, SolversThatRunOutOfTimeSayHowFarTheyGot) {
  const Scratch scratch;
  const json document =
      bench(scratch, {"solvers", "--sizes", "400", "--layers", "20", "--warmup", "30", "--levels",
                      "1e-1,1e-5", "--solvers", "jacobi", "--limit", "1e-3"});
  const json& last = document.at("results").at(3);
  EXPECT_EQ(last.at("solver"), "jacobi");
  EXPECT_EQ(last.at("start"), "cold");
  EXPECT_FALSE(last.at("reached"));
  EXPECT_GT(last.at("residual_relative"), 1e-5);
  EXPECT_GT(last.at("applications"), 0);
}

TEST(CliBench, CapacityComparesMemoryAndEndsWhereItDoesNotFit) {
  const Scratch scratch;
  const json document =
      bench(scratch, {"capacity", "--sizes", "2000,1900000000,2000", "--steps", "3"});
  ASSERT_EQ(document.at("results").size(), 2u);
  EXPECT_FALSE(document.at("results").at(1).at("fits"));
  EXPECT_NE(document.at("results").at(1).at("reason").get<std::string>().find("bodies fit"),
            std::string::npos);
  const json& result = document.at("results").at(0);
  EXPECT_TRUE(result.at("fits"));
  EXPECT_NEAR(expected_over_peak(result), 1, 0.1);
  EXPECT_NEAR(result.at("bodies_that_fit").get<double>(),
              document.at("device_memory_bytes").get<double>() /
                  result.at("memory_bytes_per_body").get<double>(),
              1);
}

TEST(CliBench, MemoryOfASettledBedIsPredicted) {
  const Scratch scratch;
  for (const char* precision : {"float", "double"}) {
    for (const char* solver :
         {"apgd", "schwarz", "gauss_seidel_colored", "gauss_seidel", "jacobi"}) {
      const bool is_wide =
          precision == std::string("double");  // arrays are twice as wide, no others
      if (is_wide && solver != std::string("apgd")) continue;
      const Result run =
          scree(scratch, {"bench",     "capacity",  "--sizes",
                          "3000",      "--layers",  "20",
                          "--warmup",  "60",        "--steps",
                          "2",         "--backend", "cpu",
                          "--threads", "1",         "--precision",
                          precision,   "--set",     std::string("solver.name=") + solver,
                          "--json",    "bench.json"});
      ASSERT_EQ(run.code, 0) << run.err;
      const double ratio =
          expected_over_peak(json_file(scratch / "bench.json").at("results").at(0));
      EXPECT_GE(ratio, 0.98) << solver << " in " << precision;
      EXPECT_LE(ratio, 1.1) << solver << " in " << precision;
    }
  }
}

TEST(CliBench, MemoryOfMixedSpheresIsPredicted) {
  const Scratch scratch;
  const json result = bench(scratch, {"capacity", "--sizes", "9000", "--polydisperse", "--layers",
                                      "10", "--warmup", "120", "--steps", "2"})
                          .at("results")
                          .at(0);
  EXPECT_EQ(result.at("polydisperse"), true);
  EXPECT_GE(expected_over_peak(result), 0.98);
  EXPECT_LE(expected_over_peak(result), 1.1);
}

TEST(CliBench, SceneIsTheDefaultMode) {
  const Scratch scratch;
  const fs::path scene = put_scene(scratch, small_scene());
  const json document = bench(scratch, {"scene", scene.string(), "--warmup", "15", "--steps", "2"});
  const json& result = document.at("results").at(0);
  EXPECT_EQ(result.at("bodies"), 200);
  const Result direct = scree(scratch, {"bench", scene.string(), "--backend", "cpu", "--threads",
                                        "1", "--warmup", "15", "--steps", "2", "--json"});
  EXPECT_EQ(direct.code, 0) << direct.err;
  EXPECT_EQ(json::parse(direct.out).at("contacts"), result.at("contacts"));
}

/// A box that falls beside one that rests.
constexpr const char* kAffineScene = R"({
  "name": "boxes", "time_step": 0.01, "duration": 1, "dynamics": {"type": "affine", "reach": 0.01},
  "bodies": [
    {"shape": "box", "kind": "fixed", "size": [4, 4, 0.1], "position": [0, 0, -0.05]},
    {"shape": "box", "size": [0.2, 0.2, 0.2], "density": 1000, "position": [0, 0, 0.1099]},
    {"shape": "box", "size": [0.2, 0.2, 0.2], "density": 1000, "position": [1, 0, 1]}]
})";

TEST(CliBench, AffineScenesHaveALineEach) {
  if (find_dynamics("affine") == nullptr) GTEST_SKIP() << "no dynamics \"affine\"";
  const Scratch scratch;
  const fs::path scene = put(scratch / "boxes.json", kAffineScene);
  const Result result =
      scree(scratch, {"bench", "affine", scene.string(), scene.string(), "--backend", "cpu",
                      "--threads", "1", "--warmup", "1", "--steps", "3", "--json", "bench.json"});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_TRUE(holds(result.out, "frames/s")) << result.out;
  const json document = json_file(scratch / "bench.json");
  EXPECT_EQ(document.at("precision"), "double");
  ASSERT_EQ(document.at("results").size(), 2u);
  const json& first = document.at("results")[0];
  EXPECT_EQ(first.at("scene"), "boxes");
  EXPECT_EQ(first.at("bodies"), 2);
  EXPECT_GE(first.at("contacts"), 4.0);
  EXPECT_GE(first.at("iterations"), 1.0);
  EXPECT_GT(first.at("min_gap_m"), 0.0);
  EXPECT_LT(first.at("min_gap_m"), 0.01);
  EXPECT_TRUE(first.at("converged"));
  EXPECT_NEAR(
      first.at("frames_per_s").get<double>() * first.at("ms").at("total").at("mean").get<double>(),
      1e3, 1e-6);
  EXPECT_EQ(first.at("contacts"), document.at("results")[1].at("contacts"));
}

TEST(CliBench, AffineTakesNoOtherScenes) {
  if (find_dynamics("affine") == nullptr) GTEST_SKIP() << "no dynamics \"affine\"";
  const Scratch scratch;
  const Result result = scree(scratch, {"bench", "affine", "pile", "--backend", "cpu"});
  EXPECT_EQ(result.code, 2);
  EXPECT_TRUE(
      holds(result.err, "pile: dynamics.type: \"rigid\" is not allowed: expected \"affine\""))
      << result.err;
}

TEST(CliBench, EveryBenchmarkHasHelp) {
  const Scratch scratch;
  const Result all = scree(scratch, {"bench", "--help"});
  for (const char* mode :
       {"scene", "affine", "iteration", "collision", "step", "solvers", "capacity"}) {
    EXPECT_NE(all.out.find(mode), std::string::npos) << mode;
    EXPECT_EQ(scree(scratch, {"bench", mode, "--help"}).code, 0) << mode;
  }
}

struct BadBench {
  std::string name;
  Arguments arguments;
  std::vector<std::string> words;  ///< that the message holds
};

std::ostream& operator<<(std::ostream& out, const BadBench& bad) { return out << bad.name; }

class CliBadBench : public testing::TestWithParam<BadBench> {};

TEST_P(CliBadBench, IsRefused) {
  const Scratch scratch;
  Arguments all{"bench"};
  all.insert(all.end(), GetParam().arguments.begin(), GetParam().arguments.end());
  const Result result = scree(scratch, all);
  EXPECT_EQ(result.code, 2) << result.out;
  EXPECT_EQ(line_count(result.err), 1u) << result.err;
  for (const std::string& word : GetParam().words)
    EXPECT_NE(result.err.find(word), std::string::npos) << word << " in: " << result.err;
  EXPECT_FALSE(fs::exists(scratch / "x.json"));
}

INSTANTIATE_TEST_SUITE_P(
    Options, CliBadBench,
    testing::Values(
        BadBench{"UnknownMode", {"iterations"}, {"iterations", "known benchmarks", "capacity"}},
        BadBench{"UnknownOption", {"step", "--size", "5"}, {"--size", "scree bench step --help"}},
        BadBench{"ZeroSize",
                 {"iteration", "--sizes", "0", "--json", "x.json"},
                 {"--sizes", "\"0\"", "numbers of bodies from 1"}},
        BadBench{"HalfASize", {"step", "--sizes", "10,2.5"}, {"--sizes", "\"2.5\""}},
        BadBench{
            "TooLargeSize", {"step", "--sizes", "1e12"}, {"--sizes", "\"1e12\"", "2000000000"}},
        BadBench{"WordForSize", {"capacity", "--sizes", "many"}, {"--sizes", "\"many\""}},
        BadBench{"ZeroLayers", {"step", "--layers", "0"}, {"--layers", "\"0\""}},
        BadBench{"SeveralLayers",
                 {"step", "--backend", "cpu", "--layers", "3,4"},
                 {"--layers", "2 values", "expected one"}},
        BadBench{"ZeroSteps", {"collision", "--steps", "0"}, {"--steps"}},
        BadBench{"UnknownScene",
                 {"step", "--backend", "cpu", "--kind", "drum"},
                 {"--kind", "\"drum\"", "bed or column"}},
        BadBench{"UnknownSolver",
                 {"solvers", "--backend", "cpu", "--solvers", "newton"},
                 {"--solvers", "\"newton\"", "apgd"}},
        BadBench{"NegativeLevel",
                 {"solvers", "--backend", "cpu", "--levels", "-1"},
                 {"--levels", "\"-1\"", "positive"}},
        BadBench{"ZeroLimit", {"solvers", "--backend", "cpu", "--limit", "0"}, {"--limit", "0"}},
        BadBench{"UnknownBackend", {"step", "--backend", "gpu"}, {"\"gpu\"", "cuda, cpu or auto"}},
        BadBench{"SetUnknownKey",
                 {"step", "--backend", "cpu", "--set", "foo=1"},
                 {"foo", "unknown key"}},
        BadBench{"SetParticles",
                 {"step", "--backend", "cpu", "--set", "particles.0.count=5"},
                 {"particles.0.count=5", "given"}},
        BadBench{"JsonInNoFolder",
                 {"step", "--backend", "cpu", "--json", "none/x.json"},
                 {"--json", "none/x.json", "no folder"}},
        BadBench{"JsonIsAFolder",
                 {"iteration", "--backend", "cpu", "--json", "."},
                 {"--json", "not a file"}},
        BadBench{"JsonInsteadOfAScene", {"--json", "pile"}, {"--json", "\"pile\"", ".json"}}),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace scree::test
