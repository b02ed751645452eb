// Drives of joints: ways, energies and their derivatives against turns and differences.

#include <random>

#include "kernels/affine/drive.h"
#include "tests/backend_fixture.h"
#include "tests/kernels/affine/differences.h"

namespace scree::affine {
namespace {

using AffineDriveTest = BackendTest<double>;

/// A body that is turned by an angle about an axis through a point.
AffineVec turned_about(const Vec3d& axis, double angle, const Vec3d& center) {
  const Quat<double> q = exp_map(angle * axis);
  AffineVec out;
  out.node[0] = rotate(q, center);
  for (int k = 0; k < 3; ++k) {
    Vec3d unit;
    unit[k] = 1;
    out.node[k + 1] = rotate(q, unit);
  }
  return out;
}

struct MeasureDrives {
  static constexpr const char* name = "measure_drives";
  Span<const DriveTerm> terms;
  Span<const AffineVec> start, q;
  Span<double> way;
  SCREE_HD void operator()(Index j) const { way[j] = terms[j].way(start, q); }
};

/// A hinge about an oblique axis between two bodies, both turned by several turns, and then by a little more.
TEST_F(AffineDriveTest, PositionsCountTurnsAndWaysAreThoseOfTheStep) {
  const Vec3d axis = normalized(Vec3d{1, -2, 0.5}), across = any_orthogonal(axis);
  DrivenJoint joint;
  joint.body[0] = 0, joint.body[1] = 1;
  for (auto& own : joint.across) own[0] = across, own[1] = cross(axis, across);
  joint.law.friction = 1, joint.law.slip = 1, joint.law.inertia = 1;
  DrivenJoint to_world = joint;
  to_world.body[1] = -1;
  const double first = 1.3, second = 16.1, more_first = 1e-3, more_second = -2e-3;
  const std::vector<AffineVec> start{turned_about(axis, first, {1, 2, 3}),
                                     turned_about(axis, second, {0, 1, 0})};
  const std::vector<AffineVec> end{turned_about(axis, first + more_first, {1, 2, 3}),
                                   turned_about(axis, second + more_second, {0, 1, 0})};
  TestBackend& b = backend();
  Buffer<TestBackend, DrivenJoint> joints(b);
  Buffer<TestBackend, AffineVec> from(b), to(b);
  Buffer<TestBackend, double> position(b), way(b, 2);
  Buffer<TestBackend, DriveTerm> terms(b, 2);
  upload(b, std::vector<DrivenJoint>{joint, to_world}, joints);
  upload(b, start, from);
  upload(b, end, to);
  upload(b, std::vector<double>{14, -2}, position);  // of the turns nearest to these
  for_each(b, 2,
           SetDrives{std::as_const(joints).view(2), std::as_const(from).view(2), 0.01,
                     position.view(), terms.view()});
  for_each(b, 2,
           MeasureDrives{std::as_const(terms).view(2), std::as_const(from).view(2),
                         std::as_const(to).view(2), way.view()});
  const std::vector<double> at = download(b, position.view()), moved = download(b, way.view());
  EXPECT_NEAR(at[0], second - first, 1e-12);
  EXPECT_NEAR(at[1], -first, 1e-12);
  EXPECT_NEAR(moved[0], std::sin(more_second) - std::sin(more_first), 1e-12);
  EXPECT_NEAR(moved[1], -std::sin(more_first), 1e-12);
}

TEST(DriveTermTest, DerivativesAreThoseOfTheEnergy) {
  DriveTerm t;
  t.motor = {0.3, 40, 5};
  t.friction = {0, 100, 2};
  t.lower = -0.4, t.upper = 0.5, t.hard = 1e3;
  DriveTerm loose;  // a motor without a bound, and nothing else
  loose.motor = {0.3, 40, INFINITY};
  DriveTerm forced = t;
  forced.force = 3;
  for (const DriveTerm& each : {t, loose, forced}) {
    double last = -1e300;
    for (const double way : {-0.9, -0.42, -0.2, -0.021, 0.001, 0.04, 0.22, 0.31, 0.44, 0.52, 0.8}) {
      const auto energy = [&](const Eigen::VectorXd& x) { return test::scalar(each.energy(x(0))); };
      const auto slope = [&](const Eigen::VectorXd& x) { return test::scalar(each.first(x(0))); };
      EXPECT_NEAR(test::differences(energy, test::scalar(way), 1e-5)(0, 0), each.first(way), 1e-6)
          << way;
      EXPECT_NEAR(test::differences(slope, test::scalar(way), 1e-5)(0, 0), each.second(way), 1e-5)
          << way;
      EXPECT_GE(each.first(way), last) << "not convex at " << way;
      last = each.first(way);
    }
  }
}

}  // namespace
}  // namespace scree::affine
