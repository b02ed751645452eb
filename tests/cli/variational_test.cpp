// The variational model from the command line: its files, resuming, what is refused before a run and what ends one.

#include "host/io/checkpoint.h"
#include "host/io/h5.h"
#include "tests/cli/program.h"
#include "tests/steps_file.h"

namespace scree::test {
namespace {

using json = nlohmann::json;

json balls() {
  return json::parse(R"({
    "name": "balls", "time_step": 0.01, "duration": 0.4,
    "dynamics": {"type": "variational"},
    "materials": {"smooth": {"friction": 0, "restitution": 1}},
    "output": {"frame_interval": 0.1, "picture": {"width": 64, "height": 48}},
    "bodies": [{"kind": "fixed", "shape": "container", "size": [4, 4, 4], "material": "smooth"}],
    "particles": [{"layout": "lattice", "count": 60, "radius": 0.2, "density": 1000, "velocity": [1, 2, 3], "jitter": 0.5,
                   "material": "smooth", "region": {"min": [-1.9, -1.9, -1.9], "max": [1.9, 1.9, 1.9]}}]})");
}

TEST(CliVariational, RunsWriteWhatTheModelHas) {
  const Scratch scratch;
  const std::string scene = put_scene(scratch, balls()).string();
  const Result run = scree(scratch, run_arguments(scene, scratch / "a"));
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.err.find("residual"), std::string::npos) << run.err;
  const json totals = json_file(scratch / "a" / "run.json").at("totals");
  EXPECT_EQ(totals.at("steps"), 40);
  EXPECT_EQ(totals.count("max_contacts"), 0u);
  const double mass = 60 * 1000 * 4.0 / 3 * 3.14159265358979 * 0.008;
  // All from the same height: the lattice is filled from below.
  EXPECT_GT(totals.at("final_energy_J").get<double>(), 0.5 * mass * 14 - mass * 9.81 * 2);
  EXPECT_TRUE(fs::exists(scratch / "a" / "picture_00000.png"));
  const h5::File frames = h5::File::open(scratch / "a" / "frames.vtkhdf");
  EXPECT_EQ(frames.root().open_group("VTKHDF/PointData").shape("velocity"), (h5::Shape{5 * 61, 3}))
      << "the container is a row";
}

TEST(CliVariational, ResumedRunsAreTheSame) {
  const Scratch scratch;
  const std::string scene = put_scene(scratch, balls()).string();
  ASSERT_EQ(scree(scratch, run_arguments(scene, scratch / "whole")).code, 0);
  ASSERT_EQ(scree(scratch, run_arguments(scene, scratch / "a", {"--steps", "17"})).code, 0);
  const Result resumed = scree(scratch, run_arguments(scene, scratch / "a", {"--resume"}));
  ASSERT_EQ(resumed.code, 0) << resumed.err;
  EXPECT_EQ(steps_without_times(scratch / "a/steps.csv"),
            steps_without_times(scratch / "whole/steps.csv"));
  const WorldState a = read_checkpoint(scratch / "a/checkpoint.h5").state;
  const WorldState b = read_checkpoint(scratch / "whole/checkpoint.h5").state;
  for (const char* name : {"body/position", "body/velocity"})
    EXPECT_EQ(a.at<Vec3d>(name), b.at<Vec3d>(name));
}

TEST(CliVariational, WhatItDoesNotHaveIsRefusedBeforeARun) {
  const Scratch scratch;
  json scene = balls();
  scene["materials"]["smooth"]["friction"] = 0.3;
  for (const char* command : {"check", "run"}) {
    const Result refused = scree(scratch, {command, put_scene(scratch, scene).string()});
    EXPECT_EQ(refused.code, 2) << command;
    EXPECT_NE(refused.err.find("friction: 0.3 is not allowed: must be 0"), std::string::npos)
        << refused.err;
  }
}

TEST(CliVariational, WhatComesToRestEndsTheRunByName) {
  const Scratch scratch;
  json scene = balls();
  scene["materials"]["smooth"]["restitution"] = 0.3;
  scene["particles"][0]["count"] = 1;
  scene["duration"] = 20;
  const Result ended =
      scree(scratch, run_arguments(put_scene(scratch, scene).string(), scratch / "a"));
  EXPECT_EQ(ended.code, 1);
  EXPECT_NE(ended.err.find("comes to rest"), std::string::npos) << ended.err;
  EXPECT_TRUE(fs::exists(scratch / "a" / "steps.csv"));
}

TEST(CliVariational, ChecksTellOfTheModelAndItsMemory) {
  const Scratch scratch;
  const std::string scene = put_scene(scratch, balls()).string();
  const Result check = scree(scratch, {"check", scene, "--json"});
  ASSERT_EQ(check.code, 0) << check.err;
  EXPECT_EQ(json::parse(check.out).at("dynamics"), "variational");
  EXPECT_EQ(json::parse(check.out).count("solver"), 0u);
}

}  // namespace
}  // namespace scree::test
