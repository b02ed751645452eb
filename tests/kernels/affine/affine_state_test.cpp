// Mass and coordinates of affine bodies against closed forms (case A83).
#include "kernels/affine/affine_state.h"

#include <gtest/gtest.h>

#include <random>

#include "kernels/affine/inertial_target.h"
#include "shapes/sphere.h"
#include "tests/box_mesh.h"
#include "tests/kernels/affine/differences.h"

namespace scree::affine {
namespace {

using scree::test::box_mesh;

Eigen::Matrix3d second_of(const AffineMass& m) {
  const Sym3<double>& s = m.second;
  Eigen::Matrix3d r;
  r << s.xx, s.xy, s.xz, s.xy, s.yy, s.yz, s.xz, s.yz, s.zz;
  return r;
}

TEST(AffineMassTest, A83BoxWhereverItIs) {
  for (const double place : {0.0, 1e3}) {
    const SolidMoments moments = moments_of(box_mesh({0.5, 1, 1.5}, {place, -place, 2 * place}));
    const AffineMass m = affine_mass(moments, 200);
    EXPECT_NEAR(m.mass, 200 * 6, 1e-12 * 1200);
    const Eigen::Vector3d expected = 1200.0 / 12 * Eigen::Vector3d(1, 4, 9);
    EXPECT_LT((second_of(m) - expected.asDiagonal().toDenseMatrix()).norm(),
              1e-12 * expected.norm());
    EXPECT_NEAR(moments.center.x, place, 1e-12 * (1 + place));
  }
}

/// The tetrahedron of the corners 0, a, b, c has the second moment V / 20 (sum + own products).
TEST(AffineMassTest, A83Tetrahedron) {
  const Eigen::Vector3d a(2, 0, 0), b(0, 3, 0), c(0.5, 0, 1);
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {0.5, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  const AffineMass m = affine_mass(moments_of(mesh), 7);
  EXPECT_NEAR(m.mass, 7, 1e-13);
  // About the center, by the corners: S = m / 20 (sum of corner corner^T) of centered corners.
  const Eigen::Vector3d center = (a + b + c) / 4;
  Eigen::Matrix3d s = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& x : {Eigen::Vector3d(0, 0, 0), a, b, c})
    s += 7.0 / 20 * (x - center) * (x - center).transpose();
  EXPECT_LT((second_of(m) - s).norm(), 1e-12 * s.norm());
}

TEST(AffineMassTest, A83SphereByItsMomentsOfInertia) {
  Shape shape;
  shape.radius = 0.3;
  const MassProperties ball = shapes::Sphere::mass(shape, 1000);
  const AffineMass m = affine_mass(ball.mass, ball.inertia);
  const Eigen::Matrix3d expected = 0.2 * ball.mass * 0.09 * Eigen::Matrix3d::Identity();
  EXPECT_LT((second_of(m) - expected).norm(), 1e-14);
  EXPECT_NEAR(m.inertia().xx, ball.inertia.x, 1e-14);
  EXPECT_NEAR(m.inertia().yy, ball.inertia.y, 1e-14);
}

/// The kinetic energy of a turning body is that of a rigid one, M^-1 undoes M, and both are what
/// the dense matrix of integrals is.
TEST(AffineMassTest, ProductsAreThoseOfTheDenseMatrix) {
  const AffineMass m = affine_mass(moments_of(box_mesh({0.5, 1, 1.5}, {})), 200);
  AffineMass turned = m;
  turned.second =
      rotated_diagonal(exp_map(Vec3d{0.3, 0.5, -1}), Vec3d{m.second.xx, m.second.yy, m.second.zz});
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  Eigen::VectorXd v(12);
  for (int i = 0; i < 12; ++i) v(i) = normal(random);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(12, 12);
  const Eigen::Matrix3d s = second_of(turned), one = Eigen::Matrix3d::Identity();
  dense.topLeftCorner(3, 3) = turned.mass * one;
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < 3; ++l) dense.block(3 + 3 * k, 3 + 3 * l, 3, 3) = s(k, l) * one;
  const AffineVec q = test::to_affine(v);
  EXPECT_LT((test::to_eigen(turned.product(q)) - dense * v).norm(), 1e-12 * (dense * v).norm());
  EXPECT_LT((test::to_eigen(turned.solve(turned.product(q))) - v).norm(), 1e-12);

  AffineVec turning;
  const Vec3d w{1, -2, 0.5};
  for (int k = 0; k < 3; ++k) {
    Vec3d axis;
    axis[k] = 1;
    turning.node[k + 1] = cross(w, axis);
  }
  EXPECT_NEAR(dot(turning, turned.product(turning)), dot(w, turned.inertia() * w), 1e-10);
}

TEST(AffineForceTest, ForcesAndTorquesDoTheWorkTheyShould) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  const auto vector = [&] { return Vec3d{normal(random), normal(random), normal(random)}; };
  AffineVec q, v;
  for (int k = 0; k < 4; ++k) q.node[k] = vector(), v.node[k] = vector();
  const Vec3d rest = vector(), force = vector(), torque = vector(), w = vector();
  AffineVec f;
  add_force(f, rest, force);
  EXPECT_NEAR(dot(f, v), dot(force, point_of(v, rest)), 1e-13);
  // A torque: its power on a rotation of the body, as deformed as it is, and none on a stretch.
  const AffineVec t = torque_force(q, torque);
  AffineVec turning, stretching;
  Eigen::Matrix3d symmetric = Eigen::Matrix3d::Random();
  symmetric += symmetric.transpose().eval();
  for (int k = 1; k < 4; ++k) {
    turning.node[k] = cross(w, q.node[k]);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) stretching.node[k][i] += symmetric(i, j) * q.node[k][j];
  }
  EXPECT_NEAR(dot(t, turning), dot(torque, w), 1e-12);
  EXPECT_NEAR(dot(t, stretching), 0, 1e-12);
}

// Motion of constant acceleration, from one step to the next of any length.
TEST(StepSchemeTest, Bdf2IsExactForParabolasWhateverTheStepBefore) {
  AffineMass mass;
  mass.mass = 2, mass.second = {1, 1, 1, 0, 0, 0};
  const Vec3d x{1, -2, 3}, v{0.5, 4, -1}, a{3, -7, 2};
  for (const double ratio : {0.25, 1.0, 2.0}) {
    StepScheme scheme{StepRule::bdf2, true, 0.1, a, ratio};
    const double h = scheme.h, earlier = h / ratio;
    StepStart s;
    s.q.node[0] = x, s.v.node[0] = v;
    s.earlier_q.node[0] = x - earlier * v + (0.5 * earlier * earlier) * a;
    s.earlier_v.node[0] = v - earlier * a;
    const InertialTarget t = inertial_target(scheme, mass, s, {}, {});
    EXPECT_LT(norm(t.q.node[0] - (x + h * v + (0.5 * h * h) * a)), 1e-14) << ratio;
    EXPECT_LT(norm(velocity_after(scheme, s, t, t.q).node[0] - (v + h * a)), 1e-13) << ratio;
  }
}

}  // namespace
}  // namespace scree::affine
