// Corners of convex bodies in valleys and pits of triangle meshes: a little below the surface they lie over no triangle.

#include <cmath>

#include "tests/backend_fixture.h"
#include "tests/collision/collision_scene.h"

namespace scree {
namespace {

template <class Real>
class ConvexOnMeshTest : public BackendTest<Real> {
 protected:
  static constexpr double kSlope = 0.3, kDepth = 1e-4;
  static constexpr double kEps = std::is_same_v<Real, float> ? 2e-6 : 1e-9;

  /// z = slope |x|.
  static MeshSource valley() {
    MeshSource m;
    m.closed = false;
    m.vertices = {{-1, -1, kSlope}, {-1, 1, kSlope}, {0, -1, 0},
                  {0, 1, 0},        {1, -1, kSlope}, {1, 1, kSlope}};
    m.triangles = {{0, 2, 3}, {0, 3, 1}, {2, 4, 5}, {2, 5, 3}};
    return m;
  }
  /// z = slope max(|x|, |y|).
  static MeshSource pit() {
    MeshSource m;
    m.closed = false;
    m.vertices = {{-1, -1, kSlope}, {1, -1, kSlope}, {1, 1, kSlope}, {-1, 1, kSlope}, {0, 0, 0}};
    m.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
    return m;
  }
  /// Contacts of a cube that stands on a corner with a mesh. @param tip  where that corner is [m]
  std::vector<HostContact> contacts(const MeshSource& mesh, const Vec3<double>& tip, double turn) {
    const double half = 0.1;
    CollisionScene<Real> s;
    s.settings.envelope = 1e-3;
    const Vec3<double> down = normalized(Vec3<double>{-1, -1, -1});
    const Vec3<double> axis = normalized(cross(down, Vec3<double>{0, 0, -1}));
    const Quat<double> upright = exp_map(std::acos(-down.z) * axis);
    const Quat<double> q = exp_map(Vec3<double>{0, 0, turn}) * upright;
    s.add_free_box(tip + Vec3<double>{0, 0, half * std::sqrt(3.0)}, {half, half, half},
                   Quat<Real>(q));
    s.add_mesh_wall({0, 0, 0}, mesh);
    CollisionRun<TestBackend, Real> run(this->backend(), s);
    return run.detect();
  }
  /// How many of them are on a plane through the origin and hold the tip.
  int count_on(const std::vector<HostContact>& contacts, const Vec3<double>& normal,
               const Vec3<double>& tip) {
    int count = 0;
    for (const HostContact& c : contacts) {
      if (norm(c.normal + normal) > kEps) continue;
      EXPECT_NEAR(c.gap, dot(normal, tip), kEps);
      EXPECT_NEAR(norm(c.arm_a), 0.1 * std::sqrt(3.0), kEps) << "the corner";
      ++count;
    }
    return count;
  }
};
TYPED_TEST_SUITE(ConvexOnMeshTest, Reals);

TYPED_TEST(ConvexOnMeshTest, BothSidesOfAValleyHoldACornerBelowIt) {
  const double slope = this->kSlope, depth = this->kDepth;
  for (const double aside : {0.0, 0.5, -0.5, 0.9, -0.9}) {
    for (const double turn : {0.1, 1.3, 2.9}) {
      // Over no triangle: the bottom of the valley is nearer than any.
      const Vec3<double> tip{aside * slope * depth, 0.21, -depth};
      SCOPED_TRACE(testing::Message() << "aside " << aside << " turn " << turn);
      const auto c = this->contacts(this->valley(), tip, turn);
      EXPECT_EQ(this->count_on(c, normalized(Vec3<double>{slope, 0, 1}), tip), 1);
      EXPECT_EQ(this->count_on(c, normalized(Vec3<double>{-slope, 0, 1}), tip), 1);
      EXPECT_EQ(c.size(), 2u);
    }
  }
}

TYPED_TEST(ConvexOnMeshTest, AllSidesOfAPitHoldACornerBelowIt) {
  const double slope = this->kSlope, depth = this->kDepth;
  for (const double turn : {0.1, 1.3, 2.9}) {
    SCOPED_TRACE(testing::Message() << "turn " << turn);
    const Vec3<double> tip{0.3 * slope * depth, -0.2 * slope * depth, -depth};
    const auto c = this->contacts(this->pit(), tip, turn);
    for (const Vec3<double>& up : {Vec3<double>{slope, 0, 1}, Vec3<double>{-slope, 0, 1},
                                   Vec3<double>{0, slope, 1}, Vec3<double>{0, -slope, 1}})
      EXPECT_EQ(this->count_on(c, normalized(up), tip), 1) << up.x << " " << up.y;
    EXPECT_EQ(c.size(), 4u);
  }
}

// It leans over the bottom of the valley: its middle is over one side, its tip came through the other one. The nearest way out
// of that leads past the bottom.
TYPED_TEST(ConvexOnMeshTest, TheSideThatANeedleWentThroughHoldsItsTip) {
  using Real = TypeParam;
  const double slope = this->kSlope, inside = 6e-3, x = 5e-4, lean = std::atan(1.0);
  const Vec3<double> half{2.5e-4, 2.5e-4, 2e-2};
  for (const double side : {-1.0, 1.0}) {
    const Quat<double> q = exp_map(Vec3<double>{0, -side * lean, 0});
    const Vec3<double> through{side * x, 0.21, slope * x};
    const Vec3<double> center = through + rotate(q, Vec3<double>{0, 0, half.z - inside});
    CollisionScene<Real> s;
    s.settings.envelope = 1e-3;
    s.add_free_box(center, half, Quat<Real>(q));
    s.add_mesh_wall({0, 0, 0}, this->valley());
    CollisionRun<TestBackend, Real> run(this->backend(), s);
    const Vec3<double> up = normalized(Vec3<double>{-side * slope, 0, 1});
    double lowest = 0, deepest = 0;
    for (const double corner : {-half.x, half.x})
      lowest = std::min(lowest, dot(center + rotate(q, Vec3<double>{corner, half.y, -half.z}), up));
    ASSERT_LT(lowest, -5e-3);
    for (const HostContact& c : run.detect())
      if (norm(c.normal + up) < this->kEps) deepest = std::min(deepest, c.gap);
    EXPECT_NEAR(deepest, lowest, this->kEps) << side;
  }
}

TYPED_TEST(ConvexOnMeshTest, ACornerOverAValleyMeetsBothSidesOnce) {
  const Vec3<double> tip{0, 0.21, this->kDepth};
  EXPECT_EQ(this->contacts(this->valley(), tip, 0.1).size(), 2u);
}

}  // namespace
}  // namespace scree
