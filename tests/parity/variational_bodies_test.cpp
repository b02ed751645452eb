// Bodies of all shapes by the variational model on both backends.

#include "tests/dynamics/variational_bodies.h"

#include "host/state_hash.h"
#include "tests/parity/parity.h"

namespace scree::parity {
namespace {

class ParityVariationalBodies : public Parity {};

// Times of impacts are right within a tolerance, not to rounding, and differences grow fiftyfold in four steps: on the CPU,
// starts that differ by 1e-12 m are 4e-7 m/s apart after 20 steps, and an H200 and a CPU were 1.8e-4 m/s apart then.
TEST_F(ParityVariationalBodies, BackendsAgreeUntilChaosTellsThemApart) {
  const Scene scene = test::bodies_among_walls();
  World cpu = world_on(BackendKind::cpu, scene), cuda = world_on(BackendKind::cuda, scene);
  double hits = 0;
  for (int k = 0; k < 18; ++k) {
    const StepReport a = cpu.step(), b = cuda.step();
    hits += a.own[test::impacts];
    ASSERT_EQ(a.own[test::impacts], b.own[test::impacts]) << k;
    ASSERT_NEAR(a.own[test::energy], b.own[test::energy], 1e-9 * std::abs(a.own[test::energy]))
        << k;
    ASSERT_EQ(b.max_penetration, 0);
  }
  EXPECT_GT(hits, 10);
  const BodyStates a = cpu.states(), b = cuda.states();
  for (std::size_t i = 0; i < a.position.size(); ++i)
    ASSERT_LT(norm(a.velocity[i] - b.velocity[i]), 1e-4) << "body " << i;
}

TEST_F(ParityVariationalBodies, CudaGivesEqualBitsOnEveryRun) {
  const Scene scene = test::bodies_among_walls();
  World one = world_on(BackendKind::cuda, scene), two = world_on(BackendKind::cuda, scene);
  for (int k = 0; k < 100; ++k) one.step(), two.step();
  EXPECT_EQ(state_hash(one.states()), state_hash(two.states()));
}

}  // namespace
}  // namespace scree::parity
