// Affine and elastic bodies from the command line: files, resuming, warnings.

#include "dynamics/affine/affine_card.h"
#include "host/io/h5.h"
#include "tests/cli/program.h"
#include "tests/steps_file.h"

namespace scree::test {
namespace {

using json = nlohmann::json;

/// Eight tetrahedra about the origin that hang from their upper tip.
json hanging_octahedron(const Scratch& scratch) {
  put(scratch / "octahedron.vtk",
      "# vtk DataFile Version 3.0\noctahedron\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 7 double\n"
      "1 0 0 -1 0 0 0 1 0 0 -1 0 0 0 1 0 0 -1 0 0 0\nCELLS 8 40\n"
      "4 6 0 2 4\n4 6 0 2 5\n4 6 0 3 4\n4 6 0 3 5\n4 6 1 2 4\n4 6 1 2 5\n4 6 1 3 4\n4 6 1 3 5\n"
      "CELL_TYPES 8\n10 10 10 10 10 10 10 10\n");
  return json::parse(R"({
    "name": "soft", "time_step": 0.02, "duration": 0.4, "dynamics": {"type": "affine"},
    "bodies": [{"name": "soft", "shape": "mesh", "file": "octahedron.vtk", "kind": "free", "density": 1000,
                "elastic": {"young_modulus": 1e5}}],
    "attachments": [{"body": "soft", "to": "world", "box": [[-0.1, -0.1, 0.9], [0.1, 0.1, 1.1]]}],
    "output": {"frame_interval": 0.1, "surface_frames": true, "picture": {"width": 64, "height": 48}}})");
}

TEST(CliAffine, ElasticBodiesAreInSurfacesAsTheyBend) {
  const Scratch scratch;
  const std::string scene = put_scene(scratch, hanging_octahedron(scratch)).string();
  const Result run = scree(scratch, run_arguments(scene, scratch / "a"));
  ASSERT_EQ(run.code, 0) << run.err;
  const h5::File file = h5::File::open(scratch / "a" / "surfaces.vtkhdf");
  const auto points = file.root().read<float>("VTKHDF/Points");
  ASSERT_EQ(points.size(), 5u * 6 * 3);
  float highest = -9, lowest = 9;
  for (std::size_t v = 4 * 6; v < 5 * 6; ++v) {  // in the last frame
    highest = std::max(highest, points[3 * v + 2]);
    lowest = std::min(lowest, points[3 * v + 2]);
  }
  EXPECT_NEAR(highest, 1, 1e-6);
  EXPECT_LT(lowest, -1.05);
}

TEST(CliAffine, ResumedRunsOfElasticBodiesAreTheSame) {
  const Scratch scratch;
  const std::string scene = put_scene(scratch, hanging_octahedron(scratch)).string();
  ASSERT_EQ(scree(scratch, run_arguments(scene, scratch / "whole")).code, 0);
  ASSERT_EQ(scree(scratch, run_arguments(scene, scratch / "a", {"--steps", "7"})).code, 0);
  const Result resumed = scree(scratch, run_arguments(scene, scratch / "a", {"--resume"}));
  ASSERT_EQ(resumed.code, 0) << resumed.err;
  EXPECT_EQ(steps_without_times(scratch / "a/steps.csv"),
            steps_without_times(scratch / "whole/steps.csv"));
}

TEST(CliAffine, WhatTheModelDoesNotUseIsRefusedOrTold) {
  const Scratch scratch;
  json scene = json::parse(R"({
    "name": "block", "time_step": 0.01, "duration": 0.1, "dynamics": {"type": "affine"},
    "bodies": [{"shape": "box", "size": [1, 1, 1], "density": 1000}], "output": {"picture": {"width": 64, "height": 48}}})");
  const std::string plain = put_scene(scratch, scene).string();
  const Result dump = scree(scratch, run_arguments(plain, scratch / "a", {"--dump-problem", "2"}));
  EXPECT_EQ(dump.code, 2);
  EXPECT_NE(dump.err.find("--dump-problem: the dynamics \"affine\" have no contact problems"),
            std::string::npos)
      << dump.err;
  EXPECT_FALSE(fs::exists(scratch / "a"));
  const Result check = scree(scratch, {"check", plain, "--set", "solver.max_iterations=3"});
  EXPECT_EQ(check.code, 0) << check.err;
  EXPECT_NE(
      check.out.find("\"solver\" has no effect: the dynamics \"affine\" have keys of their own"),
      std::string::npos)
      << check.out;
  EXPECT_EQ(check.out.find("\"stepping\" has no effect"), std::string::npos);
  const Result part = scree(scratch, {"check", plain, "--set", "dynamics.max_iterations=0.5"});
  EXPECT_EQ(part.code, 2);
  EXPECT_NE(
      part.err.find(
          "dynamics.max_iterations (overridden): 0.5 is not allowed: must be a whole number, "),
      std::string::npos)
      << part.err;
  const Result loose = scree(scratch, {"check", plain, "--set", "dynamics.tolerance=0.05"});
  EXPECT_NE(loose.out.find("dynamics.tolerance is 0.05 m/s, 51 % of what gravity changes"),
            std::string::npos)
      << loose.out;
}

/// A large cube presses a small one flat, as its stiffness is no match for its weight.
TEST(CliAffine, BodiesThatGiveWayAreTold) {
  const Scratch scratch;
  const json scene = json::parse(R"({
    "time_step": 0.01, "duration": 0.3, "dynamics": {"type": "affine", "stiffness": 1e5},
    "bodies": [{"shape": "half_space"},
               {"shape": "box", "size": [0.1, 0.1, 0.1], "density": 1000, "position": [0, 0, 0.051]},
               {"shape": "box", "size": [1, 1, 1], "density": 7800, "position": [0, 0, 0.602], "lock": ["x", "y", "rx", "ry", "rz"]}],
    "output": {"picture": false}})");
  const Result run = scree(scratch, run_arguments(put_scene(scratch, scene), scratch / "a"));
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(holds(run.out + run.err, "a stiff body was strained by")) << run.out << run.err;
}

TEST(CliAffine, TurnsThatAStepIsTooLongForAreTold) {
  const Scratch scratch;
  json scene = json::parse(R"({
    "name": "spin", "time_step": 0.01, "duration": 0.1, "gravity": [0, 0, 0],
    "dynamics": {"type": "affine", "rule": "rotational"}, "output": {"picture": {"width": 64, "height": 48}},
    "bodies": [{"shape": "box", "size": [0.1, 0.1, 0.1], "density": 1000, "angular_velocity": [0, 0, 60]}]})");
  const std::string file = put_scene(scratch, scene).string();
  const Result run = scree(scratch, run_arguments(file, scratch / "a", {"--quiet"}));
  ASSERT_EQ(run.code, 0);
  EXPECT_EQ(run.err,
            "warning: a body turned by 0.6 rad in a step: steps follow turns of up to 0.5 rad; a "
            "smaller time step follows it better, or max_turn of the dynamics\n");
  const Result finer =
      scree(scratch, run_arguments(file, scratch / "b", {"--quiet", "--set", "time_step=0.005"}));
  EXPECT_EQ(finer.err, "");
  const Result in_parts = scree(
      scratch, run_arguments(file, scratch / "c", {"--quiet", "--set", "dynamics.max_turn=0.3"}));
  EXPECT_EQ(in_parts.err, "");
  const std::vector<StepReport> steps =
      read_steps_csv(scratch / "c" / "steps.csv", dynamics_card("affine").report);
  ASSERT_EQ(steps.size(), 10u);
  EXPECT_EQ(steps[0].own[kPartsColumn], 2);
}

}  // namespace
}  // namespace scree::test
