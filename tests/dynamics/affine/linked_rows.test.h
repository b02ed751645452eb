// The system of unknowns against T^T H T written out.

#include <Eigen/Dense>
#include <random>
#include <set>

#include "dynamics/affine/linked_rows.h"
#include "tests/backend_fixture.h"
#include "tests/kernels/affine/differences.h"

namespace scree::affine {
namespace {

class LinkedRowsTest : public BackendTest<double> {
 protected:
  std::mt19937 random_{11};
  double uniform() { return std::uniform_real_distribution<double>(-1, 1)(random_); }

  /// Bodies that follow up to four rows, and row 0 if it is a hub; the last row has two unknowns only.
  LinkTable table(int bodies, int rows, bool has_hub) {
    LinkTable t;
    for (int b = 0; b < bodies; ++b) {
      t.begin.push_back(static_cast<Index>(t.links.size()));
      std::set<int> followed;
      if (has_hub) followed.insert(0);
      while (std::ssize(followed) < b % 5)
        followed.insert(static_cast<int>(random_() % unsigned(rows)));
      if (b < rows) followed.insert(b);  // so that no row is without a body
      for (const int row : followed) {
        Link link{b, row, {}};
        for (auto& line : link.weight)
          for (int k = 0; k < (row == rows - 1 ? 2 : 4); ++k) line[k] = uniform();
        t.links.push_back(link);
      }
    }
    t.begin.push_back(static_cast<Index>(t.links.size()));
    t.used.assign(static_cast<std::size_t>(rows), 4);
    t.used.back() = 2;
    return t;
  }

  /// By one item a block, or by several.
  template <bool kSplits>
  void expect_dense_system(int bodies, int rows, bool has_hub);
};

template <bool kSplits>
void LinkedRowsTest::expect_dense_system(int bodies, int rows, bool has_hub) {
  const LinkTable t = table(bodies, rows, has_hub);
  Eigen::MatrixXd follow = Eigen::MatrixXd::Zero(12 * bodies, 12 * rows);
  for (const Link& link : t.links)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k)
        for (int d = 0; d < 3; ++d)
          follow(12 * link.body + 3 * j + d, 12 * link.row + 3 * k + d) = link.weight[j][k];
  Eigen::MatrixXd h = Eigen::MatrixXd::Zero(12 * bodies, 12 * bodies);
  Eigen::VectorXd f(12 * bodies);
  std::vector<Dense<12>> diagonal(static_cast<std::size_t>(bodies));
  std::vector<AffineVec> right(static_cast<std::size_t>(bodies));
  std::vector<MixedBlock> mixed;
  for (int b = 0; b < bodies; ++b) {
    for (int i = 0; i < 12; ++i) {
      for (int j = 0; j <= i; ++j)
        diagonal[std::size_t(b)](i, j) = diagonal[std::size_t(b)](j, i) = uniform();
      f(12 * b + i) = right[std::size_t(b)].node[i / 3][i % 3] = uniform();
    }
    h.block(12 * b, 12 * b, 12, 12) = test::to_eigen(diagonal[std::size_t(b)]);
    for (int other = b + 1; other < bodies; other += 3) {
      MixedBlock m;
      m.row = b, m.column = other;
      for (double& x : m.value.entry) x = uniform();
      mixed.push_back(m);
      h.block(12 * b, 12 * other, 12, 12) = test::to_eigen(m.value);
      h.block(12 * other, 12 * b, 12, 12) = test::to_eigen(m.value).transpose();
    }
  }
  mixed.insert(mixed.end(), 3, MixedBlock{});  // as room for blocks that there are not
  Eigen::MatrixXd expected = follow.transpose() * h * follow;
  for (int k = 12 * rows - 6; k < 12 * rows; ++k) expected(k, k) = 1;  // what is no unknown

  TestBackend& b = backend();
  LinkedRows<TestBackend, kSplits> linked(b, t);
  ASSERT_TRUE(linked.is_on());
  Buffer<TestBackend, Dense<12>> diagonal_in(b);
  Buffer<TestBackend, MixedBlock> mixed_in(b);
  Buffer<TestBackend, AffineVec> right_in(b), followed(b, bodies);
  upload(b, diagonal, diagonal_in), upload(b, mixed, mixed_in), upload(b, right, right_in);
  const BlockSystemView system =
      linked.carry(b, {diagonal_in.view(), mixed_in.view(), right_in.view()});
  Eigen::MatrixXd found = Eigen::MatrixXd::Zero(12 * rows, 12 * rows);
  const std::vector<Dense<12>> own = download(b, system.diagonal);
  for (int r = 0; r < rows; ++r)
    found.block(12 * r, 12 * r, 12, 12) = test::to_eigen(own[std::size_t(r)]);
  for (const MixedBlock& m : download(b, system.mixed)) {
    EXPECT_LT(m.row, m.column);
    found.block(12 * m.row, 12 * m.column, 12, 12) = test::to_eigen(m.value);
    found.block(12 * m.column, 12 * m.row, 12, 12) = test::to_eigen(m.value).transpose();
  }
  EXPECT_LT((found - expected).norm(), 1e-13 * expected.norm());
  const std::vector<AffineVec> carried = download(b, system.right);
  const Eigen::VectorXd force = follow.transpose() * f;
  for (int r = 0; r < rows; ++r)
    EXPECT_LT((test::to_eigen(carried[std::size_t(r)]) - force.segment(12 * r, 12)).norm(),
              1e-13 * force.norm());

  std::vector<AffineVec> step(static_cast<std::size_t>(rows));
  Eigen::VectorXd y(12 * rows);
  for (int i = 0; i < 12 * rows; ++i)
    y(i) = step[std::size_t(i / 12)].node[i % 12 / 3][i % 3] = uniform();
  upload(b, step.data(), linked.step());
  linked.follow(b, followed.view());
  const std::vector<AffineVec> moved = download(b, followed.view());
  const Eigen::VectorXd x = follow * y;
  for (int k = 0; k < bodies; ++k)
    EXPECT_LT((test::to_eigen(moved[std::size_t(k)]) - x.segment(12 * k, 12)).norm(),
              1e-13 * x.norm());
}

TEST_F(LinkedRowsTest, SystemsAreThoseOfTheDenseMatrices) {
  expect_dense_system<false>(23, 7, false);
  expect_dense_system<true>(23, 7, false);
}

// Row 0 has a piece of each of them, and of each two that touch.
TEST_F(LinkedRowsTest, SoAreThoseOfARowThatManyBodiesFollow) {
  expect_dense_system<false>(110, 9, true);
  expect_dense_system<true>(110, 9, true);
}

TEST_F(LinkedRowsTest, WithoutLinksThereIsNothingToDo) {
  EXPECT_FALSE(LinkedRows<TestBackend>(backend(), {}).is_on());
}

}  // namespace
}  // namespace scree::affine
