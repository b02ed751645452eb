// The contact problem that a step hands out, from both backends.

#include "host/problems/body_problem.h"
#include "tests/parity/parity.h"
#include "tests/physics/column.h"

namespace scree::parity {
namespace {

class ParityDump : public Parity {};

BodyProblem first_problem(BackendKind backend, const Scene& scene, Precision precision) {
  World world = world_on(backend, scene, precision);
  BodyProblem problem;
  const StepReport report = world.step(problem);
  EXPECT_EQ(report.contact_count, problem.contact_count());
  EXPECT_NO_THROW(validate(problem));
  EXPECT_EQ(problem.source.backend, name_of(backend));
  EXPECT_EQ(problem.source.precision, name_of(precision));
  return problem;
}

TEST_F(ParityDump, FirstStep) {
  const Scene scene = column_scene(cut_column(800), 5e-4);
  for (const Precision precision : kPrecisions) {
    SCOPED_TRACE(name_of(precision));
    const double rounding = precision == Precision::double_precision ? 1e-12 : 1e-4;
    const BodyProblem cpu = first_problem(BackendKind::cpu, scene, precision);
    const BodyProblem cuda = first_problem(BackendKind::cuda, scene, precision);
    EXPECT_EQ(cpu.layout, cuda.layout);
    EXPECT_EQ(cpu.free_count, cuda.free_count);
    EXPECT_EQ(cpu.body_id, cuda.body_id);
    EXPECT_EQ(cpu.friction, cuda.friction);
    ASSERT_EQ(cpu.body_a, cuda.body_a);
    ASSERT_EQ(cpu.body_b, cuda.body_b);
    for (std::size_t c = 0; c < cpu.normal.size(); ++c) {
      EXPECT_LT(norm(cpu.normal[c] - cuda.normal[c]), rounding);
      EXPECT_NEAR(cpu.bias[c], cuda.bias[c], rounding);
    }
    ASSERT_EQ(cpu.body_count(), cuda.body_count());
    for (std::size_t i = 0; i < cpu.free_velocity.size(); ++i)
      EXPECT_LT(norm(cpu.free_velocity[i].linear - cuda.free_velocity[i].linear), rounding);
  }
}

}  // namespace
}  // namespace scree::parity
