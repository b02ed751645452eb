// scree run: files, options and interrupts.

#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <sstream>

#include "host/io/checkpoint.h"
#include "host/io/h5.h"
#include "host/io/problem_file.h"
#include "tests/cli/frame_count.h"
#include "tests/cli/program.h"
#include "tests/steps_file.h"

namespace scree::test {
namespace {

constexpr const char* png_signature = "\x89PNG\r\n\x1a\n";

/// Every array that decides how a run goes on.
void expect_same_state(const fs::path& a, const fs::path& b) {
  const WorldState x = read_checkpoint(a).state, y = read_checkpoint(b).state;
  EXPECT_EQ(x.dynamics, y.dynamics);
  EXPECT_EQ(x.step, y.step);
  EXPECT_EQ(x.time, y.time);
  EXPECT_EQ(x.insertions_done, y.insertions_done);
  ASSERT_EQ(x.arrays.size(), y.arrays.size());
  for (std::size_t k = 0; k < x.arrays.size(); ++k) {
    const std::string& name = x.arrays[k].name;
    ASSERT_EQ(name, y.arrays[k].name);
    std::visit(
        [&](const auto& p) {
          const auto& q = std::get<std::decay_t<decltype(p)>>(y.arrays[k].values);
          ASSERT_EQ(p.size(), q.size()) << name;
          EXPECT_EQ(0, p.empty() ? 0 : std::memcmp(p.data(), q.data(), p.size() * sizeof p[0]))
              << name;
        },
        x.arrays[k].values);
  }
}

/// Same steps, same final state: the runs cannot be told apart but by the clock.
void expect_same_run(const fs::path& a, const fs::path& b) {
  EXPECT_EQ(steps_without_times(a / "steps.csv"), steps_without_times(b / "steps.csv"));
  expect_same_state(a / "checkpoint.h5", b / "checkpoint.h5");
}

class CliRun : public testing::Test {
 protected:
  void must_run(const std::string& out, const Arguments& more = {}) {
    const Result result = scree(scratch, run_arguments(scene, scratch / out, more));
    ASSERT_EQ(result.code, 0) << result.err;
  }

  /// Resumes the stopped run "a" for five steps and compares it with one that was never stopped.
  void expect_resume_equals_whole(const Arguments& options) {
    const std::int64_t done = read_checkpoint(scratch / "a/checkpoint.h5").state.step;
    Arguments more = options;
    more.insert(more.end(), {"--steps", std::to_string(done + 5)});
    must_run("whole", more);
    more.push_back("--resume");
    must_run("a", more);
    expect_same_run(scratch / "whole", scratch / "a");
  }

  Scratch scratch;
  fs::path scene = put_scene(scratch, small_scene());
};

TEST_F(CliRun, WritesAllFiles) {
  must_run("a");
  const std::vector<StepReport> steps = read_steps_csv(scratch / "a/steps.csv");
  ASSERT_EQ(steps.size(), 20u);
  EXPECT_EQ(steps.back().step, 20);
  EXPECT_NEAR(steps.back().time, 0.02, 1e-12);
  EXPECT_EQ(steps.front().body_count, 160);  // the first batch of rain is there
  EXPECT_EQ(steps.back().body_count, 200);
  EXPECT_GT(steps.back().contact_count, 20);

  const Checkpoint checkpoint = read_checkpoint(scratch / "a/checkpoint.h5");
  EXPECT_EQ(checkpoint.state.step, 20);
  EXPECT_EQ(checkpoint.state.at<Vec3d>("body/position").size(), 200u);
  EXPECT_EQ(frame_count(scratch / "a/frames.vtkhdf"), 5);  // 0, 5, 10, 15 and 20 ms

  const nlohmann::json record = json_file(scratch / "a/run.json");
  EXPECT_EQ(record.at("status"), "done");
  EXPECT_EQ(record.at("totals").at("steps"), 20);
  EXPECT_EQ(record.at("scene").at("name"), "small");
  EXPECT_EQ(record.at("backend"), "cpu");
  EXPECT_EQ(record.at("threads"), 1);

  EXPECT_EQ(frame_count(scratch / "a/walls.vtkhdf"), 5);
  EXPECT_TRUE(contents(scratch / "a/walls.obj").starts_with("# Fixed"));
  for (const char* name : {"a/picture_00000.png", "a/picture_00001.png"})
    EXPECT_TRUE(contents(scratch / name).starts_with(png_signature)) << name;
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(scratch / "a")) ++files;
  EXPECT_EQ(files, 8u) << "no temporary file is left, and the last picture is not there twice";
}

/// The lines of a table, each cut at its commas.
std::vector<std::vector<std::string>> table(const fs::path& file) {
  std::vector<std::vector<std::string>> rows;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::istringstream fields(line);
    rows.emplace_back();
    for (std::string field; std::getline(fields, field, ',');) rows.back().push_back(field);
  }
  return rows;
}

TEST_F(CliRun, ForcesOnWallsGroupsAndJoints) {
  nlohmann::json forces = small_scene();
  forces["output"]["force_interval"] = 0.004;
  forces["bodies"][0]["group"] = "tank";
  forces["particles"][0]["group"] = "grains";
  scene = put_scene(scratch, forces);
  must_run("whole");
  const auto rows = table(scratch / "whole/forces.csv");
  const std::vector<std::string> header = rows.front();
  EXPECT_EQ(header.size(), 11u);
  EXPECT_EQ(header[5], "force_x_N");
  std::map<std::string, double> upward;  // sums over the intervals
  std::size_t lines = 1;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    ASSERT_EQ(rows[k].size(), header.size()) << k;
    EXPECT_EQ(rows[k][2], "4") << "steps in an interval";
    upward[rows[k][3] + " " + rows[k][4]] += std::stod(rows[k][7]);
    lines += rows[k][0] == "4" ? 1 : 0;
  }
  EXPECT_EQ(rows.size(), 1 + 5 * (lines - 1));
  for (const char* wall : {"fixed 0", "kinematic 1", "kinematic 2"}) {
    ASSERT_EQ(upward.count(wall), 1u) << wall;
    EXPECT_LT(upward[wall], -0.1) << wall << " is hit from above";
  }
  EXPECT_EQ(upward.count("group tank"), 1u);
  EXPECT_GT(upward["group grains"], 0.1);
  double sum = 0;  // groups push each other
  for (const auto& [name, force] : upward) sum += name.starts_with("group") ? force : 0;
  EXPECT_NEAR(sum, 0, 1e-9 * std::abs(upward["group grains"]));

  must_run("parts", {"--steps", "10"});  // ends within an interval
  must_run("parts", {"--steps", "20", "--resume"});
  EXPECT_EQ(contents(scratch / "whole/forces.csv"), contents(scratch / "parts/forces.csv"));

  must_run("other", {"--steps", "10"});
  put(scratch / "other/forces.csv", "a,b\n1,2\n");
  const Result refused =
      scree(scratch, run_arguments(scene, scratch / "other", {"--steps", "20", "--resume"}));
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("forces.csv line 1"), std::string::npos) << refused.err;
}

/// A run in two parts writes what a run in one does: falling bodies, and one that joins later.
TEST_F(CliRun, SurfacesAtTheTimesOfTheFrames) {
  const nlohmann::json falling = nlohmann::json::parse(R"({
    "name": "falling", "time_step": 1e-3, "duration": 0.02, "precision": "double",
    "bodies": [
      {"shape": "half_space", "normal": [0, 0, 1]},
      {"shape": "sphere", "radius": 0.1, "position": [0.5, 0.2, 0.3], "mass": 3},
      {"shape": "box", "size": [0.2, 0.2, 0.2], "position": [-0.5, 0, 0.3], "mass": 4},
      {"shape": "cone", "radius": 0.1, "length": 0.2, "position": [0, 0, 0.4], "mass": 1, "insert_at": 0.008}],
    "output": {"frame_interval": 0.005, "surface_frames": true, "picture": false}})");
  scene = put_scene(scratch, falling);
  must_run("whole");
  must_run("parts", {"--steps", "10"});
  must_run("parts", {"--steps", "20", "--resume"});
  const auto with_vtk = [&](const char* run, const auto& look) {
    const h5::File file = h5::File::open(scratch / run / "surfaces.vtkhdf");
    look(file.root().open_group("VTKHDF"));
  };
  std::vector<float> points;
  std::vector<double> times;
  with_vtk("whole", [&](const h5::Group& vtk) {
    points = vtk.read<float>("Points");
    times = vtk.read<double>("Steps/Values");
    EXPECT_EQ(times.size(), 5u);
    EXPECT_EQ(vtk.read<std::int64_t>("NumberOfPoints").size(), 2u) << "without and with the cone";
    const auto cells = vtk.read<std::int64_t>("CellData/id");
    EXPECT_EQ(std::set<std::int64_t>(cells.begin(), cells.end()),
              (std::set<std::int64_t>{1, 2, 3}));
    // The cone, the last body, falls from rest: its speed in the last frame is g t.
    const auto speed = vtk.read<float>("PointData/speed");
    EXPECT_NEAR(speed.back(), 9.81 * 0.012, 1e-2 * 9.81 * 0.012);
  });
  with_vtk("parts", [&](const h5::Group& vtk) {
    EXPECT_EQ(vtk.read<float>("Points"), points);
    EXPECT_EQ(vtk.read<double>("Steps/Values"), times);
  });
  const Result check = scree(scratch, {"check", scene.string()});
  EXPECT_NE(check.out.find("surfaces    "), std::string::npos) << check.out;
  const Result json = scree(scratch, {"check", scene.string(), "--json"});
  with_vtk("whole", [&](const h5::Group& vtk) {
    EXPECT_EQ(nlohmann::json::parse(json.out).at("surfaces").at("corners"),
              vtk.read<std::int64_t>("NumberOfPoints").back());
  });
}

/// Of bodies at rest: contacts lie on the floor, and their forces hold the bodies.
TEST_F(CliRun, ContactsAtTheTimesOfTheFrames) {
  nlohmann::json resting = nlohmann::json::parse(R"({
    "name": "resting", "time_step": 1e-3, "duration": 0.02, "precision": "double",
    "bodies": [
      {"shape": "half_space", "normal": [0, 0, 1]},
      {"shape": "sphere", "radius": 0.1, "position": [0.5, 0.2, 0.1], "mass": 3},
      {"shape": "box", "size": [0.2, 0.2, 0.2], "position": [-0.5, 0, 0.1], "mass": 4},
      {"shape": "sphere", "radius": 0.1, "position": [0, 0, 0.11], "mass": 1}],
    "output": {"frame_interval": 0.005, "contact_frames": true, "picture": false}})");
  scene = put_scene(scratch, resting);
  must_run("whole");
  must_run("parts", {"--steps", "12"});
  must_run("parts", {"--steps", "20", "--resume"});
  for (const char* run : {"whole", "parts"}) {
    const h5::File file = h5::File::open(scratch / run / "contacts.vtkhdf");
    const h5::Group vtk = file.root().open_group("VTKHDF");
    const auto times = vtk.read<double>("Steps/Values");
    ASSERT_EQ(times.size(), run[0] == 'w' ? 4u : 5u) << "no contacts at the start";
    EXPECT_EQ(times.back(), 0.02);
    const auto contacts = vtk.read<std::int64_t>("NumberOfPoints");
    const auto first = vtk.read<std::int64_t>("Steps/PointOffsets").back();
    EXPECT_EQ(vtk.read<std::int64_t>("Steps/CellOffsets").size(), 4 * times.size());
    const auto points = vtk.read<double>("Points");
    const auto force = vtk.read<double>("PointData/force");
    const auto body_a = vtk.read<std::int32_t>("PointData/body_a");
    const auto body_b = vtk.read<std::int32_t>("PointData/body_b");
    const auto gap = vtk.read<double>("PointData/gap");
    std::map<int, double> weight;
    for (std::int64_t k = first; k < first + contacts.back(); ++k) {
      const auto c = static_cast<std::size_t>(k);
      EXPECT_EQ(body_b[c], 0);
      EXPECT_NEAR(points[3 * c + 2], 0, 1e-4) << "on the floor";
      EXPECT_LT(gap[c], 1e-3);
      if (body_a[c] == 1) {
        EXPECT_NEAR(points[3 * c], 0.5, 1e-9);
      }
      weight[body_a[c]] -= force[3 * c + 2];
    }
    EXPECT_NEAR(weight[1], 3 * 9.81, 1e-3 * 9.81);
    EXPECT_NEAR(weight[2], 4 * 9.81, 1e-2 * 4 * 9.81);
    EXPECT_EQ(weight.count(3), 0u) << "it still falls";
  }
  const Result refused =
      scree(scratch, run_arguments(scene, scratch / "parts",
                                   {"--steps", "25", "--resume", "--precision", "float"}));
  EXPECT_EQ(refused.code, 2);
}

TEST_F(CliRun, StepsAndOverridesAreRecorded) {
  must_run("a", {"--steps", "3", "--set", "solver.max_iterations=7", "--set",
                 "particles.0.count=20", "--set", "solver.name=gauss_seidel"});
  EXPECT_EQ(read_steps_csv(scratch / "a/steps.csv").size(), 3u);
  const nlohmann::json record = json_file(scratch / "a/run.json");
  EXPECT_EQ(record.at("scene").at("solver").at("max_iterations"), 7);
  EXPECT_EQ(record.at("scene").at("solver").at("name"), "gauss_seidel");
  EXPECT_EQ(record.at("scene").at("particles").at(0).at("count"), 20);
}

TEST_F(CliRun, DoublePrecision) {
  must_run("a", {"--steps", "3", "--precision", "double"});
  EXPECT_EQ(read_checkpoint(scratch / "a/checkpoint.h5").precision, Precision::double_precision);
}

/// The corners of a box that turns by 5 rad/s about the z axis through its middle at (0.04, 0).
TEST_F(CliRun, MovingWallsMoveInTheFrames) {
  must_run("a", {"--precision", "double"});
  must_run("b", {"--precision", "double", "--steps", "7"});
  must_run("b", {"--precision", "double", "--resume"});
  for (const char* run : {"a", "b"}) {
    const h5::File file = h5::File::open(scratch / run / "walls.vtkhdf");
    const h5::Group vtk = file.root().open_group("VTKHDF");
    const auto times = vtk.read<double>("Steps/Values");
    const auto first = vtk.read<std::int64_t>("Steps/PointOffsets");
    const auto points = vtk.read<double>("Points");
    ASSERT_EQ(times.size(), run[0] == 'a' ? 5u : 6u);  // the first part of b ends at 7 ms
    for (std::size_t frame = 0; frame < times.size(); ++frame) {
      const double c = std::cos(5 * times[frame]), s = std::sin(5 * times[frame]);
      // Container, first box, second box: eight corners each, the lowest signs first.
      const std::size_t corner = 3 * (static_cast<std::size_t>(first[frame]) + 16);
      EXPECT_NEAR(points[corner], 0.04 - 0.025 * c + 0.025 * s, 1e-12) << times[frame];
      EXPECT_NEAR(points[corner + 1], -0.025 * s - 0.025 * c, 1e-12) << times[frame];
      EXPECT_NEAR(points[corner + 2], 0, 1e-12);
    }
  }
}

TEST_F(CliRun, QuietPrintsNothing) {
  const Result result =
      scree(scratch, run_arguments(scene, scratch / "a", {"--steps", "2", "--quiet"}));
  EXPECT_EQ(result.code, 0);
  EXPECT_EQ(result.out + result.err, "");
}

TEST_F(CliRun, SummaryNamesStepsAndFolder) {
  const Result result = scree(scratch, run_arguments(scene, scratch / "a", {"--steps", "2"}));
  const std::string text = result.out + result.err;
  EXPECT_NE(text.find("2 steps"), std::string::npos) << text;
  EXPECT_NE(text.find((scratch / "a").string()), std::string::npos) << text;
}

TEST_F(CliRun, DefaultFolderIsOutAndTheName) {
  const Result result =
      scree(scratch, {"run", scene.string(), "--backend", "cpu", "--steps", "1", "--quiet"});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_TRUE(fs::exists(scratch / "out/small/steps.csv"));
}

TEST_F(CliRun, DumpProblemWritesTheProblemsOfTheStepsAskedFor) {
  must_run("plain", {"--steps", "20"});
  must_run("dumped", {"--steps", "20", "--dump-problem", "20", "--dump-problem", "11"});
  expect_same_run(scratch / "plain", scratch / "dumped");
  for (const int step : {11, 20}) {
    const auto path = scratch / "dumped" / ("problem_" + std::to_string(step) + ".hdf5");
    const StoredProblem stored = read_problem(path);
    const auto& problem = std::get<BodyProblem>(stored.form);
    EXPECT_EQ(problem.source.scene, "small");
    EXPECT_EQ(problem.source.step, step);
    EXPECT_EQ(problem.source.precision, "float");
    EXPECT_GT(problem.contact_count(), 10);
  }
  EXPECT_FALSE(fs::exists(scratch / "plain/problem_20.hdf5"));
  must_run("dumped", {"--steps", "5", "--force"});
  EXPECT_FALSE(fs::exists(scratch / "dumped/problem_20.hdf5"));
}

TEST_F(CliRun, DumpProblemOfAStepWithoutContactsSaysSo) {
  nlohmann::json empty = small_scene();
  empty["gravity"] = {0, 0, 0};
  empty["bodies"] = nlohmann::json::array();
  put_scene(scratch, empty);
  const Result result = scree(
      scratch,
      run_arguments(scene, scratch / "a", {"--steps", "2", "--dump-problem", "1", "--quiet"}));
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(result.err, "step 1 has no contacts: problem_1.hdf5 is not written\n");
  EXPECT_FALSE(fs::exists(scratch / "a/problem_1.hdf5"));
}

TEST_F(CliRun, DumpProblemOfAStepThatIsNotMadeIsRefused) {
  must_run("a", {"--steps", "3"});
  for (const Arguments& more : {Arguments{"--steps", "8", "--dump-problem", "9"},
                                Arguments{"--steps", "8", "--dump-problem", "3", "--resume"}}) {
    const bool resumes = more.back() == "--resume";
    const Result result =
        scree(scratch, run_arguments(scene, scratch / (resumes ? "a" : "b"), more));
    EXPECT_EQ(result.code, 2);
    const std::string expected = resumes ? "--dump-problem 3: this run makes the steps 4 to 8"
                                         : "--dump-problem 9: this run makes the steps 1 to 8";
    EXPECT_NE(result.err.find(expected), std::string::npos) << result.err;
  }
  EXPECT_FALSE(fs::exists(scratch / "b"));
}

TEST_F(CliRun, ForceReplacesTheEarlierRunAndNothingElse) {
  must_run("a");
  put(scratch / "a/notes.txt", "mine");
  must_run("a", {"--force", "--steps", "2"});
  EXPECT_EQ(read_steps_csv(scratch / "a/steps.csv").size(), 2u);
  EXPECT_FALSE(fs::exists(scratch / "a/picture_00001.png"));
  EXPECT_EQ(contents(scratch / "a/notes.txt"), "mine");
}

TEST_F(CliRun, ThreadsDoNotChangeAnyBit) {
  must_run("one");
  must_run("two", {"--threads", "2"});
  expect_same_run(scratch / "one", scratch / "two");
}

class CliResume : public CliRun, public testing::WithParamInterface<const char*> {};

TEST_P(CliResume, ContinuesBitForBit) {
  const std::string solver = std::string("solver.name=") + GetParam();
  must_run("whole", {"--steps", "20", "--set", solver});
  must_run("parts", {"--steps", "10", "--set", solver});
  must_run("parts", {"--steps", "20", "--resume", "--set", solver});
  expect_same_run(scratch / "whole", scratch / "parts");
  EXPECT_EQ(frame_count(scratch / "whole/frames.vtkhdf"),
            frame_count(scratch / "parts/frames.vtkhdf"));
  for (const char* picture : {"picture_00000.png", "picture_00001.png"})
    EXPECT_EQ(contents(scratch / "whole" / picture), contents(scratch / "parts" / picture))
        << picture;
  EXPECT_EQ(json_file(scratch / "parts/run.json").at("resumed_from_step"), 10);
}

INSTANTIATE_TEST_SUITE_P(Solvers, CliResume,
                         testing::Values("apgd", "jacobi", "gauss_seidel", "gauss_seidel_colored",
                                         "schwarz"),
                         [](const auto& info) { return std::string(info.param); });

TEST_F(CliRun, ParticlesOfMixedShapesContinueBitForBit) {
  nlohmann::json json = small_scene();
  json["particles"] =
      nlohmann::json::parse(R"([{"layout": "rain", "count": 60, "density": 1000, "layers": 3,
    "interval": 0.006, "velocity": [0, 0, -8], "region": {"min": [-0.1, -0.1, 0.03], "max": [0.1, 0.1, 0.1]},
    "orientation": "random", "scale": {"min": 0.5, "max": 1}, "shapes": [
      {"shape": "box", "size": [0.02, 0.015, 0.01]}, {"shape": "sphere", "radius": 0.01},
      {"shape": "capsule", "radius": 0.006, "length": 0.01},
      {"shape": "cylinder", "radius": 0.008, "length": 0.02}]}])");
  scene = put_scene(scratch, json);
  must_run("whole", {"--steps", "20"});
  must_run("parts", {"--steps", "10"});
  must_run("parts", {"--steps", "20", "--resume"});
  EXPECT_GT(read_steps_csv(scratch / "whole/steps.csv").back().contact_count, 10);
  expect_same_run(scratch / "whole", scratch / "parts");
  EXPECT_EQ(contents(scratch / "whole/picture_00000.png"),
            contents(scratch / "parts/picture_00000.png"));
}

TEST_F(CliRun, ResumeWithALongerDuration) {
  must_run("whole", {"--set", "duration=0.02"});
  must_run("parts", {"--set", "duration=0.007"});
  must_run("parts", {"--set", "duration=0.02", "--resume"});
  expect_same_state(scratch / "whole/checkpoint.h5", scratch / "parts/checkpoint.h5");
}

TEST_F(CliRun, ResumeOfAFinishedRunChangesNothing) {
  must_run("a", {"--steps", "4"});
  const std::string before = contents(scratch / "a/run.json");
  const Result result =
      scree(scratch, run_arguments(scene, scratch / "a", {"--steps", "4", "--resume"}));
  EXPECT_EQ(result.code, 0);
  EXPECT_NE(result.err.find("nothing to do"), std::string::npos) << result.err;
  EXPECT_EQ(contents(scratch / "a/run.json"), before);
}

TEST_F(CliRun, InterruptWritesACheckpointAndCanBeResumed) {
  const fs::path out = scratch / "a";
  const Arguments endless{"--set", "duration=1000",
                          "--set", "output.checkpoint_interval=0",
                          "--set", "output.frame_interval=0"};
  Program program(scratch.path(), run_arguments(scene, out, endless));
  ASSERT_TRUE(eventually([&] { return line_count(contents(out / "steps.csv")) > 1; }));
  program.send(SIGINT);
  const Result result = program.wait();
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_NE(result.err.find("--resume"), std::string::npos) << result.err;
  EXPECT_EQ(json_file(out / "run.json").at("status"), "interrupted");

  const std::int64_t done = read_checkpoint(out / "checkpoint.h5").state.step;
  EXPECT_EQ(read_steps_csv(out / "steps.csv").back().step, done);
  expect_resume_equals_whole(endless);
}

TEST_F(CliRun, KillLeavesReadableFilesThatCanBeResumed) {
  const fs::path out = scratch / "a";
  const Arguments endless{"--set", "duration=1000"};
  Program program(scratch.path(), run_arguments(scene, out, endless));
  ASSERT_TRUE(eventually([&] {
    return fs::exists(out / "checkpoint.h5") && fs::exists(out / "frames.vtkhdf") &&
           line_count(contents(out / "steps.csv")) > 5;
  }));
  program.send(SIGKILL);
  EXPECT_EQ(program.wait().signal, SIGKILL);

  EXPECT_FALSE(read_steps_csv(out / "steps.csv").empty());
  EXPECT_GE(frame_count(out / "frames.vtkhdf"), 1);
  EXPECT_EQ(json_file(out / "run.json").at("status"), "running");
  expect_resume_equals_whole(endless);
}

TEST_F(CliRun, TwoRunsInOneFolderAreRefused) {
  const fs::path out = scratch / "a";
  Program first(scratch.path(), run_arguments(scene, out, {"--set", "duration=1000"}));
  ASSERT_TRUE(eventually([&] { return fs::exists(out / "steps.csv"); }));
  Scratch other;  // the second program's output streams
  const Result result = scree(other, run_arguments(scene, out, {"--force"}));
  EXPECT_EQ(result.code, 2);
  EXPECT_NE(result.err.find("another run is writing there now"), std::string::npos) << result.err;
  EXPECT_TRUE(fs::exists(out / "steps.csv"));
}

/// Each step may take one iteration and must be solved to the last bit.
Arguments never_converges() {
  return {"--set", "solver.max_iterations=1", "--set", "solver.stop=1e-30"};
}

TEST_F(CliRun, StepsThatDidNotConvergeAreToldEvenWhenQuiet) {
  Arguments more = never_converges();
  more.push_back("--quiet");
  const Result result = scree(scratch, run_arguments(scene, scratch / "a", more));
  EXPECT_EQ(result.code, 0);
  const nlohmann::json totals = json_file(scratch / "a/run.json").at("totals");
  const int count = totals.at("steps_not_converged");
  EXPECT_GT(count, 10);
  // One iteration a step does not keep bodies apart either, which is told before.
  EXPECT_EQ(line_count(result.err), 2u) << result.err;
  EXPECT_TRUE(holds(result.err, " overlap by ")) << result.err;
  EXPECT_TRUE(holds(result.err,
                    "\nwarning: " + std::to_string(count) +
                        " of 20 steps ended at the iteration cap (solver.max_iterations 1) above "
                        "the tolerance; the largest residual was "))
      << result.err;
  EXPECT_TRUE(holds(result.err, "of particles[0] #")) << result.err;
}

TEST_F(CliRun, RequiredConvergenceMakesThemAFailureThatKeepsTheResults) {
  Arguments more = never_converges();
  more.insert(more.end(), {"--quiet", "--require-convergence"});
  const Result result = scree(scratch, run_arguments(scene, scratch / "a", more));
  EXPECT_EQ(result.code, 1);
  EXPECT_EQ(line_count(result.err), 2u) << result.err;
  EXPECT_TRUE(holds(result.err, "\nscree: ")) << result.err;
  EXPECT_NE(result.err.find("of 20 steps ended at the iteration cap"), std::string::npos);
  const nlohmann::json record = json_file(scratch / "a/run.json");
  EXPECT_EQ(record.at("status"), "failed");
  EXPECT_NE(result.err.find(record.at("message").get<std::string>()), std::string::npos);
  EXPECT_EQ(read_checkpoint(scratch / "a/checkpoint.h5").state.step, 20);
  must_run("b", {"--require-convergence"});
}

TEST_F(CliRun, ResumeTellsWhichStepsTheTableLacks) {
  must_run("a", {"--steps", "10"});
  const std::string table = contents(scratch / "a/steps.csv");
  const auto resumed = [&](const std::string& kept) {
    fs::remove_all(scratch / "b");
    fs::copy(scratch / "a", scratch / "b");
    if (kept.empty())
      fs::remove(scratch / "b/steps.csv");
    else
      put(scratch / "b/steps.csv", kept);
    const Result result = scree(
        scratch, run_arguments(scene, scratch / "b", {"--steps", "12", "--resume", "--quiet"}));
    EXPECT_EQ(result.code, 0);
    return result.err;
  };
  EXPECT_EQ(resumed(table), "");
  EXPECT_EQ(json_file(scratch / "b/run.json").count("message"), 0u);
  const auto warning = [&](int missing) {
    return "warning: " + (scratch / "b/steps.csv").string() + " has no lines of " +
           std::to_string(missing) + " of the 10 steps before this run\n";
  };
  EXPECT_EQ(resumed(""), warning(10));
  EXPECT_NE(json_file(scratch / "b/run.json").at("message").get<std::string>().find("no lines of"),
            std::string::npos);
  std::size_t end = 0;
  for (int line = 0; line < 8; ++line) end = table.find('\n', end) + 1;
  EXPECT_EQ(resumed(table.substr(0, end)), warning(3));
  EXPECT_EQ(resumed(table.substr(0, end + 9)), warning(3));  // a torn line
}

/// A folder of the same name is not the folder that the run began in.
TEST_F(CliRun, AFolderThatIsRemovedOrReplacedFailsTheRun) {
  for (const bool replaced : {false, true}) {
    const fs::path out = scratch / (replaced ? "replaced" : "removed");
    Program program(scratch.path(),
                    run_arguments(scene, out, {"--set", "duration=1000", "--quiet"}));
    ASSERT_TRUE(eventually([&] { return line_count(contents(out / "steps.csv")) > 1; }));
    fs::rename(out, scratch / "aside");
    if (replaced) fs::create_directory(out);
    program.send(SIGINT);
    const Result result = program.wait();
    EXPECT_EQ(result.code, 1) << result.err;
    EXPECT_NE(result.err.find("it was removed or replaced during the run"), std::string::npos)
        << result.err;
    EXPECT_TRUE(!replaced || fs::is_empty(out));
    fs::remove_all(scratch / "aside");
  }
}

/// A full disk, by a limit on the size of files: the run fails with one message,
/// what was written stays.
TEST_F(CliRun, FullDiskFailsCleanly) {
  const fs::path out = scratch / "a";
  const Result result =
      scree(scratch, run_arguments(scene, out, {"--set", "duration=1000", "--quiet"}),
            /*file_limit=*/400'000);
  EXPECT_EQ(result.code, 1);
  EXPECT_EQ(line_count(result.err), 1u) << result.err;
  EXPECT_NE(result.err.find("cannot write"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find((scratch / "a").string()), std::string::npos) << result.err;
  EXPECT_FALSE(read_steps_csv(out / "steps.csv").empty());
  EXPECT_GE(frame_count(out / "frames.vtkhdf"), 1);
  EXPECT_GT(read_checkpoint(out / "checkpoint.h5").state.step, 0);
  const nlohmann::json record = json_file(out / "run.json");
  EXPECT_EQ(record.at("status"), "failed");
  EXPECT_NE(result.err.find(record.at("message").get<std::string>()), std::string::npos);
}

/// The lines of a table without one of its columns.
std::string without_column(const std::string& table, const std::string& name) {
  std::istringstream in(table);
  std::string out;
  std::ptrdiff_t place = -1;
  for (std::string line; std::getline(in, line);) {
    std::vector<std::string> fields;
    std::istringstream values(line);
    for (std::string field; std::getline(values, field, ',');) fields.push_back(field);
    if (place < 0) place = std::find(fields.begin(), fields.end(), name) - fields.begin();
    fields.erase(fields.begin() + place);
    for (std::size_t k = 0; k < fields.size(); ++k) out += (k > 0 ? "," : "") + fields[k];
    out += '\n';
  }
  return out;
}

TEST_F(CliRun, ResumeKeepsTheColumnsOfAnEarlierVersion) {
  must_run("whole", {"--steps", "12"});
  must_run("a", {"--steps", "8"});
  const fs::path table = scratch / "a/steps.csv";
  put(table, without_column(contents(table), "max_joint_error_m"));
  must_run("a", {"--steps", "12", "--resume"});
  put(scratch / "whole/steps.csv",
      without_column(contents(scratch / "whole/steps.csv"), "max_joint_error_m"));
  EXPECT_EQ(contents(table).find("max_joint_error_m"), std::string::npos);
  EXPECT_EQ(read_steps_csv(table).size(), 12u);
  EXPECT_EQ(json_file(scratch / "a/run.json").count("message"), 0u);
  expect_same_run(scratch / "whole", scratch / "a");
}

}  // namespace
}  // namespace scree::test
