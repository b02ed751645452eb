#include "host/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "host/body_constants.h"
#include "host/scene/scene_summary.h"
#include "shapes/box.h"
#include "shapes/container.h"
#include "shapes/half_space.h"
#include "shapes/mesh.h"
#include "shapes/sphere.h"
#include "tests/host/input_files.h"

namespace scree {
namespace {

using test::refusal;
using testing::StartsWith;

BodyDescription sphere(double radius = 0.1) {
  BodyDescription body;
  body.shape.kind = shapes::Sphere::kind;
  body.shape.radius = radius;
  set_mass_from_density(body, 1000);
  return body;
}
BodyDescription wall(ShapeKind kind) {
  BodyDescription body;
  body.kind = BodyKind::fixed;
  body.shape.kind = kind;
  body.shape.half_extents = {1, 1, 1};
  return body;
}
Scene scene_with(std::vector<BodyDescription> bodies) {
  Scene scene;
  scene.bodies = std::move(bodies);
  return scene;
}
/// The refusal of a good scene after a change.
std::string refused_after(const std::function<void(Scene&)>& change) {
  Scene scene = scene_with({sphere(), wall(shapes::HalfSpace::kind)});
  change(scene);
  return refusal([&] { validate(scene); });
}

TEST(Validate, AcceptsAGoodScene) {
  EXPECT_EQ(refused_after([](Scene&) {}), "no error");
  EXPECT_EQ(refused_after([](Scene& s) { s.bodies.push_back(wall(shapes::Container::kind)); }),
            "no error");
}

TEST(Validate, RefusesNonFiniteAndOutOfRangeValues) {
  EXPECT_EQ(refused_after([](Scene& s) { s.bodies[0].shape.radius = NAN; }),
            "bodies[0].radius: nan is not allowed: must be positive [m]");
  EXPECT_EQ(refused_after([](Scene& s) { s.bodies[0].velocity.y = INFINITY; }),
            "bodies[0].velocity: [0, inf, 0] is not allowed: must be three finite numbers [m/s]");
  EXPECT_EQ(refused_after([](Scene& s) { s.bodies[0].mass = 0; }),
            "bodies[0].mass: 0 is not allowed: a free body needs a positive mass [kg]");
  EXPECT_EQ(refused_after([](Scene& s) { s.bodies[0].orientation.w = 1.1; }),
            "bodies[0].orientation: [1.1, 0, 0, 0] is not allowed: must be a unit quaternion "
            "[w, x, y, z]");
  EXPECT_EQ(refused_after([](Scene& s) {
              s.bodies[1].shape.normal = {0, 0, 2};
            }),
            "bodies[1].normal: [0, 0, 2] is not allowed: must have length 1");
  EXPECT_EQ(refused_after([](Scene& s) { s.stepping.time_step = NAN; }),
            "time_step: nan is not allowed: must be positive [s]");
  EXPECT_EQ(refused_after([](Scene& s) { s.gravity.x = NAN; }),
            "gravity: [nan, 0, -9.81] is not allowed: must be three finite numbers [m/s^2]");
  EXPECT_EQ(refused_after([](Scene& s) { s.solver.name = "magic"; }),
            "solver.name: \"magic\" is not allowed: must be one of \"apgd\", \"jacobi\", "
            "\"gauss_seidel\", \"gauss_seidel_colored\", \"schwarz\"");
  EXPECT_EQ(refused_after([](Scene& s) { s.solver.parameters["relaxation"] = 2; }),
            "solver.relaxation: 2 is not allowed: must be between 0 and 2, both excluded");
  EXPECT_EQ(refused_after([](Scene& s) { s.solver.parameters["metric"] = 2; }),
            "solver.metric: 2 is not allowed: must be one of \"diagonal\", \"euclidean\"");
  EXPECT_EQ(refused_after([](Scene& s) { s.solver.parameters["speed"] = 1; }),
            "solver.parameters: \"speed\" is not allowed: must be one of \"metric\", "
            "\"relaxation\"");
  EXPECT_EQ(refused_after([](Scene& s) { s.materials[0].friction = NAN; }),
            "materials.default.friction: nan is not allowed: must be zero or positive [-]");
}

/// Every one of these ended in a crash, a failed run or results that are no numbers.
TEST(Validate, RefusesNumbersThatNoRunCanComputeWith) {
  const auto box = [](Scene& s) -> BodyDescription& {
    BodyDescription& body = s.bodies[0];
    body.shape.kind = shapes::Box::kind;
    body.shape.half_extents = {0.1, 0.1, 0.1};
    return body;
  };
  EXPECT_EQ(refused_after([](Scene& s) { s.bodies[0].shape.radius = 1e21; }),
            "bodies[0].radius: 1e+21 is not allowed: must be from 1e-12 to 1e+15 [m]");
  EXPECT_EQ(refused_after([&](Scene& s) { box(s).shape.half_extents.y = 1e-13; }),
            "bodies[0].half_extents: 1e-13 is not allowed: must be from 1e-12 to 1e+15 [m]");
  EXPECT_EQ(refused_after([](Scene& s) { s.bodies[1].position.z = -1e16; }),
            "bodies[1].position: [0, 0, -1e+16] is not allowed: must be numbers from -1e+15 to "
            "1e+15 [m]");
  EXPECT_EQ(refused_after([](Scene& s) { s.bodies[0].velocity.x = 1e27; }),
            "bodies[0].velocity: [1e+27, 0, 0] is not allowed: must move the body by 1e+15 m/s at "
            "most, and by 1e+15 m in a step of 0.001 s [m/s]");
  EXPECT_THAT(refused_after([](Scene& s) { s.bodies[0].angular_velocity.x = 1e17; }),
              StartsWith("bodies[0].angular_velocity: [1e+17, 0, 0] is not allowed"));
  EXPECT_EQ(refused_after([](Scene& s) { s.bodies[0].mass = 1e25; }),
            "bodies[0].mass: 1e+25 is not allowed: must be from 1e-24 to 1e+24 [kg]");
  EXPECT_THAT(refused_after([&](Scene& s) { box(s).inertia.x = 1e-40; }),
              StartsWith("bodies[0].inertia: 1e-40 is not allowed: must be from 1e-36"));
  EXPECT_EQ(refused_after([](Scene& s) { s.materials[0].friction = 1e30; }),
            "materials.default.friction: 1e+30 is not allowed: must be from 0 to 1e+06 [-]");
  EXPECT_EQ(refused_after([](Scene& s) { s.materials[0].cohesion = 1e38; }),
            "materials.default.cohesion: 1e+38 is not allowed: must be from 0 to 1e+15 [N]");
  EXPECT_THAT(refused_after([](Scene& s) {
                s.material_pairs = {{0, 0, {}}};
                s.material_pairs[0].values.rolling_friction = 1e30;
              }),
              StartsWith("material_pairs[0].rolling_friction: 1e+30 is not allowed"));
  EXPECT_EQ(refused_after([](Scene& s) { s.stepping.time_step = 1e-40; }),
            "time_step: 1e-40 is not allowed: must be from 1e-15 to 1e+09 [s]");
  EXPECT_EQ(refused_after([](Scene& s) { s.stepping.duration = 1e17; }),
            "duration: 1e+17 is not allowed: would take 1e+20 steps of 0.001 s, must be 1e+15 "
            "steps or fewer");
  EXPECT_THAT(refused_after([](Scene& s) { s.gravity.z = -1e30; }),
              StartsWith("gravity: [0, 0, -1e+30] is not allowed"));
  EXPECT_EQ(refused_after([](Scene& s) { s.stepping.envelope = 1e30; }),
            "collision.envelope: 1e+30 is not allowed: must be from 0 to 1e+15 [m]");
  EXPECT_EQ(refused_after([](Scene& s) { s.stepping.skin = 1e30; }),
            "collision.skin: 1e+30 is not allowed: must be from 0 to 1e+15 [m]");
  EXPECT_THAT(refused_after([](Scene& s) {
                s.periodicity.periodic[0] = true;
                s.periodicity.upper.x = 1e300;
              }),
              StartsWith("periodic.x: [0, 1e+300] is not allowed: must be numbers from -1e+15"));
  EXPECT_THAT(refused_after([](Scene& s) {
                Motion motion;
                motion.kind = Motion::Kind::rotating;
                motion.center = {1e14, 0, 0};
                motion.rate = 3e3;
                s.bodies[1].kind = BodyKind::kinematic;
                s.bodies[1].motion = motion;
              }),
              StartsWith("bodies[1].motion: a start at [0, 0, 0] m with ["));
  EXPECT_THAT(refused_after([](Scene& s) {
                s.particles = {ParticleSet{}};
                s.particles[0].position = {{0, 0, 1}, {0, 1e16, 1}};
                s.particles[0].radius = 0.1;
                s.particles[0].density = 1000.0;
              }),
              StartsWith("particles[0][1].position: [0, 1e+16, 1] is not allowed"));
}

TEST(Validate, TakesSizesFromGrainsOfPowderToMoons) {
  EXPECT_EQ(refused_after([](Scene& s) { s.bodies[0] = sphere(1e-7); }), "no error");
  EXPECT_EQ(refused_after([](Scene& s) { s.bodies[0] = sphere(1e6); }), "no error");
}

TEST(Validate, RefusesMoreMaterialsThanABodyCanName) {
  const auto with_materials = [](std::size_t count) {
    return refused_after([&](Scene& s) { s.materials.resize(count); });
  };
  EXPECT_EQ(with_materials(256), "no error");
  EXPECT_EQ(with_materials(257),
            "materials: a list of 257 materials is not allowed: must hold 256 or fewer");
}

TEST(Validate, RefusesNamesThatAreNoFolderInsideAnother) {
  for (const char* name : {"..", ".", "", "../a", "/tmp/a", "a/b", "a\\b", "a\nb", "a\x1b[2Jb"})
    EXPECT_THAT(refused_after([&](Scene& s) { s.name = name; }),
                testing::AllOf(StartsWith("name: \""), testing::HasSubstr("fit for a folder"),
                               testing::Not(testing::ContainsRegex("[\x1b\n]"))))
        << name;
  EXPECT_THAT(refused_after([](Scene& s) { s.name = std::string(201, 'a'); }),
              StartsWith("name: \"aaa"));
  for (const char* name : {"pile", "two words", "..a", "H\xc3\xb6he 3.5"})
    EXPECT_EQ(refused_after([&](Scene& s) { s.name = name; }), "no error");
}

TEST(Validate, RefusesBadIndices) {
  EXPECT_EQ(refused_after([](Scene& s) { s.bodies[0].material = 1; }),
            "bodies[0].material: 1 is not allowed: must be an index below 1");
  EXPECT_EQ(refused_after([](Scene& s) { s.bodies[1].group = -1; }),
            "bodies[1].group: -1 is not allowed: must be an index below 1");
  EXPECT_EQ(refused_after([](Scene& s) { s.bodies.push_back(wall(shapes::Mesh::kind)); }),
            "bodies[2].mesh: -1 is not allowed: must be an index below 0");
  EXPECT_EQ(refused_after([](Scene& s) {
              s.meshes.push_back({"m", {{0, 0, 0}}, {{0, 1, 2}}, true});
            }),
            "meshes[0] (m).triangles[0]: 1 is not allowed: must be a vertex index below 1");
}

TEST(Validate, RefusesImpossibleBodies) {
  EXPECT_THAT(refused_after([](Scene& s) { s.bodies[1].kind = BodyKind::free; }),
              StartsWith("bodies[1].kind: \"free\" is not allowed: only sphere, box, capsule, "
                         "cylinder, hull, cone, ellipsoid or compound bodies"));
  EXPECT_THAT(refused_after([](Scene& s) {
                Motion motion;
                motion.kind = Motion::Kind::linear;
                s.bodies[1].motion = motion;
              }),
              StartsWith("bodies[1].motion: a motion is not allowed: only kinematic bodies"));
  EXPECT_THAT(refused_after([](Scene& s) { s.bodies.erase(s.bodies.begin()); }),
              StartsWith("bodies: a scene of 1 bodies, none free is not allowed"));
}

TEST(Validate, RefusesBadInsertions) {
  EXPECT_EQ(refused_after([](Scene& s) {
              s.insertions = {{1, {sphere()}}, {1, {sphere()}}};
            }),
            "insertions[1].time: 1 is not allowed: must be later than the insertion before [s]");
  EXPECT_EQ(refused_after([](Scene& s) {
              s.insertions = {{-1, {sphere()}}};
            }),
            "insertions[0].time: -1 is not allowed: must be zero or positive [s]");
  EXPECT_EQ(refused_after([](Scene& s) {
              s.insertions = {{1, {wall(shapes::HalfSpace::kind)}}};
            }),
            "insertions[0].bodies[0].kind: a fixed or kinematic body is not allowed: only free "
            "bodies can be inserted during a run");
  EXPECT_EQ(
      refused_after([](Scene& s) {
        s.insertions = {{1, {sphere(0.1), sphere(0.2)}}};
        s.insertions[0].bodies[1].mass = NAN;
      }),
      "insertions[0].bodies[1].mass: nan is not allowed: a free body needs a positive mass [kg]");
}

ParticleSet two_particles() {
  ParticleSet set;
  set.position = {{0, 0, 1}, {0, 0, 2}};
  set.radius = 0.1;
  set.density = 1000.0;
  return set;
}

TEST(Validate, RefusesBadParticles) {
  const auto refused_set = [](auto change) {
    return refused_after([&](Scene& s) {
      s.particles = {two_particles(), two_particles()};
      change(s.particles[1]);
    });
  };
  EXPECT_EQ(refused_set([](ParticleSet&) {}), "no error");
  EXPECT_EQ(refused_set([](ParticleSet& set) { set.position[1].x = NAN; }),
            "particles[1][1].position: [nan, 0, 2] is not allowed: must be three finite numbers "
            "[m]");
  EXPECT_EQ(refused_set([](ParticleSet& set) { set.density = 0.0; }),
            "particles[1][0].mass: 0 is not allowed: a free body needs a positive mass [kg]");
  EXPECT_EQ(refused_set([](ParticleSet& set) {
              set.radius = PerParticle(std::vector<double>{0.1, -0.1});
            }),
            "particles[1][1].radius: -0.1 is not allowed: must be positive [m]");
  EXPECT_EQ(refused_set([](ParticleSet& set) { set.mass = PerParticle(std::vector<double>{1.0}); }),
            "particles[1].mass: a list of another length is not allowed: must be one value for "
            "all, or one for each of 2 particles");
  EXPECT_EQ(refused_set([](ParticleSet& set) { set.shape = PerParticle(std::vector<Shape>(3)); }),
            "particles[1].shape: a list of another length is not allowed: must be one value for "
            "all, or one for each of 2 particles");
  Shape box;
  box.kind = shapes::Box::kind;
  box.half_extents = {2, 2, 1};
  EXPECT_EQ(
      refused_set([&](ParticleSet& set) { set.shape = box; }),
      "particles[1][0].radius: 0.1 is not allowed: must be that of the bounding sphere, 3 [m]");
  EXPECT_EQ(refused_set([&](ParticleSet& set) {
              set.radius = 3.0;
              std::vector<Shape> shapes{box, box};
              shapes[1].half_extents.z = -1;
              set.shape = PerParticle(shapes);
            }),
            "particles[1][1].half_extents: [2, 2, -1] is not allowed: must be positive [m]");
  EXPECT_THAT(refused_set([&](ParticleSet& set) {
                Shape wall;
                wall.kind = shapes::HalfSpace::kind;
                set.shape = wall;
              }),
              StartsWith("particles[1][0].kind: \"free\" is not allowed: only sphere, box"));
  EXPECT_THAT(refused_set([&](ParticleSet& set) {
                Shape none;
                none.kind = ShapeKind{200};
                set.shape = none;
              }),
              StartsWith("particles[1][0].shape: number 200 is not allowed: must be one of"));
  EXPECT_THAT(refused_after([](Scene& s) {
                s.insertions = {{1, {}, {two_particles()}}};
                s.insertions[0].particles[0].group = 3;
              }),
              StartsWith("insertions[0].particles[0][0].group: 3 is not allowed"));
}

TEST(ParticleSets, HaveTheMassAndInertiaOfTheSameBodies) {
  BodyDescription ball = sphere(0.1);
  set_mass_from_density(ball, 1000);
  ParticleSet set = two_particles();
  EXPECT_EQ(particle_body(set, 1).mass, ball.mass);
  EXPECT_EQ(particle_body(set, 1).inertia, ball.inertia);
  EXPECT_EQ(particle_mass(set, 1), ball.mass);
  set.mass = PerParticle(std::vector<double>{0.0, 3.0});  // 0: from the density
  EXPECT_EQ(particle_body(set, 0).mass, ball.mass);
  EXPECT_EQ(particle_body(set, 1).mass, 3);
  EXPECT_NEAR(particle_body(set, 1).inertia.y, 0.4 * 3 * 0.01, 1e-15);
}

TEST(BodyConstants, AreInTheOrderOfIds) {
  Scene scene = scene_with({sphere(0.1), wall(shapes::Container::kind)});
  scene.groups = {"bodies", "others"};
  scene.particles = {two_particles(), ParticleSet{}, two_particles()};
  scene.particles[2].radius = PerParticle(std::vector<double>{0.2, 0.3});
  scene.particles[2].group = 1;
  scene.insertions = {{1, {sphere(0.4), sphere(0.5)}, {two_particles()}}, {2, {sphere(0.6)}, {}}};
  const BodyConstants constants(scene);
  ASSERT_EQ(constants.size(), 11u);
  const std::vector<double> radii{0.1, -1, 0.1, 0.1, 0.2, 0.3, 0.4, 0.5, 0.1, 0.1, 0.6};
  for (std::size_t id = 0; id < radii.size(); ++id) {
    if (id == 1) continue;
    EXPECT_EQ(constants[id].radius, radii[id]) << id;
    EXPECT_EQ(constants[id].kind, BodyKind::free) << id;
    EXPECT_EQ(constants[id].shape, shapes::Sphere::kind) << id;
    EXPECT_GT(constants[id].mass, 0) << id;
    EXPECT_EQ(constants[id].group, id == 4 || id == 5 ? 1 : 0) << id;
  }
  EXPECT_EQ(constants[1].kind, BodyKind::fixed);
  EXPECT_EQ(constants[1].shape, shapes::Container::kind);
  EXPECT_EQ(constants[1].mass, 0);
}

TEST(SceneSummary, MedianOfSetsAndBodies) {
  Scene scene = scene_with({sphere(0.5)});
  scene.particles = {two_particles(), two_particles()};
  scene.particles[1].radius = PerParticle(std::vector<double>{0.2, 0.3});
  const SceneSummary s = summarize(scene);
  EXPECT_EQ(s.free_capacity, 5);
  EXPECT_EQ(s.median_diameter, 0.4);
  EXPECT_EQ(s.largest_diameter, 1.0);
  scene.particles.pop_back();
  scene.bodies = {sphere(0.1)};
  EXPECT_EQ(summarize(scene).median_diameter, 0.2);
}

TEST(Validate, ContainersMayTouchOrNestButNotOverlapInPart) {
  const auto containers = [](const Vec3d& offset, double size, double angle) {
    BodyDescription a = wall(shapes::Container::kind);
    BodyDescription b = wall(shapes::Container::kind);
    b.position = offset;
    b.shape.half_extents = {size, size, size};
    b.orientation = exp_map(Vec3d{0, 0, angle});
    return refusal([&] { validate(scene_with({sphere(), a, b})); });
  };
  EXPECT_EQ(containers({2, 0, 0}, 1, 0), "no error");         // touching
  EXPECT_EQ(containers({0.1, 0, 0}, 0.5, 0.3), "no error");   // inside
  EXPECT_EQ(containers({2.5, 0, 0}, 1, 0.7854), "no error");  // apart, turned
  EXPECT_THAT(containers({2.3, 0, 0}, 1, 0.7854),
              StartsWith("bodies[2]: a container is not allowed"));
  EXPECT_THAT(containers({1, 0, 0}, 0.5, 0), StartsWith("bodies[2]: a container is not allowed"));
}

TEST(Validate, BoxesMayMeetAllShapes) {
  BodyDescription box = wall(shapes::Box::kind);
  const BodyDescription fixed_box = box;
  box.kind = BodyKind::free;
  set_mass_from_density(box, 1000);
  const auto check = [](std::vector<BodyDescription> bodies) {
    return refusal([&] { validate(scene_with(std::move(bodies))); });
  };
  EXPECT_EQ(check({box, sphere(), wall(shapes::HalfSpace::kind), wall(shapes::Container::kind)}),
            "no error");
  EXPECT_EQ(check({sphere(), fixed_box, fixed_box}), "no error");
  EXPECT_EQ(check({box, box, fixed_box}), "no error");
  Scene with_mesh = scene_with({wall(shapes::Mesh::kind), box});
  with_mesh.bodies[0].shape.mesh = 0;
  with_mesh.meshes.push_back({"plate", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, false});
  EXPECT_EQ(refusal([&] { validate(with_mesh); }), "no error");
}

TEST(Validate, ContactsOfAllBodiesHaveNames) {
  BodyDescription box = wall(shapes::Box::kind);
  box.kind = BodyKind::free;
  set_mass_from_density(box, 1000);
  ParticleSet spheres;
  spheres.radius = 0.1;
  spheres.density = 1000.0;
  const auto check = [&](std::vector<BodyDescription> bodies, std::size_t particles) {
    Scene scene = scene_with(std::move(bodies));
    spheres.position.resize(particles);
    scene.particles = {spheres};
    return refusal([&] { validate(scene); });
  };
  const std::size_t most = (std::size_t{1} << 23) - 1;  // two boxes touch by 9 bits of features
  EXPECT_EQ(check({box, box}, most - 2), "no error");
  EXPECT_EQ(
      check({box, box}, most - 1),
      "bodies: 8388608 bodies with 0 faces and 0 elements of solid walls is not allowed: one run "
      "has 2^32 names of contacts; a body takes 512 (because free bodies that are no spheres "
      "touch at several points), a face 8, a solid wall one for each triangle and each "
      "periodic image");
  EXPECT_EQ(check({box}, most - 1), "no error");
  std::vector<BodyDescription> walled(11, wall(shapes::Container::kind));  // 66 faces, 528 names
  walled.insert(walled.end(), {box, box});
  EXPECT_THAT(check(walled, most - 13), StartsWith("bodies: 8388607 bodies with 66 faces"));
  walled.pop_back();
  EXPECT_EQ(check(walled, most - 12), "no error");
}

TEST(Validate, PeriodsHoldTwoOfTheLargestBodyAndTheEnvelope) {
  const auto period = [](double length) {
    return refused_after([&](Scene& s) {
      s.stepping.envelope = 0.01;
      s.periodicity.periodic[1] = true;
      s.periodicity.upper.y = length;
    });
  };
  EXPECT_EQ(period(0.4201), "no error");
  EXPECT_EQ(period(0.41),
            "periodic.y: [0, 0.41] is not allowed: must span at least 0.42 m: twice the "
            "largest free body and the contact envelope, so that two bodies meet through one image "
            "only; what spans the domain must be fixed or kinematic");
}

TEST(MassFromDensity, SphereAndBox) {
  const BodyDescription ball = sphere(0.5);
  EXPECT_NEAR(ball.mass, 1000 * 3.14159265358979 / 6, 1e-9);
  EXPECT_NEAR(ball.inertia.x, 0.1 * ball.mass, 1e-12);
  BodyDescription box;
  box.shape.kind = shapes::Box::kind;
  box.shape.half_extents = {0.5, 1, 1.5};
  set_mass_from_density(box, 2);
  EXPECT_DOUBLE_EQ(box.mass, 12);
  EXPECT_DOUBLE_EQ(box.inertia.x, 4 + 9);
  EXPECT_DOUBLE_EQ(box.inertia.y, 1 + 9);
  EXPECT_DOUBLE_EQ(box.inertia.z, 1 + 4);
  EXPECT_EQ(refusal([&] { set_mass_from_density(box, -1); }),
            "density: -1 is not allowed: must be positive [kg/m^3]");
}

TEST(PairValues, MixOrListedPairInEitherOrder) {
  Scene scene;
  scene.materials = {{"a", 0.2, 0.5, 3, 0.1, 0.2}, {"b", 0.8, 0.1, 4, 0.2, 0.1}};
  const Material mix = pair_values(scene, 0, 1);
  EXPECT_DOUBLE_EQ(mix.friction, 0.4);
  EXPECT_EQ(mix.restitution, 0.1);
  EXPECT_EQ(mix.cohesion, 3);
  EXPECT_EQ(mix.rolling_friction, 0.1);
  EXPECT_EQ(mix.spinning_friction, 0.1);
  scene.material_pairs = {{0, 1, {"ab", 0.9, 0, 0, 0, 0}}};
  EXPECT_EQ(pair_values(scene, 1, 0).friction, 0.9);
  EXPECT_DOUBLE_EQ(pair_values(scene, 1, 1).friction, 0.8);
}

TEST(PairValues, TableHoldsThoseOfAllPairs) {
  Scene scene;
  scene.materials = {{"a", 0.2, 0.5, 3, 0.1, 0.2}, {"b", 0.8, 0.1, 4, 0.2, 0.1}, {"c", 0.7}};
  scene.material_pairs = {{2, 0, {"ca", 0.9, 0.4, 0, 0, 0}}};
  const std::vector<Material> table = all_pair_values(scene);
  ASSERT_EQ(table.size(), 9u);
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      const Material one = pair_values(scene, a, b);
      const Material& other = table[static_cast<std::size_t>(3 * a + b)];
      EXPECT_EQ(other.friction, one.friction) << a << b;
      EXPECT_EQ(other.restitution, one.restitution) << a << b;
      EXPECT_EQ(other.cohesion, one.cohesion) << a << b;
      EXPECT_EQ(other.rolling_friction, one.rolling_friction) << a << b;
      EXPECT_EQ(other.spinning_friction, one.spinning_friction) << a << b;
    }
}

}  // namespace
}  // namespace scree
