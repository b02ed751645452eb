// How far bodies that joints hold together may be apart.

#include "dynamics/rigid/joint_reach.h"

#include <gtest/gtest.h>

#include "dynamics/rigid/joint_frames.h"
#include "tests/physics/joint_scenes.h"

namespace scree {
namespace {

using namespace physics;

TEST(JointReach, IsTheDiametersOfTheFreeBodiesThatJointsHoldTogether) {
  Scene scene = empty_scene(1, 0);
  for (const double radius : {0.1, 0.2, 0.4, 0.8, 1.6})
    add_sphere(scene, {5 * radius, 0, 0}, radius, 1);
  add_wall_box(scene, {0, 3, 0}, {2, 0.1, 0.1}, BodyKind::fixed);
  scene.joints.push_back(joint_of(JointKind::ball, 0, 1, {}));
  scene.joints.push_back(joint_of(JointKind::ball, 1, 5, {}));  // what is fixed holds none together
  scene.joints.push_back(joint_of(JointKind::ball, 5, 2, {}));
  scene.joints.push_back(joint_of(JointKind::hinge, kWorldBody, 3, {}));
  scene.joints.push_back(joint_of(JointKind::ball, 0, 1, {0.1, 0, 0}));
  const std::vector<JointFrames> frames = joint_frames(scene);
  const std::vector<double> expected{0.6, 0.6, 0.8, 1.6, 0.6};
  ASSERT_EQ(frames.size(), expected.size());
  for (std::size_t k = 0; k < frames.size(); ++k) EXPECT_NEAR(frames[k].reach, expected[k], 1e-12);
}

}  // namespace
}  // namespace scree
