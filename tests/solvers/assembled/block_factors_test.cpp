// Factors of sparse block matrices against dense ones, and the order they are made in.
#include "solvers/assembled/block_factors.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <random>

#include "solvers/assembled/dissection.h"
#include "tests/reference/dense_algebra.h"

namespace scree {
namespace {

enum class Graph { grid, path, complete, apart };

/// Neighbors of every node, itself among them.
BlockMatrix pattern(Graph graph, int count) {
  const auto is_edge = [&](int i, int j) {
    if (i == j || graph == Graph::complete) return true;
    if (graph == Graph::path) return std::abs(i - j) == 1;
    if (graph == Graph::apart) return i / 5 == j / 5;
    constexpr int side = 6;
    const int d[3] = {i % side - j % side, i / side % side - j / side % side,
                      i / side / side - j / side / side};
    return std::abs(d[0]) <= 1 && std::abs(d[1]) <= 1 && std::abs(d[2]) <= 1;
  };
  BlockMatrix m;
  m.row_start.push_back(0);
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j)
      if (is_edge(i, j)) m.column.push_back(j);
    m.row_start.push_back(static_cast<int>(m.column.size()));
  }
  m.block.resize(m.column.size());
  return m;
}

Eigen::MatrixXd dense(const BlockMatrix& m) {
  Eigen::MatrixXd d = Eigen::MatrixXd::Zero(3 * m.row_count(), 3 * m.row_count());
  for (int row = 0; row < m.row_count(); ++row)
    for (int k = m.row_start[row]; k < m.row_start[row + 1]; ++k)
      for (int e = 0; e < 9; ++e) d(3 * row + e / 3, 3 * m.column[k] + e % 3) = m.block[k][e];
  return d;
}

/// Random values with a diagonal that makes the matrix definite.
void fill(BlockMatrix& m, bool symmetric, double diagonal, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd values = dense(m);
  for (Eigen::Index i = 0; i < values.rows(); ++i)
    for (Eigen::Index j = 0; j < values.cols(); ++j) values(i, j) = normal(generator);
  if (symmetric) values = (values + values.transpose()).eval();
  values.diagonal().array() += diagonal;
  for (int row = 0; row < m.row_count(); ++row)
    for (int k = m.row_start[row]; k < m.row_start[row + 1]; ++k)
      for (int e = 0; e < 9; ++e) m.block[k][e] = values(3 * row + e / 3, 3 * m.column[k] + e % 3);
}

struct GraphCase {
  Graph graph;
  int count;
};

class BlockFactorsOf : public ::testing::TestWithParam<GraphCase> {};
INSTANTIATE_TEST_SUITE_P(Graphs, BlockFactorsOf,
                         ::testing::Values(GraphCase{Graph::grid, 216}, GraphCase{Graph::path, 100},
                                           GraphCase{Graph::complete, 40},
                                           GraphCase{Graph::apart, 53}, GraphCase{Graph::path, 1}));

TEST_P(BlockFactorsOf, SolveWhatDenseOnesSolve) {
  for (const bool symmetric : {true, false}) {
    BlockMatrix m = pattern(GetParam().graph, GetParam().count);
    BlockFactors factors(m);
    for (unsigned seed = 1; seed <= 2; ++seed) {  // the second with the order of the first
      fill(m, symmetric, 400, seed);
      ASSERT_TRUE(
          factors.factorize(m, symmetric ? BlockFactors::Kind::cholesky : BlockFactors::Kind::lu));
      const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(3 * m.row_count(), -1, 2);
      std::vector<double> x(b.data(), b.data() + b.size());
      factors.solve(x);
      const Eigen::VectorXd expected = oracle::least_norm(dense(m), b);
      for (Eigen::Index i = 0; i < b.size(); ++i)
        EXPECT_NEAR(x[static_cast<std::size_t>(i)], expected(i), 1e-13);
    }
  }
}

TEST_P(BlockFactorsOf, SayWhenThereAreNone) {
  BlockMatrix m = pattern(GetParam().graph, GetParam().count);
  fill(m, true, 400, 3);
  const int last = m.row_start.back() - 1;  // the last diagonal block
  m.block[static_cast<std::size_t>(last)][0] = -1000;
  EXPECT_FALSE(BlockFactors(m).factorize(m, BlockFactors::Kind::cholesky));
  for (int k = 0; k <= last; ++k)
    for (int e = 0; e < 9; ++e)
      if (m.column[static_cast<std::size_t>(k)] == m.row_count() - 1 && e % 3 == 0)
        m.block[static_cast<std::size_t>(k)][static_cast<std::size_t>(e)] = 0;
  EXPECT_FALSE(BlockFactors(m).factorize(m, BlockFactors::Kind::lu));
}

/// What the fronts rely on.
TEST_P(BlockFactorsOf, PartsAreJoinedByAncestorsOnly) {
  const BlockMatrix m = pattern(GetParam().graph, GetParam().count);
  const std::vector<DissectedPart> parts = dissect(m.row_start, m.column);
  std::vector<int> part_of(static_cast<std::size_t>(m.row_count()), -1);
  for (int part = 0; part < static_cast<int>(parts.size()); ++part) {
    EXPECT_TRUE(parts[part].parent < 0 || parts[part].parent > part);
    for (const int i : parts[part].nodes) {
      EXPECT_EQ(part_of[i], -1);
      part_of[i] = part;
    }
  }
  const auto is_above = [&](int above, int part) {
    while (part >= 0 && part != above) part = parts[part].parent;
    return part == above;
  };
  for (int i = 0; i < m.row_count(); ++i) {
    ASSERT_GE(part_of[i], 0);
    for (int k = m.row_start[i]; k < m.row_start[i + 1]; ++k) {
      const int j = m.column[k];
      EXPECT_TRUE(is_above(part_of[i], part_of[j]) || is_above(part_of[j], part_of[i]));
    }
  }
}

TEST(Dissection, SplitsWhatHasAMiddle) {
  const BlockMatrix grid = pattern(Graph::grid, 216);
  const std::vector<DissectedPart> parts = dissect(grid.row_start, grid.column);
  std::size_t largest = 0;
  for (const DissectedPart& part : parts) largest = std::max(largest, part.nodes.size());
  EXPECT_LE(largest, 72u);  // a third: two planes of the six
  EXPECT_EQ(
      dissect(pattern(Graph::complete, 40).row_start, pattern(Graph::complete, 40).column).size(),
      1u);
}

}  // namespace
}  // namespace scree
