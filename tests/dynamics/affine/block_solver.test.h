// The linear system of a Newton step, by both ways of solving it, against its equations written out.

#include <algorithm>
#include <array>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include "dynamics/affine/block_solver.h"
#include "tests/backend_fixture.h"

namespace scree::affine {
namespace {

class BlockSolverTest : public BackendTest<double> {
 protected:
  std::mt19937 random_{7};
  double uniform(double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random_);
  }

  std::vector<Dense<12>> diagonal_;
  std::vector<MixedBlock> mixed_;
  std::vector<AffineVec> right_;

  /// Rows with a mass and a stiff elastic part, and contacts of rank one between neighbors.
  void make(int rows, const std::vector<std::array<int, 2>>& pairs) {
    diagonal_.assign(static_cast<std::size_t>(rows), {});
    mixed_.clear();
    right_.assign(static_cast<std::size_t>(rows), {});
    for (auto& block : diagonal_) {
      for (int i = 0; i < 12; ++i) block(i, i) = uniform(0.5, 2);
      for (int mode = 0; mode < 6; ++mode) {  // as many directions as deform a body
        double d[12];
        for (int i = 0; i < 12; ++i) d[i] = i < 3 ? 0 : uniform(-1, 1);
        for (int i = 0; i < 12; ++i)
          for (int j = 0; j < 12; ++j) block(i, j) += 1e4 * d[i] * d[j];
      }
    }
    for (const auto& [a, b] : pairs) {
      MixedBlock m;
      m.row = a, m.column = b;
      for (int contact = 0; contact < 4; ++contact) {
        double u[12], w[12];
        for (int i = 0; i < 12; ++i) u[i] = uniform(-1, 1), w[i] = uniform(-1, 1);
        for (int i = 0; i < 12; ++i) {
          for (int j = 0; j < 12; ++j) {
            diagonal_[static_cast<std::size_t>(a)](i, j) += 50 * u[i] * u[j];
            diagonal_[static_cast<std::size_t>(b)](i, j) += 50 * w[i] * w[j];
            m.value(i, j) -= 50 * u[i] * w[j];
          }
        }
      }
      mixed_.push_back(m);
    }
    for (auto& v : right_)
      for (int i = 0; i < 12; ++i) v.node[i / 3][i % 3] = uniform(-1, 1);
  }
  static std::vector<std::array<int, 2>> chain(int rows) {
    std::vector<std::array<int, 2>> pairs;
    for (int k = 0; k + 1 < rows; ++k) pairs.push_back({k, k + 1});
    return pairs;
  }
  static std::vector<std::array<int, 2>> star(int rows) {
    std::vector<std::array<int, 2>> pairs;
    for (int k = 0; k < rows; ++k)
      if (k != rows / 2) pairs.push_back({std::min(k, rows / 2), std::max(k, rows / 2)});
    std::sort(pairs.begin(), pairs.end());
    return pairs;
  }

  /// Each row meets those so many rows on. @param ways  rising
  static std::vector<std::array<int, 2>> bands(int rows, const std::vector<int>& ways) {
    std::vector<std::array<int, 2>> pairs;
    for (int k = 0; k < rows; ++k)
      for (const int way : ways)
        if (k + way < rows) pairs.push_back({k, k + way});
    return pairs;
  }

  /// A chain, and some rows that meet so many others each, from the first on.
  static std::vector<std::array<int, 2>> hubs(int rows, const std::vector<int>& of, int others) {
    std::set<std::array<int, 2>> pairs;
    for (const auto& pair : chain(rows)) pairs.insert(pair);
    for (const int hub : of)
      for (int k = 0, met = 0; k < rows && met < others; ++k)
        if (k != hub) pairs.insert({std::min(k, hub), std::max(k, hub)}), ++met;
    return {pairs.begin(), pairs.end()};
  }

  /// Those of all blocks, by row and then by the other row.
  void list_halves(Buffer<TestBackend, Index>& half, Buffer<TestBackend, Index>& begin) {
    std::vector<std::array<Index, 3>> found;
    for (std::size_t k = 0; k < mixed_.size(); ++k) {
      const auto number = static_cast<Index>(2 * k);
      found.push_back({mixed_[k].row, mixed_[k].column, number});
      found.push_back({mixed_[k].column, mixed_[k].row, number + 1});
    }
    std::sort(found.begin(), found.end());
    std::vector<Index> halves, begins(diagonal_.size() + 1);
    for (const auto& each : found) {
      halves.push_back(each[2]);
      ++begins[static_cast<std::size_t>(each[0]) + 1];
    }
    std::partial_sum(begins.begin(), begins.end(), begins.begin());
    upload(backend(), halves, half);
    upload(backend(), begins, begin);
  }

  void expect_gradients_solve_it() {
    const std::vector<AffineVec> x = solve({}, LinearMethod::gradients), r = residual(x);
    EXPECT_LT(std::sqrt(product(r, r)), 1e-6 * std::sqrt(product(right_, right_)));
    const std::vector<AffineVec> again = solve({}, LinearMethod::gradients);
    for (std::size_t k = 0; k < x.size(); ++k) EXPECT_EQ(dot(x[k] - again[k], x[k] - again[k]), 0);
  }
  /// @param lists_halves  whether the solver is told which blocks a row has, and gets others behind them
  std::vector<AffineVec> solve(const std::vector<NodeEquation>& equations, LinearMethod method,
                               bool lists_halves = false) {
    TestBackend& b = backend();
    const auto rows = static_cast<Index>(diagonal_.size());
    Buffer<TestBackend, Dense<12>> diagonal(b);
    Buffer<TestBackend, MixedBlock> mixed(b);
    Buffer<TestBackend, AffineVec> right(b), step(b, rows);
    std::vector<MixedBlock> blocks = mixed_;
    if (lists_halves) blocks.resize(blocks.size() + 5);
    upload(b, diagonal_, diagonal);
    upload(b, blocks, mixed);
    upload(b, right_, right);
    BlockSystemView system{std::as_const(diagonal).view(rows),
                           std::as_const(mixed).view(std::ssize(blocks)),
                           std::as_const(right).view(rows)};
    Buffer<TestBackend, Index> half(b), half_begin(b);
    if (lists_halves) {
      list_halves(half, half_begin);
      system.halves = {half.view(), half_begin.view()};
    }
    BlockSolver<TestBackend> solver(b, rows, equations, method);
    const auto report = solver.solve(b, system, step.view(), 1e-10);
    EXPECT_TRUE(report.is_solved);
    return download(b, step.view());
  }

  /// right - H x.
  std::vector<AffineVec> residual(const std::vector<AffineVec>& x) const {
    std::vector<AffineVec> r = right_;
    const auto take = [&](std::size_t row, std::size_t column, const Dense<12>& block,
                          bool turned) {
      for (int i = 0; i < 12; ++i)
        for (int j = 0; j < 12; ++j)
          r[row].node[i / 3][i % 3] -=
              (turned ? block(j, i) : block(i, j)) * x[column].node[j / 3][j % 3];
    };
    for (std::size_t k = 0; k < diagonal_.size(); ++k) take(k, k, diagonal_[k], false);
    for (const MixedBlock& m : mixed_) {
      const auto a = static_cast<std::size_t>(m.row), b = static_cast<std::size_t>(m.column);
      take(a, b, m.value, false);
      take(b, a, m.value, true);
    }
    return r;
  }
  static double product(const std::vector<AffineVec>& a, const std::vector<AffineVec>& b) {
    double sum = 0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += dot(a[k], b[k]);
    return sum;
  }
  /// Largest number that an equation is off by.
  static double broken(const std::vector<NodeEquation>& equations,
                       const std::vector<AffineVec>& x) {
    double most = 0;
    for (const NodeEquation& e : equations) {
      Vec3d sum;
      for (int side = 0; side < 2; ++side)
        for (int k = 0; k < 4 && e.row[side] >= 0; ++k)
          sum += e.weight[side][k] * x[static_cast<std::size_t>(e.row[side])].node[k];
      for (int d = 0; d < e.count; ++d) most = std::max(most, std::abs(dot(sum, e.direction[d])));
    }
    return most;
  }
  NodeEquation point(int row, int other) {
    NodeEquation e;
    e.row[0] = row, e.row[1] = other;
    for (int side = 0; side < 2; ++side)
      for (int k = 0; k < 4; ++k)
        e.weight[side][k] = (side == 0 ? 1 : -1) * (k == 0 ? 1 : uniform(-1, 1));
    return e;
  }
};

TEST_F(BlockSolverTest, BothWaysSolveChainsAndStars) {
  for (const auto& pairs : {chain(60), star(40), std::vector<std::array<int, 2>>{}}) {
    make(60, pairs);
    for (const LinearMethod method : {LinearMethod::direct, LinearMethod::gradients}) {
      const std::vector<AffineVec> x = solve({}, method), r = residual(x);
      EXPECT_LT(std::sqrt(product(r, r)), 1e-6 * std::sqrt(product(right_, right_)));
    }
  }
}

// A device has programs of its own for few rows, whose matrix may be larger than the memory that they have beside them.
TEST_F(BlockSolverTest, GradientsSolveSystemsOfAllSizes) {
  const std::vector<int> few{1, 7, 13}, many{1, 2, 3, 5, 8, 13, 21, 34, 55, 89};
  for (const auto& [rows, ways] : {std::pair{1, few},
                                   {2, few},
                                   {5, few},
                                   {8, many},
                                   {9, many},
                                   {30, few},
                                   {157, few},
                                   {300, few},
                                   {157, many},
                                   {400, many},
                                   {900, few},
                                   {1100, few}}) {
    SCOPED_TRACE(testing::Message() << rows << " rows, " << ways.size() << " bands");
    make(rows, bands(rows, ways));
    expect_gradients_solve_it();
  }
}

// A device cuts rows of more than sixteen blocks into parts, and parts of the longest go to several of its processors.
TEST_F(BlockSolverTest, GradientsSolveSystemsWithLongRows) {
  std::vector<int> half(40);
  std::iota(half.begin(), half.end(), 30);
  struct Case {
    int rows;
    std::vector<int> of;
    int others;
  };
  const Case cases[] = {
      {20, {0, 19}, 19},         {60, {3, 30, 31, 59}, 13}, {60, {3, 30, 31, 59}, 14},
      {60, {3, 30, 31, 59}, 15}, {60, {3, 30, 31, 59}, 16}, {60, {3, 30, 31, 59}, 17},
      {120, {0, 1, 2, 119}, 31}, {120, {0, 1, 2, 119}, 32}, {120, {0, 1, 2, 119}, 33},
      {300, {0}, 299},           {300, {150, 151}, 299},    {300, {299}, 299},
      {100, half, 99},           {700, {3}, 699},           {900, {3, 400}, 899}};
  for (const auto& [rows, of, others] : cases) {
    SCOPED_TRACE(testing::Message() << rows << " rows, some with " << others << " others");
    make(rows, hubs(rows, of, others));
    expect_gradients_solve_it();
  }
}

// Who lists the blocks of rows need not know how many there are. Also where a device hands the system to the host.
TEST_F(BlockSolverTest, ListedBlocksMayHaveZerosBehindThem) {
  for (const int rows : {3, 60, 1500}) {
    const bool is_long = rows > 60;
    if (is_long && !TestBackend::kIsDevice) continue;
    make(rows, chain(rows));
    const LinearMethod method = is_long ? LinearMethod::standard : LinearMethod::gradients;
    const std::vector<AffineVec> x = solve({}, method, true), r = residual(x);
    EXPECT_LT(std::sqrt(product(r, r)), 1e-5 * std::sqrt(product(right_, right_))) << rows;
  }
}

// What gradients do not solve in 400 iterations, a device hands to the host.
TEST_F(BlockSolverTest, LongChainsAreSolvedWhateverTheBackend) {
  make(1500, chain(1500));
  const std::vector<AffineVec> x = solve({}, LinearMethod::standard), r = residual(x);
  EXPECT_LT(std::sqrt(product(r, r)), 1e-5 * std::sqrt(product(right_, right_)));
}

/// Whose rounding differs: of one in four an earlier method lost the equations.
constexpr unsigned kSystems = 12;

// Steps that meet the equations have no slope: what is left of the right-hand side is at a right angle to all of them.
TEST_F(BlockSolverTest, EquationsOfRowsHoldInBothWays) {
  for (unsigned seed = 1; seed <= kSystems; ++seed) {
    SCOPED_TRACE(seed);
    random_.seed(seed);
    make(20, chain(20));
    std::vector<NodeEquation> equations{point(3, -1), point(7, -1), point(7, -1)};
    equations[0].direction[1] = {0, std::sqrt(0.5), -std::sqrt(0.5)};  // and along x
    equations[0].count = 2;
    for (int k = 0; k < 4; ++k) {  // a body that cannot move at all
      NodeEquation e;
      e.row[0] = 12, e.weight[0][k] = 1;
      equations.push_back(e);
    }
    for (const LinearMethod method : {LinearMethod::direct, LinearMethod::gradients}) {
      const std::vector<AffineVec> x = solve(equations, method), r = residual(x);
      EXPECT_LT(broken(equations, x), 1e-12);
      std::swap(right_[0], right_[5]);
      const std::vector<AffineVec> other = solve(equations, method);
      std::swap(right_[0], right_[5]);
      EXPECT_LT(std::abs(product(r, other)), 1e-7);
      EXPECT_LT(std::abs(product(r, x)), 1e-7);
    }
  }
}

TEST_F(BlockSolverTest, EquationsBetweenRowsHoldAlsoInLoopsAndTwice) {
  for (unsigned seed = 1; seed <= kSystems; ++seed) {
    SCOPED_TRACE(seed);
    random_.seed(seed);
    make(20, chain(20));
    std::vector<NodeEquation> equations{point(0, -1)};
    for (int k = 0; k < 8; ++k) equations.push_back(point(k, k + 1));
    equations.push_back(point(8, 0));
    equations.push_back(equations[3]);  // says again what another says
    const std::vector<AffineVec> x = solve(equations, LinearMethod::standard), r = residual(x);
    EXPECT_LT(broken(equations, x), 1e-12);
    std::swap(right_[0], right_[5]);
    const std::vector<AffineVec> other = solve(equations, LinearMethod::standard);
    EXPECT_LT(std::abs(product(r, other)), 1e-7);
    EXPECT_GT(std::sqrt(product(r, r)), 1e-3);  // joints carry something
  }
}

}  // namespace
}  // namespace scree::affine
