// The variational model on both backends.

#include "host/state_hash.h"
#include "tests/dynamics/variational_scenes.h"
#include "tests/parity/parity.h"

namespace scree::parity {
namespace {

class ParityVariational : public Parity {};

/// A gas in a room with a box, a ball and a mesh in it: all kinds of impacts.
Scene gas_among_walls() {
  Scene scene = test::gas(8, 0.1, 0.02, 1);
  scene.periodicity.periodic = {true, true, false};
  scene.gravity = {0, 0, -0.5};
  const double edge = scene.periodicity.upper.z;
  std::erase_if(scene.bodies, [&](const BodyDescription& body) {
    const Vec3d d = body.position - 0.5 * scene.periodicity.upper;
    return norm(d) < 4 || body.position.z < 0.6 || body.position.z > edge - 0.6;
  });
  const Vec3d middle = 0.5 * scene.periodicity.upper;
  add_plane(scene);
  add_plane(scene, {0, 0, -1}, {0, 0, edge});
  add_wall_box(scene, middle + Vec3d{1, 1, 0}, {0.8, 0.6, 0.4});
  BodyDescription& ball = add_sphere(scene, middle - Vec3d{1.2, 1.2, 0}, 0.7, 1);
  ball.kind = BodyKind::fixed;
  ball.mass = 0;
  ball.inertia = {};
  TriangleMesh roof;
  roof.name = "roof";
  roof.closed = false;
  for (const Vec3d& v : {Vec3d{-1, -1, 1.5}, {1, -1, 1.5}, {1, 1, 1.5}, {-1, 1, 1.5}, {0, 0, 2.5}})
    roof.vertices.push_back(middle + v);
  roof.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  add_mesh(scene, roof);
  return scene;
}

/// Multiplications and additions are fused on one and not on the other, and impacts double what that makes every
/// collision or so: after half a collision a body little of it is left.
TEST_F(ParityVariational, BackendsAgreeUntilChaosTellsThemApart) {
  const Scene scene = gas_among_walls();
  World cpu = world_on(BackendKind::cpu, scene), cuda = world_on(BackendKind::cuda, scene);
  double hits = 0;
  for (int k = 0; k < 60; ++k) {
    const StepReport a = cpu.step(), b = cuda.step();
    hits += a.own[test::impacts];
    ASSERT_EQ(a.own[test::impacts], b.own[test::impacts]) << k;
    ASSERT_NEAR(a.own[test::energy], b.own[test::energy], 1e-9 * std::abs(a.own[test::energy]))
        << k;
    ASSERT_LT(b.max_penetration, 1e-11);
  }
  EXPECT_GT(hits, 150);
  const BodyStates a = cpu.states(), b = cuda.states();
  for (std::size_t i = 0; i < a.position.size(); ++i)
    ASSERT_LT(norm(a.velocity[i] - b.velocity[i]), 1e-6) << "body " << i;
}

TEST_F(ParityVariational, CudaGivesEqualBitsOnEveryRun) {
  const Scene scene = test::gas(16, 0.25, 0.05, 0.95);
  World first = world_on(BackendKind::cuda, scene), second = world_on(BackendKind::cuda, scene);
  for (int k = 0; k < 100; ++k) {
    const StepReport a = first.step(), b = second.step();
    ASSERT_EQ(a.own, b.own) << k;
  }
  EXPECT_EQ(state_hash(first.states()), state_hash(second.states()));
}

TEST_F(ParityVariational, ACheckpointOfOneBackendGoesOnOnTheOther) {
  const Scene scene = test::gas(8, 0.1, 0.02, 1);
  World cuda = world_on(BackendKind::cuda, scene), cpu = world_on(BackendKind::cpu, scene);
  StepReport last;
  for (int k = 0; k < 70; ++k) last = cuda.step();
  cpu.restore(cuda.save());
  const StepReport next = cpu.step();
  EXPECT_NEAR(next.own[test::energy], last.own[test::energy], 1e-11 * last.own[test::energy]);
  EXPECT_EQ(next.step, last.step + 1);
}

}  // namespace
}  // namespace scree::parity
