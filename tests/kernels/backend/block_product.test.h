// Products with the assembled operator: by the backend's own way and by the element program,
// against the host's and the matrix-free operator's.
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "host/problems/matrix_form.h"
#include "host/problems/upload_problem.h"
#include "kernels/contact/contact_operator.h"
#include "solvers/assembled/backend_problem.h"
#include "tests/assembled_samples.h"
#include "tests/backend_fixture.h"

namespace scree {
namespace {

class BlockProductTest : public BackendTest<double> {
 protected:
  /// W x by BlockProduct and by BlockRowProduct.
  std::vector<double> by_product(const AssembledProblem& p, const std::vector<double>& x) {
    const BlockProduct<TestBackend> product(backend());
    const BackendProblem<TestBackend> on_backend(backend(), product, p);
    Buffer<TestBackend, double> in = on_backend.vector(x), out = on_backend.vector();
    on_backend.multiply(in, out);
    return download(backend(), out.view(on_backend.row_count()));
  }
  std::vector<double> by_program(const AssembledProblem& p, const std::vector<double>& x) {
    TestBackend& b = backend();
    const BlockProduct<TestBackend> product(b);
    const BackendProblem<TestBackend> on_backend(b, product, p);
    Buffer<TestBackend, double> in = on_backend.vector(x), out = on_backend.vector();
    for_each(b, p.contact_count, BlockRowProduct{on_backend.rows(), in.view(), out.view()});
    return download(b, out.view(on_backend.row_count()));
  }
};

double largest(const std::vector<double>& v) {
  double most = 0;
  for (const double x : v) most = std::max(most, std::abs(x));
  return most;
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double most = 0;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k)
    most = std::max(most, std::abs(a[k] - b[k]));
  return most;
}

/// Blocks at random places; every third contact has none of its own, so that its row is empty but
/// for a zero block.
AssembledProblem scattered(int contact_count, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  std::uniform_int_distribution<int> any(0, contact_count - 1);
  std::vector<PlacedBlock> blocks;
  for (int row = 0; row < contact_count; ++row) {
    for (int k = 0; row % 3 != 2 && k < 6; ++k) {
      PlacedBlock block{row, any(generator), {}};
      for (double& x : block.value) x = normal(generator);
      blocks.push_back(block);
    }
  }
  return assemble(contact_count, blocks, std::vector<double>(3 * contact_count, 0.0),
                  std::vector<double>(contact_count, 0.5));
}

std::vector<double> random_vector(std::size_t size, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<double> x(size);
  for (double& v : x) v = normal(generator);
  return x;
}

TEST_F(BlockProductTest, IsThatOfTheHost) {
  for (const int contact_count : {1, 33, 5000}) {
    const AssembledProblem p = scattered(contact_count, 3);
    const std::vector<double> x = random_vector(p.q.size(), 4);
    std::vector<double> expected;
    multiply(p, x, expected);
    const double rounding = 1e-14 * std::max(1.0, largest(expected));
    EXPECT_LE(distance(by_product(p, x), expected), rounding) << contact_count;
    EXPECT_LE(distance(by_program(p, x), expected), rounding) << contact_count;
    EXPECT_EQ(by_product(p, x), by_product(p, x)) << "the same bits on every run";
  }
}

/// W gamma + q of a stored problem with bodies is the contact velocity of the matrix-free operator.
TEST_F(BlockProductTest, IsThatOfTheMatrixFreeOperator) {
  TestBackend& b = backend();
  const BodyProblem stored = fixtures::random_body_problem(
      {.layout = ContactLayout::general, .free_count = 200, .contact_count = 600, .seed = 5});
  UploadedProblem<TestBackend, double> uploaded(b, stored);
  const ContactProblem<double>& p = uploaded.problem();
  Buffer<TestBackend, Twist<double>> v(b, p.bodies.count);
  Buffer<TestBackend, Vec3<double>> u(b, p.contact_count);
  for_each(b, p.bodies.count, StartVelocity<double>{p, v.view()});
  for_each(b, p.bodies.owned_count,
           BodyVelocity<GeneralRows<double>, double>{p, uploaded.impulses(), v.view()});
  for_each(b, p.contact_count, ContactVelocity<GeneralRows<double>, double>{p, v.view(), u.view()});
  const std::vector<Vec3d> matrix_free = download(b, u.view());

  const AssembledProblem assembled = assembled_form(local_form(stored));
  std::vector<double> product = by_product(assembled, to_rows(stored, stored.impulse));
  for (std::size_t k = 0; k < product.size(); ++k) product[k] += assembled.q[k];
  const std::vector<Vec3d> world = to_world(stored, product);
  ASSERT_EQ(world.size(), matrix_free.size());
  double most = 0, apart = 0;
  for (std::size_t c = 0; c < world.size(); ++c) {
    most = std::max(most, norm(matrix_free[c]));
    apart = std::max(apart, norm(world[c] - matrix_free[c]));
  }
  EXPECT_LE(apart, 1e-12 * most);
}

}  // namespace
}  // namespace scree
