// A model of dynamics from outside the list, of one file and one line of CMake, is known to every
// part of the program: scene check, runs and their files, resuming, schema and help.

#include <algorithm>

#include "dynamics/dynamics_card.h"
#include "host/io/h5.h"
#include "tests/cli/program.h"

namespace scree::test {
namespace {

using json = nlohmann::json;

Result with_extra_model(const Scratch& scratch, const Arguments& arguments) {
  return Program(scratch.path(), arguments, 0, {}, SCREE_PROGRAM_WITH_EXTRA_DYNAMICS).wait();
}

json points() {
  return json::parse(R"({
    "name": "points", "time_step": 0.01, "duration": 0.4,
    "dynamics": {"type": "point_masses", "gravity_factor": 0.5},
    "output": {"frame_interval": 0.1, "picture": {"width": 64, "height": 48}},
    "particles": [{"layout": "lattice", "count": 20, "radius": 0.1, "density": 1000, "velocity": [0, 0, 3],
                   "region": {"min": [0, 0, 0], "max": [1, 1, 2]}}]})");
}

std::vector<std::string> lines_of(const fs::path& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// Lines of steps.csv without the two columns of times.
std::vector<std::string> untimed(const fs::path& file) {
  std::vector<std::string> lines = lines_of(file);
  for (std::string& line : lines)
    for (int k = 0; k < 2; ++k) line.resize(line.rfind(','));
  return lines;
}

TEST(CliExtraDynamics, IsUnknownToTheProgramWithoutIt) {
  const Scratch scratch;
  const Result refused = scree(scratch, {"check", put_scene(scratch, points()).string()});
  EXPECT_EQ(refused.code, 2);
  EXPECT_TRUE(holds(refused.err, "dynamics.type")) << refused.err;
  EXPECT_TRUE(holds(refused.err, "\"rigid\"")) << refused.err;
}

TEST(CliExtraDynamics, ScenesWithItAreChecked) {
  const Scratch scratch;
  const std::string scene = put_scene(scratch, points()).string();
  const Result check = with_extra_model(scratch, {"check", scene, "--json"});
  ASSERT_EQ(check.code, 0) << check.err;
  EXPECT_EQ(json::parse(check.out).at("dynamics"), "point_masses");
  const Result text = with_extra_model(scratch, {"check", scene});
  EXPECT_TRUE(holds(text.out, "point_masses: point masses in free flight")) << text.out;
  EXPECT_FALSE(holds(text.out, "solver")) << text.out;
  const Result range =
      with_extra_model(scratch, {"check", scene, "--set", "dynamics.gravity_factor=11"});
  EXPECT_EQ(range.code, 2);
  EXPECT_TRUE(holds(range.err, "dynamics.gravity_factor")) << range.err;
  EXPECT_TRUE(holds(range.err, "must be between -10 and 10")) << range.err;
  const Result forces =
      with_extra_model(scratch, {"check", scene, "--set", "output.force_interval=1"});
  EXPECT_EQ(forces.code, 2) << "they do not touch";
  EXPECT_TRUE(holds(forces.err, "output.force_interval")) << forces.err;
  const Result rigid = with_extra_model(scratch, {"check", scene, "--set", "dynamics.type=rigid"});
  EXPECT_EQ(rigid.code, 2) << "the parameter is not one of rigid bodies";
  EXPECT_TRUE(holds(rigid.err, "gravity_factor")) << rigid.err;
}

TEST(CliExtraDynamics, RunsWriteWhatTheModelHas) {
  const Scratch scratch;
  const std::string scene = put_scene(scratch, points()).string();
  const Result run = with_extra_model(scratch, run_arguments(scene, scratch / "a"));
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_FALSE(holds(run.err, "contacts")) << run.err;
  EXPECT_FALSE(holds(run.err, "penetration")) << run.err;

  const std::vector<std::string> steps = lines_of(scratch / "a" / "steps.csv");
  ASSERT_EQ(steps.size(), 41u);
  EXPECT_EQ(steps[0],
            "step,time_s,bodies,kinetic_energy_J,upward_momentum_kg_m_per_s,flight_ms,total_ms");

  const h5::File frames = h5::File::open(scratch / "a" / "frames.vtkhdf");
  const h5::Group data = frames.root().open_group("VTKHDF/PointData");
  EXPECT_EQ(data.shape("distance"), (h5::Shape{5 * 20, 0}));
  EXPECT_EQ(data.shape("velocity"), (h5::Shape{5 * 20, 3}));
  EXPECT_FALSE(data.has("orientation"));
  EXPECT_FALSE(data.has("angular_velocity"));
  const double v = 3 - 0.5 * 9.81 * 0.4;  // after the run
  EXPECT_NEAR(data.read<float>("velocity").back(), v, 1e-5);
  EXPECT_NEAR(data.read<float>("speed").back(), v, 1e-5);
  EXPECT_TRUE(fs::exists(scratch / "a" / "picture_00000.png"));

  const json totals = json_file(scratch / "a" / "run.json").at("totals");
  EXPECT_EQ(totals.at("steps"), 40);
  EXPECT_EQ(totals.count("max_contacts"), 0u);
  EXPECT_EQ(totals.at("mean_ms").size(), 2u);
  const double mass = 20 * 1000 * 4.0 / 3 * 3.14159265358979 * 1e-3;
  EXPECT_NEAR(totals.at("final_upward_momentum_kg_m_per_s").get<double>(), mass * v,
              1e-5 * mass * v);
}

TEST(CliExtraDynamics, ResumedRunsAreTheSame) {
  const Scratch scratch;
  const std::string scene = put_scene(scratch, points()).string();
  ASSERT_EQ(with_extra_model(scratch, run_arguments(scene, scratch / "whole")).code, 0);
  ASSERT_EQ(with_extra_model(scratch, run_arguments(scene, scratch / "a", {"--steps", "17"})).code,
            0);
  const Result resumed =
      with_extra_model(scratch, run_arguments(scene, scratch / "a", {"--resume"}));
  ASSERT_EQ(resumed.code, 0) << resumed.err;
  EXPECT_EQ(untimed(scratch / "a" / "steps.csv"), untimed(scratch / "whole" / "steps.csv"));
  const auto bytes = [&](const char* run) {
    const h5::File file = h5::File::open(scratch / run / "checkpoint.h5");
    return file.root().read<double>("body/position");
  };
  EXPECT_EQ(bytes("a"), bytes("whole"));

  // The program without the model cannot go on.
  const Result refused = scree(scratch, run_arguments(scene, scratch / "a", {"--resume"}));
  EXPECT_EQ(refused.code, 2);
}

TEST(CliExtraDynamics, ACheckpointGivesItsBodiesToOtherScenes) {
  const Scratch scratch;
  const std::string scene = put_scene(scratch, points()).string();
  ASSERT_EQ(with_extra_model(scratch, run_arguments(scene, scratch / "a")).code, 0);
  json next = points();
  next["dynamics"] = {{"type", "rigid"}};
  next["particles"] =
      json::array({{{"layout", "file"}, {"file", (scratch / "a" / "checkpoint.h5").string()}}});
  const std::string path = put(scratch / "next.json", next.dump()).string();
  const Result check = with_extra_model(scratch, {"check", path, "--json"});
  ASSERT_EQ(check.code, 0) << check.err;
  EXPECT_EQ(json::parse(check.out).at("free_bodies"), 20);
}

TEST(CliExtraDynamics, IsInTheSchemaAndInTheHelp) {
  const Scratch scratch;
  const Result result = with_extra_model(scratch, {"info", "--schema"});
  ASSERT_EQ(result.code, 0) << result.err;
  const json dynamics = json::parse(result.out).at("$defs").at("dynamics").at("properties");
  EXPECT_EQ(dynamics.at("type").at("enum"),
            json({"rigid", "variational", "affine", "point_masses"}));
  const json factor = {
      {"type", "number"},
      {"exclusiveMinimum", -10},
      {"exclusiveMaximum", 10},
      {"default", 1},
      {"description", "point_masses: part of the gravity of the scene that acts [-]."}};
  EXPECT_EQ(dynamics.at("gravity_factor"), factor);
  const Result info = with_extra_model(scratch, {"info"});
  EXPECT_TRUE(holds(info.out, "point masses in free flight")) << info.out;
}

TEST(CliExtraDynamics, JointsAreRefusedWhereBodiesCannotBeJoined) {
  const Scratch scratch;
  json scene = points();
  for (const char* name : {"a", "b"})
    scene["bodies"].push_back({{"name", name},
                               {"shape", "sphere"},
                               {"radius", 0.1},
                               {"density", 1000},
                               {"position", {*name == 'a' ? 2 : 3, 0, 0}}});
  scene["joints"] =
      json::array({{{"type", "ball"}, {"bodies", {"a", "b"}}, {"anchor", {2.5, 0, 0}}}});
  const std::string path = put_scene(scratch, scene).string();
  for (const char* command : {"check", "run"}) {
    const Result refused = with_extra_model(scratch, {command, path});
    EXPECT_EQ(refused.code, 2) << command;
    EXPECT_TRUE(holds(refused.err, "joints: a list of 1 is not allowed")) << refused.err;
    EXPECT_TRUE(holds(refused.err, "point_masses")) << refused.err;
  }
}

TEST(CliExtraDynamics, NothingTellsOfContactsThatTheModelDoesNotHave) {
  const Scratch scratch;
  const std::string scene = put_scene(scratch, points()).string();
  const json check = json::parse(with_extra_model(scratch, {"check", scene, "--json"}).out);
  EXPECT_FALSE(check.contains("solver")) << check;
  EXPECT_FALSE(check.contains("contact_layout")) << check;
  const Arguments bench{"bench", "scene", scene, "--backend", "cpu", "--steps", "2"};
  const Result text = with_extra_model(scratch, bench);
  ASSERT_EQ(text.code, 0) << text.err;
  EXPECT_TRUE(holds(text.out, "20 bodies")) << text.out;
  for (const char* word : {"contact", "iterations", "residual", "apgd"})
    EXPECT_FALSE(holds(text.out, word)) << text.out;
  Arguments with_json = bench;
  with_json.insert(with_json.end(), {"--json", "bench.json"});
  ASSERT_EQ(with_extra_model(scratch, with_json).code, 0);
  const json result = json_file(scratch / "bench.json").at("results").at(0);
  EXPECT_EQ(result.at("bodies"), 20);
  for (const char* key : {"contacts", "solver", "iterations", "converged"})
    EXPECT_FALSE(result.contains(key)) << result;
}

}  // namespace
}  // namespace scree::test
