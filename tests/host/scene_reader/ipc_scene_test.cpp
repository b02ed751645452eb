// Each rule of the format of rigid-ipc scenes, with values worked out by hand.

#include "host/scene_reader/ipc_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "host/scene/motion.h"
#include "host/scene_reader.h"
#include "tests/host/scene_reader/ipc_support.h"

namespace scree {
namespace {

using test::folder_with_meshes;
using test::ipc_scene;
using test::ipc_text;
using test::refusal;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180;

/// The scene with one entry, read in the folder with a cube and a plane.
Scene with_entry(const std::string& entry, std::vector<std::string>* notes = nullptr) {
  return ipc_scene(ipc_text(entry), folder_with_meshes(), notes);
}

BodyDescription body_of(const std::string& entry) { return with_entry(entry).bodies.at(0); }

/// Where a point of a mesh file is, by the scene that was made of it: the corner that is nearest.
Vec3d corner_near(const Scene& scene, std::size_t body, const Vec3d& where) {
  const BodyDescription& b = scene.bodies.at(body);
  Vec3d best{1e9, 1e9, 1e9};
  for (const Vec3d& v : scene.meshes.at(static_cast<std::size_t>(b.shape.mesh)).vertices) {
    const Vec3d x = b.position + rotate(b.orientation, v);
    if (norm(x - where) < norm(best - where)) best = x;
  }
  return best;
}

double distance_to_corner(const Scene& scene, std::size_t body, const Vec3d& where) {
  return norm(corner_near(scene, body, where) - where);
}

TEST(IpcScene, DefaultsAreThoseOfTheFormat) {
  std::vector<std::string> notes;
  const Scene scene = with_entry(R"({"mesh": "cube.obj"})", &notes);
  EXPECT_EQ(scene.dynamics.type, "affine");
  EXPECT_EQ(scene.gravity, Vec3d(0, 0, 0));
  EXPECT_EQ(scene.stepping.time_step, 0.01);
  EXPECT_NEAR(scene.stepping.duration, 10, 1e-12);
  EXPECT_EQ(scene.materials.at(0).friction, 0);
  EXPECT_EQ(scene.name, "x");
  const auto& p = scene.dynamics.parameters;
  EXPECT_EQ(p.at("rule"), 0);
  EXPECT_EQ(p.at("reach"), 1e-3);
  EXPECT_EQ(p.at("slip_speed"), 1e-3);
  EXPECT_EQ(p.at("friction_solves"), 1);
  EXPECT_NEAR(p.at("tolerance"), 1e-2 * std::sqrt(3.0), 1e-12) << "of the diagonal of a unit cube";
  EXPECT_EQ(p.count("stiffness"), 0u);
  EXPECT_EQ(p.count("separation"), 0u);
  const BodyDescription& body = scene.bodies.at(0);
  EXPECT_EQ(body.kind, BodyKind::free);
  EXPECT_NEAR(body.mass, 1000, 1e-9);
  EXPECT_NEAR(body.inertia.x, 1000. / 6, 1e-9);
  EXPECT_EQ(body.collision_group, kNoCollisionGroup);
  EXPECT_THAT(notes, ElementsAre(AllOf(HasSubstr("rigid-ipc"), HasSubstr("1 free, 0 fixed"))));
}

TEST(IpcScene, SettingsBecomeThoseOfTheModel) {
  const Scene scene = ipc_scene(ipc_text(R"({"mesh": "cube.obj"})",
                                         R"("gravity": [0, -9.8, 0], "coefficient_friction": 0.3,
                  "coefficient_restitution": -1, "orthogonality_stiffness": 2e8)",
                                         R"("timestep": 0.1, "max_time": 0.3,
                  "distance_barrier_constraint": {"initial_barrier_activation_distance": 5e-4,
                                                  "minimum_separation_distance": 1e-6},
                  "ipc_solver": {"velocity_conv_tol": 1e-4, "is_velocity_conv_tol_abs": true,
                                 "max_iterations": 77},
                  "friction_constraints": {"static_friction_speed_bound": 1e-5, "iterations": -1})"),
                                folder_with_meshes());
  EXPECT_EQ(scene.gravity, Vec3d(0, -9.8, 0));
  EXPECT_EQ(scene.materials.at(0).friction, 0.3);
  EXPECT_EQ(scene.stepping.time_step, 0.1);
  EXPECT_NEAR(scene.stepping.duration, 0.3, 1e-12) << "three steps, not four";
  const auto& p = scene.dynamics.parameters;
  EXPECT_EQ(p.at("stiffness"), 2e8);
  EXPECT_EQ(p.at("reach"), 5e-4);
  EXPECT_EQ(p.at("separation"), 1e-6);
  EXPECT_EQ(p.at("tolerance"), 1e-4);
  EXPECT_EQ(p.at("max_iterations"), 77);
  EXPECT_EQ(p.at("slip_speed"), 1e-5);
  EXPECT_EQ(p.at("friction_solves"), 0) << "until converged";
}

TEST(IpcScene, NoFrictionSolvesAreNoFriction) {
  const Scene scene =
      ipc_scene(ipc_text(R"({"mesh": "cube.obj"})", R"("coefficient_friction": 0.3)",
                         R"("friction_constraints": {"iterations": 0})"),
                folder_with_meshes());
  EXPECT_EQ(scene.materials.at(0).friction, 0);
  EXPECT_EQ(scene.dynamics.parameters.at("friction_solves"), 1);
}

TEST(IpcScene, StepsAreCountedOrTimed) {
  const auto steps = [](const std::string& keys) {
    const Scene scene =
        ipc_scene(ipc_text(R"({"mesh": "cube.obj"})", "", keys), folder_with_meshes());
    return std::llround(scene.stepping.duration / scene.stepping.time_step);
  };
  EXPECT_EQ(steps(R"("timestep": 0.02, "max_iterations": 7)"), 7);
  EXPECT_EQ(steps(R"("timestep": 0.02, "max_iterations": -1)"), 1000);
  EXPECT_EQ(steps(R"("timestep": 0.02, "max_time": 0.05)"), 3) << "the end is passed";
  EXPECT_EQ(steps(R"("timestep": 0.001, "max_time": 10)"), 10000);
  EXPECT_EQ(steps(R"("timestep": 0.01, "max_iterations": 7, "max_time": 0.2)"), 20);
}

TEST(IpcScene, MeshesAreScaledThenTurnedThenMoved) {
  // The corner (0.5, 0.5, 0.5): scaled to (1, 1.5, 2); turned about x by 90 deg to (1, -2, 1.5), then
  // about z by 90 deg to (2, 1, 1.5); moved.
  const Scene scene = with_entry(
      R"({"mesh": "cube.obj", "scale": [2, 3, 4], "rotation": [90, 0, 90], "position": [10, 20, 30]})");
  EXPECT_LT(distance_to_corner(scene, 0, {12, 21, 31.5}), 1e-12);
  const BodyDescription& body = scene.bodies.at(0);
  EXPECT_NEAR(body.mass, 24000, 1e-8);
  EXPECT_LT(norm(body.position - Vec3d{10, 20, 30}), 1e-12);
  // Moments about world axes: along y of the mesh, edge 3, is world z; x, edge 2, is world y.
  const Vec3d spin = rotate_back(body.orientation, Vec3d{0, 0, 1});
  EXPECT_NEAR(
      dot(spin, Vec3d{spin.x * body.inertia.x, spin.y * body.inertia.y, spin.z * body.inertia.z}),
      24000. / 12 * (2 * 2 + 4 * 4), 1e-7);
}

TEST(IpcScene, RotationsAreAboutTheOriginOfTheMesh) {
  const auto folder = folder_with_meshes();
  std::ofstream(folder / "meshes" / "off.obj") << [] {
    std::string text = test::kCubeObj;  // a cube whose center is at x = 5
    for (std::size_t at = 0; (at = text.find("v ", at)) != std::string::npos; at += 2) {
      const std::size_t end = text.find(' ', at + 2);
      const double x = std::stod(text.substr(at + 2, end - at - 2)) + 5;
      text.replace(at + 2, end - at - 2, std::to_string(x));
    }
    return text;
  }();
  const Scene scene = ipc_scene(ipc_text(R"({"mesh": "off.obj", "rotation": [0, 0, 90]})"), folder);
  EXPECT_LT(norm(scene.bodies.at(0).position - Vec3d{0, 5, 0}), 1e-5);
}

TEST(IpcScene, DimensionsAreThoseOfTheBoxAboutTheMesh) {
  const Scene cube =
      with_entry(R"({"mesh": "cube.obj", "scale": 100, "dimensions": [1, 2, 3], "density": 2})");
  EXPECT_NEAR(cube.bodies.at(0).mass, 12, 1e-11);
  const Scene plane =
      with_entry(R"({"mesh": "plane.obj", "type": "static", "dimensions": [4, 0, 6]})");
  EXPECT_LT(distance_to_corner(plane, 0, {2, 0, 3}), 1e-12);
}

TEST(IpcScene, VelocitiesAreInDegreesAndTorquesToo) {
  const BodyDescription body = body_of(
      R"({"mesh": "cube.obj", "linear_velocity": [1, 2, 3], "angular_velocity": [90, 0, 180],
          "force": [4, 5, 6], "torque": [0, 180, 0]})");
  EXPECT_EQ(body.velocity, Vec3d(1, 2, 3));
  EXPECT_LT(norm(body.angular_velocity - kDegree * Vec3d{90, 0, 180}), 1e-12);
  EXPECT_EQ(body.load->force, Vec3d(4, 5, 6));
  EXPECT_LT(norm(body.load->torque - Vec3d{0, std::numbers::pi, 0}), 1e-12);
}

TEST(IpcScene, FixedDirectionsAreLocksOfWorldAxes) {
  const BodyDescription axle = body_of(
      R"({"mesh": "cube.obj", "is_dof_fixed": [true, true, true, true, true, false],
          "linear_velocity": [1, 0, 0], "angular_velocity": [90, 0, 90]})");
  EXPECT_EQ(axle.kind, BodyKind::free);
  EXPECT_EQ(axle.locks, lock_x | lock_y | lock_z | lock_rx | lock_ry);
  EXPECT_EQ(norm(axle.velocity), 0);
  EXPECT_LT(norm(axle.angular_velocity - Vec3d{0, 0, 90 * kDegree}), 1e-12);
  const BodyDescription slide =
      body_of(R"({"mesh": "cube.obj", "is_dof_fixed": [false, true, true, true, true, true]})");
  EXPECT_EQ(slide.locks, lock_all & ~lock_x);
  EXPECT_EQ(body_of(R"({"mesh": "cube.obj", "is_dof_fixed": true})").kind, BodyKind::fixed);
  EXPECT_EQ(body_of(R"({"mesh": "cube.obj", "is_dof_fixed": false})").locks, 0);
}

TEST(IpcScene, OneFixedRotationIsRefused) {
  EXPECT_THAT(refusal([] {
                body_of(R"({"mesh": "cube.obj",
                            "is_dof_fixed": [false, false, false, true, false, false]})");
              }),
              AllOf(HasSubstr("x.json: rigid_body_problem.rigid_bodies[0].is_dof_fixed"),
                    HasSubstr("none, two or three")));
}

TEST(IpcScene, BodiesHaveTheirGroups) {
  const Scene scene = with_entry(R"(
      {"mesh": "plane.obj", "type": "static"}, {"mesh": "cube.obj", "type": "kinematic"},
      {"mesh": "cube.obj", "group_id": 3}, {"mesh": "cube.obj", "group_id": 3},
      {"mesh": "cube.obj"}, {"mesh": "plane.obj", "type": "static", "group_id": 3})");
  const auto group = [&](std::size_t k) { return scene.bodies.at(k).collision_group; };
  EXPECT_EQ(group(0), kNoCollisionGroup);  // that of all resting ones, in the model
  EXPECT_EQ(group(1), kNoCollisionGroup);
  EXPECT_EQ(group(2), 3);
  EXPECT_EQ(group(3), 3);
  EXPECT_EQ(group(4), kNoCollisionGroup);
  EXPECT_EQ(group(5), 3);
}

TEST(IpcScene, KinematicBodiesMoveWithTheirVelocities) {
  const Scene scene = with_entry(
      R"({"mesh": "plane.obj", "type": "kinematic", "position": [1, 0, 0],
          "linear_velocity": [2, 0, 0], "angular_velocity": [0, 90, 0], "kinematic_max_time": 0.5,
          "is_dof_fixed": [false, true, true, true, false, true]})");
  const BodyDescription& body = scene.bodies.at(0);
  EXPECT_EQ(body.kind, BodyKind::kinematic);
  EXPECT_LT(norm(pose_at(body, 0).position - Vec3d{1, 0, 0}), 1e-12);
  EXPECT_LT(norm(pose_at(body, 0.25).position - Vec3d{1.5, 0, 0}), 1e-12);
  const Pose end = pose_at(body, 9);  // it stopped at half a second
  EXPECT_LT(norm(end.position - Vec3d{2, 0, 0}), 1e-12);
  EXPECT_LT(
      norm(rotate(end.orientation, Vec3d{1, 0, 0}) - Vec3d{std::sqrt(0.5), 0, -std::sqrt(0.5)}),
      1e-12);
}

TEST(IpcScene, KinematicBodiesTurnAboutTheirCenterOfMass) {
  const auto folder = folder_with_meshes();
  // A right triangle with legs of 3 m: its area nearest to each corner is half at the right angle
  // and a quarter at the others, so the center is at 3/4, 3/4.
  std::ofstream(folder / "meshes" / "corner.obj") << "v 0 0 0\nv 3 0 0\nv 0 3 0\nf 1 2 3\n";
  const Scene scene = ipc_scene(
      ipc_text(R"({"mesh": "corner.obj", "type": "kinematic", "angular_velocity": [0, 0, 90]})"),
      folder);
  EXPECT_LT(norm(scene.bodies.at(0).position - Vec3d{0.75, 0.75, 0}), 1e-12);
}

TEST(IpcScene, KinematicPosesAreOneAStep) {
  const Scene scene =
      ipc_scene(ipc_text(R"({"mesh": "cube.obj", "type": "kinematic", "position": [0, 5, 0],
                   "rotation": [0, 0, 90], "angular_velocity": [360, 0, 0],
                   "kinematic_poses": [{"position": [0, 1, 0]},
                                       {"position": [0, 2, 0], "rotation": [0, 0, 0.3]}]})",
                         "", R"("timestep": 0.1, "max_time": 2)"),
                folder_with_meshes());
  const BodyDescription& body = scene.bodies.at(0);
  EXPECT_LT(norm(pose_at(body, 0).position - Vec3d{0, 5, 0}), 1e-12);
  EXPECT_LT(norm(pose_at(body, 0.1).position - Vec3d{0, 1, 0}), 1e-12);
  const Vec3d x{1, 0, 0};
  EXPECT_LT(norm(rotate(pose_at(body, 0.1).orientation, x) - Vec3d{0, 1, 0}), 1e-12)
      << "a pose without rotation keeps it";
  EXPECT_LT(
      norm(rotate(pose_at(body, 0.2).orientation, x) - Vec3d{std::cos(0.3), std::sin(0.3), 0}),
      1e-12)
      << "a vector in radians, not added to the rotation at the start";
  // Then it goes on with its velocity: three quarters of a turn later about x.
  const Quatd turn = exp_map(Vec3d{1.5 * std::numbers::pi, 0, 0}) * exp_map(Vec3d{0, 0, 0.3});
  EXPECT_LT(norm(rotate(pose_at(body, 0.95).orientation, x) - rotate(turn, x)), 1e-9);
  EXPECT_LT(norm(pose_at(body, 0.95).position - Vec3d{0, 2, 0}), 1e-12);
}

TEST(IpcScene, BodiesThatAreNotEnabledAreLeftOut) {
  std::vector<std::string> notes;
  const Scene scene = with_entry(
      R"({"mesh": "nowhere.obj", "enabled": false}, {"mesh": "cube.obj", "enabled": true})",
      &notes);
  EXPECT_EQ(scene.bodies.size(), 1u);
  EXPECT_EQ(scene.bodies.at(0).entry, 1);
  EXPECT_THAT(notes.at(0), HasSubstr("1 left out"));
}

TEST(IpcScene, ComponentsBecomeBodies) {
  const auto folder = folder_with_meshes();
  std::string two = test::kCubeObj;
  for (std::string line, all = test::kCubeObj; !all.empty();) {
    line = all.substr(0, all.find('\n'));
    all.erase(0, line.size() + 1);
    double x = 0, y = 0, z = 0;
    if (std::sscanf(line.c_str(), "v %lf %lf %lf", &x, &y, &z) == 3)
      two +=
          "v " + std::to_string(x + 5) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
  }
  two += "f 9 12 11 10\nf 13 14 15 16\nf 9 10 14 13\nf 10 11 15 14\nf 11 12 16 15\nf 12 9 13 16\n";
  std::ofstream(folder / "meshes" / "two.obj") << two;
  const Scene whole = ipc_scene(ipc_text(R"({"mesh": "two.obj"})"), folder);
  EXPECT_EQ(whole.bodies.size(), 1u);
  EXPECT_NEAR(whole.bodies.at(0).mass, 2000, 1e-9);
  const Scene split = ipc_scene(
      ipc_text(R"({"mesh": "two.obj", "split_components": true, "position": [0, 1, 0]})"), folder);
  ASSERT_EQ(split.bodies.size(), 2u);
  EXPECT_LT(norm(split.bodies.at(0).position - Vec3d{0, 1, 0}), 1e-9);
  EXPECT_LT(norm(split.bodies.at(1).position - Vec3d{5, 1, 0}), 1e-9);
  EXPECT_NEAR(split.bodies.at(1).mass, 1000, 1e-6);
  EXPECT_EQ(split.body_names.at("two.2"), 1);
}

TEST(IpcScene, SurfacesMayStandInTheScene) {
  const BodyDescription body = body_of(
      R"({"vertices": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]],
          "faces": [[0,2,1],[0,1,3],[0,3,2],[1,2,3]], "scale": 2, "density": 3})");
  EXPECT_NEAR(body.mass, 3 * 8. / 6, 1e-12);
  EXPECT_LT(norm(body.position - Vec3d{0.5, 0.5, 0.5}), 1e-12);
}

TEST(IpcScene, SurfacesThatAreInsideOutAreTurnedOver) {
  std::vector<std::string> notes;
  const Scene scene = with_entry(R"({"mesh": "cube.obj", "scale": [-1, 1, 1]})", &notes);
  EXPECT_NEAR(scene.bodies.at(0).mass, 1000, 1e-9);
  EXPECT_THAT(notes, Contains(HasSubstr("inside out")));
}

TEST(IpcScene, BodiesOfOneMeshShareIt) {
  const Scene scene =
      with_entry(R"({"mesh": "cube.obj"}, {"mesh": "cube.obj", "position": [3, 0, 0]},
      {"mesh": "cube.obj", "scale": 2}, {"mesh": "cube.obj", "type": "static"})");
  EXPECT_EQ(scene.bodies.at(0).shape.mesh, scene.bodies.at(1).shape.mesh);
  EXPECT_EQ(scene.meshes.size(), 3u);
}

TEST(IpcScene, MeshesAreFoundInFoldersAround) {
  const auto folder = folder_with_meshes();
  const auto deep = folder / "fixtures" / "3D" / "chain";
  std::filesystem::create_directories(deep);
  EXPECT_EQ(ipc_scene(ipc_text(R"({"mesh": "cube.obj"})"), deep).bodies.size(), 1u);
  EXPECT_THAT(refusal([&] { ipc_scene(ipc_text(R"({"mesh": "ball.obj"})"), deep); }),
              AllOf(HasSubstr("rigid_bodies[0].mesh: \"ball.obj\" is not allowed"),
                    HasSubstr("no such file")));
}

TEST(IpcScene, OffFilesHaveTheirCountsInEitherLine) {
  const auto folder = folder_with_meshes();
  const std::string rest =
      "0 0 0 255 0 0\n1 0 0\n\n# a comment\n0 1 0\n0 0 1\n"
      "3 0 2 1\n3 0 1 3 1 1 1\n3 0 3 2\n3 1 2 3\n";
  std::ofstream(folder / "a.off") << "OFF\n4 4 0\n" << rest;
  std::ofstream(folder / "b.off") << "OFF 4 4 0\n" << rest;
  std::ofstream(folder / "c.off") << "OFF 4 5 0\n" << rest;
  std::ofstream(folder / "d.off") << "OFF 4 1 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 4\n";
  for (const char* name : {"a.off", "b.off"}) {
    const Scene scene = ipc_scene(ipc_text(R"({"mesh": ")" + std::string(name) + "\"}"), folder);
    EXPECT_NEAR(scene.bodies.at(0).mass, 1000. / 6, 1e-9) << name;
  }
  EXPECT_THAT(refusal([&] { ipc_scene(ipc_text(R"({"mesh": "c.off"})"), folder); }),
              AllOf(HasSubstr("c.off"), HasSubstr("a face expected")));
  EXPECT_THAT(refusal([&] { ipc_scene(ipc_text(R"({"mesh": "d.off"})"), folder); }),
              AllOf(HasSubstr("d.off: line 6"), HasSubstr("vertex 4 is out of range")));
}

TEST(IpcScene, FlatFreeBodiesAreRefusedByName) {
  EXPECT_THAT(refusal([] { body_of(R"({"mesh": "plane.obj"})"); }),
              AllOf(HasSubstr("rigid_bodies[0].mesh: \"plane.obj\" is not allowed"),
                    HasSubstr("enclose a volume"), HasSubstr("2 triangles")));
  for (const char* key : {"dimensions", "scale"})
    EXPECT_THAT(refusal([&] {
                  body_of(std::string(R"({"mesh": "cube.obj", ")") + key + R"(": [1, 0, 1]})");
                }),
                AllOf(HasSubstr(std::string("rigid_bodies[0].") + key + ": [1,0,1] is not allowed"),
                      HasSubstr("enclose a volume")));
}

TEST(IpcScene, BodiesWithoutTrianglesAreRefusedByName) {
  EXPECT_THAT(
      refusal([] { body_of(R"({"vertices": [[0,0,0],[1,0,0],[0,0,1]], "type": "static"})"); }),
      AllOf(HasSubstr("rigid_bodies[0]"), HasSubstr("edges or points alone")));
}

TEST(IpcScene, UnknownKeysAreToldAndCommentsAreNot) {
  std::vector<std::string> notes;
  ipc_scene(ipc_text(R"({"mesh": "cube.obj", "colour": 1, "#type": "static"},
                         {"mesh": "cube.obj", "colour": 2, "#type": 1, "#type": 2})",
                     R"("coefficient_restitution": 0.5, "#gravity": [1, 2, 3])",
                     R"("distance_barrier_constraints": {}, "viewport_bbox": {})"),
            folder_with_meshes(), &notes);
  EXPECT_THAT(notes, Contains(AllOf(HasSubstr("distance_barrier_constraints"),
                                    HasSubstr("rigid_bodies[].colour (2 times)"))));
  EXPECT_THAT(notes, Contains(HasSubstr("coefficient_restitution 0.5 is not used")));
  for (const std::string& note : notes) {
    EXPECT_THAT(note, testing::Not(HasSubstr("#")));
    EXPECT_THAT(note, testing::Not(HasSubstr("viewport_bbox")));
  }
}

TEST(IpcScene, WrongValuesAreNamed) {
  const auto refused = [](const std::string& body, const std::string& problem = "",
                          const std::string& root = "") {
    return refusal([&] { ipc_scene(ipc_text(body, problem, root), folder_with_meshes()); });
  };
  EXPECT_THAT(refused(R"({"mesh": "cube.obj", "density": 0})"),
              HasSubstr("x.json: rigid_body_problem.rigid_bodies[0].density: 0 is not allowed"));
  EXPECT_THAT(refused(R"({"mesh": "cube.obj", "type": "fixed"})"),
              AllOf(HasSubstr("type"), HasSubstr("\"static\", \"kinematic\", \"dynamic\"")));
  EXPECT_THAT(refused(R"({"mesh": "cube.obj", "is_dof_fixed": [true, false, true]})"),
              AllOf(HasSubstr("is_dof_fixed"), HasSubstr("six")));
  EXPECT_THAT(refused(R"({"mesh": "cube.obj", "position": [1, 2]})"), HasSubstr("position"));
  EXPECT_THAT(refused(R"({"position": [1, 2, 3]})"), HasSubstr("vertices: missing"));
  EXPECT_THAT(refused(R"({"mesh": "cube.obj"})", R"("coefficient_friction": -1)"),
              HasSubstr("rigid_body_problem.coefficient_friction: -1 is not allowed"));
  EXPECT_THAT(refused(R"({"mesh": "cube.obj"})", "", R"("timestep": 0)"),
              HasSubstr("timestep: 0 is not allowed"));
  EXPECT_THAT(refused(R"({"mesh": "cube.obj", "enabled": false})"), HasSubstr("one body or more"));
}

TEST(IpcScene, OwnKeysHaveTheLastWord) {
  const Scene scene =
      ipc_scene(ipc_text(R"({"mesh": "cube.obj"})", "",
                         R"("name": "mine", "backend": "cpu", "output": {"frame_interval": 0.5})"),
                folder_with_meshes());
  EXPECT_EQ(scene.name, "mine");
  EXPECT_EQ(scene.backend, "cpu");
  EXPECT_EQ(scene.output.frame_interval, 0.5);
}

TEST(AutodeskScene, AnglesAreRadiansAndTorquesAreTorques) {
  std::vector<std::string> notes;
  const Scene scene = ipc_scene(
      ipc_text(R"({"mesh": "parts\\cube.obj", "rotation": [0, 0, 1.5707963267948966],
                   "angular_velocity": [0, 2, 0], "torque": [0, 0, 7], "scale": [2, 4, 6]})"),
      [] {
        const auto folder = folder_with_meshes();
        std::filesystem::create_directories(folder / "meshes" / "parts");
        std::filesystem::copy_file(folder / "meshes" / "cube.obj",
                                   folder / "meshes" / "parts" / "cube.obj",
                                   std::filesystem::copy_options::overwrite_existing);
        return folder;
      }(),
      &notes);
  EXPECT_LT(distance_to_corner(scene, 0, {2, 1, 3}), 1e-12);
  EXPECT_EQ(scene.bodies.at(0).angular_velocity, Vec3d(0, 2, 0));
  EXPECT_EQ(scene.bodies.at(0).load->torque, Vec3d(0, 0, 7));
  EXPECT_EQ(scene.dynamics.parameters.at("stiffness"), 5e9);
  EXPECT_THAT(notes.at(0), AllOf(HasSubstr("Autodesk"), HasSubstr("radians")));
}

TEST(AutodeskScene, TheDialectCanBeSaid) {
  const std::string body = R"({"mesh": "cube.obj", "angular_velocity": [90, 0, 0]})";
  const auto folder = folder_with_meshes();
  EXPECT_EQ(ipc_scene(ipc_text(body, "", R"("dialect": "autodesk")"), folder)
                .bodies.at(0)
                .angular_velocity.x,
            90);
  EXPECT_NEAR(
      ipc_scene(ipc_text(body, R"("orthogonality_stiffness": 1e9)", R"("dialect": "rigid-ipc")"),
                folder)
          .bodies.at(0)
          .angular_velocity.x,
      std::numbers::pi / 2, 1e-12);
  EXPECT_THAT(refusal([&] { ipc_scene(ipc_text(body, "", R"("dialect": "other")"), folder); }),
              AllOf(HasSubstr("dialect"), HasSubstr("\"rigid-ipc\", \"autodesk\"")));
}

TEST(AutodeskScene, PinsAreBallJoints) {
  const auto folder = folder_with_meshes();
  std::ofstream(folder / "meshes" / "rod.obj") << test::kCubeObj;
  const std::string bodies = R"({"mesh": "cube.obj", "position": [1, 0, 0]},
      {"mesh": "rod.obj", "rotation": [0, 0, 1.5707963267948966], "scale": 2})";
  const Scene scene = ipc_scene(ipc_text(bodies, R"("linear_constraints": [
          {"type": "pin_world", "body_name": "cube", "body_point": [0, 0, 1]},
          {"type": "pin_joint", "bodyA_name": "rod", "bodyA_point": [0.5, 0, 0],
           "bodyB_name": "cube"}])"),
                                folder);
  ASSERT_EQ(scene.joints.size(), 2u);
  EXPECT_EQ(scene.joints[0].kind, JointKind::ball);
  EXPECT_EQ(scene.joints[0].bodies, (std::array<int, 2>{kWorldBody, 0}));
  EXPECT_LT(norm(scene.joints[0].anchor - Vec3d{1, 0, 1}), 1e-12);
  EXPECT_EQ(scene.joints[1].bodies, (std::array<int, 2>{0, 1}));
  EXPECT_LT(norm(scene.joints[1].anchor - Vec3d{0, 1, 0}), 1e-12)
      << "a point of the scaled and turned rod";
  const auto refused = [&](const std::string& constraint) {
    return refusal([&] {
      ipc_scene(ipc_text(bodies + R"(, {"mesh": "plane.obj", "type": "static"},
                                       {"mesh": "plane.obj", "type": "static"})",
                         "\"linear_constraints\": [" + constraint + "]"),
                folder);
    });
  };
  EXPECT_THAT(refused(R"({"type": "pin_world", "body_name": "cub", "body_point": [0, 0, 0]})"),
              AllOf(HasSubstr("linear_constraints[0].body_name: \"cub\""), HasSubstr("\"cube\"")));
  EXPECT_THAT(refused(R"({"type": "pin_world", "body_name": "plane", "body_point": [0, 0, 0]})"),
              HasSubstr("2 have this mesh"));
  EXPECT_THAT(refused(R"({"type": "weld"})"), HasSubstr("\"pin_world\", \"pin_joint\""));
}

TEST(IpcScene, NoiseIsReadOrRefused) {
  const std::string whole = R"({"timestep": 0.01, "max_time": 0.1,
    "distance_barrier_constraint": {"initial_barrier_activation_distance": 1e-3},
    "ipc_solver": {"velocity_conv_tol": 0.001, "is_velocity_conv_tol_abs": true},
    "friction_constraints": {"static_friction_speed_bound": 0.001, "iterations": -1},
    "rigid_body_problem": {"gravity": [0, -9.8, 0], "coefficient_friction": 0.3,
      "rigid_bodies": [
        {"vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
         "faces": [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], "scale": [1, 2, 1],
         "rotation": [10, 20, 30], "density": 500, "force": [0, 1, 0], "split_components": true,
         "is_dof_fixed": [false, true, false, true, true, false], "group_id": 2},
        {"vertices": [[-9, 0, -9], [0, 0, 9], [9, 0, -9]], "faces": [[0, 1, 2]],
         "type": "kinematic", "dimensions": [2, 0, 2], "angular_velocity": [0, 90, 0],
         "kinematic_max_time": 0.5,
         "kinematic_poses": [{"position": [0, 0.1, 0], "rotation": [0, 0.1, 0]}]}],
      "linear_constraints": [
        {"type": "pin_world", "body_name": "body-0", "body_point": [0, 0, 1]}]}})";
  const auto folder = folder_with_meshes();
  EXPECT_EQ(ipc_scene(whole, folder).bodies.size(), 2u);
  std::mt19937 random(7);
  int read = 0;
  for (int run = 0; run < 4000; ++run) {
    std::string text = whole;
    for (int k = 0; k < 1 + run % 3; ++k) {
      const std::size_t at = random() % text.size();
      if (random() % 2 == 0)  // a character that means something in JSON, or another digit
        text[at] = "0123456789-.e[]{},:\"#"[random() % 21];
      else
        text.erase(at, 1 + random() % 12);
    }
    if (test::refusal([&] { ipc_scene(text, folder); }) == "no error") ++read;
  }
  EXPECT_GT(read, 100) << "most changes of numbers are fine";
  EXPECT_LT(read, 3900);
}

TEST(IpcScene, SceneFilesOfThatFormatAreRecognized) {
  EXPECT_TRUE(ipc::is_ipc_scene(reader::parse_json(ipc_text(""), "x")));
  EXPECT_FALSE(ipc::is_ipc_scene(reader::parse_json(R"({"bodies": []})", "x")));
  EXPECT_FALSE(ipc::is_ipc_scene(reader::parse_json("[1]", "x")));
  // Their faults are those of any scene file.
  EXPECT_THAT(refusal([] {
                parse_scene(ipc_text(R"({"mesh": "nowhere.obj"})"), "x.json", testing::TempDir());
              }),
              HasSubstr("x.json: rigid_body_problem.rigid_bodies[0].mesh"));
}

}  // namespace
}  // namespace scree
