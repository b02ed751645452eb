// How much of the mobility of a spring the joints about it leave, against closed forms.

#include <gtest/gtest.h>

#include "dynamics/rigid/joint_frames.h"
#include "tests/physics/joint_scenes.h"

namespace scree {
namespace {

using physics::add_box;
using physics::add_sphere;
using physics::empty_scene;
using physics::joint_of;
using physics::line_of;

double share_of_last(const Scene& scene) { return joint_frames(scene).back().drive.share; }

void add_spring(Scene& scene, int a, int b, const Vec3d& from, const Vec3d& to) {
  Joint spring = line_of(JointKind::spring, a, b, from, to);
  spring.stiffness = 1;
  scene.joints.push_back(spring);
}

TEST(JointMobility, OfABodyThatNothingElseHoldsIsWhole) {
  Scene scene = empty_scene(1, 0);
  add_sphere(scene, {}, 0.1, 2);
  add_sphere(scene, {1, 0, 0}, 0.1, 3);
  add_spring(scene, 0, 1, {}, {1, 0, 0});
  EXPECT_EQ(share_of_last(scene), 1);
}

TEST(JointMobility, OfBodiesInALineIsThatOfTheirMasses) {
  Scene scene = empty_scene(1, 0);
  double mass = 0;
  for (int k = 0; k < 4; ++k) {
    add_sphere(scene, {0.3 * k, 0, 0}, 0.1, k + 0.5);
    mass += k + 0.5;
    if (k > 0) scene.joints.push_back(joint_of(JointKind::fixed, k - 1, k, {0.3 * k, 0, 0}));
  }
  // A second joint that holds what is held already changes nothing.
  scene.joints.push_back(joint_of(JointKind::ball, 1, 0, {0.1, 0.2, 0}));
  add_spring(scene, kWorldBody, 0, {-1, 0, 0}, {});
  EXPECT_NEAR(share_of_last(scene), 0.5 / mass, 1e-8);
}

TEST(JointMobility, OfALeverIsThatAboutItsHinge) {
  // A rod of length 2 l and moment I about its center, hinged at one end, a spring across it at the other.
  Scene scene = empty_scene(1, 0);
  const BodyDescription rod = add_box(scene, {0.5, 0, 0}, {0.5, 0.02, 0.02}, 1.2);
  scene.joints.push_back(joint_of(JointKind::hinge, kWorldBody, 0, {}, {0, 1, 0}));
  add_spring(scene, 0, kWorldBody, {1, 0, 0}, {1, 0, 2});
  const double own = rod.inertia.y;
  const double alone = 1 / 1.2 + 0.25 / own, hinged = 1 / (own + 1.2 * 0.25);
  EXPECT_NEAR(share_of_last(scene), hinged / alone, 1e-8);
}

TEST(JointMobility, OfASliderOnACartIsThatAlongItsAxis) {
  // The cart slides along x in the world, a piston along z in the cart, a spring pulls the piston along x and z.
  Scene scene = empty_scene(1, 0);
  add_box(scene, {}, {0.2, 0.2, 0.2}, 5);
  add_box(scene, {0, 0, 0.5}, {0.05, 0.05, 0.05}, 0.4);
  scene.joints.push_back(joint_of(JointKind::slider, kWorldBody, 0, {}, {1, 0, 0}));
  scene.joints.push_back(joint_of(JointKind::slider, 0, 1, {0, 0, 0.5}, {0, 0, 1}));
  add_spring(scene, 1, kWorldBody, {0, 0, 0.5}, {3, 0, 4.5});
  const double alone = 1 / 0.4, held = 0.36 / 5.4 + 0.64 / 0.4;
  EXPECT_NEAR(share_of_last(scene), held / alone, 1e-8);
}

TEST(JointMobility, OfLockedAndHeldBodies) {
  Scene scene = empty_scene(1, 0);
  add_sphere(scene, {}, 0.1, 2).locks = lock_rotation | lock_z;
  add_spring(scene, kWorldBody, 0, {-3, 0, -4}, {});
  EXPECT_EQ(share_of_last(scene), 1);
  // One that cannot move along its spring may move later: nothing is known of it.
  scene.joints.insert(scene.joints.begin(),
                      joint_of(JointKind::slider, kWorldBody, 0, {}, {0, 1, 0}));
  EXPECT_EQ(share_of_last(scene), 1);
}

TEST(JointMobility, AMotorWithGainsIsASpringAboutItsHinge) {
  Scene scene = empty_scene(1, 0);
  const double axle = add_box(scene, {}, {0.01, 0.1, 0.01}, 0.1).inertia.y;
  const double wheel = add_box(scene, {0, 0.2, 0}, {0.2, 0.05, 0.2}, 3).inertia.y;
  scene.joints.push_back(joint_of(JointKind::fixed, 0, 1, {0, 0.1, 0}));
  Joint hinge = joint_of(JointKind::hinge, kWorldBody, 0, {}, {0, 1, 0});
  hinge.motor = JointMotor{.position = 1, .stiffness = 7};
  scene.joints.push_back(hinge);
  EXPECT_NEAR(share_of_last(scene) / (axle / (axle + wheel)), 1, 1e-3);
}

}  // namespace
}  // namespace scree
