// What scree run tells at the end of a run whose steps were too long for it, or whose joints did not hold.

#include "tests/cli/program.h"

namespace scree::test {
namespace {

/// Two rods of 0.4 m between points 2 m apart: no velocity holds both.
TEST(CliRunWarnings, JointsThatDoNotHoldAreTold) {
  const Scratch scratch;
  const nlohmann::json scene = nlohmann::json::parse(R"({
    "time_step": 0.001, "duration": 0.1,
    "bodies": [{"name": "s", "shape": "sphere", "radius": 0.05, "mass": 1}],
    "joints": [{"type": "distance", "bodies": ["world", "s"], "anchors": [[1, 0, 0], [0, 0, 0]], "length": 0.4},
               {"type": "distance", "bodies": ["world", "s"], "anchors": [[-1, 0, 0], [0, 0, 0]], "length": 0.4}],
    "output": {"picture": false}})");
  const fs::path file = put_scene(scratch, scene);
  const Result run = scree(scratch, run_arguments(file, scratch / "a"));
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(holds(run.out + run.err, "joints were off by up to 0.6")) << run.out << run.err;
  EXPECT_TRUE(holds(run.out + run.err, "(distance) of the world and bodies[0] (id 0)")) << run.err;
  const nlohmann::json record = json_file(scratch / "a/run.json");
  EXPECT_EQ(record.at("status"), "joints_apart");
  const auto message = record.at("message").get<std::string>();
  EXPECT_TRUE(holds(message, "joints were off by up to 0.6")) << message;
  EXPECT_TRUE(holds(message, "m/s RMS")) << message;
  const Result strict =
      scree(scratch, run_arguments(file, scratch / "b", {"--require-convergence"}));
  EXPECT_EQ(strict.code, 1);
  EXPECT_TRUE(holds(strict.err, "joints_apart: joints were off")) << strict.err;
  EXPECT_TRUE(holds(strict.err, "m/s RMS")) << strict.err;
}

/// A fixed joint and a hinge whose motor nothing stops, between the same bodies: anchors stay together, velocities cannot.
TEST(CliRunWarnings, AMotorThatAJointContradictsIsTold) {
  const Scratch scratch;
  nlohmann::json scene = nlohmann::json::parse(R"({
    "time_step": 0.001, "duration": 0.02,
    "bodies": [{"name": "a", "shape": "box", "size": [0.5, 0.1, 0.1], "mass": 1}],
    "joints": [{"type": "fixed", "bodies": ["world", "a"], "anchor": [0, 0, 0]},
               {"type": "hinge", "bodies": ["world", "a"], "anchor": [0, 0, 0], "axis": [0, 0, 1], "motor": {"speed": 1}}],
    "output": {"picture": false}})");
  const Result run = scree(scratch, run_arguments(put_scene(scratch, scene), scratch / "a"));
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(holds(run.out + run.err, "m/s in step")) << run.out << run.err;
  const nlohmann::json record = json_file(scratch / "a/run.json");
  EXPECT_EQ(record.at("status"), "joints_apart");
  const auto message = record.at("message").get<std::string>();
  EXPECT_TRUE(holds(message, "joints[")) << message;
  EXPECT_TRUE(holds(message, "of the world and bodies[0] (id 0): it contradicts")) << message;
  EXPECT_TRUE(holds(message, "m/s RMS")) << message;
  const std::string table = contents(scratch / "a/steps.csv");
  EXPECT_NE(table.find("residual_max_joint,"), std::string::npos) << table;

  scene["gravity"] = {0, 0, 0};
  scree(scratch, run_arguments(put_scene(scratch, scene), scratch / "weightless"));
  EXPECT_EQ(json_file(scratch / "weightless/run.json").at("status"), "joints_apart");
}

/// A ball joint and a rod of half a meter to a point 1 m above it: of what is off, the rod has most.
TEST(CliRunWarnings, TheJointThatIsFarthestOffIsNamed) {
  const Scratch scratch;
  const nlohmann::json scene = nlohmann::json::parse(R"({
    "time_step": 0.001, "duration": 0.1,
    "bodies": [{"name": "other", "shape": "sphere", "radius": 0.05, "mass": 1, "position": [3, 0, 0]},
               {"name": "s", "shape": "sphere", "radius": 0.05, "mass": 1, "position": [0, 0, 1]}],
    "joints": [{"type": "ball", "bodies": ["world", "other"], "anchor": [3, 0, 0]},
               {"type": "ball", "bodies": ["world", "s"], "anchor": [0, 0, 1]},
               {"type": "distance", "bodies": ["s", "world"], "anchors": [[0, 0, 1], [0, 0, 2]], "length": 0.5}],
    "output": {"picture": false}})");
  const Result run = scree(scratch, run_arguments(put_scene(scratch, scene), scratch / "a"));
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(holds(run.out + run.err,
                    "farthest off was joints[2] (distance) of bodies[1] (id 1) and the world"))
      << run.out << run.err;
  const std::string table = contents(scratch / "a/steps.csv");
  EXPECT_NE(table.find("max_joint_error_m,max_joint_error_joint,"), std::string::npos) << table;
}

/// Boxes that meet at 40 m/s in steps of 1/60 s turn into each other.
TEST(CliRunWarnings, BodiesThatRunDeepIntoEachOtherAreTold) {
  const Scratch scratch;
  const nlohmann::json scene = nlohmann::json::parse(R"({
    "time_step": 0.016666666666666666, "duration": 0.2, "gravity": [0, 0, 0],
    "bodies": [{"shape": "box", "size": [1, 1, 1], "density": 1000, "position": [-2, 0, 0], "velocity": [20, 0, 0],
                "orientation": [0.9479570915939886, -0.2687390259662378, 0.1600870154680084, 0.05940400573976382]},
               {"shape": "box", "size": [1, 1, 1], "density": 1000, "position": [2, 0.47, 0.33], "velocity": [-20, 0, 0],
                "orientation": [-0.2570559807278712, -0.46571196508441104, -0.6659959500686206, -0.5229569607926108]}],
    "output": {"picture": false}})");
  const Result run = scree(scratch, run_arguments(put_scene(scratch, scene), scratch / "a"));
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(holds(run.out + run.err, "overlap by 0.145 m in step 6")) << run.out << run.err;
}

// The step is not to blame where they appear.
TEST(CliRunWarnings, ParticlesThatAppearInABodyAreToldAsThat) {
  const Scratch scratch;
  const nlohmann::json scene = nlohmann::json::parse(R"({
    "time_step": 0.001, "duration": 0.12, "gravity": [0, 0, 0],
    "bodies": [{"shape": "box", "kind": "fixed", "size": [1, 1, 0.2], "position": [0, 0, 1.05]}],
    "particles": [{"layout": "rain", "count": 40, "radius": 0.05, "density": 1000, "velocity": [0, 0, -3], "layers": 2, "start": 0.05,
                   "interval": 0.05, "region": {"min": [-0.5, -0.5, 1], "max": [0.5, 0.5, 1.15]}}],
    "output": {"picture": false}})");
  const Result run = scree(scratch, run_arguments(put_scene(scratch, scene), scratch / "a"));
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(holds(run.out + run.err, ": particles joined in this step, where other bodies were"))
      << run.out << run.err;
  EXPECT_FALSE(holds(run.out + run.err, "a smaller time step")) << run.out << run.err;
}

/// A body that rests and is to move.
TEST(CliRunWarnings, StepsAtTheCapNameTheWorstBodies) {
  const Scratch scratch;
  const nlohmann::json scene = nlohmann::json::parse(R"({
    "time_step": 0.001, "duration": 0.01,
    "bodies": [{"shape": "sphere", "radius": 0.1, "mass": 1, "position": [2, 0, 0]},
               {"name": "d", "shape": "box", "size": [1, 0.1, 0.1], "mass": 10}],
    "joints": [{"type": "fixed", "bodies": ["world", "d"], "anchor": [0, 0, 0]},
               {"type": "slider", "bodies": ["world", "d"], "anchor": [0, 0, 0], "axis": [1, 0, 0], "motor": {"speed": 1}}],
    "output": {"picture": false}})");
  const Result run = scree(scratch, run_arguments(put_scene(scratch, scene), scratch / "a"));
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(holds(run.out + run.err, "; the largest residual was 0.75")) << run.out << run.err;
  EXPECT_TRUE(holds(run.out + run.err, "of the world and bodies[1] (id 1)") ||
              holds(run.out + run.err, "of bodies[1] (id 1) and the world"))
      << run.out << run.err;
}

}  // namespace
}  // namespace scree::test
