// Sets of particles in a running simulation: the same bodies as those described one by one.

#include <gtest/gtest.h>

#include <algorithm>

#include "host/error.h"
#include "host/world.h"
#include "shapes/half_space.h"

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
