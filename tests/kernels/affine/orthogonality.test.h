// The orthogonality energy against differences and Eigen's eigenvectors.

#include <random>

#include "kernels/affine/orthogonality.h"
#include "tests/backend_fixture.h"
#include "tests/kernels/affine/differences.h"

namespace scree::affine {
namespace {

struct RunOrthogonality {
  static constexpr const char* name = "run_orthogonality";
  double stiffness;
  Span<const AffineVec> q;
  Span<double> energy;
  Span<AffineVec> gradient;
  Span<Dense<9>> hessian, projected;
  Span<SignedSvd> svd;
  SCREE_HD void operator()(Index k) const {
    energy[k] = orthogonality_energy(stiffness, q[k]);
    gradient[k] = orthogonality_gradient(stiffness, q[k]);
    hessian[k] = orthogonality_hessian(stiffness, q[k]);
    projected[k] = projected_orthogonality_hessian(stiffness, q[k]);
    svd[k] = signed_svd(q[k]);
  }
};

class OrthogonalityTest : public BackendTest<double> {
 protected:
  static constexpr double kStiffness = 7;
  struct Results {
    std::vector<double> energy;
    std::vector<AffineVec> gradient;
    std::vector<Dense<9>> hessian, projected;
    std::vector<SignedSvd> svd;
  };
  Results run(const std::vector<AffineVec>& q) {
    TestBackend& b = backend();
    const auto n = static_cast<Index>(q.size());
    Buffer<TestBackend, AffineVec> in(b), gradient(b, n);
    Buffer<TestBackend, double> energy(b, n);
    Buffer<TestBackend, Dense<9>> hessian(b, n), projected(b, n);
    Buffer<TestBackend, SignedSvd> svd(b, n);
    upload(b, q, in);
    for_each(b, n,
             RunOrthogonality{kStiffness, std::as_const(in).view(n), energy.view(), gradient.view(),
                              hessian.view(), projected.view(), svd.view()});
    return {download(b, energy.view()), download(b, gradient.view()), download(b, hessian.view()),
            download(b, projected.view()), download(b, svd.view())};
  }
  /// Rotations that are deformed by about `size`.
  static std::vector<AffineVec> samples(int count, double size) {
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    std::vector<AffineVec> r;
    for (int k = 0; k < count; ++k) {
      const Quat<double> turn = exp_map(Vec3d{3 * normal(random), normal(random), normal(random)});
      AffineVec q;
      for (int c = 0; c < 3; ++c) {
        Vec3d axis;
        axis[c] = 1;
        q.node[c + 1] =
            rotate(turn, axis) + size * Vec3d{normal(random), normal(random), normal(random)};
      }
      q.node[0] = {normal(random), normal(random), normal(random)};
      r.push_back(q);
    }
    return r;
  }
};

TEST_F(OrthogonalityTest, DerivativesAreThoseOfTheEnergy) {
  for (const double size : {0.01, 0.3, 1.0}) {
    const std::vector<AffineVec> q = samples(40, size);
    const Results r = run(q);
    for (std::size_t k = 0; k < q.size(); ++k) {
      Eigen::Matrix3d a;
      for (int c = 0; c < 3; ++c)
        a.col(c) << q[k].node[c + 1].x, q[k].node[c + 1].y, q[k].node[c + 1].z;
      const double energy =
          kStiffness * (a * a.transpose() - Eigen::Matrix3d::Identity()).squaredNorm();
      EXPECT_NEAR(r.energy[k], energy, 1e-12 * (1 + energy));
      const Eigen::VectorXd x = test::to_eigen(q[k]), g = test::to_eigen(r.gradient[k]);
      const Eigen::MatrixXd by_energy = test::differences(
          [](const Eigen::VectorXd& y) {
            return test::scalar(orthogonality_energy(kStiffness, test::to_affine(y)));
          },
          x, 1e-3);
      EXPECT_LT(test::relative_error(g, by_energy.transpose()), 1e-7) << k;
      const Eigen::MatrixXd by_gradient = test::differences(
          [](const Eigen::VectorXd& y) {
            return test::to_eigen(orthogonality_gradient(kStiffness, test::to_affine(y)));
          },
          x, 1e-3);
      EXPECT_LT(by_gradient.topRows(3).norm() + by_gradient.leftCols(3).norm(), 1e-12);
      EXPECT_LT(
          test::relative_error(test::to_eigen(r.hessian[k]), by_gradient.bottomRightCorner(9, 9)),
          1e-9)
          << k;
    }
  }
}

/// Rotations, small and large strain, flat, straight, vanished and mirrored bodies.
TEST_F(OrthogonalityTest, TheClosedFormIsTheNearestSemidefiniteMatrix) {
  std::vector<AffineVec> q;
  for (const double size : {0.0, 1e-9, 1e-4, 0.1, 1.0})
    for (const AffineVec& s : samples(30, size)) q.push_back(s);
  for (int kind = 0; kind < 4; ++kind) {
    for (AffineVec s : samples(10, 0.1)) {
      if (kind == 0) s.node[3] = s.node[1] + s.node[2];
      if (kind == 1) s.node[3] = 2.0 * s.node[1], s.node[2] = -0.3 * s.node[1];
      if (kind == 2) s = AffineVec{};
      if (kind == 3) s.node[1] = -s.node[1];
      q.push_back(s);
    }
  }
  const Results r = run(q);
  int lifted = 0;
  for (std::size_t k = 0; k < q.size(); ++k) {
    const Eigen::MatrixXd h = test::to_eigen(r.hessian[k]), p = test::to_eigen(r.projected[k]);
    EXPECT_LT((p - test::semidefinite(h)).norm(), 1e-12 * h.norm()) << k;
    EXPECT_GT(test::lowest_eigenvalue(p), -1e-12 * h.norm()) << k;
    lifted += (p - h).norm() > 1e-3 * h.norm() ? 1 : 0;
    const SignedSvd& d = r.svd[k];
    for (int c = 0; c < 3; ++c) {  // U diag(s) V^T is A, U and V are rotations
      Vec3d column;
      for (int m = 0; m < 3; ++m) column += (d.s[m] * d.v[m][c]) * d.u[m];
      EXPECT_LT(norm(column - q[k].node[c + 1]), 1e-13 * (1 + norm(q[k].node[c + 1])));
      EXPECT_LT(norm(cross(d.u[c], d.u[(c + 1) % 3]) - d.u[(c + 2) % 3]), 1e-13);
      EXPECT_LT(norm(cross(d.v[c], d.v[(c + 1) % 3]) - d.v[(c + 2) % 3]), 1e-13);
    }
  }
  EXPECT_GT(lifted, 40);
}

/// In units of 4 k: the stiffness of a rigid body is 2 against scalings and shears, 0 against turns.
TEST_F(OrthogonalityTest, ARotationHasTheEigenvaluesOfTheTheory) {
  const Results r = run(samples(1, 0.0));
  const Eigen::VectorXd values =
      oracle::eigenvalues(test::to_eigen(r.hessian[0])) / (4 * kStiffness);
  for (int k = 0; k < 9; ++k) EXPECT_NEAR(values(k), k < 3 ? 0 : 2, 1e-13);
  EXPECT_NEAR(r.energy[0], 0, 1e-28);
}

}  // namespace
}  // namespace scree::affine
