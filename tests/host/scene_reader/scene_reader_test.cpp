#include "host/scene_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "shapes/sphere.h"
#include "tests/host/input_files.h"
#include "tests/host/scene_texts.h"

namespace scree {
namespace {

using test::parsed;
using test::with_body;
using test::with_particles;
using test::with_sphere;
using test::write_file;
using testing::HasSubstr;

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
    "stepping": {"max_recovery_speed": 0.1, "restitution_law": "newton",
                 "restitution_threshold": 0.2},
    "collision": {"envelope": 0.003, "skin": 0.02},
    "output": {"frame_interval": 0.5, "checkpoint_interval": 0.6, "picture": {
      "interval": 0.25, "width": 64, "height": 32, "color_by": "size", "color_range": [1, 2],
      "labels": false,
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
  EXPECT_EQ(scene.stepping.restitution_law, RestitutionLaw::newton);
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
  EXPECT_EQ(scene.solver.parameters,
            (std::map<std::string, double>{{"relaxation", 1.5}, {"metric", 1}}));
  EXPECT_EQ(scene.output.frame_interval, 0.5);
  EXPECT_EQ(scene.output.checkpoint_interval, 0.6);
  const PictureSettings& picture = scene.output.picture;
  EXPECT_EQ(picture.interval, 0.25);
  EXPECT_EQ(picture.width, 64);
  EXPECT_EQ(picture.height, 32);
  EXPECT_EQ(picture.color_by, ColorBy::size);
  EXPECT_EQ(picture.color_min, 1);
  EXPECT_EQ(picture.color_max, 2);
  EXPECT_FALSE(picture.labels);
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
  EXPECT_EQ(body.shape.kind, shapes::Sphere::kind);
  EXPECT_EQ(body.shape.radius, 0.5);
  EXPECT_NEAR(body.mass, std::numbers::pi, 1e-14);
  EXPECT_NEAR(body.inertia.y, 0.4 * std::numbers::pi * 0.25, 1e-14);
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
     "motion": {"type": "linear", "velocity": [1, 2, 3], "angular_velocity": [0, 4, 0],
                "start": 0.5, "stop": 2}},
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
  EXPECT_EQ(linear.angular_velocity, Vec3d(0, 4, 0));
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

/// Ids number bodies, then particles, then what is inserted in the order of its times.
TEST(SceneReader, NamesOfBodiesAreKeptWithTheirIds) {
  const Scene scene = parsed(R"({"time_step": 1, "duration": 1, "bodies": [
    {"name": "late", "shape": "sphere", "radius": 1, "mass": 1, "insert_at": 2},
    {"name": "soon", "shape": "sphere", "radius": 1, "mass": 1, "insert_at": 1},
    {"shape": "half_space"},
    {"name": "ball, red", "shape": "sphere", "radius": 1, "mass": 1},
    {"name": "last", "shape": "sphere", "radius": 1, "mass": 1, "insert_at": 2}],
    "particles": [{"layout": "lattice", "count": 5, "radius": 0.1, "density": 1, "spacing": 0.3,
                   "region": {"min": [9, 9, 9], "max": [10, 10, 10]}}]})");
  const std::map<std::string, int> expected{
      {"ball, red", 1}, {"soon", 7}, {"late", 8}, {"last", 9}};
  EXPECT_EQ(scene.body_names, expected);
  Scene wrong = scene;
  wrong.body_names["ghost"] = 10;
  EXPECT_THAT(
      test::refusal([&] { validate(wrong); }),
      HasSubstr("body_names[\"ghost\"]: 10 is not allowed: must be the id of one of 10 bodies"));
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
  EXPECT_NEAR(particle_mass(lattice, 0), 1000 * 4 / 3.0 * std::numbers::pi * 1e-3, 1e-12);
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
  EXPECT_NEAR(particle_mass(set, 0), std::numbers::pi, 1e-14);
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
  const std::string text = scree::scene_text(file, {"seed=9"});
  EXPECT_THAT(text, HasSubstr("\"seed\": 9"));
  EXPECT_THAT(text, testing::Not(HasSubstr("why")));
  EXPECT_EQ(parsed(text).seed, 9u);
}

// Layers of a rain are one entry, and those before the end come.
TEST(SceneReader, TellsWhatWouldComeAfterTheEnd) {
  std::vector<std::string> notes;
  parse_scene(R"({"time_step": 0.1, "duration": 1,
    "bodies": [{"shape": "sphere", "radius": 1, "mass": 1, "insert_at": 0.5},
               {"shape": "sphere", "radius": 1, "mass": 1, "insert_at": 2, "position": [9, 0, 0]}],
    "particles": [{"layout": "rain", "count": 60, "radius": 0.1, "density": 1, "layers": 6, "interval": 0.25,
                   "velocity": [0, 0, -4], "region": {"min": [0, 0, 5], "max": [4, 4, 5.5]}}]})",
              "scene.json", {}, {}, &notes);
  EXPECT_THAT(notes, testing::ElementsAre(
                         "1 body of bodies[1] would come after the end of the run, 1 s",
                         "10 bodies of particles[0] would come after the end of the run, 1 s"));
}

TEST(SceneReader, TellsOfParametersThatTheSolverDoesNotHave) {
  std::vector<std::string> notes;
  parse_scene(with_sphere(R"("solver": {"name": "apgd", "relaxation": 0.5})"), "x.json", {}, {},
              &notes);
  EXPECT_THAT(notes,
              testing::ElementsAre(HasSubstr(
                  "solver.relaxation has no effect: \"apgd\" has none, these have: jacobi")));
  parse_scene(with_sphere(R"("solver": {"name": "jacobi", "relaxation": 0.5})"), "x.json", {}, {},
              &notes);
  EXPECT_THAT(notes, testing::ElementsAre());
}

TEST(SceneReader, TellsOfADurationThatDoesNotEndWithAStep) {
  const auto notes_of = [](const std::string& settings) {
    std::vector<std::string> notes;
    parse_scene("{" + settings + R"(, "bodies": [{"shape": "sphere", "radius": 1, "mass": 1}]})",
                "scene.json", {}, {}, &notes);
    return notes;
  };
  EXPECT_THAT(notes_of(R"("time_step": 0.1, "duration": 0.74)"),
              testing::ElementsAre("duration: 0.74 s are 7.4 steps of 0.1 s: 7 are taken"));
  EXPECT_THAT(notes_of(R"("time_step": 0.0041667, "duration": 2)"), testing::IsEmpty());
}

TEST(SceneReader, PicturesAreAgainstGravityUp) {
  const auto up = [](const std::string& gravity) {
    return parsed(
               R"({"time_step": 1, "duration": 1, "bodies": [{"shape": "sphere", "radius": 1, "mass": 1}],
                     "gravity": )" +
               gravity + "}")
        .output.picture.camera.up;
  };
  EXPECT_EQ(up("[0, 0, -9.81]"), Vec3d(0, 0, 1));
  EXPECT_EQ(up("[0, 0, 0]"), Vec3d(0, 0, 1));
  EXPECT_EQ(up("[5, 0, -8]"), Vec3d(0, 0, 1));  // a slope
  EXPECT_EQ(up("[-9.81, 0, 0]"), Vec3d(1, 0, 0));
  EXPECT_EQ(up("[0, 9.81, 0]"), Vec3d(0, -1, 0));
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

}  // namespace
}  // namespace scree
