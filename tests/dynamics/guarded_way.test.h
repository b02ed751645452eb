// Bodies whose solved velocities lead through a wall stop there with the ball about their center.

#include "kernels/step/guarded_way.h"
#include "tests/backend_fixture.h"
#include "tests/collision/collision_scene.h"

namespace scree {
namespace {

template <class Real>
struct EndOfWay {
  static constexpr const char* name = "end_of_way";
  GuardedWay<Real> way;
  Vec3<Real> velocity;
  Span<Vec3<double>> end;
  Span<Index> stopped;
  SCREE_HD void operator()(Index i) const {
    bool is_stopped = false;
    end[i] = way.end(i, velocity, is_stopped);
    stopped[i] = is_stopped ? 1 : 0;
  }
};

template <class Real>
using GuardedWayTest = BackendTest<Real>;
TYPED_TEST_SUITE(GuardedWayTest, Reals);

TYPED_TEST(GuardedWayTest, StopsASphereAtItsSurfaceAndAPlateAtTheBallInside) {
  using Real = TypeParam;
  constexpr double kHeight = 3e-3, kThin = 5e-4, kRadius = 2e-3;
  MeshSource floor;
  floor.closed = false;
  floor.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  floor.triangles = {{0, 1, 2}, {0, 2, 3}};
  for (const bool has_mesh : {true, false}) {
    CollisionScene<Real> s;
    s.add_free({0.1, 0.2, kHeight}, kRadius);
    s.add_free_box({0.3, -0.2, kHeight}, {0.01, kThin, 0.02});
    if (has_mesh) {
      s.add_mesh_wall({0, 0, 0}, floor);
    } else {
      s.add_box_wall({0, 0, -0.001}, {1, 1, 0.001});
    }
    auto& b = this->backend();
    CollisionRun<TestBackend, Real> run(b, s);
    run.detect();  // walls are where their bodies are
    Buffer<TestBackend, ShapeRecord<Real>> shapes(b);
    upload(b, s.obstacles.shapes, shapes);
    Buffer<TestBackend, Vec3<double>> end(b, 2);
    Buffer<TestBackend, Index> stopped(b, 2);
    const auto ends = [&](double down) {
      GuardedWay<Real> way;
      way.bodies = way.parts = run.bodies();
      way.walls = run.detector().walls();
      way.time_step = s.h;
      way.records = shapes.view();
      const Vec3<Real> velocity{Real(1), 0, static_cast<Real>(-down)};
      for_each(b, 2, EndOfWay<Real>{way, velocity, end.view(), stopped.view()});
      return download(b, end.view());
    };
    const double ball = MiddleContact::kBall * kThin;
    const auto through = ends(20);
    EXPECT_NEAR(through[0].z, kRadius, 1e-8);
    EXPECT_NEAR(through[1].z, ball, 1e-8);
    EXPECT_NEAR(through[1].x, 0.301, 1e-6) << "slides on";
    EXPECT_EQ(download(b, stopped.view()), (std::vector<Index>{1, 1}));
    const auto above = ends(0.5);
    EXPECT_NEAR(above[0].z, kHeight - 5e-4, 1e-8);
    EXPECT_NEAR(above[1].z, kHeight - 5e-4, 1e-8);
    EXPECT_EQ(download(b, stopped.view()), (std::vector<Index>{0, 0}));
  }
}

}  // namespace
}  // namespace scree
