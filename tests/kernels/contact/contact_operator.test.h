// The matrix-free operator against its adjoint and against dense matrices from the equations.
#include <cmath>
#include <random>
#include <vector>

#include "kernels/contact/contact_operator.h"
#include "kernels/solve/metric_step.h"
#include "solvers/residual.h"
#include "tests/backend_fixture.h"
#include "tests/problem_builder.h"
#include "tests/reference/dense_algebra.h"

namespace scree {
namespace {

using fixtures::PlainProblem;
using fixtures::ProblemBuffers;
using fixtures::random_problem;

const ContactLayout kOperatorLayouts[] = {ContactLayout::radial, ContactLayout::general,
                                          ContactLayout::rolling, ContactLayout::mixed};

template <class R, class Real>
struct StoreWrench {
  static constexpr const char* name = "store_wrench";
  ContactProblem<Real> p;
  Span<const Vec3<Real>> gamma;
  Span<Twist<Real>> out;
  SCREE_HD void operator()(Index i) const { out[i] = gather_wrench<R>(p, gamma, i); }
};

template <class Real>
class ContactOperatorTest : public BackendTest<Real> {
 protected:
  static std::vector<Eigen::Vector3d> random_vectors(std::size_t count, unsigned seed) {
    std::mt19937 generator(seed);
    std::normal_distribution<double> normal;
    std::vector<Eigen::Vector3d> v(count);
    for (auto& x : v) {
      x = Eigen::Vector3d(normal(generator), normal(generator), normal(generator))
              .cast<Real>()
              .template cast<double>();
    }
    return v;
  }
  static double rounding(double in_double) {
    return std::is_same_v<Real, double> ? in_double : 1e-5;
  }
};
TYPED_TEST_SUITE(ContactOperatorTest, Reals);

TYPED_TEST(ContactOperatorTest, A03Adjoint) {
  using Real = TypeParam;
  TestBackend& b = this->backend();
  for (ContactLayout layout : kOperatorLayouts) {
    PlainProblem plain =
        random_problem({.layout = layout, .free_count = 200, .contact_count = 700, .seed = 2});
    for (auto& c : plain.data.contacts) c.bias = 0;
    for (std::size_t i = 200; i < plain.data.bodies.size(); ++i) {
      plain.data.bodies[i].velocity.setZero();
      plain.data.bodies[i].angular_velocity.setZero();
    }
    ProblemBuffers<TestBackend, Real> buffers(b, plain);
    const ContactProblem<Real>& p = buffers.problem();
    buffers.set_impulses(this->random_vectors(
        static_cast<std::size_t>(p.contact_count) * vectors_per_contact(layout), 4));
    const std::vector<Vec3<Real>> gamma = download(b, buffers.gamma());
    Buffer<TestBackend, Vec3<Real>> u(b, buffers.gamma().size);
    Buffer<TestBackend, Twist<Real>> wrench(b, p.bodies.owned_count);
    with_rows<Real>(layout, [&](auto rows) {
      using R = decltype(rows);
      for_each(b, p.contact_count, ContactVelocity<R, Real>{p, p.free_velocity.values, u.view()});
      for_each(b, p.bodies.owned_count, StoreWrench<R, Real>{p, buffers.gamma(), wrench.view()});
    });
    double left = 0, right = 0, size = 0;
    const std::vector<Vec3<Real>> velocities = download(b, u.view());
    for (std::size_t k = 0; k < velocities.size(); ++k) {
      const double term = dot(Vec3<double>(velocities[k]), Vec3<double>(gamma[k]));
      left += term;
      size += std::abs(term);
    }
    const std::vector<Twist<Real>> twists = download(b, p.free_velocity.values),
                                   wrenches = download(b, wrench.view());
    for (Index i = 0; i < p.bodies.owned_count; ++i) {
      right += dot(Vec3<double>(twists[i].linear), Vec3<double>(wrenches[i].linear)) +
               dot(Vec3<double>(twists[i].angular), Vec3<double>(wrenches[i].angular));
    }
    EXPECT_NEAR(left, right, this->rounding(1e-13) * size) << "layout " << static_cast<int>(layout);
  }
}

TYPED_TEST(ContactOperatorTest, VelocitiesAndResidualsMatchDenseMatrices) {
  using Real = TypeParam;
  TestBackend& b = this->backend();
  for (ContactLayout layout : kOperatorLayouts) {
    PlainProblem plain = random_problem(
        {.layout = layout, .free_count = 12, .contact_count = 30, .seed = 3, .has_adhesion = true});
    fixtures::round_to<Real>(plain);
    ProblemBuffers<TestBackend, Real> buffers(b, plain);
    const ContactProblem<Real>& p = buffers.problem();
    const auto vectors = this->random_vectors(
        static_cast<std::size_t>(p.contact_count) * vectors_per_contact(layout), 6);
    buffers.set_impulses(vectors);
    const Eigen::VectorXd gamma = oracle::rows_from_world(plain.data, vectors);

    Buffer<TestBackend, Twist<Real>> v(b, p.bodies.count);
    copy(b, p.free_velocity.values, v.view());
    ResidualEvaluator<TestBackend, Real> evaluator(b);
    Residual residual;
    with_rows<Real>(layout, [&](auto rows) {
      using R = decltype(rows);
      for_each(b, p.bodies.owned_count, BodyVelocity<R, Real>{p, buffers.gamma(), v.view()});
      residual = evaluator.template evaluate_with_objective<R>(b, p, buffers.gamma(), v.view());
    });

    const Eigen::MatrixXd j = oracle::jacobian(plain.data);
    const Eigen::VectorXd expected = oracle::free_velocity(plain.data) +
                                     oracle::inverse_mass(plain.data) * j.transpose() * gamma;
    const double scale = expected.cwiseAbs().maxCoeff();
    EXPECT_LE((buffers.velocities(v.view()) - expected).cwiseAbs().maxCoeff(),
              this->rounding(1e-13) * scale);
    const oracle::Residual dense = oracle::residual(plain.data, gamma);
    EXPECT_NEAR(residual.rms, dense.rms, this->rounding(1e-12) * dense.rms);
    EXPECT_NEAR(residual.exact_rms, dense.exact_rms, this->rounding(1e-12) * dense.exact_rms);
    const double objective = oracle::objective(plain.data, gamma);
    EXPECT_NEAR(residual.objective, objective, this->rounding(1e-12) * std::abs(objective));
  }
}

TYPED_TEST(ContactOperatorTest, BlockMetricBoundsTheDiagonalBlock) {
  using Real = TypeParam;
  TestBackend& b = this->backend();
  for (ContactLayout layout : kOperatorLayouts) {
    PlainProblem plain =
        random_problem({.layout = layout, .free_count = 40, .contact_count = 150, .seed = 8});
    fixtures::round_to<Real>(plain);
    ProblemBuffers<TestBackend, Real> buffers(b, plain);
    const ContactProblem<Real>& p = buffers.problem();
    Buffer<TestBackend, ContactMetric<Real>> block(b, p.contact_count), split(b, p.contact_count);
    with_rows<Real>(layout, [&](auto rows) {
      using R = decltype(rows);
      for_each(b, p.contact_count, StoreBlockMetric<R, Real>{p, block.view()});
      for_each(b, p.contact_count, StoreMassSplitMetric<R, Real>{p, split.view()});
    });
    const auto host_block = download(b, block.view()), host_split = download(b, split.view());
    const Eigen::MatrixXd n = oracle::delassus(plain.data);
    const int rows = plain.data.rows_per_contact();
    Eigen::MatrixXd remainder = -n;
    for (Index c = 0; c < p.contact_count; ++c) {
      const auto diagonal = [&](const ContactMetric<Real>& m) {
        Eigen::VectorXd d(rows);
        d.head<3>() << m.normal, m.tangential, m.tangential;
        if (rows == 6) d.tail<3>().setConstant(m.moment);
        return d;
      };
      const Eigen::MatrixXd n_cc = n.block(rows * c, rows * c, rows, rows);
      const double scale = n_cc.trace();
      const Eigen::VectorXd weights = diagonal(host_block[c]);
      const Eigen::MatrixXd left = weights.asDiagonal().toDenseMatrix() - n_cc;
      EXPECT_GE(oracle::eigenvalues(left)(0), -this->rounding(1e-13) * scale);
      // Exact for spheres, up to the floor of tangential rows that no body can follow.
      if (layout == ContactLayout::radial) {
        EXPECT_LE(left.norm(), this->rounding(1e-13) * scale);
      }
      remainder.diagonal().segment(rows * c, rows) += diagonal(host_split[c]);
    }
    // Mass splitting bounds the whole operator.
    EXPECT_GE(oracle::eigenvalues(remainder)(0), -this->rounding(1e-12) * n.diagonal().maxCoeff());
  }
}

}  // namespace
}  // namespace scree
