// Values that are allowed, but far from what anybody would run: the program ends with results that
// are numbers, or with a message that names what left their range.

#include <cmath>
#include <sstream>

#include "tests/cli/frame_count.h"
#include "tests/cli/program.h"

namespace scree::test {
namespace {

using nlohmann::json;

json falling_ball() {
  return json::parse(R"({"name": "ball", "time_step": 0.01, "duration": 3,
    "bodies": [{"shape": "half_space"},
               {"shape": "sphere", "radius": 0.1, "density": 1000, "position": [0, 0, 0.3]}],
    "output": {"picture": false}})");
}

/// All numbers of steps.csv. Fails when one is not finite.
std::size_t finite_numbers(const fs::path& steps_csv) {
  std::istringstream lines(contents(steps_csv));
  std::string line;
  std::getline(lines, line);
  std::size_t count = 0;
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ','); ++count)
      EXPECT_TRUE(std::isfinite(std::stod(cell))) << line;
  }
  return count;
}

TEST(CliExtremeValues, FramesEveryStepWhateverTheIntervalBelowIt) {
  for (const double interval : {1e-9, 1e-300}) {
    const Scratch scratch;
    json scene = falling_ball();
    scene["duration"] = 0.5;
    scene["output"]["frame_interval"] = interval;
    const fs::path file = put_scene(scratch, scene);
    const Result result = scree(scratch, run_arguments(file, scratch / "a", {"--quiet"}));
    EXPECT_EQ(result.code, 0) << result.err;
    // 50 steps and the start.
    EXPECT_EQ(frame_count(scratch / "a" / "frames.vtkhdf"), 51) << interval;
  }
}

TEST(CliExtremeValues, ADurationWithoutAStepIsRefused) {
  const Scratch scratch;
  json scene = falling_ball();
  scene["duration"] = 0.004;
  const fs::path file = put_scene(scratch, scene);
  const Result result = scree(scratch, run_arguments(file, scratch / "a"));
  EXPECT_EQ(result.code, 2);
  EXPECT_NE(result.err.find(file.string() + ": duration: 0.004 is not allowed"), std::string::npos)
      << result.err;
  EXPECT_FALSE(fs::exists(scratch / "a"));
  EXPECT_EQ(scree(scratch, run_arguments(file, scratch / "a", {"--steps", "2"})).code, 0);
}

TEST(CliExtremeValues, APictureIsNumberedByThoseBeforeItAfterAResume) {
  const Scratch scratch;
  json scene = falling_ball();
  scene["duration"] = 0.03;
  scene["output"]["picture"] = {{"interval", 1e-9}, {"width", 16}, {"height", 16}};
  const fs::path file = put_scene(scratch, scene);
  EXPECT_EQ(scree(scratch, run_arguments(file, scratch / "a", {"--steps", "2"})).code, 0);
  EXPECT_EQ(scree(scratch, run_arguments(file, scratch / "a", {"--resume"})).code, 0);
  std::vector<std::string> pictures;
  for (const auto& entry : fs::directory_iterator(scratch / "a"))
    if (entry.path().extension() == ".png") pictures.push_back(entry.path().stem());
  std::sort(pictures.begin(), pictures.end());
  EXPECT_EQ(pictures.size(), 3u);
  EXPECT_EQ(pictures.back().substr(pictures.back().size() - 1), "2");
}

TEST(CliExtremeValues, ABodyThatLeavesTheRangeEndsTheRunByName) {
  for (const char* gravity : {"1e15", "1e17"}) {
    const Scratch scratch;
    json scene = falling_ball();
    scene["gravity"] = {std::stod(gravity) > 1e15 ? 1e15 : 1e14, 0, 0};
    scene["time_step"] = 0.5;
    scene["duration"] = 100;
    const fs::path file = put_scene(scratch, scene);
    const Result result = scree(scratch, run_arguments(file, scratch / "a", {"--quiet"}));
    EXPECT_EQ(result.code, 1);
    EXPECT_NE(result.err.find("body 1 is too far out or too fast"), std::string::npos)
        << result.err;
    EXPECT_GT(finite_numbers(scratch / "a" / "steps.csv"), 0u);
  }
}

TEST(CliExtremeValues, AWallThatLeavesTheRangeEndsTheRunByName) {
  const Scratch scratch;
  json scene = falling_ball();
  scene["bodies"].push_back(json::parse(R"({"shape": "box", "kind": "kinematic", "size": [1, 1, 1],
    "position": [9, 0, 0], "motion": {"type": "linear", "velocity": [0, 3e14, 0]}})"));
  scene["duration"] = 10;
  scene["time_step"] = 0.5;
  const fs::path file = put_scene(scratch, scene);
  const Result result = scree(scratch, run_arguments(file, scratch / "a", {"--quiet"}));
  EXPECT_EQ(result.code, 1);
  EXPECT_NE(result.err.find("body 2 is too far out or too fast"), std::string::npos) << result.err;
}

/// Ends of the ranges, one and two at a time: no crash, and no number that is none.
TEST(CliExtremeValues, EndsOfTheRangesGiveNumbersOrAMessage) {
  const std::vector<std::pair<json::json_pointer, std::vector<double>>> values{
      {json::json_pointer("/bodies/1/radius"), {1e-12, 1e-6, 1e6, 1e15}},
      {json::json_pointer("/bodies/1/density"), {1e-30, 1e-6, 1e9, 1e30}},
      {json::json_pointer("/bodies/1/position/2"), {-1e15, 1e15, 1e9}},
      {json::json_pointer("/gravity/2"), {-1e15, -1e-12, 1e9}},
      {json::json_pointer("/time_step"), {1e-15, 1e-9, 1e3, 1e9}},
      {json::json_pointer("/materials/m/friction"), {1e6, 1e-12}},
      {json::json_pointer("/materials/m/cohesion"), {1e15, 1e-12}},
      {json::json_pointer("/materials/m/rolling_friction"), {1e6}},
      {json::json_pointer("/collision/envelope"), {0, 1e15}},
      {json::json_pointer("/collision/skin"), {0, 1e15}},
      {json::json_pointer("/stepping/max_recovery_speed"), {0, 1e15}}};
  const Scratch scratch;
  int number = 0;
  const auto expect_numbers_or_a_message = [&](const json& scene) {
    const fs::path out = scratch / std::to_string(number++);
    const fs::path file = put_scene(scratch, scene);
    const Result result = scree(scratch, run_arguments(file, out, {"--quiet", "--steps", "4"}));
    EXPECT_EQ(result.signal, 0) << scene;
    EXPECT_TRUE(result.code == 0 || line_count(result.err) == 1) << scene << result.err;
    if (fs::exists(out / "steps.csv")) finite_numbers(out / "steps.csv");
  };
  json plain = falling_ball();
  plain["gravity"] = {0, 0, -9.81};
  plain["materials"]["m"] = {{"friction", 0.5}};
  plain["bodies"][1]["velocity"] = {1, 0, -1};
  for (std::size_t i = 0; i < values.size(); ++i)
    for (const double a : values[i].second) {
      json one = plain;
      one[values[i].first] = a;
      expect_numbers_or_a_message(one);
      const std::size_t j = (i + 1 + static_cast<std::size_t>(number) % 7) % values.size();
      json two = one;
      two[values[j].first] =
          values[j].second[static_cast<std::size_t>(number) % values[j].second.size()];
      expect_numbers_or_a_message(two);
    }
}

}  // namespace
}  // namespace scree::test
