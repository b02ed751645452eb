// Which joints a device leaves to a direct solve on the host.

#include "dynamics/rigid/deep_joints.h"

#include <gmock/gmock.h>

#include "dynamics/rigid/joint_frames.h"
#include "tests/physics/hanging_scenes.h"

namespace scree {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

std::vector<Index> deep_joints_of(const Scene& scene) {
  return deep_joints(scene, joint_frames(scene));
}

/// Pairs of balls on fixed joints.
void add_pairs(Scene& scene, int count) {
  for (int k = 0; k < count; ++k) {
    const auto first = static_cast<int>(scene.bodies.size());
    physics::add_sphere(scene, {1.0 * k, 5, 0}, 0.1, 1);
    physics::add_sphere(scene, {1.0 * k, 5.2, 0}, 0.1, 1);
    scene.joints.push_back(
        physics::joint_of(JointKind::fixed, first, first + 1, {1.0 * k, 5.1, 0}));
  }
}

TEST(DeepJoints, AreAllOfALongChain) {
  EXPECT_THAT(deep_joints_of(physics::hanging_chain(1000)), SizeIs(1001));
  EXPECT_THAT(deep_joints_of(physics::hanging_chain(30)), SizeIs(31));
}

TEST(DeepJoints, AreNoneOfAWideNetAndOfShortMechanisms) {
  EXPECT_THAT(deep_joints_of(physics::hanging_net(32)), IsEmpty());
  Scene pairs = physics::empty_scene(1e-3, 0);
  EXPECT_THAT(deep_joints_of(pairs), IsEmpty());
  add_pairs(pairs, 500);
  EXPECT_THAT(deep_joints_of(pairs), IsEmpty());
}

TEST(DeepJoints, AreThoseOfTheChainAmongPairs) {
  Scene scene = physics::empty_scene(1e-3, 0);
  add_pairs(scene, 3);
  for (int k = 0; k < 100; ++k) {
    const auto id = static_cast<int>(scene.bodies.size());
    physics::add_sphere(scene, {0.2 * k, 0, 0}, 0.1, 1);
    scene.joints.push_back(physics::joint_of(JointKind::ball, k == 0 ? kWorldBody : id - 1, id,
                                             {0.2 * k - 0.1, 0, 0}));
  }
  add_pairs(scene, 3);
  const std::vector<Index> deep = deep_joints_of(scene);
  ASSERT_THAT(deep, SizeIs(100));
  EXPECT_EQ(deep.front(), 3);
  EXPECT_EQ(deep.back(), 102);
}

// Chains on one body that does not move do not reach each other through it.
TEST(DeepJoints, OfChainsOnABodyAtRestAreApart) {
  Scene scene = physics::empty_scene(1e-3, 0);
  physics::add_sphere(scene, {}, 1, 1).kind = BodyKind::fixed;
  for (int chain = 0; chain < 40; ++chain)
    for (int k = 0; k < 5; ++k) {
      const auto id = static_cast<int>(scene.bodies.size());
      physics::add_sphere(scene, {2.0 + k, 3.0 * chain, 0}, 0.1, 1);
      scene.joints.push_back(
          physics::joint_of(JointKind::ball, k == 0 ? 0 : id - 1, id, {1.5 + k, 3.0 * chain, 0}));
    }
  EXPECT_THAT(deep_joints_of(scene), IsEmpty());
}

}  // namespace
}  // namespace scree
