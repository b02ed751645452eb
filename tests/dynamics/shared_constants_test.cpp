// Which constants of the bodies of a scene are the same for all free ones.

#include "dynamics/rigid/shared_constants.h"

#include <gtest/gtest.h>

#include "shapes/box.h"

namespace scree {
namespace {

ParticleSet spheres(int count, double radius) {
  ParticleSet set;
  set.position.resize(static_cast<std::size_t>(count));
  set.radius = radius;
  set.density = 2500.0;
  return set;
}

Scene two_sets(const ParticleSet& first, const ParticleSet& second) {
  Scene scene;
  scene.particles = {first, second};
  return scene;
}

TEST(SharedConstants, OfEqualSpheresAreAllShared) {
  const SharedConstants s = shared_constants(two_sets(spheres(3, 0.01), spheres(2, 0.01)));
  EXPECT_EQ(s.radius, 0.01);
  EXPECT_NEAR(s.mass.value(), 2500 * 4.0 / 3 * 3.14159265358979 * 1e-6, 1e-12);
  EXPECT_EQ(s.locks, 0);
  EXPECT_EQ(s.material, 0);
  EXPECT_EQ(s.group, 0);
  EXPECT_TRUE(s.spheres);
}

TEST(SharedConstants, DifferOneByOne) {
  ParticleSet other = spheres(1, 0.01);
  other.radius = 0.02;
  other.mass = 0.5;
  EXPECT_FALSE(shared_constants(two_sets(spheres(1, 0.01), other)).radius);
  EXPECT_FALSE(shared_constants(two_sets(spheres(1, 0.01), other)).mass);
  other = spheres(1, 0.01);
  other.locks = lock_rotation;
  EXPECT_FALSE(shared_constants(two_sets(spheres(1, 0.01), other)).locks);
  EXPECT_TRUE(shared_constants(two_sets(spheres(1, 0.01), other)).radius);
  other = spheres(2, 0.01);
  other.group = PerParticle(std::vector<int>{0, 1});
  EXPECT_FALSE(shared_constants(two_sets(other, spheres(1, 0.01))).group);
  other = spheres(1, 0.01);
  other.material = 1;
  EXPECT_FALSE(shared_constants(two_sets(spheres(1, 0.01), other)).material);
}

TEST(SharedConstants, LookAtInsertionsButNotAtEmptySetsOrWalls) {
  Scene scene = two_sets(spheres(2, 0.01), spheres(0, 0.5));
  BodyDescription wall;
  wall.kind = BodyKind::fixed;
  wall.shape.radius = 3;
  wall.group = 1;
  scene.bodies = {wall};
  EXPECT_EQ(shared_constants(scene).radius, 0.01);
  EXPECT_EQ(shared_constants(scene).group, 0);
  scene.insertions = {{1.0, {}, {spheres(1, 0.03)}}};
  EXPECT_FALSE(shared_constants(scene).radius);
}

TEST(SharedConstants, BoundingRadiiOfOtherShapesAreNot) {
  Scene scene;
  BodyDescription box;
  box.shape.kind = shapes::Box::kind;
  scene.bodies = {box, box};
  EXPECT_FALSE(shared_constants(scene).radius);
  EXPECT_FALSE(shared_constants(scene).spheres);
  EXPECT_TRUE(shared_constants(scene).mass);
}

}  // namespace
}  // namespace scree
