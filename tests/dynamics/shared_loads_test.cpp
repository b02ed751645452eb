// Unknowns of a singular system that may change without effect, and the least of them.

#include "dynamics/rigid/shared_loads.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace scree {
namespace {

struct Singular {
  Eigen::MatrixXd matrix;
  std::vector<FactorEntry> entries;  ///< of its lower triangle
};

/// J J^T where J has orthogonal rows at first, and then means of two of them.
/// @param off  how much the last row has of a direction that no other has
Singular singular_system(int rows, int independent, unsigned seed, double off = 0) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd any(independent, independent);
  for (Eigen::Index k = 0; k < any.size(); ++k) any(k) = normal(random);
  const Eigen::MatrixXd orthogonal = any.householderQr().householderQ();
  Eigen::MatrixXd j = Eigen::MatrixXd::Zero(rows, independent + 1);
  j.topLeftCorner(independent, independent) = orthogonal;
  for (int k = independent; k < rows; ++k)
    j.row(k) = 0.5 * (j.row(k - independent) + j.row(k - independent + 1));
  j(rows - 1, independent) = off;
  Singular s{j * j.transpose(), {}};
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column <= row; ++column)
      s.entries.push_back({row, column, s.matrix(row, column)});
  return s;
}

TEST(SharedLoads, DirectionsHaveNoEffectAndLoadsAreLeast) {
  constexpr int kRows = 12, kColumns = 7;
  const Singular s = singular_system(kRows, kColumns, 3);
  SparseFactor factor;
  ASSERT_TRUE(factor.factorize(kRows, s.entries));
  const std::vector<FactorEntry> free = factor.free_directions();
  ASSERT_FALSE(free.empty());
  ASSERT_EQ(free.back().column, kRows - kColumns - 1);
  Eigen::MatrixXd along = Eigen::MatrixXd::Zero(kRows, kRows - kColumns);
  for (const FactorEntry& e : free) along(e.row, e.column) = e.value;
  EXPECT_LT((s.matrix * along).norm(), 1e-6 * s.matrix.norm() * along.norm());
  EXPECT_EQ(along.colPivHouseholderQr().rank(), kRows - kColumns);

  // The least solution is that of a pseudoinverse, which knows nothing of directions.
  const Eigen::VectorXd right = s.matrix * Eigen::VectorXd::LinSpaced(kRows, -1, 2);
  std::vector<double> x(right.data(), right.data() + kRows);
  factor.solve(x);
  const std::vector<double> ways = ways_to_least(x, free);
  ASSERT_EQ(ways.size(), static_cast<std::size_t>(kRows - kColumns));
  const Eigen::VectorXd least =
      Eigen::Map<const Eigen::VectorXd>(x.data(), kRows) -
      along * Eigen::Map<const Eigen::VectorXd>(ways.data(), kRows - kColumns);
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> inverse;
  inverse.setThreshold(1e-9);
  inverse.compute(s.matrix);
  const Eigen::VectorXd expected = inverse.solve(right);
  EXPECT_LT((least - expected).norm(), 1e-5 * expected.norm());
}

// Along it impulses would have an effect of 1e-4, and the next solve would have to take that back.
TEST(SharedLoads, ARowThatIsNearlySuperfluousHasNoDirection) {
  const Singular s = singular_system(9, 7, 5, 1e-4);
  SparseFactor factor;
  ASSERT_TRUE(factor.factorize(9, s.entries));
  const std::vector<FactorEntry> free = factor.free_directions();
  ASSERT_FALSE(free.empty());
  EXPECT_EQ(free.back().column, 0);  // of the other row
}

// Two rows are nearly one, and their difference, thirty times larger, is the third. Its pivot is small, but not as small as
// that of a row that is like another one, and a solution that divided by it would take rounding for a load.
TEST(SharedLoads, ARowThatHasASmallPartInADirectionIsSuperfluous) {
  constexpr double kAngle = 3e-2, kInconsistent = 1e-6, kShift = 1e-9;
  Eigen::Matrix<double, 3, 2> rows;
  rows << 1, 0, std::cos(kAngle), std::sin(kAngle), 0, 1;
  Eigen::Vector3d free(-std::cos(kAngle), 1, -std::sin(kAngle));
  std::array<int, 3> order{0, 1, 2};
  do {
    Eigen::Matrix<double, 3, 2> j;
    Eigen::Vector3d z;
    for (int k = 0; k < 3; ++k) {
      j.row(k) = rows.row(order[static_cast<std::size_t>(k)]);
      z(k) = free(order[static_cast<std::size_t>(k)]);
    }
    const Eigen::Matrix3d matrix = j * j.transpose();
    std::vector<FactorEntry> entries;
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column <= row; ++column)
        entries.push_back({row, column, matrix(row, column)});
    SparseFactor factor;
    ASSERT_TRUE(factor.factorize(3, entries));
    const std::vector<FactorEntry> found = factor.free_directions();
    ASSERT_EQ(found.size(), 3u);
    Eigen::Vector3d direction;
    for (const FactorEntry& e : found) direction(e.row) = e.value;
    EXPECT_LT(direction.normalized().cross(z.normalized()).norm(), 2 * kShift / kAngle);

    const Eigen::Vector3d right = j * Eigen::Vector2d(1, 2) + kInconsistent * z;
    std::vector<double> x(right.data(), right.data() + 3);
    factor.solve(x);
    Eigen::Map<Eigen::Vector3d> solution(x.data());
    EXPECT_LT((matrix * solution - right).norm(), 1e-4);
    EXPECT_LT(solution.norm(), 3 / kAngle);
    const double way = ways_to_least(x, found).at(0);
    EXPECT_LT((solution - way * direction).norm(), 4);
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(SharedLoads, ARegularSystemHasNoDirections) {
  const Singular s = singular_system(7, 6, 4, 0.5);
  SparseFactor factor;
  ASSERT_TRUE(factor.factorize(7, s.entries));
  EXPECT_TRUE(factor.free_directions().empty());
  EXPECT_TRUE(ways_to_least({1, 2}, {}).empty());
}

}  // namespace
}  // namespace scree
