// Projection on cones that are cut off below a least normal impulse, against the nearest
// of many points.
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "kernels/contact/impact_rows.h"
#include "tests/backend_fixture.h"

namespace scree {
namespace {

template <class Real>
struct ProjectCut {
  static constexpr const char* name = "project_cut";
  ContactProblem<Real> p;
  Span<const Vec3<Real>> y;
  Span<Vec3<Real>> out;
  SCREE_HD void operator()(Index c) const {
    out[c] = ImpactRows<RadialRows<Real>>::project(p, c, {y[c]}, {2, Real(0.7), 1}).force;
  }
};

template <class Real>
class ImpactRowsTest : public BackendTest<Real> {};
TYPED_TEST_SUITE(ImpactRowsTest, Reals);

TYPED_TEST(ImpactRowsTest, ProjectsOnTheNearestPointOfTheCutCone) {
  using Real = TypeParam;
  constexpr int count = 200;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<Vec3<Real>> normal(count, {0, 0, 1}), y;
  std::vector<Real> mu, least;
  for (int c = 0; c < count; ++c) {
    const double x = 2 * unit(random), z = 2 * unit(random);
    y.push_back(Vec3<Real>(Vec3<double>{x, 0, z}));
    mu.push_back(static_cast<Real>(std::abs(unit(random))));
    least.push_back(static_cast<Real>(c % 4 == 0 ? 0 : std::abs(unit(random))));
  }
  TestBackend& b = this->backend();
  Buffer<TestBackend, Vec3<Real>> normals(b), in(b), out(b, count);
  Buffer<TestBackend, Real> friction(b), cut(b);
  upload(b, normal, normals);
  upload(b, y, in);
  upload(b, mu, friction);
  upload(b, least, cut);
  ContactProblem<Real> p;
  p.contact_count = count;
  p.normal = normals.view();
  p.friction.values = friction.view();
  p.adhesion.values = cut.view();
  for_each(b, count, ProjectCut<Real>{p, std::as_const(in).view(count), out.view()});
  const std::vector<Vec3<Real>> found = download(b, out.view());

  int on_cut = 0;
  for (int c = 0; c < count; ++c) {
    const auto k = static_cast<std::size_t>(c);
    const auto distance = [&](double x, double z) {
      return 0.7 * (x - y[k].x) * (x - y[k].x) + 2 * (z - y[k].z) * (z - y[k].z);
    };
    ASSERT_GE(found[k].z, least[k] - 1e-6) << c;
    ASSERT_LE(std::abs(found[k].x), mu[k] * found[k].z + 1e-6) << c;
    ASSERT_EQ(found[k].y, 0) << c;
    on_cut += std::abs(found[k].z - least[k]) < 1e-6 ? 1 : 0;
    double nearest = 1e30;  // over a grid of the plane in which the projection lies
    for (int i = 0; i <= 300; ++i) {
      const double z = least[k] + 0.01 * i;
      for (int j = -100; j <= 100; ++j)
        nearest = std::min(nearest, distance(0.01 * j * mu[k] * z, z));
    }
    EXPECT_LE(distance(found[k].x, found[k].z), nearest + 1e-6) << c;
    EXPECT_GE(distance(found[k].x, found[k].z), nearest - 0.1) << c;
  }
  EXPECT_GT(on_cut, count / 4);
  EXPECT_LT(on_cut, 9 * count / 10);
}

}  // namespace
}  // namespace scree
