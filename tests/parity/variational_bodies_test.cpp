// Bodies of all shapes by the variational model on both backends.

#include "tests/dynamics/variational_bodies.h"

#include "host/state_hash.h"
#include "tests/parity/parity.h"

namespace scree::parity {
namespace {

class ParityVariationalBodies : public Parity {};

// Times and points of impacts are right within a tolerance, not to rounding: on the CPU, starts that differ by 1e-15 to 1e-12 m/s
// are up to 1.1e-3 m/s apart after an impact of two round bodies. The backends differ no more than such starts do.
TEST_F(ParityVariationalBodies, BackendsDifferNoMoreThanStartsThatDifferByRounding) {
  const Scene scene = test::bodies_among_walls();
  World cpu = world_on(BackendKind::cpu, scene), cuda = world_on(BackendKind::cuda, scene);
  std::vector<World> others;
  for (const double off : {1e-15, 3e-15, 1e-14, 1e-13, 1e-12}) {
    Scene other = scene;
    for (BodyDescription& body : other.bodies)
      if (body.kind == BodyKind::free) body.velocity.x += off;
    others.push_back(world_on(BackendKind::cpu, other));
  }
  double hits = 0;
  for (int k = 0; k < 20; ++k) {
    const StepReport a = cpu.step(), b = cuda.step();
    for (World& other : others) other.step();
    hits += a.own[test::impacts];
    ASSERT_EQ(a.own[test::impacts], b.own[test::impacts]) << k;
    ASSERT_NEAR(a.own[test::energy], b.own[test::energy], 1e-9 * std::abs(a.own[test::energy]))
        << k;
    ASSERT_EQ(b.max_penetration, 0);
  }
  EXPECT_GT(hits, 10);
  double spread = 0;
  for (World& other : others)
    spread = std::max(spread, largest_difference(cpu.states().velocity, other.states().velocity));
  EXPECT_LT(spread, 2e-3);
  EXPECT_LT(largest_difference(cpu.states().velocity, cuda.states().velocity), 3 * spread);
}

TEST_F(ParityVariationalBodies, CudaGivesEqualBitsOnEveryRun) {
  const Scene scene = test::bodies_among_walls();
  World one = world_on(BackendKind::cuda, scene), two = world_on(BackendKind::cuda, scene);
  for (int k = 0; k < 100; ++k) one.step(), two.step();
  EXPECT_EQ(state_hash(one.states()), state_hash(two.states()));
}

}  // namespace
}  // namespace scree::parity
