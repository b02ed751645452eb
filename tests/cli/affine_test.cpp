// Affine and elastic bodies from the command line: files, resuming, warnings.

#include <algorithm>
#include <map>

#include "dynamics/affine/affine_card.h"
#include "host/io/h5.h"
#include "kernels/affine/orthogonality.h"
#include "tests/cli/program.h"
#include "tests/exact_triangles.h"
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

/// Blocks that press on each other until they are some percent flatter, turned so that edges lie across faces.
json pressed_blocks() {
  return json::parse(R"({
    "name": "pressed", "time_step": 0.01, "duration": 0.5, "dynamics": {"type": "affine", "stiffness": 1e5},
    "bodies": [
      {"shape": "box", "size": [1, 1, 1], "density": 1000, "position": [0, 0, 0.505]},
      {"shape": "box", "size": [1, 1, 1], "density": 1000, "position": [0, 0, 1.515], "rotation_deg": {"axis": [0, 0, 1], "angle": 30}},
      {"shape": "box", "size": [1, 1, 1], "density": 1000, "position": [0, 0, 2.525], "rotation_deg": {"axis": [0, 0, 1], "angle": 60}},
      {"shape": "box", "size": [4, 4, 0.2], "kind": "fixed", "position": [0, 0, -0.1]}],
    "output": {"frame_interval": 0.1, "surface_frames": true, "picture": false}})");
}

/// Triangles of the bodies of a frame of surfaces, which all of them are in, by body.
std::map<std::int64_t, std::vector<exact::Triangle>> triangles_of(const h5::Group& vtk,
                                                                  std::size_t frame) {
  const auto points = vtk.read<float>("Points");
  const auto first = static_cast<std::size_t>(vtk.read<std::int64_t>("Steps/PointOffsets")[frame]);
  const auto offsets = vtk.read<std::int64_t>("Polygons/Offsets");
  const auto corners = vtk.read<std::int64_t>("Polygons/Connectivity");
  const auto id = vtk.read<std::int64_t>("CellData/id");
  std::map<std::int64_t, std::vector<exact::Triangle>> all;
  for (std::size_t face = 0; face < id.size(); ++face) {
    const auto corner = [&](std::int64_t k) {
      const std::size_t p = first + static_cast<std::size_t>(corners[static_cast<std::size_t>(k)]);
      return Vec3d{points[3 * p], points[3 * p + 1], points[3 * p + 2]};
    };
    for (std::int64_t k = offsets[face] + 2; k < offsets[face + 1]; ++k)
      all[id[face]].push_back({corner(offsets[face]), corner(k - 1), corner(k)});
  }
  return all;
}

TEST(CliAffine, SurfacesAreThoseOfTheState) {
  const Scratch scratch;
  const std::string scene = put_scene(scratch, pressed_blocks()).string();
  const Result run = scree(scratch, run_arguments(scene, scratch / "a"));
  ASSERT_EQ(run.code, 0) << run.err;
  const h5::File file = h5::File::open(scratch / "a" / "surfaces.vtkhdf");
  const h5::Group vtk = file.root().open_group("VTKHDF");
  const std::size_t frames = vtk.shape("Steps/Values").rows;
  ASSERT_EQ(frames, 6u);
  for (std::size_t frame = 0; frame < frames; ++frame) {
    const auto bodies = triangles_of(vtk, frame);
    ASSERT_EQ(bodies.size(), 3u);
    for (std::int64_t a = 0; a < 3; ++a)
      for (std::int64_t b = a + 1; b < 3; ++b)
        for (const exact::Triangle& s : bodies.at(a))
          for (const exact::Triangle& t : bodies.at(b))
            ASSERT_FALSE(exact::triangles_touch(s, t))
                << "frame " << frame << ": " << a << ", " << b;
  }
  // In the last one corners are where the checkpoint, which holds four vectors of each body, says.
  const h5::File checkpoint = h5::File::open(scratch / "a" / "checkpoint.h5");
  const auto nodes = checkpoint.root().read<double>("affine/position");
  double strain = 0;
  for (const auto& [id, triangles] : triangles_of(vtk, frames - 1)) {
    affine::AffineVec q;
    for (int k = 0; k < 12; ++k)
      q.node[k / 3][k % 3] = nodes[static_cast<std::size_t>(12 * id + k)];
    strain = std::max(strain, affine::strain_norm(q));
    for (const exact::Triangle& triangle : triangles)
      for (const Vec3d& x : triangle) {
        double least = 1;
        for (int corner = 0; corner < 8; ++corner) {
          const auto side = [&](int axis) { return (corner >> axis & 1) != 0 ? 0.5 : -0.5; };
          least = std::min(least, norm(point_of(q, {side(0), side(1), side(2)}) - x));
        }
        EXPECT_LT(least, 3e-7) << "body " << id;  // float
      }
  }
  EXPECT_GT(strain, 0.02);
  const h5::File poses = h5::File::open(scratch / "a" / "frames.vtkhdf");
  const auto strains = poses.root().read<float>("VTKHDF/PointData/strain");
  ASSERT_EQ(strains.size(), 4 * frames);
  EXPECT_FLOAT_EQ(*std::max_element(strains.end() - 4, strains.end()), static_cast<float>(strain));
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

TEST(CliAffine, JointsThatContradictAreTold) {
  const Scratch scratch;
  json scene = json::parse(R"({
    "name": "cart", "time_step": 0.01, "duration": 0.02, "dynamics": {"type": "affine"},
    "bodies": [{"name": "cart", "shape": "box", "size": [1, 1, 1], "density": 1000}],
    "joints": [{"type": "slider", "bodies": ["world", "cart"], "axis": [1, 0, 0], "anchor": [0, 0, 0]}],
    "output": {"picture": false}})");
  const auto told = [&] {
    return scree(scratch,
                 run_arguments(put_scene(scratch, scene).string(), scratch / "a", {"--force"}))
        .err;
  };
  EXPECT_FALSE(holds(told(), "joints["));
  scene["joints"][0]["limits"] = {0.5, 1};
  EXPECT_TRUE(holds(told(),
                    "warning: joints[0]: its bodies began apart, 0.5 m beyond its "
                    "\"limits\" [0.5, 1]"));
  scene["joints"][0].erase("limits");
  scene["joints"][0]["motor"] = {{"speed", 1}};
  EXPECT_FALSE(holds(told(), "joints["));
  scene["bodies"][0]["lock"] = {"x"};
  EXPECT_TRUE(holds(told(),
                    "warning: joints[0]: its motor has no \"max_force\", and other joints, "
                    "locks or such motors hold what it drives"));
}

TEST(CliAffine, BodiesThatIntersectAreNamed) {
  const Scratch scratch;
  const json scene = json::parse(R"({
    "name": "lid", "time_step": 0.01, "duration": 0.02, "dynamics": {"type": "affine"},
    "bodies": [{"shape": "half_space", "point": [0, 0, -9]},
               {"name": "lid", "shape": "box", "size": [1, 1, 1], "density": 1000},
               {"name": "pot", "shape": "box", "size": [1, 1, 1], "density": 1000, "position": [0.5, 0.4, 0.3]}]})");
  for (const char* command : {"run", "check"}) {
    const Result result = scree(scratch, {command, put_scene(scratch, scene).string()});
    EXPECT_EQ(result.code, 2);
    for (const char* part :
         {"bodies[1] \"lid\"", "bodies[2] \"pot\"", "intersect at the start: triangle "})
      EXPECT_TRUE(holds(result.err, part)) << result.err;
  }
}

/// By file and name, as values are.
TEST(CliAffine, FaultsOfBodiesNameTheFileAndTheBody) {
  const Scratch scratch;
  const json plain = json::parse(R"({
    "name": "two", "time_step": 0.01, "duration": 0.02, "dynamics": {"type": "affine"},
    "bodies": [{"name": "lid", "shape": "box", "size": [1, 1, 1], "density": 1000},
               {"name": "pot", "shape": "box", "size": [1, 1, 1], "density": 1000, "position": [0, 0, 2]}]})");
  const auto expect = [&](const json& scene, const std::string& fault) {
    const std::string file = put_scene(scratch, scene).string();
    for (const Arguments& command : {Arguments{"run", file, "--out", (scratch / "a").string()},
                                     Arguments{"check", file}, Arguments{"bench", "scene", file}}) {
      const Result result = scree(scratch, command);
      EXPECT_EQ(result.code, 2);
      EXPECT_TRUE(holds("\n" + result.err, "\nscree: " + file + ": " + fault)) << result.err;
    }
  };
  json scene = plain;
  scene["bodies"][1]["position"] = {0, 0, 1};
  expect(scene, "bodies[0] \"lid\" and bodies[1] \"pot\" touch at the start: ");
  scene["bodies"][1]["position"] = {0.5, 0.4, 0.3};
  expect(scene, "bodies[0] \"lid\" and bodies[1] \"pot\" intersect at the start: ");
  scene = plain;
  scene["bodies"][1]["size"] = {1, 1, 1e-9};
  expect(scene, "bodies[1] \"pot\": second moments of [");
  const Result thin = scree(scratch, {"check", put_scene(scratch, scene).string()});
  EXPECT_TRUE(holds(thin.err, "extended along all axes; see its \"size\"\n")) << thin.err;
  scene = plain;
  scene["attachments"] = {{{"body", "lid"}, {"to", "world"}, {"box", {{-5, -5, -5}, {6, 6, 6}}}}};
  expect(scene, "attachments[0].body: \"lid\" is not allowed: must be an elastic body");

  json soft = hanging_octahedron(scratch);
  soft["attachments"][0]["to"] = "soft";
  expect(soft, "attachments[0].to: \"soft\" is not allowed: must be a body that is not elastic");
  soft["attachments"][0]["to"] = "world";
  soft["attachments"][0]["box"] = {{-5, -5, -5}, {6, 6, 6}};
  expect(soft,
         "attachments[0].box: [-5, -5, -5] to [6, 6, 6] is not allowed: must leave a corner of "
         "bodies[0] \"soft\" loose");
  soft["attachments"][0]["box"] = {{5, 5, 5}, {6, 6, 6}};
  expect(soft,
         "attachments[0].box: [5, 5, 5] to [6, 6, 6] is not allowed: must hold a corner of "
         "bodies[0] \"soft\" at the start");
}

/// A gap is that of bodies that are near: else there is none.
TEST(CliAffine, GapsOfBodiesThatAreFarApartAreEmpty) {
  const Scratch scratch;
  json scene = json::parse(R"({
    "name": "gap", "time_step": 0.01, "duration": 0.03, "gravity": [0, 0, 0],
    "dynamics": {"type": "affine", "reach": 1e-3}, "output": {"picture": false},
    "bodies": [{"shape": "box", "size": [0.1, 0.1, 0.1], "density": 1000},
               {"shape": "box", "size": [0.1, 0.1, 0.1], "density": 1000, "position": [0, 0, 0.2]}]})");
  const auto run = [&] {
    const Result done = scree(
        scratch, run_arguments(put_scene(scratch, scene).string(), scratch / "a", {"--force"}));
    EXPECT_EQ(done.code, 0) << done.err;
    const json record = json::parse(contents(scratch / "a" / "run.json"));
    const auto steps = read_steps_csv(scratch / "a" / "steps.csv", dynamics_card("affine").report);
    EXPECT_EQ(steps.size(), 3u);
    return std::pair(record.at("totals").at("final_min_gap_m"), steps.back().own.at(kMinGapColumn));
  };
  const auto [far_record, far] = run();
  EXPECT_TRUE(far_record.is_null()) << far_record;
  EXPECT_EQ(far, kNoValue);
  EXPECT_TRUE(holds(contents(scratch / "a" / "steps.csv"), ",,"));
  scene["bodies"][1]["position"] = {0, 0, 0.102};
  const auto [near_record, near] = run();
  EXPECT_NEAR(near, 0.002, 1e-9);
  EXPECT_EQ(near_record.get<double>(), near);
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
