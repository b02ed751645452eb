#include "dynamics/affine/block_factor.h"

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <cmath>
#include <vector>

namespace scree::affine {
namespace {

constexpr int kSize = 12;

/// A block by columns, so that a loop over its rows fills vector registers.
struct alignas(64) Block {
  double value[kSize * kSize];
};
struct alignas(32) Part {  ///< of a vector
  double value[kSize];
};

/// FourLanes numbers in a vector register. Written out, because loops over twelve numbers keep their sums in memory.
using FourLanes = double __attribute__((vector_size(32)));
constexpr int kFours = kSize / 4;

/// c -= a b^T.
void subtract_product(Block& c, const Block& a, const Block& b) {
  constexpr int kColumns = 4;
  for (int j = 0; j < kSize; j += kColumns) {
    FourLanes* const out = reinterpret_cast<FourLanes*>(c.value + kSize * j);
    FourLanes sum[kColumns][kFours];
    for (int m = 0; m < kColumns; ++m)
      for (int i = 0; i < kFours; ++i) sum[m][i] = out[kFours * m + i];
    for (int k = 0; k < kSize; ++k) {
      const FourLanes* const column = reinterpret_cast<const FourLanes*>(a.value + kSize * k);
      for (int m = 0; m < kColumns; ++m) {
        const double factor = b.value[kSize * k + j + m];
        const FourLanes factors = {factor, factor, factor, factor};
        for (int i = 0; i < kFours; ++i) sum[m][i] -= column[i] * factors;
      }
    }
    for (int m = 0; m < kColumns; ++m)
      for (int i = 0; i < kFours; ++i) out[kFours * m + i] = sum[m][i];
  }
}

/// Replaces the lower triangle by its Cholesky factor, and the upper one by zeros. @return whether all pivots were positive
bool factorize(Block& a) {
  for (int j = 0; j < kSize; ++j) {
    double* column = a.value + kSize * j;
    for (int k = 0; k < j; ++k) {
      const double* before = a.value + kSize * k;
      const double factor = before[j];
      for (int i = j; i < kSize; ++i) column[i] -= before[i] * factor;
    }
    if (!(column[j] > 0)) return false;
    const double root = std::sqrt(column[j]);
    for (int i = j; i < kSize; ++i) column[i] /= root;
    for (int i = 0; i < j; ++i) column[i] = 0;
  }
  return true;
}

/// a = a L^-T.
void divide(Block& a, const Block& l) {
  for (int j = 0; j < kSize; ++j) {
    double* column = a.value + kSize * j;
    for (int k = 0; k < j; ++k) {
      const double factor = l.value[kSize * k + j];
      const double* before = a.value + kSize * k;
      for (int i = 0; i < kSize; ++i) column[i] -= before[i] * factor;
    }
    const double root = l.value[kSize * j + j];
    for (int i = 0; i < kSize; ++i) column[i] /= root;
  }
}

/// x = L^-1 x.
void forward(const Block& l, Part& x) {
  for (int j = 0; j < kSize; ++j) {
    x.value[j] /= l.value[kSize * j + j];
    for (int i = j + 1; i < kSize; ++i) x.value[i] -= l.value[kSize * j + i] * x.value[j];
  }
}
/// x = L^-T x.
void backward(const Block& l, Part& x) {
  for (int j = kSize - 1; j >= 0; --j) {
    for (int i = j + 1; i < kSize; ++i) x.value[j] -= l.value[kSize * j + i] * x.value[i];
    x.value[j] /= l.value[kSize * j + j];
  }
}
/// y -= a x, and y -= a^T x.
void subtract(const Block& a, const Part& x, Part& y) {
  for (int j = 0; j < kSize; ++j)
    for (int i = 0; i < kSize; ++i) y.value[i] -= a.value[kSize * j + i] * x.value[j];
}
void subtract_turned(const Block& a, const Part& x, Part& y) {
  for (int j = 0; j < kSize; ++j)
    for (int i = 0; i < kSize; ++i) y.value[j] -= a.value[kSize * j + i] * x.value[i];
}

double& entry(AffineVec& v, int i) { return v.node[i / 3][i % 3]; }
double entry(const AffineVec& v, int i) { return v.node[i / 3][i % 3]; }

/// y -= block x, or its transpose.
void subtract(const Dense<12>& block, bool is_turned, const AffineVec& x, AffineVec& y) {
  for (int i = 0; i < kSize; ++i)
    for (int j = 0; j < kSize; ++j)
      entry(y, i) -= (is_turned ? block(j, i) : block(i, j)) * entry(x, j);
}

}  // namespace

struct BlockFactor::Impl {
  Index rows = -1;
  std::vector<Index> pattern;  ///< rows and columns of the mixed blocks
  std::vector<Index> place;    ///< of a row in the order of elimination
  // Columns of L: blocks below the diagonal, with the places of their rows rising.
  std::vector<Offset> begin;
  std::vector<Index> below;
  // Blocks of each line of L left of the diagonal, by column.
  std::vector<Offset> line_begin;
  std::vector<Index> line_column;
  std::vector<Offset> line_block;
  std::vector<Offset> of_mixed;  ///< block of L at the place of a mixed block
  std::vector<bool> is_turned;   ///< whether that is the place of its transpose
  std::vector<Block> diagonal, block;
  std::vector<Index> slot;  ///< block of a row in the column at work

  bool has_pattern(const BlockSystemView& s) const {
    if (s.diagonal.size != rows || static_cast<Offset>(pattern.size()) != 2 * s.mixed.size)
      return false;
    for (Offset k = 0; k < s.mixed.size; ++k) {
      const auto at = static_cast<std::size_t>(2 * k);
      if (pattern[at] != s.mixed[k].row || pattern[at + 1] != s.mixed[k].column) return false;
    }
    return true;
  }

  void analyze(const BlockSystemView& s) {
    rows = static_cast<Index>(s.diagonal.size);
    const auto n = static_cast<std::size_t>(rows);
    pattern.clear();
    for (Offset k = 0; k < s.mixed.size; ++k) {
      pattern.push_back(s.mixed[k].row);
      pattern.push_back(s.mixed[k].column);
    }
    order(s);
    find_columns(s);
    line_begin.assign(n + 1, 0);
    for (const Index row : below) ++line_begin[static_cast<std::size_t>(row) + 1];
    for (std::size_t j = 0; j < n; ++j) line_begin[j + 1] += line_begin[j];
    std::vector<Offset> next(line_begin.begin(), line_begin.end() - 1);
    line_column.resize(below.size());
    line_block.resize(below.size());
    for (Index j = 0; j < rows; ++j) {
      for (Offset k = begin[static_cast<std::size_t>(j)];
           k < begin[static_cast<std::size_t>(j) + 1]; ++k) {
        const auto at = static_cast<std::size_t>(next[static_cast<std::size_t>(below[k])]++);
        line_column[at] = j;
        line_block[at] = k;
      }
    }
    of_mixed.resize(static_cast<std::size_t>(s.mixed.size));
    is_turned.resize(of_mixed.size());
    for (Offset k = 0; k < s.mixed.size; ++k) {
      const Index a = place[static_cast<std::size_t>(s.mixed[k].row)];
      const Index b = place[static_cast<std::size_t>(s.mixed[k].column)];
      const auto column = static_cast<std::size_t>(std::min(a, b));
      const auto at = std::lower_bound(below.begin() + begin[column],
                                       below.begin() + begin[column + 1], std::max(a, b));
      of_mixed[static_cast<std::size_t>(k)] = at - below.begin();
      is_turned[static_cast<std::size_t>(k)] = a < b;  // the block of L is that below the diagonal
    }
    diagonal.resize(n);
    block.resize(below.size());
    slot.assign(n, -1);
  }

  void order(const BlockSystemView& s) {
    Eigen::SparseMatrix<double> graph(rows, rows);
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(static_cast<std::size_t>(rows + 2 * s.mixed.size));
    for (Index i = 0; i < rows; ++i) entries.emplace_back(i, i, 1);
    for (Offset k = 0; k < s.mixed.size; ++k) {
      entries.emplace_back(s.mixed[k].row, s.mixed[k].column, 1);
      entries.emplace_back(s.mixed[k].column, s.mixed[k].row, 1);
    }
    graph.setFromTriplets(entries.begin(), entries.end());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> next;  // the row at each place
    if (rows > 0) Eigen::AMDOrdering<int>()(graph, next);
    place.resize(static_cast<std::size_t>(rows));
    for (Index i = 0; i < rows; ++i) place[static_cast<std::size_t>(next.indices()[i])] = i;
  }

  /// A column of L has the rows of its column of H, and those of the columns whose first row below the diagonal it is.
  void find_columns(const BlockSystemView& s) {
    const auto n = static_cast<std::size_t>(rows);
    std::vector<std::vector<Index>> column(n), child(n);
    for (Offset k = 0; k < s.mixed.size; ++k) {
      const Index a = place[static_cast<std::size_t>(s.mixed[k].row)];
      const Index b = place[static_cast<std::size_t>(s.mixed[k].column)];
      column[static_cast<std::size_t>(std::min(a, b))].push_back(std::max(a, b));
    }
    begin.assign(1, 0);
    below.clear();
    for (std::size_t j = 0; j < n; ++j) {
      std::vector<Index>& mine = column[j];
      for (const Index c : child[j]) {
        const auto from = static_cast<std::size_t>(c);
        mine.insert(mine.end(), below.begin() + begin[from] + 1, below.begin() + begin[from + 1]);
      }
      std::sort(mine.begin(), mine.end());
      mine.erase(std::unique(mine.begin(), mine.end()), mine.end());
      below.insert(below.end(), mine.begin(), mine.end());
      begin.push_back(static_cast<Offset>(below.size()));
      if (!mine.empty())
        child[static_cast<std::size_t>(mine.front())].push_back(static_cast<Index>(j));
      mine = {};
    }
  }

  void fill(const BlockSystemView& s, double shift) {
    std::fill(block.begin(), block.end(), Block{});
    for (Index row = 0; row < rows; ++row) {
      Block& d = diagonal[static_cast<std::size_t>(place[static_cast<std::size_t>(row)])];
      for (int i = 0; i < kSize * kSize; ++i) d.value[i] = s.diagonal[row].entry[i];
      for (int i = 0; i < kSize; ++i) d.value[(kSize + 1) * i] += shift;
    }
    for (Offset k = 0; k < s.mixed.size; ++k) {
      const Dense<12>& from = s.mixed[k].value;
      Block& to = block[static_cast<std::size_t>(of_mixed[static_cast<std::size_t>(k)])];
      if (is_turned[static_cast<std::size_t>(k)]) {
        for (int i = 0; i < kSize * kSize; ++i) to.value[i] = from.entry[i];
      } else {
        for (int i = 0; i < kSize; ++i)
          for (int j = 0; j < kSize; ++j) to.value[kSize * j + i] = from(i, j);
      }
    }
  }

  bool factorize_all() {
    for (std::size_t j = 0; j < static_cast<std::size_t>(rows); ++j) {
      for (Offset k = begin[j]; k < begin[j + 1]; ++k)
        slot[static_cast<std::size_t>(below[k])] = static_cast<Index>(k - begin[j]);
      Block* const column = block.data() + begin[j];
      for (Offset k = line_begin[j]; k < line_begin[j + 1]; ++k) {
        const Offset at = line_block[static_cast<std::size_t>(k)];
        const Offset end =
            begin[static_cast<std::size_t>(line_column[static_cast<std::size_t>(k)]) + 1];
        const Block& own = block[static_cast<std::size_t>(at)];
        subtract_product(diagonal[j], own, own);
        for (Offset m = at + 1; m < end; ++m)
          subtract_product(
              column[slot[static_cast<std::size_t>(below[static_cast<std::size_t>(m)])]],
              block[static_cast<std::size_t>(m)], own);
      }
      if (!factorize(diagonal[j])) return false;
      for (Offset k = begin[j]; k < begin[j + 1]; ++k) divide(column[k - begin[j]], diagonal[j]);
    }
    return true;
  }

  void solve_factors(Span<const AffineVec> right, Span<AffineVec> step) const {
    const auto n = static_cast<std::size_t>(rows);
    std::vector<Part> x(n);
    for (Index row = 0; row < rows; ++row)
      for (int i = 0; i < kSize; ++i)
        x[static_cast<std::size_t>(place[static_cast<std::size_t>(row)])].value[i] =
            entry(right[row], i);
    for (std::size_t j = 0; j < n; ++j) {
      forward(diagonal[j], x[j]);
      for (auto k = static_cast<std::size_t>(begin[j]); k < static_cast<std::size_t>(begin[j + 1]);
           ++k)
        subtract(block[k], x[j], x[static_cast<std::size_t>(below[k])]);
    }
    for (std::size_t j = n; j-- > 0;) {
      for (auto k = static_cast<std::size_t>(begin[j]); k < static_cast<std::size_t>(begin[j + 1]);
           ++k)
        subtract_turned(block[k], x[static_cast<std::size_t>(below[k])], x[j]);
      backward(diagonal[j], x[j]);
    }
    for (Index row = 0; row < rows; ++row)
      for (int i = 0; i < kSize; ++i)
        entry(step[row], i) =
            x[static_cast<std::size_t>(place[static_cast<std::size_t>(row)])].value[i];
  }
};

BlockFactor::BlockFactor() : impl_(std::make_unique<Impl>()) {}
BlockFactor::~BlockFactor() = default;
BlockFactor::BlockFactor(BlockFactor&&) noexcept = default;
BlockFactor& BlockFactor::operator=(BlockFactor&&) noexcept = default;

Offset BlockFactor::fill() const { return static_cast<Offset>(impl_->below.size()); }

BlockFactor::Report BlockFactor::solve(const BlockSystemView& system, Span<AffineVec> step) {
  /// Shifts that are tried, in parts of the largest diagonal entry, and corrections that take one out again.
  constexpr double kShifts[] = {0, 1e-14, 1e-12, 1e-10, 1e-8, 1e-6};
  constexpr int kCorrections = 20;
  Impl& m = *impl_;
  if (!m.has_pattern(system)) m.analyze(system);
  double largest = 0;
  for (Index row = 0; row < m.rows; ++row)
    for (int i = 0; i < kSize; ++i) largest = std::max(largest, system.diagonal[row](i, i));
  Report report;
  for (const double shift : kShifts) {
    m.fill(system, shift * largest);
    report.shift = shift;
    report.is_solved = m.factorize_all();
    if (report.is_solved) break;
  }
  if (!report.is_solved) return report;
  m.solve_factors(system.right, step);

  std::vector<AffineVec> left(static_cast<std::size_t>(m.rows)), more(left.size());
  const auto measure = [&] {
    double square = 0, whole = 0;
    for (Index row = 0; row < m.rows; ++row) {
      left[static_cast<std::size_t>(row)] = system.right[row];
      subtract(system.diagonal[row], false, step[row], left[static_cast<std::size_t>(row)]);
      whole += dot(system.right[row], system.right[row]);
    }
    for (Offset k = 0; k < system.mixed.size; ++k) {
      const MixedBlock& b = system.mixed[k];
      subtract(b.value, false, step[b.column], left[static_cast<std::size_t>(b.row)]);
      subtract(b.value, true, step[b.row], left[static_cast<std::size_t>(b.column)]);
    }
    for (const AffineVec& r : left) square += dot(r, r);
    report.residual = whole > 0 ? std::sqrt(square / whole) : 0;
  };
  measure();
  for (int k = 0; k < kCorrections && report.shift > 0 && report.residual > 1e-10; ++k) {
    m.solve_factors({left.data(), m.rows}, {more.data(), m.rows});
    const double before = report.residual;
    for (Index row = 0; row < m.rows; ++row) step[row] += more[static_cast<std::size_t>(row)];
    measure();
    if (!(report.residual < before)) {
      for (Index row = 0; row < m.rows; ++row)
        step[row] += -1.0 * more[static_cast<std::size_t>(row)];
      report.residual = before;
      break;
    }
  }
  report.is_solved = std::isfinite(report.residual);
  return report;
}

}  // namespace scree::affine
