#include "solvers/assembled/newton_system.h"

#include <Eigen/LU>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "solvers/assembled/block_factors.h"
#include "solvers/assembled/cone_vectors.h"

namespace scree {
namespace {

using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
using Vector = Eigen::VectorXd;
using Small = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

/// Contacts that touch from which on block factors are the faster ones, by far.
constexpr int many_contacts = 300;
/// Residual of a solution over that of zero, which refinement tries to get below.
constexpr double refined_to = 1e-12;
constexpr int most_refinements = 3;

Eigen::Map<const Small> as_small(const Block3& b) { return Eigen::Map<const Small>(b.data()); }

Block3 as_block(const Small& m) {
  Block3 b;
  std::copy(m.data(), m.data() + 9, b.begin());
  return b;
}

bool depends_on_velocity(const ContactFunction& f) {
  return std::any_of(f.by_u.begin(), f.by_u.end(), [](double x) { return std::abs(x) > 0; });
}

}  // namespace

struct NewtonSystem::Factors {
  const AssembledProblem& contacts;
  const std::vector<double>& contact_scale;
  AssembledProblem p;         ///< with held rows behind the contacts, whose function is u
  std::vector<double> scale;  ///< zero for them: they are not shifted
  double shift;
  std::vector<ContactFunction> at;
  std::vector<int> touching;  ///< contacts that are unknowns
  std::vector<int> number;    ///< of a contact among them, -1: none
  std::optional<BlockFactors> blocks;
  Eigen::SparseLU<Matrix> sparse;

  Factors(const AssembledProblem& problem, const std::vector<double>& scales, double shifted)
      : contacts(problem),
        contact_scale(scales),
        p(bordered(problem)),
        scale(scales),
        shift(shifted) {
    scale.resize(p.contact_count, 0.0);
  }

  /// J_ck of a contact and the block k of its row.
  Small entry(int c, int k) const {
    Small j = as_small(at[c].by_u) * as_small(p.block[k]);
    if (p.column[k] == c) j += as_small(at[c].by_r) + shift * scale[c] * as_small(at[c].by_u);
    return j;
  }

  BlockMatrix block_matrix() const {
    BlockMatrix m;
    m.row_start.push_back(0);
    for (const int c : touching) {
      for (int k = p.row_start[c]; k < p.row_start[c + 1]; ++k) {
        if (number[p.column[k]] < 0) continue;
        m.column.push_back(number[p.column[k]]);
        m.block.push_back(as_block(entry(c, k)));
      }
      m.row_start.push_back(static_cast<int>(m.column.size()));
    }
    return m;
  }

  Matrix sparse_matrix() const {
    std::vector<Eigen::Triplet<double>> entries;
    for (const int c : touching) {
      for (int k = p.row_start[c]; k < p.row_start[c + 1]; ++k) {
        const int column = number[p.column[k]];
        if (column < 0) continue;
        const Small j = entry(c, k);
        for (int row = 0; row < 3; ++row)
          for (int i = 0; i < 3; ++i)
            if (std::abs(j(row, i)) > 0)
              entries.emplace_back(3 * number[c] + row, 3 * column + i, j(row, i));
      }
    }
    const int rows = 3 * static_cast<int>(touching.size());
    Matrix m(rows, rows);
    m.setFromTriplets(entries.begin(), entries.end());
    return m;
  }

  bool factorize() {
    number.assign(p.contact_count, -1);
    touching.clear();
    for (int c = 0; c < p.contact_count; ++c) {
      if (!depends_on_velocity(at[c])) continue;
      number[c] = static_cast<int>(touching.size());
      touching.push_back(c);
    }
    blocks.reset();
    if (touching.empty()) return true;
    if (static_cast<int>(touching.size()) >= many_contacts) {
      const BlockMatrix m = block_matrix();
      blocks.emplace(m);
      return blocks->factorize(m, BlockFactors::Kind::lu);
    }
    sparse.compute(sparse_matrix());
    return sparse.info() == Eigen::Success;
  }

  std::vector<double> solve_once(const std::vector<double>& b) const {
    std::vector<double> x(b.size(), 0.0);
    for (int c = 0; c < p.contact_count; ++c) {
      if (number[c] >= 0) continue;
      const Eigen::Vector3d own =
          as_small(at[c].by_r).inverse() * Eigen::Map<const Eigen::Vector3d>(&b[3 * c]);
      std::copy(own.data(), own.data() + 3, &x[3 * c]);
    }
    std::vector<double> reduced;
    for (const int c : touching) {
      Eigen::Vector3d left = Eigen::Map<const Eigen::Vector3d>(&b[3 * c]);
      for (int k = p.row_start[c]; k < p.row_start[c + 1]; ++k)
        if (number[p.column[k]] < 0)
          left -= entry(c, k) * Eigen::Map<const Eigen::Vector3d>(&x[3 * p.column[k]]);
      reduced.insert(reduced.end(), left.data(), left.data() + 3);
    }
    if (blocks.has_value()) {
      blocks->solve(reduced);
    } else if (!touching.empty()) {
      Eigen::Map<Vector> right(reduced.data(), static_cast<Eigen::Index>(reduced.size()));
      right = sparse.solve(right).eval();
    }
    for (std::size_t k = 0; k < reduced.size(); ++k) x[3 * touching[k / 3] + k % 3] = reduced[k];
    return x;
  }

  /// b - J x
  std::vector<double> missing(const std::vector<double>& b, const std::vector<double>& x) const {
    std::vector<double> u;
    multiply(p, x, u);
    for (int c = 0; c < p.contact_count; ++c) {
      const Eigen::Map<const Eigen::Vector3d> xc(&x[3 * c]), bc(&b[3 * c]);
      Eigen::Map<Eigen::Vector3d> uc(&u[3 * c]);
      uc = (bc - as_small(at[c].by_r) * xc - as_small(at[c].by_u) * (uc + shift * scale[c] * xc))
               .eval();
    }
    return u;
  }
};

NewtonSystem::NewtonSystem(const AssembledProblem& p, const std::vector<double>& scale,
                           double shift)
    : factors_(std::make_unique<Factors>(p, scale, shift)) {}

NewtonSystem::~NewtonSystem() = default;

bool NewtonSystem::factorize(const std::vector<ContactFunction>& at) {
  ContactFunction held{};
  held.by_u = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  factors_->at = at;
  factors_->at.resize(factors_->p.contact_count, held);
  return factors_->factorize();
}

std::vector<double> NewtonSystem::solve(const std::vector<double>& given, long& products) const {
  const Factors& f = *factors_;
  std::vector<double> b = given;
  b.resize(f.p.q.size(), 0.0);
  std::vector<double> x = f.solve_once(b);
  for (int k = 0; f.blocks.has_value() && k < most_refinements; ++k) {
    const std::vector<double> left = f.missing(b, x);
    ++products;
    if (!(norm(left) > refined_to * norm(b))) break;
    const std::vector<double> more = f.solve_once(left);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += more[i];
  }
  x.resize(given.size());
  return x;
}

std::vector<double> NewtonSystem::gradient() const {
  return merit_gradient(factors_->contacts, factors_->contact_scale, factors_->shift, factors_->at);
}

std::vector<double> merit_gradient(const AssembledProblem& p, const std::vector<double>& scale,
                                   double shift, const std::vector<ContactFunction>& at) {
  std::vector<double> direct(p.q.size()), by_u(p.q.size());
  for (int c = 0; c < p.contact_count; ++c) {
    const Eigen::Vector3d y = scale[c] * Eigen::Map<const Eigen::Vector3d>(at[c].value);
    Eigen::Map<Eigen::Vector3d> own(&direct[3 * c]), through_u(&by_u[3 * c]);
    through_u = as_small(at[c].by_u).transpose() * y;
    own = as_small(at[c].by_r).transpose() * y + shift * scale[c] * through_u;
  }
  std::vector<double> result = multiply_transposed(p, by_u);
  for (std::size_t i = 0; i < result.size(); ++i) result[i] += direct[i];
  return result;
}

}  // namespace scree
