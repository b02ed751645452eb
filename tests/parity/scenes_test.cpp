// Every kind of scene takes 20 steps on both backends. The states of 20 steps are not yet chaotic:
// with a residual of 1e-3 of what gravity does in a step, energies agree within 1e-3 and mean
// heights within 1e-4 of a diameter.

#include <functional>

#include "host/compounds.h"
#include "host/hulls.h"
#include "shapes/container.h"
#include "shapes/rounded.h"
#include "tests/host/scene/shape_samples.h"
#include "tests/parity/parity.h"

namespace scree::parity {
namespace {

constexpr double kDiameter = 0.01;

/// Spheres that fall onto whatever is below them at 0.5 m/s.
Scene falling_spheres(double lowest = 0.006) {
  Scene scene = empty_scene(1e-3, 0.4);
  solve_to(scene, 1e-5);
  scene.solver.max_iterations = 2000;
  add_lattice(scene, 320, 8, 8, {-0.037, -0.037, lowest}, 0.0104, kDiameter / 2, 2500, 6);
  for (BodyDescription& body : scene.bodies) body.velocity = {0.1, 0.05, -0.5};
  return scene;
}

Scene walls() {
  Scene scene = falling_spheres();
  add_tank(scene, -0.044, 0.044, -0.044, 0.044);
  return scene;
}

Scene container() {
  Scene scene = falling_spheres(-0.03);
  BodyDescription body;
  body.kind = BodyKind::fixed;
  body.shape.kind = shapes::Container::kind;
  body.shape.half_extents = {0.044, 0.044, 0.037};
  body.shape.open_faces = 32;
  body.orientation = exp_map(Vec3d{0, 0, 0.05});
  scene.bodies.push_back(body);
  return scene;
}

Scene mesh() {
  Scene scene = falling_spheres(0.01);
  add_valley(scene);
  return scene;
}

Scene fixed_boxes() {
  Scene scene = falling_spheres(0.03);
  for (int k = -1; k <= 1; ++k)
    add_wall_box(scene, {0.03 * k, 0, 0.01}, {0.01, 0.05, 0.008}).orientation =
        exp_map(Vec3d{0, 0.3 * (k + 2), 0.1});
  add_plane(scene);
  return scene;
}

Scene one_free_box() {
  Scene scene = falling_spheres(0.05);
  add_box(scene, {0.003, 0.002, 0.021}, {0.03, 0.03, 0.02}, 0.4).velocity = {0, 0, -0.5};
  add_plane(scene);
  return scene;
}

/// Three layers of boxes, each turned in its own way, that fall onto a floor and a fixed box.
Scene boxes() {
  Scene scene = empty_scene(1e-3, 0.4);
  solve_to(scene, 1e-5);
  scene.solver.max_iterations = 2000;
  for (int k = 0; k < 75; ++k) {
    const Vec3d site{0.013 * (k % 5) - 0.026, 0.013 * (k / 5 % 5) - 0.026,
                     0.013 + 0.0102 * (k / 25)};
    BodyDescription& box = add_box(scene, site, {0.005, 0.0045, 0.005}, 2e-3);
    box.orientation = exp_map(Vec3d{0, 0, 0.37 * k});
    box.velocity = {0.1, 0.05, -0.5};
  }
  add_wall_box(scene, {0, 0, 0}, {0.02, 0.1, 0.007}).orientation = exp_map(Vec3d{0, 0, 0.1});
  add_plane(scene);
  return scene;
}

/// Bodies of several parts that fall onto a fixed one, spheres among them.
Scene compounds() {
  Scene scene = falling_spheres(0.05);
  for (int k = 0; k < 50; ++k) {
    BodyDescription body;
    body.position = {0.018 * (k % 5) - 0.036, 0.018 * (k / 5 % 5) - 0.036,
                     0.025 + 0.013 * (k / 25)};
    body.orientation = exp_map(Vec3d{0.3, 0.2, 0.37 * k});
    body.velocity = {0.1, 0.05, -0.5};
    const double r = 0.003;
    if (k % 2 == 0) {
      set_compound(scene, body,
                   {test::part(test::ball_of(r), {}), test::part(test::ball_of(r), {r, 0, 0}),
                    test::part(test::ball_of(r), {0, r, 0})});
    } else {
      set_compound(scene, body,
                   {test::part(test::box_of({2 * r, r, r}), {}),
                    test::part(test::round_of("cylinder", r / 2, 2 * r), {0, r, 0})},
                   SharedMass::each_part);
    }
    set_mass_from_density(body, 2500);
    scene.bodies.push_back(body);
  }
  BodyDescription floor;
  floor.kind = BodyKind::fixed;
  set_compound(scene, floor,
               {test::part(test::box_of({0.1, 0.1, 0.005}), {0, 0, 0.012}),
                test::part(test::ball_of(0.004), {0.01, 0.01, 0.018})});
  scene.bodies.push_back(floor);
  return scene;
}

/// Rounded bodies of every core that fall onto a fixed one, spheres among them.
Scene rounded_shapes() {
  Scene scene = falling_spheres(0.05);
  constexpr double kRadius = 0.002;
  for (int k = 0; k < 50; ++k) {
    BodyDescription body;
    body.position = {0.018 * (k % 5) - 0.036, 0.018 * (k / 5 % 5) - 0.036,
                     0.025 + 0.013 * (k / 25)};
    body.orientation = exp_map(Vec3d{0.3, 0.2, 0.37 * k});
    body.velocity = {0.1, 0.05, -0.5};
    const int core = (k + k / 5) % 5;
    if (core == 4) {
      set_hull(scene, body,
               {{0, 0, 0}, {0.008, 0, 0}, {0, 0.008, 0}, {0, 0, 0.006}, {0.005, 0.005, 0.004}},
               kRadius);
    } else {
      body.shape = shapes::Rounded::of(core == 0   ? test::box_of({0.004, 0.003, 0.003})
                                       : core == 1 ? test::round_of("cylinder", 0.003, 0.004)
                                       : core == 2 ? test::round_of("cone", 0.004, 0.004)
                                                   : test::ellipsoid_of({0.005, 0.003, 0.002}),
                                       kRadius);
    }
    set_mass_from_density(body, 2500);
    scene.bodies.push_back(body);
  }
  BodyDescription floor;
  floor.kind = BodyKind::fixed;
  floor.position = {0, 0, 0.01};
  floor.shape = shapes::Rounded::of(test::box_of({0.1, 0.1, 0.005}), kRadius);
  scene.bodies.push_back(floor);
  return scene;
}

Scene cohesion() {
  Scene scene = walls();
  scene.materials[0].cohesion = 5 * scene.bodies[0].mass * kGravity;
  return scene;
}

Scene rolling_friction() {
  Scene scene = walls();
  scene.materials[0].rolling_friction = 5e-4;
  scene.materials[0].spinning_friction = 2e-4;
  return scene;
}

Scene kinematic() {
  Scene scene = walls();
  BodyDescription& paddle =
      add_wall_box(scene, {0, 0, -0.001}, {0.04, 0.004, 0.003}, BodyKind::kinematic);
  Motion turn;
  turn.kind = Motion::Kind::rotating;
  turn.rate = 20;
  paddle.motion = turn;
  BodyDescription& piston = add_plane(scene, {0, 0, 1}, {0, 0, -0.002});
  piston.kind = BodyKind::kinematic;
  Motion stroke;
  stroke.kind = Motion::Kind::oscillating;
  stroke.amplitude = 0.004;
  stroke.frequency = 20;
  piston.motion = stroke;
  return scene;
}

Scene kinematic_exact() {
  Scene scene = kinematic();
  scene.solver.exact_coulomb = true;
  return scene;
}

Scene kinematic_restitution() {
  Scene scene = kinematic();
  scene.materials[0].restitution = 0.5;
  solve_to(scene, 1e-6);
  // Whether bodies touch, and so share an impact, is decided at 1e-6 m here. At 0.5 m/s a gap of the third
  // step is that to 1e-5 of it, and float and double part for good; shifts of 1e-9 m change the energy of these by 4e-6.
  for (BodyDescription& body : scene.bodies)
    if (body.kind == BodyKind::free) body.velocity = {0.1, 0.05, -0.45};
  return scene;
}

/// A box with many spheres on it, and small boxes between these.
Scene boxes_among_spheres() {
  Scene scene = one_free_box();
  for (int k = 0; k < 6; ++k)
    add_box(scene, {0.012 * k - 0.03, 0.01, 0.12}, {0.005, 0.004, 0.004}, 2e-3).velocity = {0, 0,
                                                                                            -0.5};
  return scene;
}

Scene periodic() {
  Scene scene = falling_spheres();
  add_plane(scene);
  scene.periodicity = {{true, true, false}, {-0.0416, -0.0416, 0}, {0.0416, 0.0416, 0}};
  return scene;
}

Scene exact_coulomb() {
  Scene scene = walls();
  scene.solver.exact_coulomb = true;
  return scene;
}

Scene restitution() {
  Scene scene = walls();
  scene.materials[0].restitution = 0.5;
  // Energies after solves to 1e-5 m/s are 1.2e-3 off, after these 1e-4: bounces keep
  // what a solve leaves.
  solve_to(scene, 1e-6);
  return scene;
}

Scene newton_restitution() {
  Scene scene = restitution();
  scene.stepping.restitution_law = RestitutionLaw::newton;
  return scene;
}

Scene insertion() {
  Scene scene = walls();
  Scene batch;
  add_lattice(batch, 64, 8, 8, {-0.037, -0.037, 0.08}, 0.0104, kDiameter / 2, 2500, 7);
  scene.insertions.push_back({0.005, batch.bodies});
  return scene;
}

Scene mixed_materials() {
  Scene scene = walls();
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].friction = 0.1;
  for (std::size_t i = 0; i < scene.bodies.size(); i += 2) scene.bodies[i].material = 1;
  return scene;
}

struct Case {
  const char* name;
  std::function<Scene()> make;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class ParityScenes : public Parity, public ::testing::WithParamInterface<Case> {};
INSTANTIATE_TEST_SUITE_P(
    All, ParityScenes,
    ::testing::Values(Case{"walls", walls}, Case{"container", container}, Case{"mesh", mesh},
                      Case{"fixed_boxes", fixed_boxes}, Case{"one_free_box", one_free_box},
                      Case{"boxes", boxes}, Case{"compounds", compounds},
                      Case{"rounded_shapes", rounded_shapes}, Case{"cohesion", cohesion},
                      Case{"rolling_friction", rolling_friction}, Case{"kinematic", kinematic},
                      Case{"kinematic_exact", kinematic_exact},
                      Case{"kinematic_restitution", kinematic_restitution},
                      Case{"boxes_among_spheres", boxes_among_spheres}, Case{"periodic", periodic},
                      Case{"exact_coulomb", exact_coulomb}, Case{"restitution", restitution},
                      Case{"newton_restitution", newton_restitution}, Case{"insertion", insertion},
                      Case{"mixed_materials", mixed_materials}),
    [](const auto& info) { return std::string(info.param.name); });

struct Outcome {
  double energy = 0, height = 0;
  int contacts = 0, bodies = 0;
};

Outcome after_20_steps(const Scene& scene, BackendKind backend, Precision precision) {
  World world = world_on(backend, scene, precision);
  Outcome outcome;
  for (int k = 0; k < 20; ++k) {
    const StepReport report = world.step();
    outcome.energy = report.kinetic_energy;
    outcome.contacts = report.contact_count;
    outcome.bodies = report.body_count;
  }
  const BodyStates s = world.states();
  const BodyConstants& c = world.constants();
  for (std::size_t i = 0; i < s.position.size(); ++i)
    if (c[i].kind == BodyKind::free) outcome.height += s.position[i].z / outcome.bodies;
  return outcome;
}

TEST_P(ParityScenes, TwentySteps) {
  const Scene scene = GetParam().make();
  for (const Precision precision : kPrecisions) {
    const Outcome a = after_20_steps(scene, BackendKind::cpu, precision);
    const Outcome b = after_20_steps(scene, BackendKind::cuda, precision);
    EXPECT_GT(a.contacts, 100) << name_of(precision);
    EXPECT_EQ(a.bodies, b.bodies) << name_of(precision);
    EXPECT_NEAR(b.energy, a.energy, 1e-3 * a.energy) << name_of(precision);
    EXPECT_NEAR(b.height, a.height, 1e-4 * kDiameter) << name_of(precision);
  }
}

class ParitySolvers : public Parity, public ::testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, ParitySolvers,
                         // Sequential Gauss-Seidel runs on the CPU only.
                         ::testing::Values("apgd", "jacobi", "gauss_seidel_colored", "schwarz"),
                         [](const auto& info) { return std::string(info.param); });

/// Once the spheres are down, one step is solved by every solver to the residual that
/// all of them reach.
TEST_P(ParitySolvers, OneStepOnBothBackends) {
  Scene scene = walls();
  World fall = world_on(BackendKind::cpu, scene, Precision::double_precision);
  for (int k = 0; k < 40; ++k) fall.step();
  const BodyStates fallen = fall.states();
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (scene.bodies[i].kind != BodyKind::free) continue;
    scene.bodies[i].position = fallen.position[i];
    scene.bodies[i].velocity = fallen.velocity[i];
    scene.bodies[i].angular_velocity = fallen.angular_velocity[i];
  }
  solve_to(scene, 1e-6);
  scene.solver.max_iterations = 50000;
  for (const Precision precision : kPrecisions) {
    scene.solver.name = "apgd";
    World reference = world_on(BackendKind::cpu, scene, precision);
    const StepReport expected = reference.step();
    EXPECT_TRUE(expected.converged) << name_of(precision);
    scene.solver.name = GetParam();
    for (const BackendKind backend : kBackends) {
      World world = world_on(backend, scene, precision);
      const StepReport report = world.step();
      const auto where = std::string(name_of(backend)) + ' ' + name_of(precision);
      EXPECT_TRUE(report.converged) << where << ' ' << report.residual_rms;
      EXPECT_EQ(report.contact_count, expected.contact_count) << where;
      EXPECT_NEAR(report.objective, expected.objective, 1e-5 * std::abs(expected.objective))
          << where;
      EXPECT_LT(relative_rms(reference.states(), world.states(), kDiameter / 2), 1e-3) << where;
    }
  }
}

}  // namespace
}  // namespace scree::parity
