// scree check, info, bench, help; and every scene of the scenes folder.

#include "tests/cli/program.h"
#include "tests/steps_file.h"
#include "tests/urdf_support.h"

namespace scree::test {
namespace {

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(SCREE_SCENE_DIR))
    if (entry.path().extension() == ".json" && entry.path().stem() != "schema" &&
        (entry.path().stem() != "rover" || reads_urdf()))
      names.push_back(entry.path().stem());
  std::sort(names.begin(), names.end());
  return names;
}

TEST(CliCommands, CheckPrintsTextAndJson) {
  const Scratch scratch;
  const fs::path scene = put_scene(scratch, small_scene());
  const Result text = scree(scratch, {"check", scene.string()});
  EXPECT_EQ(text.code, 0) << text.err;
  for (const char* part :
       {"small: valid", "200 free, 3 fixed or moved", "0.001 s, 20 steps", "apgd"})
    EXPECT_NE(text.out.find(part), std::string::npos) << text.out;

  const Result json =
      scree(scratch, {"check", scene.string(), "--json", "--set", "particles.0.count=100"});
  EXPECT_EQ(json.code, 0) << json.err;
  const nlohmann::json values = nlohmann::json::parse(json.out);
  EXPECT_EQ(values.at("free_bodies"), 150);
  EXPECT_EQ(values.at("steps"), 20);
  EXPECT_GT(values.at("expected_memory_bytes"), 0);
}

TEST(CliCommands, ASceneThatDoesNotFitIsRefusedWithTheNumberOfBodiesThatDo) {
  const Scratch scratch;
  const fs::path scene = put_scene(scratch, small_scene());  // 203 bodies of about 430 bytes
  const Result check = scree(scratch, {"check", scene.string(), "--memory", "0.06", "--json"});
  EXPECT_EQ(check.code, 0) << check.err;
  const nlohmann::json values = nlohmann::json::parse(check.out);
  EXPECT_EQ(values.at("fits"), false);
  const double fit = values.at("bodies_that_fit");
  EXPECT_GT(fit, 50);
  EXPECT_LT(fit, 203);
  EXPECT_LE(values.at("free_memory_bytes"), values.at("device_memory_bytes"));
  const std::string number = std::to_string(static_cast<int>(fit));
  const Result text = scree(scratch, {"check", scene.string(), "--memory", "0.06"});
  EXPECT_NE(text.out.find("does not fit: about " + number + " bodies do"), std::string::npos)
      << text.out;
  for (const Arguments& command :
       {Arguments{"run"}, Arguments{"bench"}, Arguments{"bench", "scene"}}) {
    Arguments all = command;
    all.insert(all.end(), {scene.string(), "--memory", "0.06"});
    const Result refused = scree(scratch, all);
    EXPECT_EQ(refused.code, 2) << command.back();
    EXPECT_NE(refused.err.find("about " + number + " bodies fit"), std::string::npos)
        << refused.err;
  }
  const Result bed =
      scree(scratch, {"bench", "step", "--sizes", "3000", "--memory", "1", "--backend", "cpu"});
  EXPECT_EQ(bed.code, 2);
  EXPECT_NE(bed.err.find("the limit is 1 MiB"), std::string::npos) << bed.err;
}

TEST(CliCommands, InfoPrintsTextAndJson) {
  const Scratch scratch;
  const Result text = scree(scratch, {"info"});
  EXPECT_EQ(text.code, 0) << text.err;
  EXPECT_NE(text.out.find("gauss_seidel_colored"), std::string::npos) << text.out;
  const Result json = scree(scratch, {"info", "--json"});
  EXPECT_EQ(json.code, 0) << json.err;
  const nlohmann::json values = nlohmann::json::parse(json.out);
  EXPECT_EQ(values.at("solvers").size(), 5u);
  EXPECT_GT(values.at("cpu").at("threads"), 0);
  EXPECT_TRUE(values.contains("cuda"));
}

TEST(CliCommands, BenchPrintsTextAndJson) {
  const Scratch scratch;
  const fs::path scene = put_scene(scratch, small_scene());
  const Arguments arguments{"bench",    scene.string(), "--backend", "cpu",
                            "--warmup", "15",           "--steps",   "3"};
  const Result text = scree(scratch, arguments);
  EXPECT_EQ(text.code, 0) << text.err;
  EXPECT_NE(text.out.find("contact-iterations/s"), std::string::npos) << text.out;
  Arguments with_json = arguments;
  with_json.push_back("--json");
  const Result json = scree(scratch, with_json);
  EXPECT_EQ(json.code, 0) << json.err;
  const nlohmann::json values = nlohmann::json::parse(json.out);
  EXPECT_EQ(values.at("bodies"), 200);
  EXPECT_GT(values.at("contacts"), 0.0);
  EXPECT_GE(values.at("residual_rms_m_per_s"), 0.0);
  for (const char* stage : {"collision", "setup", "solve", "integrate", "total"})
    EXPECT_LE(values.at("ms").at(stage).at("min"), values.at("ms").at(stage).at("max")) << stage;
}

TEST(CliCommands, BenchStartsFromACheckpoint) {
  const Scratch scratch;
  const fs::path scene = put_scene(scratch, small_scene());
  ASSERT_EQ(scree(scratch, run_arguments(scene, scratch / "a")).code, 0);
  const Result json =
      scree(scratch, {"bench", scene.string(), "--backend", "cpu", "--warmup", "0", "--steps", "2",
                      "--json", "--from", (scratch / "a/checkpoint.h5").string()});
  EXPECT_EQ(json.code, 0) << json.err;
  EXPECT_GT(nlohmann::json::parse(json.out).at("contacts"), 20.0);
}

TEST(CliCommands, HelpAndVersionSucceed) {
  const Scratch scratch;
  for (const char* option : {"--help", "--version"}) {
    const Result result = scree(scratch, {option});
    EXPECT_EQ(result.code, 0) << option;
    EXPECT_NE(result.out.find("scree"), std::string::npos) << option;
  }
  for (const char* command : {"run", "check", "bench", "solve", "convert", "info"})
    EXPECT_EQ(scree(scratch, {command, "--help"}).code, 0) << command;
}

TEST(CliCommands, MissingGpuIsSaidOnce) {
  const Scratch scratch;
  if (nlohmann::json::parse(scree(scratch, {"info", "--json"}).out).at("cuda").contains("name"))
    GTEST_SKIP() << "this machine has a GPU";
  const fs::path scene = put_scene(scratch, small_scene());
  const Result result = scree(scratch, {"run", scene.string(), "--steps", "1"});
  EXPECT_EQ(result.code, 0) << result.err;
  const std::size_t first = result.err.find("running on the CPU");
  EXPECT_NE(first, std::string::npos) << result.err;
  EXPECT_EQ(result.err.find("running on the CPU", first + 1), std::string::npos) << result.err;
}

class CliScenes : public testing::TestWithParam<std::string> {};

TEST_P(CliScenes, PassesCheck) {
  const Scratch scratch;
  const Result result = scree(scratch, {"check", GetParam(), "--backend", "cpu"});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(result.err, "");
}

/// Three steps of few bodies, on the way into contact: all of them solved.
TEST_P(CliScenes, TakesSteps) {
  const Scratch scratch;
  Arguments more{"--steps", "3", "--set", "output.picture=false"};
  const nlohmann::json scene = nlohmann::json::parse(
      contents(fs::path(SCREE_SCENE_DIR) / (GetParam() + ".json")), nullptr, true, true);
  const std::size_t entries = scene.contains("particles") ? scene.at("particles").size() : 0;
  for (std::size_t i = 0; i < entries; ++i)
    if (scene.at("particles").at(i).value("count", 200) >= 200)
      more.insert(more.end(), {"--set", "particles." + std::to_string(i) + ".count=200"});
  const Result result = scree(scratch, run_arguments(GetParam(), scratch / "a", more));
  ASSERT_EQ(result.code, 0) << result.err;
  const std::string model = scene.value("/dynamics/type"_json_pointer, "rigid");
  const std::vector<StepReport> steps =
      read_steps_csv(scratch / "a/steps.csv", dynamics_card(model).report);
  ASSERT_EQ(steps.size(), 3u);
  if (model != "rigid") return;  // no solver that converges
  for (const StepReport& step : steps) EXPECT_TRUE(step.converged) << "step " << step.step;
}

INSTANTIATE_TEST_SUITE_P(Scenes, CliScenes, testing::ValuesIn(scene_names()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace scree::test
