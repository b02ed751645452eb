// A second model of dynamics, of one file that is not in the list of dynamics/, through World.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "dynamics/dynamics_card.h"
#include "host/error.h"
#include "host/problems/body_problem.h"
#include "host/state_hash.h"
#include "tests/physics/scene_builder.h"

namespace scree {
namespace {

using physics::cpu_options;
using testing::ElementsAre;
using testing::HasSubstr;

class PointMasses : public testing::TestWithParam<Precision> {
 protected:
  /// Three spheres, the first two of which start in each other, and a set of two more.
  static Scene scene(const char* model = "point_masses") {
    Scene scene = physics::empty_scene(1e-2, 0.5);
    scene.gravity = {0.5, 0, -9.81};
    scene.dynamics.type = model;
    physics::add_sphere(scene, {0, 0, 1}, 0.3, 2).velocity = {1, 0, 2};
    physics::add_sphere(scene, {0.1, 0, 1}, 0.3, 1).velocity = {0, -1, 0};
    physics::add_sphere(scene, {2, 0, 1}, 0.2, 3).velocity = {0, 0.25, 4};
    ParticleSet set;
    set.position = {{-2, 0, 0}, {-2, 1, 0}};
    set.radius = 0.1;
    set.density = 1000;
    scene.particles = {set};
    return scene;
  }
  World world(const Scene& scene) const { return World(scene, cpu_options(1, GetParam())); }
  double rounding() const { return GetParam() == Precision::double_precision ? 1e-13 : 2e-5; }
};
INSTANTIATE_TEST_SUITE_P(Precisions, PointMasses,
                         testing::Values(Precision::single_precision, Precision::double_precision),
                         [](const auto& info) {
                           return info.param == Precision::double_precision ? "double" : "float";
                         });

TEST_P(PointMasses, FlyAlongParabolas) {
  const Scene start = scene();
  World w = world(start);
  StepReport last;
  for (int k = 0; k < 100; ++k) last = w.step();
  const double t = 1;
  const BodyStates states = w.states();
  ASSERT_EQ(states.position.size(), 5u);
  EXPECT_TRUE(states.orientation.empty());
  double energy = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const BodyDescription& body = start.bodies[i];
    const Vec3d v = body.velocity + t * start.gravity;
    const Vec3d x = body.position + t * body.velocity + (t * t / 2) * start.gravity;
    EXPECT_LT(norm(states.position[i] - x), rounding()) << i;
    EXPECT_LT(norm(states.velocity[i] - v), rounding() * norm(v)) << i;
    energy += 0.5 * body.mass * norm2(v);
  }
  const double particle = 1000 * 4.0 / 3 * physics::kPi * 1e-3;
  energy += 2 * 0.5 * particle * norm2(start.gravity);
  EXPECT_NEAR(last.kinetic_energy, energy, rounding() * energy);
  EXPECT_NEAR(last.time, t, 1e-12);
  EXPECT_EQ(last.body_count, 5);
  // A fall from rest goes along a straight line: its length is the distance flown.
  EXPECT_NEAR(states.own.at(0)[3], norm(start.gravity) / 2, rounding() * 10);
}

TEST_P(PointMasses, TakeTheirParameter) {
  Scene floating = scene();
  floating.dynamics.parameters["gravity_factor"] = 0;
  World w = world(floating);
  for (int k = 0; k < 10; ++k) w.step();
  EXPECT_EQ(w.states().velocity[0], (Vec3d{1, 0, 2}));
  floating.dynamics.parameters["gravity_factor"] = 20;
  EXPECT_THROW(world(floating), InputError);
  floating.dynamics.parameters = {{"gravity", 1}};
  EXPECT_THROW(world(floating), InputError);
}

TEST_P(PointMasses, GoOnBitForBit) {
  World whole = world(scene()), resumed = world(scene());
  for (int k = 0; k < 7; ++k) whole.step();
  const WorldState saved = whole.save();
  EXPECT_EQ(saved.dynamics, "point_masses");
  std::vector<std::string> names;
  for (const StateArray& array : saved.arrays) names.push_back(array.name);
  EXPECT_THAT(names, ElementsAre("body/id", "body/position", "body/velocity", "body/distance"));
  resumed.restore(saved);
  EXPECT_EQ(resumed.steps_done(), 7);
  EXPECT_EQ(resumed.time(), whole.time());
  for (int k = 0; k < 7; ++k) {
    const StepReport a = whole.step(), b = resumed.step();
    EXPECT_EQ(a.step, b.step);
    EXPECT_EQ(a.kinetic_energy, b.kinetic_energy);
  }
  EXPECT_EQ(state_hash(resumed.states()), state_hash(whole.states()));
  EXPECT_EQ(resumed.states().own, whole.states().own);
}

TEST_P(PointMasses, RefuseStatesOfAnotherModel) {
  World rigid = world(scene("rigid")), points = world(scene());
  for (const auto& [from, to] : {std::pair{&rigid, &points}, {&points, &rigid}}) {
    try {
      to->restore(from->save());
      ADD_FAILURE() << "the state was taken";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("point_masses"));
      EXPECT_THAT(error.what(), HasSubstr("rigid"));
    }
  }
}

TEST_P(PointMasses, HaveNoContacts) {
  World w = world(scene());
  BodyProblem problem;
  EXPECT_EQ(w.step(problem).contact_count, 0);
  EXPECT_TRUE(w.contacts().empty());
  EXPECT_TRUE(w.overlaps().empty()) << "two of them are in each other";
  EXPECT_EQ(world(scene("rigid")).overlaps().size(), 1u);
}

TEST_P(PointMasses, HandOutTheirArrays) {
  World w = world(scene());
  std::vector<std::string> names;
  for (const ArrayInfo& info : w.arrays()) names.push_back(info.name);
  EXPECT_THAT(names, ElementsAre("position", "distance"));
  w.step();
  const ArrayView view = w.array("position");
  EXPECT_EQ(view.shape[0], 5);
  EXPECT_EQ(static_cast<const double*>(view.data)[8], w.states().position[2].z);
  EXPECT_THROW(w.array("angular_velocity"), InputError);
}

TEST_P(PointMasses, AreDrawnAsRigidSpheresAre) {
  PictureSettings settings;
  settings.width = 160;
  settings.height = 120;
  settings.labels = false;
  const Image points = world(scene()).render(settings);
  EXPECT_GT(std::set<std::uint8_t>(points.rgb.begin(), points.rgb.end()).size(), 10u);
  EXPECT_EQ(points.rgb, world(scene("rigid")).render(settings).rgb);
}

TEST_P(PointMasses, RefuseScenesThatTheyDoNotKnow) {
  Scene walls = scene();
  physics::add_plane(walls);
  EXPECT_THROW(world(walls), InputError);
  EXPECT_NO_THROW(validate(scene()));
}

TEST(Dynamics, ModelsAreKnownByName) {
  EXPECT_THAT(dynamics_names(), ElementsAre("rigid", "variational", "affine", "point_masses"));
  Scene scene = physics::empty_scene(1e-2, 0.5);
  physics::add_sphere(scene, {}, 0.1, 1);
  scene.dynamics.type = "point_mases";
  try {
    validate(scene);
    ADD_FAILURE() << "the scene was taken";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("dynamics.type: \"point_mases\" is not allowed"));
    EXPECT_THAT(error.what(), HasSubstr("\"point_masses\""));
  }
}

TEST(Dynamics, MemoryIsToldByTheModel) {
  Scene scene = physics::empty_scene(1e-2, 0.5);
  physics::add_sphere(scene, {}, 0.1, 1);
  const std::size_t rigid = expected_memory(scene, cpu_options());
  scene.dynamics.type = "point_masses";
  EXPECT_EQ(expected_memory(scene, cpu_options()), 24u + 10 * 8 + 4);
  EXPECT_GT(rigid, expected_memory(scene, cpu_options()));
}

}  // namespace
}  // namespace scree
