// The neo-Hookean energy against differences, and its semidefinite matrix against Eigen's eigenvectors.

#include <random>

#include "kernels/affine/neo_hookean.h"
#include "tests/backend_fixture.h"
#include "tests/kernels/affine/differences.h"

namespace scree::affine {
namespace {

struct RunNeoHookean {
  static constexpr const char* name = "run_neo_hookean";
  Lame lame;
  Span<const AffineVec> q;
  Span<double> energy;
  Span<AffineVec> gradient;
  Span<Dense<9>> projected;
  SCREE_HD void operator()(Index k) const {
    energy[k] = neo_hookean_energy(lame, q[k]);
    gradient[k] = neo_hookean_gradient(lame, q[k]);
    projected[k] = projected_neo_hookean_hessian(lame, q[k]);
  }
};

class NeoHookeanTest : public BackendTest<double> {
 protected:
  static constexpr Lame kLame{3, 5};
  struct Results {
    std::vector<double> energy;
    std::vector<AffineVec> gradient;
    std::vector<Dense<9>> projected;
  };
  Results run(const std::vector<AffineVec>& q) {
    TestBackend& b = backend();
    const auto n = static_cast<Index>(q.size());
    Buffer<TestBackend, AffineVec> in(b), gradient(b, n);
    Buffer<TestBackend, double> energy(b, n);
    Buffer<TestBackend, Dense<9>> projected(b, n);
    upload(b, q, in);
    for_each(b, n,
             RunNeoHookean{kLame, std::as_const(in).view(n), energy.view(), gradient.view(),
                           projected.view()});
    return {download(b, energy.view()), download(b, gradient.view()),
            download(b, projected.view())};
  }
  /// Rotations with stretches between e^-size and e^size along other axes.
  static std::vector<AffineVec> samples(int count, double size) {
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(-size, size);
    const auto turn = [&] {
      return exp_map(Vec3d{2 * normal(random), normal(random), normal(random)});
    };
    std::vector<AffineVec> r;
    for (int k = 0; k < count; ++k) {
      const Quat<double> from = turn(), to = turn();
      const Vec3d stretch{std::exp(uniform(random)), std::exp(uniform(random)),
                          std::exp(uniform(random))};
      AffineVec q;
      for (int c = 0; c < 3; ++c) {
        Vec3d axis;
        axis[c] = 1;
        Vec3d x = rotate(from, axis);
        for (int i = 0; i < 3; ++i) x[i] *= stretch[i];
        q.node[c + 1] = rotate(to, x);
      }
      q.node[0] = {normal(random), normal(random), normal(random)};
      r.push_back(q);
    }
    return r;
  }
};

TEST_F(NeoHookeanTest, DerivativesAreThoseOfTheEnergy) {
  int lifted = 0;
  for (const double size : {0.0, 0.1, 1.0}) {
    const std::vector<AffineVec> q = samples(30, size);
    const Results r = run(q);
    for (std::size_t k = 0; k < q.size(); ++k) {
      Eigen::Matrix3d a;
      for (int c = 0; c < 3; ++c)
        a.col(c) << q[k].node[c + 1].x, q[k].node[c + 1].y, q[k].node[c + 1].z;
      const double log_j = std::log(a.determinant());
      const double energy = 0.5 * kLame.shear * (a.squaredNorm() - 3) - kLame.shear * log_j +
                            0.5 * kLame.volume * log_j * log_j;
      EXPECT_NEAR(r.energy[k], energy, 1e-13 * (1 + energy));
      const Eigen::VectorXd x = test::to_eigen(q[k]), g = test::to_eigen(r.gradient[k]);
      const Eigen::MatrixXd by_energy = test::differences(
          [](const Eigen::VectorXd& y) {
            return test::scalar(neo_hookean_energy(kLame, test::to_affine(y)));
          },
          x, 1e-3);
      EXPECT_LT((g - by_energy.transpose()).norm(), 1e-7 * (1 + g.norm())) << k;
      const Eigen::MatrixXd by_gradient = test::differences(
          [](const Eigen::VectorXd& y) {
            return test::to_eigen(neo_hookean_gradient(kLame, test::to_affine(y)));
          },
          x, 1e-3);
      EXPECT_LT(by_gradient.topRows(3).norm() + by_gradient.leftCols(3).norm(), 1e-12);
      const Eigen::MatrixXd exact = by_gradient.bottomRightCorner(9, 9);
      const Eigen::MatrixXd projected = test::to_eigen(r.projected[k]);
      EXPECT_LT((projected - test::semidefinite(exact)).norm(), 1e-6 * exact.norm()) << k;
      EXPECT_GT(test::lowest_eigenvalue(projected), -1e-12 * exact.norm()) << k;
      lifted += test::lowest_eigenvalue(exact) < -1e-3 * exact.norm() ? 1 : 0;
    }
  }
  EXPECT_GT(lifted, 5);
}

/// At rest: no force, no stiffness against turns, 2 mu against shears, 2 mu + 3 lambda against a change of volume.
TEST_F(NeoHookeanTest, IsHookesLawWhereStrainIsLittle) {
  const Results r = run(samples(1, 0.0));
  EXPECT_NEAR(r.energy[0], 0, 1e-15);
  EXPECT_LT(test::to_eigen(r.gradient[0]).norm(), 1e-13);
  const Eigen::VectorXd values = oracle::eigenvalues(test::to_eigen(r.projected[0]));
  for (int k = 0; k < 9; ++k)
    EXPECT_NEAR(values(k),
                k < 3   ? 0
                : k < 8 ? 2 * kLame.shear
                        : 2 * kLame.shear + 3 * kLame.volume,
                1e-13);
}

TEST_F(NeoHookeanTest, FlatAndMirroredTetrahedraAreAboveAll) {
  std::vector<AffineVec> q = samples(3, 0.1);
  q[0].node[3] = {};  // flat whatever is rounded
  q[1].node[1] = -q[1].node[1];
  const Results r = run(q);
  EXPECT_EQ(r.energy[0], kInvertedEnergy);
  EXPECT_EQ(r.energy[1], kInvertedEnergy);
  EXPECT_LT(r.energy[2], 1);
}

}  // namespace
}  // namespace scree::affine
