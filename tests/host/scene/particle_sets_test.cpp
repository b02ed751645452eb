// Sets of particles in a running simulation: the same bodies as those described one by one.

#include <gtest/gtest.h>

#include <algorithm>

#include "host/error.h"
#include "host/scene/overlaps.h"
#include "host/scene/scene_summary.h"
#include "host/world.h"
#include "shapes/box.h"
#include "shapes/capsule.h"
#include "shapes/cylinder.h"
#include "shapes/half_space.h"
#include "shapes/sphere.h"

namespace scree {
namespace {

/// Loose columns of spheres above a floor; the speed tells them apart.
ParticleSet grid(int edge, int layers, double bottom) {
  ParticleSet set;
  std::vector<double> radius;
  std::vector<Vec3d> velocity;
  for (int z = 0; z < layers; ++z)
    for (int y = 0; y < edge; ++y)
      for (int x = 0; x < edge; ++x) {
        set.position.push_back({0.021 * x, 0.021 * y + 0.002 * (z % 2), bottom + 0.0205 * z});
        radius.push_back(0.009 + 0.001 * ((x + y + z) % 2));
        velocity.push_back({0.01 * x, 0.02 * y, -0.5 - 1e-6 * static_cast<double>(radius.size())});
      }
  set.radius = PerParticle(std::move(radius));
  set.velocity = PerParticle(std::move(velocity));
  set.density = 2500.0;
  return set;
}

Scene floor_scene() {
  Scene scene;
  BodyDescription floor;
  floor.kind = BodyKind::fixed;
  floor.shape.kind = shapes::HalfSpace::kind;
  scene.bodies = {floor};
  return scene;
}

void append_one_by_one(const ParticleSet& set, std::vector<BodyDescription>& bodies) {
  for (std::size_t i = 0; i < set.position.size(); ++i) bodies.push_back(particle_body(set, i));
}

void expect_same_states(const BodyStates& a, const BodyStates& b) {
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.velocity, b.velocity);
  EXPECT_EQ(a.angular_velocity, b.angular_velocity);
  for (std::size_t i = 0; i < a.orientation.size(); ++i) {
    EXPECT_EQ(a.orientation[i].w, b.orientation[i].w) << i;
    EXPECT_EQ(a.orientation[i].vec(), b.orientation[i].vec()) << i;
  }
}

TEST(ParticleSets, RunAsTheSameBodiesOneByOne) {
  Scene sets = floor_scene();
  Scene bodies = sets;
  const ParticleSet below = grid(5, 4, 0.0101);
  const ParticleSet above = grid(4, 1, 0.2);
  sets.particles = {below};
  sets.insertions = {{0.005, {}, {above}}};
  append_one_by_one(below, bodies.bodies);
  bodies.insertions = {{0.005, {}, {}}};
  append_one_by_one(above, bodies.insertions[0].bodies);
  World a(sets, {});
  World b(bodies, {});
  ASSERT_EQ(a.body_count(), 101);
  for (int step = 0; step < 20; ++step) {
    const StepReport ra = a.step();
    EXPECT_EQ(ra.contact_count, b.step().contact_count);
  }
  ASSERT_EQ(a.body_count(), 117);
  expect_same_states(a.states(), b.states());
}

/// A loose grid of all shapes that may be free, turned and of several sizes; spheres among them.
ParticleSet shapes_in_grid(int edge, int layers, double bottom) {
  std::vector<Shape> samples(4);
  samples[0].kind = shapes::Box::kind;
  samples[0].half_extents = {0.01, 0.008, 0.006};
  samples[1].kind = shapes::Capsule::kind;
  samples[1].half_extents = {0.006, 0.006, 0.012};
  samples[2].kind = shapes::Cylinder::kind;
  samples[2].half_extents = {0.007, 0.007, 0.01};
  samples[3].kind = shapes::Sphere::kind;
  samples[3].radius = 0.011;
  ParticleSet set = grid(edge, layers, bottom);
  std::vector<Shape> shapes;
  std::vector<double> radii;
  std::vector<Quatd> orientations;
  for (std::size_t i = 0; i < set.position.size(); ++i) {
    const double scale = 0.6 + 0.05 * static_cast<double>(i % 7);
    const ShapeCard& card = shape_card(samples[i % 4].kind);
    shapes.push_back(card.scaled(samples[i % 4], scale));
    radii.push_back(card.bounding_radius(shapes[i], nullptr));
    orientations.push_back(exp_map(Vec3d{0.3, 0.2, -0.1} * static_cast<double>(i + 1)));
  }
  set.shape = PerParticle(std::move(shapes));
  set.radius = PerParticle(std::move(radii));
  set.orientation = PerParticle(std::move(orientations));
  set.angular_velocity = Vec3d{3, -2, 1};
  return set;
}

/// Scenes of sets, some of which come later, and of the same bodies one by one.
struct TwoWays {
  Scene sets, bodies;
};
TwoWays two_ways(const ParticleSet& below, const ParticleSet& above) {
  TwoWays scenes{floor_scene(), floor_scene()};
  scenes.sets.particles = {below};
  scenes.sets.insertions = {{0.005, {}, {above}}};
  append_one_by_one(below, scenes.bodies.bodies);
  scenes.bodies.insertions = {{0.005, {}, {}}};
  append_one_by_one(above, scenes.bodies.insertions[0].bodies);
  return scenes;
}

void expect_same_runs(const TwoWays& scenes, const WorldOptions& options, int steps) {
  World a(scenes.sets, options);
  World b(scenes.bodies, options);
  std::int64_t contacts = 0;
  for (int step = 0; step < steps; ++step) {
    const StepReport ra = a.step(), rb = b.step();
    ASSERT_EQ(ra.contact_count, rb.contact_count) << step;
    ASSERT_EQ(ra.residual_rms, rb.residual_rms) << step;
    contacts += ra.contact_count;
  }
  EXPECT_GT(contacts, 50 * steps);
  expect_same_states(a.states(), b.states());
  EXPECT_EQ(a.memory(), b.memory());
}

TEST(ParticleSets, OfMixedShapesRunAsTheSameBodiesOneByOne) {
  ParticleSet below = shapes_in_grid(6, 4, 0.0101);
  const ParticleSet above = shapes_in_grid(4, 1, 0.12);
  for (const Precision precision : {Precision::single_precision, Precision::double_precision})
    expect_same_runs(two_ways(below, above), {.precision = precision}, 40);
  below.locks = lock_ry | lock_rz;
  expect_same_runs(two_ways(below, above), {}, 40);
}

TEST(ParticleSets, OfOneShapeRunAsTheSameBodiesOneByOne) {
  ParticleSet below = grid(6, 4, 0.0101);
  Shape box;
  box.kind = shapes::Box::kind;
  box.half_extents = {0.01, 0.008, 0.006};
  below.shape = box;
  below.radius = norm(box.half_extents);
  below.mass = 0.02;
  ParticleSet above = grid(4, 1, 0.12);
  expect_same_runs(two_ways(below, above), {}, 40);
}

TEST(ParticleSets, OfMixedShapesGoOnFromACheckpointBitForBit) {
  const Scene scene = two_ways(shapes_in_grid(6, 4, 0.0101), shapes_in_grid(4, 1, 0.12)).sets;
  for (const int before : {3, 15}) {  // the second set comes with step 6
    World whole(scene, {});
    for (int step = 0; step < before; ++step) whole.step();
    World resumed(scene, {});
    resumed.restore(whole.save());
    for (int step = 0; step < 20; ++step) {
      whole.step();
      resumed.step();
    }
    expect_same_states(whole.states(), resumed.states());
  }
}

/// `scree check` and the forecast of memory see them, too.
TEST(ParticleSets, OfMixedShapesAreCheckedAsTheSameBodiesOneByOne) {
  const TwoWays scenes = two_ways(shapes_in_grid(6, 4, 0.0101), shapes_in_grid(4, 1, 0.12));
  validate(scenes.sets);
  EXPECT_EQ(expected_memory(scenes.sets, {}), expected_memory(scenes.bodies, {}));
  const SceneSummary a = summarize(scenes.sets), b = summarize(scenes.bodies);
  EXPECT_EQ(a.layout, b.layout);
  EXPECT_EQ(a.layout, ContactLayout::mixed);
  EXPECT_EQ(a.solid_spheres, b.solid_spheres);
  EXPECT_EQ(a.radial_bodies, b.radial_bodies);
  EXPECT_EQ(a.envelope, b.envelope);
  ParticleSet tight = shapes_in_grid(6, 4, 0.0101);
  for (Vec3d& x : tight.position) x *= 0.7;
  const TwoWays squeezed = two_ways(tight, shapes_in_grid(4, 1, 0.12));
  const Overlaps in_sets = find_overlaps(squeezed.sets, {});
  const Overlaps in_bodies = find_overlaps(squeezed.bodies, {});
  EXPECT_GT(in_sets.pairs, 10);
  EXPECT_EQ(in_sets.pairs, in_bodies.pairs);
  EXPECT_EQ(in_sets.depth, in_bodies.depth);
  EXPECT_EQ(in_sets.body_a, in_bodies.body_a);
}

TEST(ParticleSets, OfMoreThanOneTransferChunkKeepTheirOrder) {
  Scene scene = floor_scene();
  const ParticleSet set = grid(260, 1, 0.5);  // 67,600
  scene.particles = {set};
  World world(scene, {});
  const BodyStates states = world.states();
  ASSERT_EQ(states.position.size(), set.position.size() + 1);
  EXPECT_TRUE(std::equal(set.position.begin(), set.position.end(), states.position.begin() + 1));
  EXPECT_EQ(states.velocity.back().z,
            static_cast<double>(static_cast<float>(set.velocity[67599].z)));

  world.step();  // sorts the bodies
  const WorldState saved = world.save();
  const auto& id = saved.at<std::int32_t>("body/id");
  EXPECT_FALSE(std::is_sorted(id.begin(), id.end()));
  World other(scene, {});
  other.restore(saved);
  expect_same_states(other.states(), world.states());
  EXPECT_EQ(other.save().at<std::int32_t>("body/id"), id);
  other.step();
  world.step();
  expect_same_states(other.states(), world.states());
}

TEST(ParticleSets, StatesOfOtherBodiesAreRefused) {
  Scene scene = floor_scene();
  scene.particles = {grid(3, 1, 0.5)};
  World world(scene, {});
  WorldState saved = world.save();
  for (const int wrong : {-1, 0, 10, saved.at<std::int32_t>("body/id")[1]}) {
    WorldState changed = saved;
    changed.at<std::int32_t>("body/id")[0] = wrong;
    EXPECT_THROW(world.restore(changed), InputError) << wrong;
  }
}

}  // namespace
}  // namespace scree
