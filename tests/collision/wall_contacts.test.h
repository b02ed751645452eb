#pragma once
// Contacts of spheres and boxes with walls of each kind.

#include <cmath>

#include "shapes/container.h"
#include "tests/backend_fixture.h"
#include "tests/collision/collision_scene.h"

namespace scree {
namespace {

template <class Real>
class WallTest : public BackendTest<Real> {
 protected:
  std::vector<HostContact> contacts(const CollisionScene<Real>& scene) {
    CollisionRun<TestBackend, Real> run(this->backend(), scene);
    return run.detect();
  }
  static void expect_near(const Vec3<double>& a, const Vec3<double>& b) {
    const double t = BackendTest<Real>::tolerance(1e-12, 1e-6);
    EXPECT_NEAR(a.x, b.x, t);
    EXPECT_NEAR(a.y, b.y, t);
    EXPECT_NEAR(a.z, b.z, t);
  }
  static constexpr double kEps = std::is_same_v<Real, float> ? 1e-6 : 1e-12;
};
TYPED_TEST_SUITE(WallTest, Reals);

TYPED_TEST(WallTest, SphereOnHalfSpace) {
  CollisionScene<TypeParam> s;
  s.settings.envelope = 0.01;
  s.add_free({3, 4, 0.505}, 0.5);
  s.add_free({3, 6, 0.52}, 0.5);
  const Index wall = s.add_half_space({0, 0, 0}, {0, 0, 1});
  const auto c = this->contacts(s);
  ASSERT_EQ(c.size(), 1u);
  EXPECT_EQ(c[0].a, 0);
  EXPECT_EQ(c[0].b, wall);
  EXPECT_NEAR(c[0].gap, 0.005, this->kEps);
  this->expect_near(c[0].normal, {0, 0, -1});
  this->expect_near(c[0].arm_a, {0, 0, -0.5});
  this->expect_near(c[0].arm_b, {3, 4, 0});
}

TYPED_TEST(WallTest, SphereTouchesAsManyBoxesAsThereAre) {
  CollisionScene<TypeParam> s;
  s.settings.envelope = 0.01;
  s.add_free({0, 0, 0}, 0.5);
  s.add_free({5, 0, 0}, 0.5);  // touches none
  s.add_free({0.999, 0, 0}, 0.5);
  constexpr int kBoxes = 14;
  std::vector<Index> walls;
  std::vector<Vec3<double>> toward;
  for (int k = 0; k < kBoxes; ++k) {  // their corners and faces around the first one
    const double z = 0.9 - 1.8 * k / (kBoxes - 1), ring = std::sqrt(1 - z * z);
    toward.push_back({-ring * std::abs(std::cos(2.4 * k)), ring * std::sin(2.4 * k), z});
    const Vec3<double> touched = 0.505 * toward.back();
    Vec3<double> half{0.05, 0.05, 0.05}, center = touched;
    for (int axis = 0; axis < 3; ++axis)
      center[axis] += toward.back()[axis] < 0 ? -half[axis] : half[axis];
    walls.push_back(s.add_box_wall(center, half));
  }
  const auto c = this->contacts(s);
  ASSERT_EQ(c.size(), std::size_t{1 + kBoxes});
  std::size_t found = 0;
  for (const HostContact& contact : c) {
    EXPECT_EQ(contact.a, 0);
    if (contact.b == 2) continue;
    ASSERT_LT(found, walls.size());
    EXPECT_EQ(contact.b, walls[found]);
    EXPECT_NEAR(contact.gap, 0.005, this->kEps);
    this->expect_near(contact.normal, toward[found]);
    this->expect_near(contact.arm_a, 0.5 * toward[found]);
    ++found;
  }
}

TYPED_TEST(WallTest, FastSphereIsListedAheadOfTheWall) {
  CollisionScene<TypeParam> s;
  s.h = 0.1;
  s.add_free({0, 0, 3}, 0.5, {0, 0, -26});  // passes the plane within the step
  s.add_free({0, 2, 3}, 0.5, {0, 0, -24});
  s.add_free({0, 4, 3}, 0.5, {0, 0, 26});
  s.add_half_space({0, 0, 0}, {0, 0, 1});
  const auto c = this->contacts(s);
  ASSERT_EQ(c.size(), 1u);
  EXPECT_EQ(c[0].a, 0);
}

TYPED_TEST(WallTest, SphereThatFallsOntoAWallWithinTheStepIsListed) {
  CollisionScene<TypeParam> s;
  s.h = 0.1;
  s.gravity = {0, 0, -10};  // 0.1 m in a step
  s.add_free({0, 0, 1.59}, 0.5);
  s.add_free({0, 1.2, 1.61}, 0.5);
  s.add_free({0, -1.2, 1.55}, 0.5);
  s.locks = {0, 0, 1 << 2};  // the last one is held up
  const auto only_first = [&] {
    const auto c = this->contacts(s);
    EXPECT_EQ(c.size(), 1u);
    for (const auto& contact : c) EXPECT_EQ(contact.a, 0);
  };
  s.settings.envelope = 0;
  s.add_half_space({0, 0, 1}, {0, 0, 1});
  only_first();
  s.position.back().z = 0.9;
  s.velocity.back() = {0, 0, 1};  // meets it half way
  only_first();
  s = {};
  s.h = 0.1;
  s.gravity = {0, 0, -10};
  s.add_free({0, 0, 1.59}, 0.5);
  s.add_free({0, 1.2, 1.61}, 0.5);
  const auto with_wall = s;
  s.add_box_wall({0, 0, 0.5}, {3, 3, 0.5});
  only_first();
  s = with_wall;
  s.add_mesh_wall({0, 0, 1}, flat_floor(4, 1));
  only_first();
}

TYPED_TEST(WallTest, MovingAndTurningWallComesToTheSphere) {
  CollisionScene<TypeParam> s;
  s.h = 0.1;
  s.add_free({2, 0, 1}, 0.5);
  s.add_half_space({0, 0, 0}, {0, 0, 1});
  EXPECT_EQ(this->contacts(s).size(), 0u);
  s.velocity.back() = {0, 0, 6};
  EXPECT_EQ(this->contacts(s).size(), 1u);
  s.velocity.back() = {};
  s.angular_velocity.back() = {0, -3, 0};  // rises at 6 m/s at x = 2
  EXPECT_EQ(this->contacts(s).size(), 1u);
  s.angular_velocity.back() = {0, 3, 0};
  EXPECT_EQ(this->contacts(s).size(), 0u);
}

TYPED_TEST(WallTest, ContainerHoldsFromInsideAndOpenFacesAreMissing) {
  CollisionScene<TypeParam> s;
  s.add_free({0.9, 1.9, 2.9}, 0.2);  // corner +x +y +z
  s.add_free({-0.9, 0, 0}, 0.2);     // face -x
  s.add_free({0, 0, 0}, 0.2);        // touches nothing
  const Index wall = s.add_container({0, 0, 0}, {1, 2, 3});
  auto c = this->contacts(s);
  ASSERT_EQ(c.size(), 4u);
  this->expect_near(c[0].normal, {1, 0, 0});
  this->expect_near(c[1].normal, {0, 1, 0});
  this->expect_near(c[2].normal, {0, 0, 1});
  this->expect_near(c[3].normal, {-1, 0, 0});
  for (const auto& contact : c) {
    EXPECT_EQ(contact.b, wall);
    EXPECT_NEAR(contact.gap, -0.1, this->kEps);
  }
  s.obstacles.shapes.back().open_faces = 1 << 5;  // +z
  EXPECT_EQ(this->contacts(s).size(), 3u);
}

TYPED_TEST(WallTest, ContainerTurnsWithItsBody) {
  CollisionScene<TypeParam> s;
  const Quat<double> q = exp_map(Vec3<double>{0.4, 0.2, -0.7});
  const Vec3<double> center{5, -3, 1};
  s.add_free(center + rotate(q, Vec3<double>{0.85, 0.1, 0.2}), 0.2);
  s.add_container(center, {1, 2, 3});
  s.orientation.back() = Quat<TypeParam>(q);
  const auto c = this->contacts(s);
  ASSERT_EQ(c.size(), 1u);
  EXPECT_NEAR(c[0].gap, -0.05, 4 * this->kEps);
  this->expect_near(c[0].normal, rotate(q, Vec3<double>{1, 0, 0}));
}

TYPED_TEST(WallTest, BoxOnHalfSpaceHasFourCorners) {
  CollisionScene<TypeParam> s;
  s.settings.envelope = 1e-3;
  s.add_free_box({0, 0, 0.5}, {0.4, 0.3, 0.5});
  s.add_half_space({0, 0, 0}, {0, 0, 1});
  const auto c = this->contacts(s);
  ASSERT_EQ(c.size(), 4u);
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(c[k].gap, 0, this->kEps);
    this->expect_near(c[k].arm_a, {k & 1 ? 0.4 : -0.4, k & 2 ? 0.3 : -0.3, -0.5});
  }
}

TYPED_TEST(WallTest, SpinningBoxCornerIsListedAhead) {
  CollisionScene<TypeParam> s;
  s.h = 0.01;
  s.add_free_box({0, 0, 0.55}, {0.5, 0.5, 0.5});
  s.add_half_space({0, 0, 0}, {0, 0, 1});
  EXPECT_EQ(this->contacts(s).size(), 0u);
  s.angular_velocity[0] = {0, 12, 0};  // the corners at +x sink at 6 m/s
  EXPECT_EQ(this->contacts(s).size(), 2u);
}

TYPED_TEST(WallTest, BoxInContainerCorner) {
  CollisionScene<TypeParam> s;
  s.add_free_box({-0.51, -0.51, -0.51}, {0.5, 0.5, 0.5});
  s.add_container({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(this->contacts(s).size(), 12u) << "four corners on each of three faces";
}

TYPED_TEST(WallTest, SphereOnBoxWall) {
  CollisionScene<TypeParam> s;
  s.settings.envelope = 0.2;
  s.add_free({1.6, 0, 0}, 0.5);
  s.add_free({1.5, 2.5, 0}, 0.6);
  s.add_free({9, 9, 9}, 0.5);
  const Index wall = s.add_box_wall({0, 0, 0}, {1, 2, 3});
  const auto c = this->contacts(s);
  ASSERT_EQ(c.size(), 2u);
  EXPECT_EQ(c[0].b, wall);
  EXPECT_NEAR(c[0].gap, 0.1, this->kEps);
  EXPECT_NEAR(c[1].gap, std::sqrt(0.5) - 0.6, this->kEps);
  this->expect_near(c[1].arm_b, {1, 2, 0});
}

TYPED_TEST(WallTest, SpheresAroundAFreeBox) {
  for (const bool box_first : {true, false}) {
    CollisionScene<TypeParam> s;
    const auto box = [&] { s.add_free_box({0, 0, 0}, {0.5, 0.5, 0.5}); };
    if (box_first) box();
    s.add_free({0.65, 0, 0}, 0.2);
    s.add_free({0, -0.65, 0.3}, 0.2);
    s.add_free({0.65, 0.65, 0.65}, 0.2);  // inside the bounding sphere, off the corner
    if (!box_first) box();
    s.add({0, 0, 0.9}, 0.45);  // a fixed sphere
    const auto c = this->contacts(s);
    ASSERT_EQ(c.size(), 3u);
    double sign = 0;
    for (const auto& contact : c) {
      EXPECT_NEAR(contact.gap, -0.05, this->kEps);
      const Vec3<double> toward = s.position[contact.b] - s.position[contact.a];
      sign += dot(contact.normal, toward) > 0;
    }
    EXPECT_EQ(sign, 3) << "normals point from A to B";
  }
}

TYPED_TEST(WallTest, BoxesHaveFourContactsWithEachOtherAndWithBoxWalls) {
  CollisionScene<TypeParam> s;
  s.settings.envelope = 1e-3;
  s.add_free_box({0, 0, 0.5}, {0.4, 0.3, 0.5});
  s.add_free_box({0.1, 0.1, 1.5}, {0.4, 0.3, 0.5});
  const Index wall = s.add_box_wall({0, 0, -2}, {5, 5, 2});
  const auto c = this->contacts(s);
  ASSERT_EQ(c.size(), 8u);
  for (std::size_t k = 0; k < 8; ++k) {
    const bool is_upper = k < 4;
    EXPECT_EQ(c[k].a, 0);
    EXPECT_EQ(c[k].b, is_upper ? 1 : wall);
    EXPECT_NEAR(c[k].gap, 0, this->kEps);
    this->expect_near(c[k].normal, {0, 0, is_upper ? 1.0 : -1.0});
    EXPECT_NEAR(std::abs(c[k].arm_a.z), 0.5, this->kEps);
    if (k > 0) {
      EXPECT_LT(c[k - 1].key, c[k].key);
    }
  }
}

TYPED_TEST(WallTest, AKindThatCannotBeFreeIsRefused) {
  CollisionScene<TypeParam> s;
  s.add_free_box({0, 0, 0}, {1, 1, 1});
  s.obstacles.shapes.back().kind = shapes::Container::kind;
  EXPECT_THROW(this->contacts(s), std::runtime_error);
}

TYPED_TEST(WallTest, RadialLayoutStoresNoArms) {
  CollisionScene<TypeParam> s;
  s.settings.layout = ContactLayout::radial;
  s.add_free({0, 0, 0.4}, 0.5);
  s.add_half_space({0, 0, 0}, {0, 0, 1});
  CollisionRun<TestBackend, TypeParam> run(this->backend(), s);
  EXPECT_EQ(run.detect().size(), 1u);
  EXPECT_TRUE(run.detector().contacts().arm_a.empty());
  EXPECT_TRUE(run.detector().contacts().arm_b.empty());
}

TYPED_TEST(WallTest, BodiesOutsideTheCountAreNotSeen) {
  CollisionScene<TypeParam> s;
  s.add_free({0, 0, 0.4}, 0.5);
  s.add_half_space({0, 0, 0}, {0, 0, 1});
  s.owned_count = 0;
  CollisionRun<TestBackend, TypeParam> run(this->backend(), s);
  auto view = run.bodies();
  view.fixed_begin = 1;
  run.detector().detect(this->backend(), view, 1e-3, {});
  EXPECT_EQ(run.detector().contacts().count, 0);
  view.owned_count = view.moving_count = 1;
  run.detector().detect(this->backend(), view, 1e-3, {});
  EXPECT_EQ(run.detector().contacts().count, 1);
}

}  // namespace
}  // namespace scree
