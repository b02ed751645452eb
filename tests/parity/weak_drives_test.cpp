// Joints whose drives change little in a step, in default solves on a GPU: closed forms, as on the CPU.

#include "tests/physics/weak_drives.h"

#include "tests/parity/parity.h"

namespace scree::parity {
namespace {

class ParityWeakDrives : public Parity {};

TEST_F(ParityWeakDrives, AMotorTurnsAHeavyWheelAndFrictionStopsABody) {
  for (const Precision precision : kPrecisions) {
    SCOPED_TRACE(name_of(precision));
    double moment = 0;
    World wheel = world_on(BackendKind::cuda, physics::weak_motor(moment), precision);
    physics::run_for(wheel, 2);
    EXPECT_NEAR(wheel.states().angular_velocity[0].z, 2 / moment, 0.02 / moment);
    World slider = world_on(BackendKind::cuda, physics::braked_slider(), precision);
    physics::run_for(slider, 2);
    EXPECT_NEAR(slider.states().position[0].x, 2.25, 0.01);
    EXPECT_NEAR(slider.states().velocity[0].x, 0, 1e-3);
  }
}

/// Several steps among drives that share a body.
TEST_F(ParityWeakDrives, AnArmOfTwoSoftMotorsComesToItsPlace) {
  World world = world_on(BackendKind::cuda, physics::arm_of_two_soft_motors());
  physics::run_for(world, 15);
  const std::vector<JointRecord> joints = world.joints();
  EXPECT_NEAR(joints[0].position, 0.3, 0.02);
  EXPECT_NEAR(joints[1].position, -0.4, 0.02);
}

TEST_F(ParityWeakDrives, ASpringSwingsBesideManyBodiesAtRest) {
  World world = world_on(BackendKind::cuda, physics::spring_beside_bodies_at_rest());
  EXPECT_LT(physics::error_of_swing(world), 0.02 * 0.05);
}

}  // namespace
}  // namespace scree::parity
