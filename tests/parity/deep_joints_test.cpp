// Long chains: a device has their held rows solved on the host, so that steps take few iterations there too.

#include "tests/parity/parity.h"
#include "tests/physics/hanging_scenes.h"

namespace scree::parity {
namespace {

class ParityDeepJoints : public Parity {};

TEST_F(ParityDeepJoints, AThousandLinksHangWithoutIterations) {
  const Scene scene = hanging_chain(1000);
  World cpu = world_on(BackendKind::cpu, scene, Precision::double_precision);
  World cuda = world_on(BackendKind::cuda, scene, Precision::double_precision);
  for (int k = 0; k < 100; ++k) {
    cpu.step();
    const StepReport report = cuda.step();
    ASSERT_TRUE(report.converged) << k;
    ASSERT_EQ(report.iterations, 0) << k;
    ASSERT_LT(report.max_joint_error, 1e-6) << k;
  }
  const BodyStates a = cpu.states(), b = cuda.states();
  for (std::size_t i = 0; i < a.position.size(); ++i)
    ASSERT_LT(norm(a.position[i] - b.position[i]), 1e-7) << i;
}

TEST_F(ParityDeepJoints, InFloatLinksHoldToo) {
  World world = world_on(BackendKind::cuda, hanging_chain(1000));
  double error = 0;
  int iterations = 0;
  for (int k = 0; k < 100; ++k) {
    const StepReport report = world.step();
    error = std::max(error, report.max_joint_error);
    iterations += report.iterations;
  }
  EXPECT_LT(error, 1e-6);
  EXPECT_LT(iterations, 100);
}

/// A ball on the middle of the chain: contacts are for iterations, beside joints that are solved.
TEST_F(ParityDeepJoints, AChainCatchesABall) {
  Scene scene = hanging_chain(200);
  const Vec3d middle = scene.bodies[100].position;
  add_sphere(scene, middle + Vec3d{0, 0, 0.05}, 0.04, 0.2).velocity = {0, 0, -1};
  for (const BackendKind backend : kBackends) {
    SCOPED_TRACE(name_of(backend));
    World world = world_on(backend, scene, Precision::double_precision);
    int contacts = 0;
    for (int k = 0; k < 100; ++k) {
      const StepReport report = world.step();
      ASSERT_LT(report.max_joint_error, 1e-4) << k;
      contacts += report.contact_count;
    }
    EXPECT_GT(contacts, 10);
  }
}

}  // namespace
}  // namespace scree::parity
