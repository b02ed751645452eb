// Cone projections (cases A01 and A02), and the conditions of optimality for every
// layout and metric.
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "kernels/contact/contact_rows.h"
#include "tests/backend_fixture.h"
#include "tests/problem_builder.h"

namespace scree {
namespace {

template <class Real>
struct ProjectAll {
  static constexpr const char* name = "project_all";
  Span<const Real> mu;
  Span<const ContactVec<Real>> x;
  Span<ContactVec<Real>> out;
  SCREE_HD void operator()(Index i) const { out[i] = project_cone(mu[i], x[i]); }
};

template <class R, class Real>
struct ProjectRows {
  static constexpr const char* name = "project_rows";
  ContactProblem<Real> p;
  Span<const ContactMetric<Real>> metric;
  Span<const Vec3<Real>> y;
  Span<Vec3<Real>> out;
  SCREE_HD void operator()(Index c) const {
    R::store(out, c, R::project(p, c, R::load(y, c), metric[c]));
  }
};

template <class Real>
class ConeTest : public BackendTest<Real> {
 protected:
  std::vector<ContactVec<Real>> project(const std::vector<Real>& mu,
                                        const std::vector<ContactVec<Real>>& x) {
    TestBackend& b = this->backend();
    const auto n = static_cast<Offset>(x.size());
    Buffer<TestBackend, Real> mu_buffer(b);
    Buffer<TestBackend, ContactVec<Real>> in(b), out(b, n);
    upload(b, mu, mu_buffer);
    upload(b, x, in);
    for_each(
        b, static_cast<Index>(n),
        ProjectAll<Real>{std::as_const(mu_buffer).view(n), std::as_const(in).view(n), out.view(n)});
    return download(b, out.view(n));
  }
  /// Rounding error of a few operations.
  static double rounding(double in_double) {
    return std::is_same_v<Real, double> ? in_double : 2e-6;
  }
};
TYPED_TEST_SUITE(ConeTest, Reals);

TYPED_TEST(ConeTest, A01ProjectionTable) {
  using V = ContactVec<TypeParam>;
  const auto r = [](double x) { return static_cast<TypeParam>(x); };
  const std::vector<V> x{{2, r(0.5), 0}, {1, 2, 0}, {-1, 1, 0}, {-1, 4, 0}, {0, 3, 4}, {0, 0, 0}};
  const std::vector<V> expected{{2, r(0.5), 0},      {r(1.6), r(0.8), 0}, {0, 0, 0},
                                {r(0.8), r(0.4), 0}, {2, r(0.6), r(0.8)}, {0, 0, 0}};
  const std::vector<V> p = this->project(std::vector<TypeParam>(x.size(), r(0.5)), x);
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_NEAR(p[i].n, expected[i].n, this->rounding(1e-14)) << "row " << i;
    EXPECT_NEAR(p[i].t1, expected[i].t1, this->rounding(1e-14)) << "row " << i;
    EXPECT_NEAR(p[i].t2, expected[i].t2, this->rounding(1e-14)) << "row " << i;
  }
}

TYPED_TEST(ConeTest, A02ProjectionProperties) {
  using V = ContactVec<TypeParam>;
  constexpr int kCount = 100000;
  std::mt19937 generator(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0, 2);
  std::vector<TypeParam> mu(kCount);
  std::vector<V> x(kCount), y(kCount);
  const auto draw = [&] { return static_cast<TypeParam>(normal(generator)); };
  for (int i = 0; i < kCount; ++i) {
    mu[i] = static_cast<TypeParam>(i % 10 == 0 ? 0.0 : unit(generator));
    x[i] = {draw(), draw(), draw()};
    y[i] = {draw(), draw(), draw()};
  }
  const std::vector<V> p = this->project(mu, x), twice = this->project(mu, p),
                       q = this->project(mu, y);
  const auto difference = [](const V& a, const V& b) {
    return Eigen::Vector3d(static_cast<double>(a.n) - b.n, static_cast<double>(a.t1) - b.t1,
                           static_cast<double>(a.t2) - b.t2);
  };
  const V zero{};
  double worst = 0;  // over |x|
  for (int i = 0; i < kCount; ++i) {
    const Eigen::Vector3d inside = difference(p[i], zero), rest = difference(x[i], p[i]);
    const double size = difference(x[i], zero).norm(), m = mu[i];
    worst = std::max(worst, difference(twice[i], p[i]).norm() / size);          // idempotent
    worst = std::max(worst, (inside.tail<2>().norm() - m * inside(0)) / size);  // feasible
    worst = std::max(worst, std::abs(inside.dot(rest)) / (size * size));    // Moreau: orthogonal
    worst = std::max(worst, (m * rest.tail<2>().norm() + rest(0)) / size);  // Moreau: polar part
    const double before = difference(x[i], y[i]).norm(), after = difference(p[i], q[i]).norm();
    worst = std::max(worst, (after - before) / size);  // non-expansive
  }
  EXPECT_LE(worst, this->rounding(1e-12));
}

/// x = P(y) in the metric A exactly when x is in K, A (x - y) in K*, and they are orthogonal; for
/// all layouts, with adhesion, in random metrics.
TYPED_TEST(ConeTest, ProjectionsMeetTheOptimalityConditions) {
  using Real = TypeParam;
  for (ContactLayout layout :
       {ContactLayout::radial, ContactLayout::general, ContactLayout::rolling}) {
    const fixtures::PlainProblem plain = fixtures::random_problem({.layout = layout,
                                                                   .free_count = 500,
                                                                   .contact_count = 20000,
                                                                   .seed = 9,
                                                                   .has_adhesion = true});
    TestBackend& b = this->backend();
    fixtures::ProblemBuffers<TestBackend, Real> buffers(b, plain);
    const ContactProblem<Real>& p = buffers.problem();
    const int vectors = vectors_per_contact(layout);
    std::mt19937 generator(11);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> weight(0.2, 3);
    std::vector<Vec3<Real>> y(static_cast<std::size_t>(p.contact_count) * vectors);
    for (auto& v : y)
      v = Vec3<Real>(Vec3<double>(normal(generator), normal(generator), normal(generator)));
    std::vector<ContactMetric<Real>> metric(p.contact_count);
    for (auto& m : metric) {
      m = {static_cast<Real>(weight(generator)), static_cast<Real>(weight(generator)),
           static_cast<Real>(weight(generator))};
    }
    Buffer<TestBackend, Vec3<Real>> y_buffer(b);
    Buffer<TestBackend, ContactMetric<Real>> metric_buffer(b);
    upload(b, y, y_buffer);
    upload(b, metric, metric_buffer);
    const auto y_view = std::as_const(y_buffer).view(static_cast<Offset>(y.size()));
    const auto metric_view = std::as_const(metric_buffer).view(p.contact_count);
    with_rows<Real>(layout, [&](auto rows) {
      for_each(b, p.contact_count,
               ProjectRows<decltype(rows), Real>{p, metric_view, y_view, buffers.gamma()});
    });
    const std::vector<Eigen::Vector3d> x = buffers.impulses();

    double worst = 0;
    for (Index c = 0; c < p.contact_count; ++c) {
      const oracle::Contact& k = plain.data.contacts[c];
      const Eigen::Matrix3d frame = oracle::contact_frame(k.normal);
      const Eigen::Vector3d force = frame.transpose() * x[vectors * c];
      const Eigen::Vector3d force_y =
          frame.transpose() * fixtures::to_eigen(Vec3<double>(y[vectors * c]));
      const double a_n = metric[c].normal, a_t = metric[c].tangential, a_m = metric[c].moment;
      const Eigen::Vector3d dual = Eigen::Vector3d(a_n, a_t, a_t).cwiseProduct(force - force_y);
      const double apex = force(0) + k.adhesion;
      double needed = k.mu * dual.tail<2>().norm(),
             work = apex * dual(0) + force.tail<2>().dot(dual.tail<2>());
      worst = std::max({worst, -apex, force.tail<2>().norm() - k.mu * apex});
      if (vectors == 2) {
        const Eigen::Vector3d moment = frame.transpose() * x[2 * c + 1];
        const Eigen::Vector3d moment_dual =
            a_m * (moment - frame.transpose() * fixtures::to_eigen(Vec3<double>(y[2 * c + 1])));
        needed += k.rolling * moment_dual.tail<2>().norm() + k.spinning * std::abs(moment_dual(0));
        work += moment.dot(moment_dual);
        worst = std::max({worst, moment.tail<2>().norm() - k.rolling * apex,
                          std::abs(moment(0)) - k.spinning * apex});
      }
      worst = std::max({worst, needed - dual(0), std::abs(work)});
    }
    EXPECT_LE(worst, this->rounding(1e-12) * 20) << "layout " << static_cast<int>(layout);
  }
}

}  // namespace
}  // namespace scree
