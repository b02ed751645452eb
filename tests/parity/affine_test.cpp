// Affine bodies on both backends: the CPU factorizes the linear systems, the device takes conjugate gradients.

#include "host/state_hash.h"
#include "tests/dynamics/affine_scenes.h"
#include "tests/parity/parity.h"

namespace scree::parity {
namespace {

class ParityAffine : public Parity {};

TEST_F(ParityAffine, StepsFromOneStateHaveOneMinimum) {
  for (const double rule : {0.0, 1.0, 2.0}) {
    SCOPED_TRACE(rule);
    const Scene scene = test::falling_boxes(rule);
    World cpu = world_on(BackendKind::cpu, scene), cuda = world_on(BackendKind::cuda, scene);
    int contacts = 0;
    for (int k = 0; k < 60; ++k) {
      cuda.restore(cpu.save());
      const StepReport a = cpu.step(), b = cuda.step();
      ASSERT_TRUE(a.converged && b.converged) << k;
      ASSERT_EQ(a.contact_count, b.contact_count) << k;
      contacts += a.contact_count;
      const auto p = cpu.save().at<Vec3d>("affine/position");
      const auto q = cuda.save().at<Vec3d>("affine/position");
      for (std::size_t i = 0; i < p.size(); ++i) ASSERT_LT(norm(p[i] - q[i]), 1e-8) << k;
    }
    EXPECT_GT(contacts, 100);
  }
}

// Motors, friction and limits are terms of the same potential.
TEST_F(ParityAffine, DrivenJointsMoveAlike) {
  const Scene scene = test::driven_pair();
  World cpu = world_on(BackendKind::cpu, scene), cuda = world_on(BackendKind::cuda, scene);
  for (int k = 0; k < 300; ++k) {
    ASSERT_TRUE(cpu.step().converged && cuda.step().converged) << k;
    const auto p = cpu.save().at<Vec3d>("affine/position");
    const auto q = cuda.save().at<Vec3d>("affine/position");
    for (std::size_t i = 0; i < p.size(); ++i) ASSERT_LT(norm(p[i] - q[i]), 1e-6) << k;
  }
}

TEST_F(ParityAffine, CudaGivesEqualBitsOnEveryRun) {
  const Scene scene = test::falling_boxes(1);
  World one = world_on(BackendKind::cuda, scene), two = world_on(BackendKind::cuda, scene);
  for (int k = 0; k < 60; ++k) one.step(), two.step();
  EXPECT_EQ(state_hash(one.states()), state_hash(two.states()));
}

}  // namespace
}  // namespace scree::parity
