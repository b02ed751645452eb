#include "host/scene_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/host/input_files.h"

namespace scree {
namespace {

using test::refusal;
using test::write_file;
using testing::HasSubstr;
using testing::StartsWith;

constexpr double kPi = 3.14159265358979323846;

/// A scene with one free sphere and further keys of the document.
std::string with_sphere(const std::string& keys) {
  return R"({"time_step": 1e-3, "duration": 1, "bodies": [{"shape": "sphere", "radius": 0.1, "density": 1000}])" +
         (keys.empty() ? "" : ", " + keys) + "}";
}
/// A scene with one free sphere and another body.
std::string with_body(const std::string& body) {
  return R"({"time_step": 1e-3, "duration": 1, "bodies": [{"shape": "sphere", "radius": 0.1, "density": 1000}, )" +
         body + "]}";
}
std::string with_particles(const std::string& entry) {
  return R"({"time_step": 1e-3, "duration": 1, "particles": [)" + entry + "]}";
}
Scene parsed(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return parse_scene(text, "x.json", testing::TempDir(), overrides);
}
std::string refused(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return refusal([&] { parsed(text, overrides); });
}
void expect_near(const Vec3d& a, const Vec3d& b, double tolerance = 1e-15) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], tolerance) << "component " << k;
}

TEST(SceneReader, DefaultsAreThoseOfTheStructs) {
  const Scene scene = parsed(with_sphere(""));
  const Scene expected;
  EXPECT_EQ(scene.name, expected.name);
  EXPECT_EQ(scene.gravity, expected.gravity);
  EXPECT_EQ(scene.seed, expected.seed);
  EXPECT_EQ(scene.backend, "auto");
  EXPECT_EQ(scene.precision, "float");
  ASSERT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(scene.materials[0].friction, Material{}.friction);
  EXPECT_EQ(scene.solver.name, "apgd");
  EXPECT_EQ(scene.solver.stop.level, StopRule::Level::quality);
  EXPECT_TRUE(scene.output.picture.camera.automatic);
  EXPECT_LT(scene.stepping.envelope, 0);
  EXPECT_LT(scene.stepping.skin, 0);
}

TEST(SceneReader, ReadsSettings) {
  const Scene scene = parsed(with_sphere(R"(
    "name": "n", "gravity": [0, 1, 2], "seed": 7, "backend": "cpu", "precision": "double",
    "periodic": {"y": [-1, 2]},
    "solver": {"name": "gauss_seidel", "stop": 1e-4, "max_iterations": 30, "check_every": 3,
               "warm_start": false, "model": "exact", "max_outer_iterations": 4, "relaxation": 1.5,
               "metric": "euclidean"},
    "stepping": {"max_recovery_speed": 0.1, "restitution_threshold": 0.2},
    "collision": {"envelope": 0.003, "skin": 0.02},
    "output": {"frame_interval": 0.5, "checkpoint_interval": 0.6, "picture": {
      "interval": 0.25, "width": 64, "height": 32, "color_by": "size", "color_range": [1, 2],
      "camera": {"position": [1, 2, 3], "target": [0, 0, 1], "up": [0, 2, 0],
                 "vertical_angle_deg": 50}}})"));
  EXPECT_EQ(scene.name, "n");
  EXPECT_EQ(scene.gravity, Vec3d(0, 1, 2));
  EXPECT_EQ(scene.seed, 7u);
  EXPECT_EQ(scene.backend, "cpu");
  EXPECT_EQ(scene.precision, "double");
  EXPECT_EQ(scene.periodicity.periodic, (std::array{false, true, false}));
  EXPECT_EQ(scene.periodicity.lower.y, -1);
  EXPECT_EQ(scene.periodicity.upper.y, 2);
  EXPECT_EQ(scene.stepping.time_step, 1e-3);
  EXPECT_EQ(scene.stepping.duration, 1);
  EXPECT_EQ(scene.stepping.max_recovery_speed, 0.1);
  EXPECT_EQ(scene.stepping.restitution_threshold, 0.2);
  EXPECT_EQ(scene.stepping.envelope, 0.003);
  EXPECT_EQ(scene.stepping.skin, 0.02);
  EXPECT_EQ(scene.solver.name, "gauss_seidel");
  EXPECT_EQ(scene.solver.stop.level, StopRule::Level::absolute);
  EXPECT_EQ(scene.solver.stop.residual, 1e-4);
  EXPECT_EQ(scene.solver.max_iterations, 30);
  EXPECT_EQ(scene.solver.check_every, 3);
  EXPECT_FALSE(scene.solver.warm_start);
  EXPECT_TRUE(scene.solver.exact_coulomb);
  EXPECT_EQ(scene.solver.max_outer_iterations, 4);
  EXPECT_EQ(scene.solver.relaxation, 1.5);
  EXPECT_FALSE(scene.solver.diagonal_metric);
  EXPECT_EQ(scene.output.frame_interval, 0.5);
  EXPECT_EQ(scene.output.checkpoint_interval, 0.6);
  const PictureSettings& picture = scene.output.picture;
  EXPECT_EQ(picture.interval, 0.25);
  EXPECT_EQ(picture.width, 64);
  EXPECT_EQ(picture.height, 32);
  EXPECT_EQ(picture.color_by, ColorBy::size);
  EXPECT_EQ(picture.color_min, 1);
  EXPECT_EQ(picture.color_max, 2);
  EXPECT_FALSE(picture.camera.automatic);
  EXPECT_EQ(picture.camera.position, Vec3d(1, 2, 3));
  EXPECT_EQ(picture.camera.target, Vec3d(0, 0, 1));
  EXPECT_EQ(picture.camera.up, Vec3d(0, 1, 0));
  EXPECT_EQ(picture.camera.vertical_angle, 50);
}

TEST(SceneReader, PicturesCanBeTurnedOff) {
  EXPECT_LT(parsed(with_sphere(R"("output": {"picture": false})")).output.picture.interval, 0);
  EXPECT_EQ(parsed(with_sphere(R"("output": {"picture": true})")).output.picture.interval, 0);
}

TEST(SceneReader, StopLevelsByName) {
  using Level = StopRule::Level;
  const auto level = [](const std::string& name) {
    return parsed(with_sphere(R"("solver": {"stop": ")" + name + "\"}")).solver.stop.level;
  };
  EXPECT_EQ(level("quality"), Level::quality);
  EXPECT_EQ(level("preview"), Level::preview);
  EXPECT_EQ(level("fixed"), Level::fixed_iterations);
}

TEST(SceneReader, MaterialsKeepTheOrderOfTheFileAndPairsTheirMix) {
  const Scene scene = parsed(with_sphere(R"(
    "materials": {"z": {"friction": 0.4, "restitution": 0.5, "cohesion": 1, "rolling_friction": 2,
                        "spinning_friction": 3},
                  "a": {"friction": 0.9, "restitution": 0.1}},
    "material_pairs": [{"between": ["a", "z"], "restitution": 0.7}])"));
  ASSERT_EQ(scene.materials.size(), 2u);
  EXPECT_EQ(scene.materials[0].name, "z");
  EXPECT_EQ(scene.materials[0].cohesion, 1);
  EXPECT_EQ(scene.materials[0].rolling_friction, 2);
  EXPECT_EQ(scene.materials[0].spinning_friction, 3);
  EXPECT_EQ(scene.bodies[0].material, 0);  // the first, because none is called default
  const Material pair = pair_values(scene, 0, 1);
  EXPECT_NEAR(pair.friction, 0.6, 1e-15);
  EXPECT_EQ(pair.restitution, 0.7);
  EXPECT_EQ(pair.cohesion, 0);
}

TEST(SceneReader, MaterialCalledDefaultIsTheDefault) {
  const Scene scene = parsed(with_sphere(R"("materials": {"a": {}, "default": {}})"));
  EXPECT_EQ(scene.bodies[0].material, 1);
}

TEST(SceneReader, ReadsASphere) {
  const Scene scene = parsed(R"({"time_step": 1, "duration": 1, "materials": {"a": {}, "b": {}},
    "bodies": [{"shape": "sphere", "radius": 0.5, "density": 6, "position": [1, 2, 3],
      "velocity": [4, 5, 6], "angular_velocity": [7, 8, 9], "material": "b", "group": "balls",
      "lock": ["x", "rz"]}]})");
  const BodyDescription& body = scene.bodies.at(0);
  EXPECT_EQ(body.kind, BodyKind::free);
  EXPECT_EQ(body.shape.kind, Shape::Kind::sphere);
  EXPECT_EQ(body.shape.radius, 0.5);
  EXPECT_NEAR(body.mass, kPi, 1e-14);
  EXPECT_NEAR(body.inertia.y, 0.4 * kPi * 0.25, 1e-14);
  EXPECT_EQ(body.position, Vec3d(1, 2, 3));
  EXPECT_EQ(body.velocity, Vec3d(4, 5, 6));
  EXPECT_EQ(body.angular_velocity, Vec3d(7, 8, 9));
  EXPECT_EQ(body.material, 1);
  EXPECT_EQ(scene.groups.at(static_cast<std::size_t>(body.group)), "balls");
  EXPECT_EQ(body.locks, lock_x | lock_rz);
}

TEST(SceneReader, ReadsABoxWithMassAndRotation) {
  const BodyDescription body =
      parsed(R"({"time_step": 1, "duration": 1, "bodies": [{"shape": "box", "size": [2, 4, 6],
        "mass": 3, "rotation_deg": {"axis": [0, 0, 2], "angle": 90}, "lock": "rotation"}]})")
          .bodies.at(0);
  EXPECT_EQ(body.shape.half_extents, Vec3d(1, 2, 3));
  EXPECT_NEAR(body.mass, 3, 1e-15);
  expect_near(body.inertia, {(16 + 36) / 4.0, (4 + 36) / 4.0, (4 + 16) / 4.0}, 1e-14);
  expect_near(rotate(body.orientation, Vec3d{1, 0, 0}), {0, 1, 0});
  EXPECT_EQ(body.locks, lock_rotation);
}

TEST(SceneReader, ReadsWalls) {
  const Scene scene = parsed(with_body(R"(
    {"shape": "half_space", "normal": [0, 0, 2], "point": [0, 0, -1]},
    {"shape": "container", "min": [-1, -2, -3], "max": [1, 2, 5], "open": ["+z", "-x"]},
    {"shape": "box", "kind": "fixed", "size": [1, 1, 1], "orientation": [0, 1, 0, 0]})"));
  const BodyDescription& plane = scene.bodies.at(1);
  EXPECT_EQ(plane.kind, BodyKind::fixed);
  EXPECT_EQ(plane.shape.normal, Vec3d(0, 0, 1));
  EXPECT_EQ(plane.position, Vec3d(0, 0, -1));
  EXPECT_EQ(scene.groups.at(static_cast<std::size_t>(plane.group)), "walls");
  const BodyDescription& container = scene.bodies.at(2);
  EXPECT_EQ(container.position, Vec3d(0, 0, 1));
  EXPECT_EQ(container.shape.half_extents, Vec3d(1, 2, 4));
  EXPECT_EQ(container.shape.open_faces, 1u | 32u);
  EXPECT_EQ(scene.bodies.at(3).kind, BodyKind::fixed);
  EXPECT_EQ(scene.bodies.at(3).orientation.x, 1);
}

TEST(SceneReader, ReadsMotions) {
  const Scene scene = parsed(with_body(R"(
    {"shape": "half_space", "kind": "kinematic",
     "motion": {"type": "linear", "velocity": [1, 2, 3], "start": 0.5, "stop": 2}},
    {"shape": "half_space", "kind": "kinematic",
     "motion": {"type": "rotating", "axis": [0, 3, 0], "center": [1, 0, 0], "rate": -2}},
    {"shape": "half_space", "kind": "kinematic",
     "motion": {"type": "oscillating", "axis": [1, 0, 0], "amplitude": 0.1, "frequency": 3, "phase": 1}},
    {"shape": "half_space", "kind": "kinematic",
     "motion": {"type": "sampled", "times": [0, 1], "positions": [[0, 0, 0], [1, 0, 0]],
                "orientations": [[1, 0, 0, 0], [0, 0, 0, 1]]}})"));
  const Motion& linear = scene.bodies.at(1).motion;
  EXPECT_EQ(linear.kind, Motion::Kind::linear);
  EXPECT_EQ(linear.velocity, Vec3d(1, 2, 3));
  EXPECT_EQ(linear.start, 0.5);
  EXPECT_EQ(linear.stop, 2);
  const Motion& rotating = scene.bodies.at(2).motion;
  EXPECT_EQ(rotating.axis, Vec3d(0, 1, 0));
  EXPECT_EQ(rotating.center, Vec3d(1, 0, 0));
  EXPECT_EQ(rotating.rate, -2);
  EXPECT_TRUE(std::isinf(rotating.stop));
  const Motion& oscillating = scene.bodies.at(3).motion;
  EXPECT_EQ(oscillating.amplitude, 0.1);
  EXPECT_EQ(oscillating.frequency, 3);
  EXPECT_EQ(oscillating.phase, 1);
  const Motion& sampled = scene.bodies.at(4).motion;
  EXPECT_EQ(sampled.times, (std::vector<double>{0, 1}));
  EXPECT_EQ(sampled.positions.at(1), Vec3d(1, 0, 0));
  EXPECT_EQ(sampled.orientations.at(1).z, 1);
}

TEST(SceneReader, FilesAreRelativeToTheScene) {
  write_file("motion.csv", "time,x,y,z\n0,0,0,0\n2,1,0,0\n");
  write_file("tetra.obj",
             "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const auto file = write_file("scene.json", with_body(R"(
    {"shape": "mesh", "file": "tetra.obj", "scale": 2, "kind": "kinematic",
     "motion": {"type": "sampled", "file": "motion.csv"}},
    {"shape": "mesh", "file": "tetra.obj", "scale": 2})"));
  const Scene scene = read_scene(file);
  ASSERT_EQ(scene.meshes.size(), 1u);  // shared by both bodies
  EXPECT_EQ(scene.meshes[0].triangles.size(), 4u);
  EXPECT_EQ(scene.bodies.at(1).motion->times.at(1), 2);
  EXPECT_EQ(scene.bodies.at(2).shape.mesh, 0);
}

TEST(SceneReader, InsertedBodiesAreSortedAndMergedByTime) {
  const Scene scene = parsed(R"({"time_step": 1, "duration": 1, "bodies": [
    {"shape": "sphere", "radius": 1, "mass": 1, "insert_at": 2},
    {"shape": "sphere", "radius": 2, "mass": 1, "insert_at": 1},
    {"shape": "sphere", "radius": 3, "mass": 1, "insert_at": 2}]})");
  EXPECT_TRUE(scene.bodies.empty());
  ASSERT_EQ(scene.insertions.size(), 2u);
  EXPECT_EQ(scene.insertions[0].time, 1);
  ASSERT_EQ(scene.insertions[1].bodies.size(), 2u);
  EXPECT_EQ(scene.insertions[1].bodies[1].shape.radius, 3);
}

TEST(SceneReader, ReadsParticlesOfEveryLayout) {
  const Scene scene = parsed(with_particles(R"(
    {"layout": "lattice", "radius": 0.1, "density": 1000, "spacing": 0.25, "velocity": [0, 0, -1],
     "group": "a", "lock": "rx", "region": {"min": [0, 0, 0], "max": [1, 1, 1]}},
    {"layout": "random", "count": 10, "radius": {"values": [0.05, 0.1], "weights": [1, 3]},
     "density": 1000, "region": {"cylinder": {"center": [5, 0, 0], "radius": 0.5, "length": 1}}},
    {"layout": "rain", "count": 1e1, "layers": 3, "interval": 0.5, "start": 0.25, "density": 1000,
     "radius": {"normal": {"mean": 0.1, "deviation": 0.01, "min": 0.08, "max": 0.12}},
     "region": {"min": [0, 0, 5], "max": [1, 1, 6]}})"));
  ASSERT_EQ(scene.particles.size(), 2u);
  const ParticleSet& lattice = scene.particles[0];
  EXPECT_EQ(lattice.position.size(), 64u);
  EXPECT_EQ(scene.particles[1].position.size(), 10u);
  EXPECT_EQ(lattice.velocity[0], Vec3d(0, 0, -1));
  EXPECT_EQ(lattice.locks, lock_rx);
  EXPECT_EQ(scene.groups.at(static_cast<std::size_t>(lattice.group[0])), "a");
  EXPECT_NEAR(particle_mass(lattice, 0), 1000 * 4 / 3.0 * kPi * 1e-3, 1e-12);
  ASSERT_EQ(scene.insertions.size(), 3u);
  EXPECT_EQ(scene.insertions[0].time, 0.25);
  EXPECT_EQ(scene.insertions[2].time, 1.25);
  std::size_t rained = 0;
  for (const Insertion& insertion : scene.insertions)
    rained += insertion.particles.at(0).position.size();
  EXPECT_EQ(rained, 10u);
}

TEST(SceneReader, RateOfRainGivesTheNumberOfBatches) {
  const Scene scene = parsed(with_particles(
      R"({"layout": "rain", "count": 10, "rate": 8, "interval": 0.5, "density": 1000, "radius": 0.1,
          "region": {"min": [0, 0, 5], "max": [1, 1, 6]}})"));
  EXPECT_EQ(scene.insertions.size(), 3u);  // 4 a batch
}

TEST(SceneReader, ReadsParticlesFromCsvWithDefaultsFromTheEntry) {
  write_file("p.csv",
             "x,y,z,vx,vy,vz,radius,density,group,material\n"
             "1,2,3,4,5,6,0.5,6,left,m\n7,8,9,0,0,0,0.25,3,right,n\n");
  const auto file = write_file("scene.json", R"({"time_step": 1, "duration": 1,
    "materials": {"m": {}, "n": {}}, "particles": [{"layout": "file", "file": "p.csv"}]})");
  const Scene scene = read_scene(file);
  const ParticleSet& set = scene.particles.at(0);
  ASSERT_EQ(set.position.size(), 2u);
  EXPECT_EQ(set.position[0], Vec3d(1, 2, 3));
  EXPECT_EQ(set.velocity[0], Vec3d(4, 5, 6));
  EXPECT_NEAR(particle_mass(set, 0), kPi, 1e-14);
  EXPECT_EQ(set.material[1], 1);
  EXPECT_EQ(scene.groups.at(static_cast<std::size_t>(set.group[1])), "right");

  write_file("q.csv", "x,y,z,mass\n1,2,3,4\n");
  const Scene other = read_scene(write_file("scene2.json", R"({"time_step": 1, "duration": 1,
    "particles": [{"layout": "file", "file": "q.csv", "radius": 0.5, "velocity": [0, 0, 1]}]})"));
  const BodyDescription body = particle_body(other.particles.at(0), 0);
  EXPECT_EQ(body.shape.radius, 0.5);
  EXPECT_EQ(body.velocity, Vec3d(0, 0, 1));
  EXPECT_NEAR(body.mass, 4, 1e-14);
  EXPECT_NEAR(body.inertia.x, 0.4, 1e-14);
}

TEST(SceneReader, OverridesSetAddAndNameElements) {
  const std::string text = with_sphere(R"("solver": {"max_iterations": 3} // a comment
  /* another */)");
  const Scene scene =
      parsed(text, {"solver.max_iterations=50", "name=plain words", "seed=3",
                    "stepping.max_recovery_speed=0.2", "bodies.0.radius=0.3", "bodies[0].group=g"});
  EXPECT_EQ(scene.solver.max_iterations, 50);
  EXPECT_EQ(scene.name, "plain words");
  EXPECT_EQ(scene.seed, 3u);
  EXPECT_EQ(scene.stepping.max_recovery_speed, 0.2);
  EXPECT_EQ(scene.bodies[0].shape.radius, 0.3);
  EXPECT_EQ(scene.groups.at(static_cast<std::size_t>(scene.bodies[0].group)), "g");
}

TEST(SceneReader, TextOfASceneHasOverridesAndNoComments) {
  const auto file = write_file("scene.json", with_sphere("\"seed\": 1 /* why */"));
  const std::string text = scene_text(file, {"seed=9"});
  EXPECT_THAT(text, HasSubstr("\"seed\": 9"));
  EXPECT_THAT(text, testing::Not(HasSubstr("why")));
  EXPECT_EQ(parsed(text).seed, 9u);
}

TEST(SceneReader, RandomLayoutsFollowTheSeed) {
  const std::string text = with_particles(
      R"({"layout": "random", "count": 20, "radius": 0.05, "density": 1000,
          "region": {"min": [0, 0, 0], "max": [1, 1, 1]}})");
  const Scene a = parsed(text);
  const Scene b = parsed(text);
  const Scene c = parsed(text, {"seed=2"});
  EXPECT_EQ(a.particles.at(0).position, b.particles.at(0).position);
  EXPECT_FALSE(a.particles.at(0).position[0] == c.particles.at(0).position[0]);
}

// --- refusals: file, key path, value and expectation, word by word -----------------------------

struct Refusal {
  const char* what;  // name of the case
  std::string text;
  std::string message;  // start of the message after "x.json: "
};
class SceneRefusal : public testing::TestWithParam<Refusal> {};

TEST_P(SceneRefusal, NamesPathValueAndExpectation) {
  EXPECT_THAT(refused(GetParam().text), StartsWith("x.json: " + GetParam().message));
}

const std::string kLattice = R"("layout": "lattice", "density": 1000, "radius": 0.1, )";
const std::string kUnitBox = R"("region": {"min": [0, 0, 0], "max": [1, 1, 1]})";

INSTANTIATE_TEST_SUITE_P(
    Json, SceneRefusal,
    testing::Values(
        Refusal{"Comma", "{\"time_step\": 1,\n \"duration\": 1,, }",
                "line 2, column 16: syntax error"},
        Refusal{"Empty", "", "line 1, column 1: syntax error"},
        Refusal{"Truncated", "{\"time_step\": 1", "line 1, column 15: syntax error"},
        Refusal{"Overflow", "{\"time_step\": 1,\n\"bodies\": [{}, {\"radius\": 1e999}]}",
                "bodies[1].radius: 1e999 is not allowed: must be a finite number (line 2)"},
        Refusal{"Twice", R"({"bodies": [{"mass": 1, "mass": 2}]})",
                "bodies[0].mass: this key is given twice"},
        Refusal{"NotAnObject", "[1]", "document: [1] is not allowed: must be an object {...}"},
        Refusal{"Deep", std::string(1000, '['), "more than 100 lists"}),
    [](const auto& one) { return std::string(one.param.what); });

INSTANTIATE_TEST_SUITE_P(
    Document, SceneRefusal,
    testing::Values(
        Refusal{"UnknownKey", with_sphere(R"("gravty": [0, 0, 0])"),
                "gravty: unknown key; did you mean \"gravity\"? Known keys: $schema, name, "
                "gravity, seed"},
        Refusal{"UnknownNestedKey", with_sphere(R"("solver": {"max_iteration": 3})"),
                "solver.max_iteration: unknown key; did you mean \"max_iterations\"? Known keys: "
                "name, stop"},
        Refusal{"MissingTimeStep", R"({"duration": 1})",
                "time_step: missing: must be positive [s]"},
        Refusal{"MissingDuration", R"({"time_step": 1})",
                "duration: missing: must be zero or positive [s]"},
        Refusal{"ZeroTimeStep", R"({"time_step": 0, "duration": 1})",
                "time_step: 0 is not allowed: must be positive [s]"},
        Refusal{"TextForNumber", R"({"time_step": "1", "duration": 1})",
                "time_step: \"1\" is not allowed: must be positive [s]"},
        Refusal{"NumberForText", with_sphere(R"("name": 3)"),
                "name: 3 is not allowed: must be a text in quotes"},
        Refusal{"NumberForBoolean", with_sphere(R"("solver": {"warm_start": 1})"),
                "solver.warm_start: 1 is not allowed: must be true or false"},
        Refusal{"NumberForList", R"({"time_step": 1, "duration": 1, "bodies": 3})",
                "bodies: 3 is not allowed: must be a list [...]"},
        Refusal{"ShortVector", with_sphere(R"("gravity": [1, 2])"),
                "gravity: [1,2] is not allowed: must be three numbers [x, y, z] [m/s^2]"},
        Refusal{"TextInVector", with_sphere(R"("gravity": [1, 2, "3"])"),
                "gravity[2]: \"3\" is not allowed: must be a finite number [m/s^2]"},
        Refusal{"FractionForInteger", with_sphere(R"("solver": {"max_iterations": 1.5})"),
                "solver.max_iterations: 1.5 is not allowed: must be a whole number, 1 or more"},
        Refusal{"NegativeSeed", with_sphere(R"("seed": -1)"),
                "seed: -1 is not allowed: must be a whole number, 0 or more"},
        Refusal{
            "UnknownSolver", with_sphere(R"("solver": {"name": "jacoby"})"),
            "solver.name: \"jacoby\" is not allowed: must be one of \"apgd\", \"jacobi\", "
            "\"gauss_seidel\", \"gauss_seidel_colored\", \"schwarz\"; did you mean \"jacobi\"?"},
        Refusal{"UnknownStop", with_sphere(R"("solver": {"stop": "fast"})"),
                "solver.stop: \"fast\" is not allowed: must be one of \"quality\""},
        Refusal{"NegativeStop", with_sphere(R"("solver": {"stop": -1})"),
                "solver.stop: -1 is not allowed: must be positive [m/s]"},
        Refusal{"Relaxation", with_sphere(R"("solver": {"relaxation": 2})"),
                "solver.relaxation: 2 is not allowed: must be between 0 and 2, both excluded"},
        Refusal{"Backend", with_sphere(R"("backend": "gpu")"),
                "backend: \"gpu\" is not allowed: must be one of \"auto\", \"cpu\", \"cuda\""},
        Refusal{"Precision", with_sphere(R"("precision": "half")"),
                "precision: \"half\" is not allowed: must be one of \"float\", \"double\""},
        Refusal{"Envelope", with_sphere(R"("collision": {"envelope": -1})"),
                "collision.envelope: -1 is not allowed: must be zero or positive [m]"},
        Refusal{"Skin", with_sphere(R"("collision": {"skin": -1})"),
                "collision.skin: -1 is not allowed: must be zero or positive [m]"},
        Refusal{"PictureWidth", with_sphere(R"("output": {"picture": {"width": 8}})"),
                "output.picture.width: 8 is not allowed: must be a whole number from 16 to 16384"},
        Refusal{
            "ColorRange", with_sphere(R"("output": {"picture": {"color_range": [2, 1]}})"),
            "output.picture.color_range: [2,1] is not allowed: must be two numbers [low, high]"},
        Refusal{"CameraAngle",
                with_sphere(R"("output": {"picture": {"camera": {"position": [1, 0, 0],
                  "target": [0, 0, 0], "vertical_angle_deg": 170}}})"),
                "output.picture.camera.vertical_angle_deg: 170 is not allowed: must be between 0 "
                "and 170"},
        Refusal{"CameraUp", with_sphere(R"("output": {"picture": {"camera": {"position": [0, 0, 1],
                  "target": [0, 0, 0]}}})"),
                "output.picture.camera.up: [0, 0, 1] is not allowed: must not be zero or parallel"},
        Refusal{"Friction", with_sphere(R"("materials": {"a": {"friction": -0.1}})"),
                "materials.a.friction: -0.1 is not allowed: must be zero or positive [-]"},
        Refusal{"Restitution", with_sphere(R"("materials": {"a": {"restitution": 1.1}})"),
                "materials.a.restitution: 1.1 is not allowed: must be from 0 to 1 [-]"},
        Refusal{"NoMaterial", with_sphere(R"("materials": {})"),
                "materials: {} is not allowed: must hold one material or more"},
        Refusal{
            "PairName",
            with_sphere(
                R"("materials": {"steel": {}}, "material_pairs": [{"between": ["steel", "stel"]}])"),
            "material_pairs[0].between[1]: \"stel\" is not allowed: must be a name of materials: "
            "steel; did you mean \"steel\"?"},
        Refusal{"PairTwice", with_sphere(R"("materials": {"a": {}, "b": {}}, "material_pairs":
                  [{"between": ["a", "b"]}, {"between": ["b", "a"]}])"),
                "material_pairs[1].between: [\"b\", \"a\"] is not allowed: material_pairs[0] is "
                "the same"},
        Refusal{"PeriodTooShort", with_sphere(R"("periodic": {"x": [0, 0.4]})"),
                "periodic.x: [0, 0.4] is not allowed: must span at least 0.404 m"},
        Refusal{"PeriodReversed", with_sphere(R"("periodic": {"x": [1, 0]})"),
                "periodic.x: [1,0] is not allowed: must be two numbers [low, high], low below high "
                "[m]"},
        Refusal{"NothingFree",
                R"({"time_step": 1, "duration": 1, "bodies": [{"shape": "half_space"}]})",
                "bodies: a scene of 1 bodies, none free is not allowed: must hold one free body"}),
    [](const auto& one) { return std::string(one.param.what); });

INSTANTIATE_TEST_SUITE_P(
    Body, SceneRefusal,
    testing::Values(
        Refusal{"NegativeRadius", with_body(R"({"shape": "sphere", "radius": -0.1, "mass": 1})"),
                "bodies[1].radius: -0.1 is not allowed: must be positive [m]"},
        Refusal{"MissingShape", with_body(R"({"radius": 1})"),
                "bodies[1].shape: missing: must be one of"},
        Refusal{"UnknownShape", with_body(R"({"shape": "spere"})"),
                "bodies[1].shape: \"spere\" is not allowed: must be one of \"sphere\", \"box\", "
                "\"half_space\", \"container\", \"mesh\"; did you mean \"sphere\"?"},
        Refusal{"KeyOfOtherShape", with_body(R"({"shape": "box", "radius": 1})"),
                "bodies[1].radius: a box has no such key"},
        Refusal{"MissingMass", with_body(R"({"shape": "sphere", "radius": 1})"),
                "bodies[1].density: missing: a free body needs a density [kg/m^3] or a mass [kg]"},
        Refusal{"MassAndDensity",
                with_body(R"({"shape": "sphere", "radius": 1, "mass": 1, "density": 1})"),
                "bodies[1].density: give either mass or density"},
        Refusal{
            "Inertia",
            with_body(R"({"shape": "sphere", "radius": 1, "mass": 1, "inertia": [1, 0, 1]})"),
            "bodies[1].inertia: [1,0,1] is not allowed: must be three positive principal moments"},
        Refusal{"FreeHalfSpace", with_body(R"({"shape": "half_space", "kind": "free"})"),
                "bodies[1].kind: \"free\" is not allowed: only spheres and boxes can be free"},
        Refusal{"VelocityOfAWall", with_body(R"({"shape": "half_space", "velocity": [1, 0, 0]})"),
                "bodies[1].velocity: only free bodies have this key"},
        Refusal{"ZeroNormal", with_body(R"({"shape": "half_space", "normal": [0, 0, 0]})"),
                "bodies[1].normal: [0,0,0] is not allowed: must be a direction"},
        Refusal{"Quaternion", with_body(R"({"shape": "half_space", "orientation": [1, 1, 0, 0]})"),
                "bodies[1].orientation: [1,1,0,0] is not allowed: must be a unit quaternion [w, x, "
                "y, z]"},
        Refusal{"TwoRotations", with_body(R"({"shape": "half_space", "orientation": [1, 0, 0, 0],
                  "rotation_deg": {"axis": [1, 0, 0], "angle": 1}})"),
                "bodies[1].rotation_deg: give either orientation or rotation_deg"},
        Refusal{"BoxSize", with_body(R"({"shape": "box", "kind": "fixed", "size": [1, 0, 1]})"),
                "bodies[1].size: [1,0,1] is not allowed: must be positive [m]"},
        Refusal{"Corners",
                with_body(R"({"shape": "container", "min": [0, 0, 0], "max": [1, 0, 1]})"),
                "bodies[1].max: [1,0,1] is not allowed: must be above min on every axis [m]"},
        Refusal{
            "CornersAndSize",
            with_body(
                R"({"shape": "container", "min": [0, 0, 0], "max": [1, 1, 1], "size": [1, 1, 1]})"),
            "bodies[1].size: give either min and max, or size and position"},
        Refusal{"OpenFace",
                with_body(R"({"shape": "container", "size": [1, 1, 1], "open": ["top"]})"),
                "bodies[1].open[0]: \"top\" is not allowed: must be one of \"-x\", \"+x\""},
        Refusal{"Lock", with_body(R"({"shape": "sphere", "radius": 1, "mass": 1, "lock": ["w"]})"),
                "bodies[1].lock[0]: \"w\" is not allowed: must be one of \"x\", \"y\""},
        Refusal{
            "Material", with_body(R"({"shape": "half_space", "material": "steel"})"),
            "bodies[1].material: \"steel\" is not allowed: must be a name of materials: default"},
        Refusal{"MissingMesh", with_body(R"({"shape": "mesh", "file": "none.stl"})"),
                "bodies[1].file: \"none.stl\" is not allowed: no such file"},
        Refusal{"InsertAt",
                with_body(R"({"shape": "sphere", "radius": 1, "mass": 1, "insert_at": -1})"),
                "bodies[1].insert_at: -1 is not allowed: must be zero or positive [s]"},
        Refusal{"MotionOfAFixedBody",
                with_body(R"({"shape": "half_space", "motion": {"type": "linear"}})"),
                "bodies[1].motion: only bodies of kind \"kinematic\" have a motion"},
        Refusal{"MissingMotion", with_body(R"({"shape": "half_space", "kind": "kinematic"})"),
                "bodies[1].motion: missing: a kinematic body needs one"},
        Refusal{"MotionType",
                with_body(
                    R"({"shape": "half_space", "kind": "kinematic", "motion": {"type": "spin"}})"),
                "bodies[1].motion.type: \"spin\" is not allowed: must be one of \"linear\""},
        Refusal{"MotionKey", with_body(R"({"shape": "half_space", "kind": "kinematic",
                  "motion": {"type": "linear", "velocity": [0, 0, 0], "rate": 1}})"),
                "bodies[1].motion.rate: a motion of type \"linear\" has no such key"},
        Refusal{"Times", with_body(R"({"shape": "half_space", "kind": "kinematic",
                  "motion": {"type": "sampled", "times": [0, 0], "positions": [[0, 0, 0], [0, 0, 0]]}})"),
                "bodies[1].motion.times[1]: 0 is not allowed: must be finite and larger"},
        Refusal{"Positions", with_body(R"({"shape": "half_space", "kind": "kinematic",
                  "motion": {"type": "sampled", "times": [0, 1], "positions": [[0, 0, 0]]}})"),
                "bodies[1].motion.positions: 1 positions is not allowed: must be one per time, 2"},
        Refusal{"StopBeforeStart", with_body(R"({"shape": "half_space", "kind": "kinematic",
                  "motion": {"type": "linear", "velocity": [1, 0, 0], "start": 2, "stop": 1}})"),
                "bodies[1].motion.stop: 1 is not allowed: must not be before start [s]"},
        Refusal{
            "TwoFreeBoxes", with_body(R"({"shape": "box", "size": [1, 1, 1], "mass": 1},
                  {"shape": "box", "size": [1, 1, 1], "mass": 1})"),
            "bodies[2]: a second free box is not allowed: bodies[1] is one already, and contact "
            "between boxes is not available yet"},
        Refusal{
            "FreeAndFixedBox", with_body(R"({"shape": "box", "size": [1, 1, 1], "mass": 1},
                  {"shape": "box", "kind": "fixed", "size": [1, 1, 1]})"),
            "bodies[1]: a free box is not allowed: it could meet bodies[2], and contact between "
            "boxes is not available yet"},
        Refusal{"OverlappingContainers", with_body(R"({"shape": "container", "size": [1, 1, 1]},
                  {"shape": "container", "size": [1, 1, 1], "position": [0.5, 0, 0]})"),
                "bodies[2]: a container is not allowed: its interior partly overlaps that of "
                "bodies[1]"}),
    [](const auto& one) { return std::string(one.param.what); });

INSTANTIATE_TEST_SUITE_P(
    Particles, SceneRefusal,
    testing::Values(
        Refusal{"Layout", with_particles(R"({"layout": "heap"})"),
                "particles[0].layout: \"heap\" is not allowed: must be one of \"lattice\""},
        Refusal{"MissingDensity", with_particles(R"({"layout": "lattice", "radius": 1})"),
                "particles[0].density: missing: must be positive [kg/m^3]"},
        Refusal{"MissingRegion", with_particles("{" + kLattice + R"("count": 1})"),
                "particles[0].region: missing: the space to fill"},
        Refusal{"ZeroCount", with_particles("{" + kLattice + kUnitBox + R"(, "count": 0})"),
                "particles[0].count: 0 is not allowed: must be a whole number, 1 or more"},
        Refusal{
            "TooMany", with_particles("{" + kLattice + kUnitBox + R"(, "count": 65})"),
            "particles[0].count: 65 is not allowed: the region holds 64 spheres at a spacing of"},
        Refusal{"Spacing", with_particles("{" + kLattice + kUnitBox + R"(, "spacing": 0.1})"),
                "particles[0].spacing: 0.1 is not allowed: must be at least the largest diameter, "
                "0.2 [m]"},
        Refusal{"Jitter", with_particles("{" + kLattice + kUnitBox + R"(, "jitter": 2})"),
                "particles[0].jitter: 2 is not allowed: must be from 0 to 1 [-]"},
        Refusal{"KeyOfOtherLayout", with_particles("{" + kLattice + kUnitBox + R"(, "layers": 2})"),
                "particles[0].layers: the layout \"lattice\" has no such key"},
        Refusal{
            "RandomTooMany",
            with_particles(R"({"layout": "random", "count": 500, "radius": 0.1, "density": 1,)" +
                           kUnitBox + "}"),
            "particles[0].count: 500 is not allowed: "},
        Refusal{"RandomTooWide",
                with_particles(R"({"layout": "random", "count": 2, "radius": 0.6, "density": 1,)" +
                               kUnitBox + "}"),
                "particles[0].count: 2 is not allowed: 0 of 2 spheres fit: the largest sphere is "
                "wider"},
        Refusal{
            "RadiusRange",
            with_particles(
                R"({"layout": "random", "count": 2, "radius": {"min": 2, "max": 1}, "density": 1,)" +
                kUnitBox + "}"),
            "particles[0].radius.max: 1 is not allowed: must not be below min [m]"},
        Refusal{
            "RadiusKinds",
            with_particles(
                R"({"layout": "random", "count": 2, "radius": {"min": 1, "values": [1]}, "density": 1,)" +
                kUnitBox + "}"),
            "particles[0].radius: {\"min\":1,\"values\":[1]} is not allowed: must have exactly one "
            "of"},
        Refusal{
            "Weights",
            with_particles(
                R"({"layout": "random", "count": 2, "radius": {"values": [1, 2], "weights": [1]}, "density": 1,)" +
                kUnitBox + "}"),
            "particles[0].radius.weights: [1] is not allowed: must be one weight per value"},
        Refusal{"Normal",
                with_particles(R"({"layout": "random", "count": 2, "radius": {"normal":
                  {"mean": 5, "deviation": 0.1, "min": 1, "max": 2}}, "density": 1,)" +
                               kUnitBox + "}"),
                "particles[0].radius.normal.mean: 5 is not allowed: must be from min to max [m]"},
        Refusal{
            "RegionReversed",
            with_particles("{" + kLattice + R"("region": {"min": [0, 0, 1], "max": [1, 1, 0]}})"),
            "particles[0].region.max: [1,1,0] is not allowed: must be above min on every axis [m]"},
        Refusal{
            "RainTooFast",
            with_particles(
                R"({"layout": "rain", "count": 20, "layers": 2, "interval": 0.01, "radius": 0.1, "density": 1,)" +
                kUnitBox + "}"),
            "particles[0].interval: 0.01 is not allowed: a batch of height"},
        Refusal{"MissingFile", with_particles(R"({"layout": "file", "file": "none.csv"})"),
                "particles[0].file: \"none.csv\" is not allowed: no such file"}),
    [](const auto& one) { return std::string(one.param.what); });

TEST(SceneReader, RefusesBadOverrides) {
  const std::string text = with_sphere("");
  EXPECT_EQ(refused(text, {"seed"}), "override \"seed\": must have the form key.path=value");
  EXPECT_EQ(
      refused(text, {"bodies.1.radius=1"}),
      "override \"bodies.1.radius=1\": bodies has 1 elements; \"1\" must be a number from 0 to 0");
  EXPECT_EQ(refused(text, {"duration.x=1"}),
            "override \"duration.x=1\": duration is the value 1, it has no key \"x\"");
  EXPECT_EQ(refused(text, {"time_step=-1"}),
            "x.json: time_step (overridden): -1 is not allowed: must be positive [s]");
  EXPECT_THAT(refused(text, {"tim_step=1"}),
              StartsWith("x.json: tim_step (overridden): unknown key"));
}

TEST(SceneReader, RefusesMissingFiles) {
  const std::string path = testing::TempDir() + "no_such_scene.json";
  EXPECT_EQ(refusal([&] { read_scene(path); }), path + ": no such file");
}

TEST(SceneReader, NamesTheFileOfABadMeshAndABadTable) {
  const auto mesh = write_file("bad.obj", "v 0 0 0\nf 1 2 3\n");
  const auto table = write_file("bad.csv", "x,y,z\n1,2,oops\n");
  const auto first = write_file("a.json", with_body(R"({"shape": "mesh", "file": "bad.obj"})"));
  const auto second = write_file(
      "b.json",
      with_particles(R"({"layout": "file", "file": "bad.csv", "radius": 1, "density": 1})"));
  EXPECT_THAT(refusal([&] { read_scene(first); }),
              StartsWith(mesh.string() + ": line 2: vertex 2"));
  EXPECT_EQ(
      refusal([&] { read_scene(second); }),
      table.string() + ": line 2, column \"z\": \"oops\" is not allowed: must be a finite number");
}

}  // namespace
}  // namespace scree
