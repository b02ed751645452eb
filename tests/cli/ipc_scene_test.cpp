// Scenes of rigid-ipc on the command line.

#include <cmath>
#include <numbers>

#include "dynamics/dynamics_card.h"
#include "host/io/frame_reader.h"
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

// Two tetrahedra, of which the second is moved by just the size of the first.
TEST(CliIpcScenes, BodiesThatTouchButForRoundingAreRefusedByTheirTriangles) {
  if (find_dynamics("affine") == nullptr) GTEST_SKIP() << "no dynamics \"affine\"";
  const Scratch scratch;
  nlohmann::json scene = nlohmann::json::parse(kFallingTetrahedron);
  nlohmann::json& bodies = scene["rigid_body_problem"]["rigid_bodies"];
  bodies[1] = bodies[0];
  bodies[1]["position"] = {1, 1, 0};
  const fs::path file = put(scratch / "touching.json", scene.dump());
  const Result run = scree(scratch, run_arguments(file, scratch / "run"));
  EXPECT_EQ(run.code, 2);
  EXPECT_TRUE(holds(run.err, "bodies[0] \"") && holds(run.err, "bodies[1] \"")) << run.err;
  EXPECT_TRUE(holds(run.err, "touch at the start: triangle ")) << run.err;
  bodies[1]["position"] = {1.001, 1, 0};
  const Result apart = scree(scratch, run_arguments(put(file, scene.dump()), scratch / "run"));
  EXPECT_EQ(apart.code, 0) << apart.err;
}

/// A box of 1 x 2 x 3 m that was turned by 30 degrees about z, spins about it and falls.
constexpr const char* kSpinningBox = R"({
  "timestep": 0.01, "max_time": 0.05, "output": {"frame_interval": 0.01, "picture": {"width": 64, "height": 48}},
  "rigid_body_problem": {
    "gravity": [0, 0, -10], "coefficient_friction": 0.5,
    "rigid_bodies": [
      {"vertices": [[0, 0, 0], [1, 0, 0], [0, 2, 0], [1, 2, 0], [0, 0, 3], [1, 0, 3], [0, 2, 3], [1, 2, 3]],
       "faces": [[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4],
                 [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]],
       "density": 500, "position": [0, 0, 5], "rotation": [0, 0, 30], "linear_velocity": [2, 0, 0],
       "angular_velocity": [0, 0, 90]},
      {"vertices": [[-9, 0, -9], [0, 0, 9], [9, 0, -9]], "faces": [[0, 1, 2]], "type": "static",
       "position": [0, -50, 0]}]
  }
})";

Vec3d vector_of(const nlohmann::json& j) { return {j.at(0), j.at(1), j.at(2)}; }
void expect_near(const Vec3d& a, const Vec3d& b, double tolerance, const char* what) {
  EXPECT_LE(norm(a - b), tolerance) << what << ": " << a.x << ' ' << a.y << ' ' << a.z << ", not "
                                    << b.x << ' ' << b.y << ' ' << b.z;
}

TEST(CliIpcScenes, ARunBecomesTheSimulationFileOfRigidIpc) {
  if (find_dynamics("affine") == nullptr) GTEST_SKIP() << "no dynamics \"affine\"";
  const Scratch scratch;
  const fs::path scene = put(scratch / "box.json", kSpinningBox);
  const Result run = scree(scratch, run_arguments(scene, scratch / "run"));
  ASSERT_EQ(run.code, 0) << run.err;
  const fs::path file = scratch / "sim.json";
  const Result converted = scree(scratch, {"convert", (scratch / "run").string(), file.string()});
  ASSERT_EQ(converted.code, 0) << converted.err;
  EXPECT_EQ(converted.out, file.string() + ": 6 states of 2 bodies\n");
  const nlohmann::json sim = json_file(file);
  const nlohmann::json& states = sim.at("animation").at("state_sequence");
  ASSERT_EQ(states.size(), 6u);

  // Moments ascend: the longest edge is the first axis, the shortest the last one.
  const double turn = std::numbers::pi / 6;
  const Vec3d edge_x{std::cos(turn), std::sin(turn), 0}, edge_y{-std::sin(turn), std::cos(turn), 0};
  const Quatd start = exp_map(vector_of(states[0]["rigid_bodies"][0]["rotation"]));
  EXPECT_NEAR(std::abs(dot(rotate(start, Vec3d{1, 0, 0}), Vec3d{0, 0, 1})), 1, 1e-12);
  EXPECT_NEAR(std::abs(dot(rotate(start, Vec3d{0, 1, 0}), edge_y)), 1, 1e-12);
  EXPECT_NEAR(std::abs(dot(rotate(start, Vec3d{0, 0, 1}), edge_x)), 1, 1e-12);
  const Vec3d center = 0.5 * edge_x + edge_y + Vec3d{0, 0, 6.5};
  const double spin = std::numbers::pi / 2, mass = 3000, moment = mass * (1 + 4) / 12;
  expect_near(vector_of(states[0]["rigid_bodies"][0]["position"]), center, 1e-12, "position");
  expect_near(vector_of(states[0]["linear_momentum"]), {2 * mass, 0, 0}, 1e-9, "momentum");
  EXPECT_NEAR(norm(vector_of(states[0]["angular_momentum"])), moment * spin, 1e-9);
  EXPECT_NEAR(states[0]["kinetic_energy"].get<double>(),
              0.5 * mass * 4 + 0.5 * moment * spin * spin, 1e-8);
  EXPECT_NEAR(states[0]["potential_energy"].get<double>(), mass * 10 * 6.5, 1e-8);
  EXPECT_TRUE(states[5]["min_distance"].is_null());  // nothing is near
  // Nearest to its tip, at z = 9, are 50.625 of 162 m^2.
  expect_near(vector_of(states[3]["rigid_bodies"][1]["position"]), {0, -50, -3.375}, 1e-12,
              "center of the triangle");

  const FrameReader frames(scratch / "run" / "frames.vtkhdf");
  for (std::size_t k = 0; k < 6; ++k) {
    const BodyStates found = frames.states(k);
    const nlohmann::json& body = states[k]["rigid_bodies"][0];
    expect_near(vector_of(body["position"]), found.position[0], 1e-12, "position");
    expect_near(vector_of(body["linear_velocity"]), found.velocity[0], 1e-12, "velocity");
    const Quatd turned = exp_map(vector_of(body["rotation"])) * conjugate(start);
    const Quatd expected = found.orientation[0] * conjugate(frames.states(0).orientation[0]);
    for (const Vec3d& axis : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}})
      expect_near(rotate(turned, axis), rotate(expected, axis), 1e-12, "axis");
    const Vec3d rate = rotate(start, vector_of(body["angular_velocity"]));
    expect_near(rate, found.angular_velocity[0], 1e-12, "angular velocity");
    // Q' is [w] Q, up to the step.
    const Vec3d column{body["Qdot"][0][1], body["Qdot"][1][1], body["Qdot"][2][1]};
    const Quatd q = exp_map(vector_of(body["rotation"]));
    if (k > 0) expect_near(column, cross(rate, rotate(q, Vec3d{0, 1, 0})), 0.03, "rate");
  }

  EXPECT_EQ(sim["args"]["timestep"], 0.01);
  EXPECT_FALSE(sim["args"].contains("output"));
  const nlohmann::json& stats = sim["stats"];
  EXPECT_EQ(stats["num_bodies"], 2);
  EXPECT_EQ(stats["num_vertices"], 11);
  EXPECT_EQ(stats["num_edges"], 18 + 3);
  EXPECT_EQ(stats["num_faces"], 13);
  EXPECT_EQ(stats["step_minimum_distances"], nlohmann::json({-1, -1, -1, -1, -1}));
  for (const char* key : {"step_timings", "solver_iterations", "num_contacts"})
    EXPECT_EQ(stats[key].size(), 5u) << key;
}

TEST(CliIpcScenes, WhatIsNoRunOfEveryStepIsRefused) {
  if (find_dynamics("affine") == nullptr) GTEST_SKIP() << "no dynamics \"affine\"";
  const Scratch scratch;
  const fs::path scene = put(scratch / "box.json", kSpinningBox);
  const fs::path run = scratch / "run", file = scratch / "sim.json";
  const auto refusal = [&](const Arguments& arguments) {
    const Result result = scree(scratch, arguments);
    EXPECT_EQ(result.code, 2) << result.out;
    EXPECT_FALSE(fs::exists(file));
    return result.err;
  };
  const Arguments convert{"convert", run.string(), file.string()};
  fs::create_directory(run);
  EXPECT_TRUE(holds(refusal(convert), "run.json: no such file: expected the folder of a run"));
  const Arguments coarse = run_arguments(scene, run, {"--set", "output.frame_interval=0.02"});
  ASSERT_EQ(scree(scratch, coarse).code, 0);
  EXPECT_TRUE(holds(refusal(convert), run.string() + ": frame 1 is at 0.02 s, expected 0.01 s"));
  Arguments kind = convert;
  kind.insert(kind.end(), {"--kind", "global"});
  EXPECT_TRUE(holds(refusal(kind), "--kind and --storage are for contact problems"));
  fs::rename(scene, scratch / "moved.json");
  EXPECT_TRUE(holds(refusal(convert), "scene_file: there is no"));
  const fs::path own = put_scene(scratch, small_scene());
  ASSERT_EQ(scree(scratch, run_arguments(own, scratch / "own", {"--steps", "1"})).code, 0);
  EXPECT_TRUE(holds(refusal({"convert", (scratch / "own").string(), file.string()}),
                    "scene: is none of rigid-ipc's"));
}

}  // namespace
}  // namespace scree::test
