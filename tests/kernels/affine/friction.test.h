// Smoothed friction against its formulas and differences.

#include <random>

#include "kernels/affine/friction.h"
#include "tests/affine_reference/hessians.h"
#include "tests/backend_fixture.h"
#include "tests/kernels/affine/differences.h"

namespace scree::affine {
namespace {

struct RunFriction {
  static constexpr const char* name = "run_friction";
  SlipLaw law;
  Span<const FrictionContact> contact;
  Span<const Four> moved;
  Span<double> energy;
  Span<Four> gradient;
  Span<Dense<12>> hessian;
  SCREE_HD void operator()(Index k) const {
    energy[k] = friction_energy(contact[k], law, moved[k]);
    gradient[k] = friction_gradient(contact[k], law, moved[k]);
    hessian[k] = friction_hessian(contact[k], law, moved[k]);
  }
};

using AffineFrictionTest = BackendTest<double>;

TEST(SlipLawTest, IsTheQuadraticOfTheTheory) {
  const SlipLaw law{1e-3};
  for (const double share : {0.0, 0.2, 0.9, 0.999, 1.0, 2.5}) {
    const double y = 1e-3 * share, force = share < 1 ? (2 - share) * share : 1;
    EXPECT_NEAR(law.force_per_slip(y) * y, force, 1e-14);
    const auto energy = [&](const Eigen::VectorXd& z) {
      return test::scalar(law.energy(std::abs(z(0))));
    };
    EXPECT_NEAR(test::differences(energy, test::scalar(y), 1e-7)(0, 0), force, 1e-6);
    EXPECT_NEAR(law.stiffness(y), share < 1 ? 2e3 * (1 - share) : 0, 1e-9);
  }
  EXPECT_NEAR(law.force_per_slip(0), 2e3, 1e-9);
  EXPECT_NEAR(law.energy(1e-3), 1e-3, 1e-18);  // where the pieces meet
}

// A mass m that slides by y, with a bound of one and a load that friction holds: without damping a step goes as far as the mass lets it.
TEST(SlipLawTest, ADampedStepThatStopsASlipGoesNotFar) {
  SlipLaw law{1e-3};
  constexpr double kMass = 1e-3, kLoad = -0.9;
  for (const double y : {1.001e-3, 2e-3, 1e-2, 1.0}) {
    const auto end = [&] {
      const double force = kLoad - kMass * y - law.force_per_slip(y) * y;
      return y + force / (kMass + law.damped_stiffness(y));
    };
    law.damping = 0;
    EXPECT_LT(end(), -1000 * y) << y;
    law.damping = 0.25;
    EXPECT_GT(end(), -7 * y) << y;
  }
  for (const double share : {0.0, 0.5, 0.8})  // contacts that stick have their own
    EXPECT_EQ(law.damped_stiffness(1e-3 * share), law.stiffness(1e-3 * share));
  EXPECT_NEAR(law.damped_stiffness(0.1), 2.5, 1e-12);
}

TEST_F(AffineFrictionTest, DerivativesAreThoseOfTheEnergyAndSemidefinite) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto vector = [&] { return Vec3d{unit(random), unit(random), unit(random)}; };
  const SlipLaw law{0.1};
  std::vector<FrictionContact> contact;
  std::vector<Four> moved;
  for (int k = 0; k < 100; ++k) {
    Four x, u;
    for (int i = 0; i < 4; ++i) x[i] = vector(), u[i] = (k % 3 == 0 ? 0.03 : 1) * vector();
    const PairKind kind = k % 2 == 0 ? PairKind::point_triangle : PairKind::edge_edge;
    contact.push_back(friction_contact(nearest_points(kind, x), 0.3, 2.0));
    moved.push_back(k == 0 ? Four{} : u);
  }
  TestBackend& b = backend();
  const auto n = static_cast<Index>(contact.size());
  Buffer<TestBackend, FrictionContact> contacts(b);
  Buffer<TestBackend, Four> in(b), gradients(b, n);
  Buffer<TestBackend, double> energies(b, n);
  Buffer<TestBackend, Dense<12>> hessians(b, n);
  upload(b, contact, contacts);
  upload(b, moved, in);
  for_each(b, n,
           RunFriction{law, std::as_const(contacts).view(n), std::as_const(in).view(n),
                       energies.view(), gradients.view(), hessians.view()});
  const std::vector<double> energy = download(b, energies.view());
  const std::vector<Four> gradient = download(b, gradients.view());
  const std::vector<Dense<12>> hessian = download(b, hessians.view());
  int sticking = 0;
  for (std::size_t k = 0; k < contact.size(); ++k) {
    const FrictionContact& f = contact[k];
    double u[2];
    slip_of(f, moved[k], u);
    const double y = std::hypot(u[0], u[1]);
    sticking += y < law.slip ? 1 : 0;
    EXPECT_NEAR(energy[k], 0.6 * law.energy(y), 1e-14);
    Vec3d force;  // on A, against B's
    for (int i = 0; i < (k % 2 == 0 ? 1 : 2); ++i) force += gradient[k][i];
    EXPECT_NEAR(norm(force), 0.6 * law.force_per_slip(y) * y, 1e-14);
    if (k > 0 && std::abs(y - law.slip) < 0.01) continue;  // second derivatives jump there
    const auto energy_at = [&](const Eigen::VectorXd& z) {
      return test::scalar(friction_energy(f, law, test::to_four(z)));
    };
    const auto gradient_at = [&](const Eigen::VectorXd& z) {
      return test::to_eigen(friction_gradient(f, law, test::to_four(z)));
    };
    const Eigen::VectorXd at = test::to_eigen(moved[k]);
    const Eigen::MatrixXd h = test::to_eigen(hessian[k]);
    const double step = 1e-3 * std::max(1e-4, std::min(y, 0.1));
    EXPECT_GE(test::lowest_eigenvalue(h), -1e-12 * h.norm());
    if (k == 0) {  // without slip: no force, and the stiffness of sticking
      EXPECT_EQ(test::to_eigen(gradient[k]).norm(), 0);
      EXPECT_LT(test::relative_error(h, test::differences(gradient_at, at, 1e-9)), 1e-6);
      continue;
    }
    EXPECT_LT(test::relative_error(test::to_eigen(gradient[k]).transpose(),
                                   test::differences(energy_at, at, step)),
              1e-7)
        << k;
    EXPECT_LT(test::relative_error(h, test::differences(gradient_at, at, step)), 1e-6) << k;
  }
  EXPECT_GT(sticking, 15);
  EXPECT_LT(sticking, 60);
}

}  // namespace
}  // namespace scree::affine
