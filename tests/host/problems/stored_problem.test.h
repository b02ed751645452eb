// A stored problem in backend memory: the matrix-free operator against the matrices that are
// exported, and a step's own solve repeated from what the step handed out.
#include <algorithm>
#include <random>
#include <vector>

#include "host/problems/download_problem.h"
#include "host/problems/matrix_form.h"
#include "host/problems/upload_problem.h"
#include "kernels/contact/contact_operator.h"
#include "tests/backend_fixture.h"
#include "tests/stored_problem_samples.h"

namespace scree {
namespace {

using fixtures::oracle_of;
using fixtures::random_body_problem;

template <class Real>
class StoredProblemTest : public BackendTest<Real> {
 protected:
  /// u = J (v* + M^-1 J^T gamma) + bias of the problem's own guess, world frame, by the operator.
  std::vector<Vec3d> contact_velocity(const BodyProblem& stored) {
    TestBackend& b = this->backend();
    UploadedProblem<TestBackend, Real> uploaded(b, stored);
    const ContactProblem<Real>& p = uploaded.problem();
    Buffer<TestBackend, Twist<Real>> v(b, p.bodies.count);
    Buffer<TestBackend, Vec3<Real>> u(b, uploaded.impulses().size);
    with_rows<Real>(p.layout, [&](auto rows) {
      using R = decltype(rows);
      for_each(b, p.bodies.count, StartVelocity<Real>{p, v.view()});
      for_each(b, p.bodies.owned_count, BodyVelocity<R, Real>{p, uploaded.impulses(), v.view()});
      for_each(b, p.contact_count, ContactVelocity<R, Real>{p, v.view(), u.view()});
    });
    const std::vector<Vec3<Real>> host = download(b, u.view());
    return {host.begin(), host.end()};
  }
  static double rounding(double in_double) {
    return std::is_same_v<Real, double> ? in_double : 2e-5;
  }
};
TYPED_TEST_SUITE(StoredProblemTest, Reals);

double largest(const std::vector<Vec3d>& v) {
  double most = 0;
  for (const Vec3d& x : v) most = std::max(most, norm(x));
  return most;
}

double distance(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b) {
  EXPECT_EQ(a.size(), b.size());
  double most = 0;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k)
    most = std::max(most, norm(a[k] - b[k]));
  return most;
}

TYPED_TEST(StoredProblemTest, LocalFormIsTheOperator) {
  for (const ContactLayout layout : {ContactLayout::radial, ContactLayout::general}) {
    for (const bool has_adhesion : {false, true}) {
      const BodyProblem stored = random_body_problem({.layout = layout,
                                                      .free_count = 20,
                                                      .contact_count = 60,
                                                      .seed = 5,
                                                      .has_adhesion = has_adhesion});
      const std::vector<Vec3d> matrix_free = this->contact_velocity(stored);
      const double scale = largest(matrix_free);

      const LocalProblem local = local_form(stored);
      std::vector<double> r = to_rows(stored, stored.impulse);
      for (std::size_t c = 0; c < stored.adhesion.size(); ++c) r[3 * c] += stored.adhesion[c];
      std::vector<double> u = multiply(local.W, r);
      for (std::size_t k = 0; k < u.size(); ++k) u[k] += local.q[k];
      EXPECT_LE(distance(to_world(stored, u), matrix_free), this->rounding(1e-12) * scale)
          << to_string(layout);
      EXPECT_EQ(local.mu, stored.friction);
    }
  }
}

TYPED_TEST(StoredProblemTest, UploadedProblemIsTheOraclesInAllLayouts) {
  for (const ContactLayout layout :
       {ContactLayout::radial, ContactLayout::general, ContactLayout::rolling}) {
    const BodyProblem stored =
        random_body_problem({.layout = layout, .free_count = 20, .contact_count = 60, .seed = 6});
    const std::vector<Vec3d> matrix_free = this->contact_velocity(stored);
    const oracle::Problem dense = oracle_of(stored);
    std::vector<Eigen::Vector3d> impulse;
    for (const Vec3d& g : stored.impulse) impulse.push_back(fixtures::to_eigen(g));
    const Eigen::VectorXd u = oracle::delassus(dense) * oracle::rows_from_world(dense, impulse) +
                              oracle::right_side(dense);
    std::vector<Vec3d> expected;
    for (const Eigen::Vector3d& x : oracle::world_from_rows(dense, u))
      expected.push_back(fixtures::to_vec3<double>(x));
    EXPECT_LE(distance(expected, matrix_free), this->rounding(1e-12) * largest(matrix_free))
        << to_string(layout);
  }
}

TYPED_TEST(StoredProblemTest, DownloadUndoesUpload) {
  using Real = TypeParam;
  TestBackend& b = this->backend();
  const auto vectors = [](const std::vector<Vec3d>& values) {
    return std::vector<Vec3<Real>>(values.begin(), values.end());
  };
  for (const ContactLayout layout :
       {ContactLayout::radial, ContactLayout::general, ContactLayout::rolling}) {
    const BodyProblem stored = random_body_problem({.layout = layout, .has_adhesion = true});
    UploadedProblem<TestBackend, Real> uploaded(b, stored);
    BodyProblem back = download_problem<TestBackend, Real>(b, uploaded.problem(),
                                                           uploaded.impulses(), stored.body_id);
    EXPECT_EQ(back.layout, layout);
    EXPECT_EQ(back.free_count, stored.free_count);
    EXPECT_EQ(back.body_id, stored.body_id);
    back.visit(
        [](const ContactField& field, const auto& a, const auto& b) {
          EXPECT_EQ(a.size(), b.size()) << field.name;  // values: contact_fields.test.h
        },
        back, stored);
    EXPECT_EQ(vectors(back.impulse), vectors(stored.impulse));
    ASSERT_EQ(back.body_count(), stored.body_count());
    for (std::size_t i = 0; i < back.free_velocity.size(); ++i) {
      EXPECT_EQ(Vec3<Real>(back.free_velocity[i].linear),
                Vec3<Real>(stored.free_velocity[i].linear));
      EXPECT_EQ(Vec3<Real>(back.free_velocity[i].angular),
                Vec3<Real>(stored.free_velocity[i].angular));
    }
    back.source = stored.source;
    EXPECT_NO_THROW(validate(back));
  }
}

}  // namespace
}  // namespace scree
