// Scenes of rigid-ipc on the command line.

#include "dynamics/dynamics_card.h"
#include "tests/cli/program.h"

namespace scree::test {
namespace {

constexpr const char* kFallingTetrahedron = R"({
  "timestep": 0.01, "max_time": 0.05,
  "rigid_body_problem": {
    "gravity": [0, -9.8, 0], "coefficient_restitution": 0.5,
    "rigid_bodies": [
      {"vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
       "faces": [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], "position": [0, 1, 0]},
      {"vertices": [[-9, 0, -9], [0, 0, 9], [9, 0, -9]], "faces": [[0, 1, 2]], "type": "static"}]
  }
})";

TEST(CliIpcScenes, TheProgramSaysWhatItTookAFileFor) {
  const Scratch scratch;
  const fs::path scene = put(scratch / "falling.json", kFallingTetrahedron);
  const Result check = scree(scratch, {"check", scene.string()});
  if (find_dynamics("affine") == nullptr) {
    EXPECT_EQ(check.code, 2);
    EXPECT_TRUE(holds(check.err, scene.string() + ": dynamics.type: \"affine\" is not allowed"))
        << check.err;
    GTEST_SKIP() << "no dynamics \"affine\"";
  }
  EXPECT_EQ(check.code, 0) << check.err;
  EXPECT_TRUE(holds(check.out, "a scene of rigid-ipc, angles in degrees: 1 free, 1 fixed"))
      << check.out;
  EXPECT_TRUE(holds(check.out, "coefficient_restitution 0.5 is not used")) << check.out;
  const Result other =
      scree(scratch, {"check", scene.string(), "--set", "dialect=autodesk", "--json"});
  EXPECT_EQ(other.code, 0) << other.err;
  EXPECT_TRUE(holds(other.out, "radians")) << other.out;
  const Result run = scree(scratch, {"run", scene.string(), "--backend", "cpu"});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(holds(run.err + run.out, "a scene of rigid-ipc")) << run.err;
  EXPECT_TRUE(fs::exists(scratch / "out" / fs::path("falling") / "steps.csv"));
}

TEST(CliIpcScenes, AFaultNamesFileKeyAndValue) {
  const Scratch scratch;
  const fs::path scene = put(scratch / "falling.json", kFallingTetrahedron);
  const Result result = scree(
      scratch, {"check", scene.string(), "--set", "rigid_body_problem.rigid_bodies.0.density=-5"});
  EXPECT_EQ(result.code, 2);
  EXPECT_TRUE(holds(result.err, scene.string() +
                                    ": rigid_body_problem.rigid_bodies[0].density (overridden): -5 "
                                    "is not allowed: must be positive [kg/m^3]"))
      << result.err;
}

}  // namespace
}  // namespace scree::test
