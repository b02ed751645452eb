#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>

#include "solvers/rolling/rolling_methods.h"

namespace scree {
namespace {

using Matrix = Eigen::SparseMatrix<double>;
using Vector = Eigen::VectorXd;
using Block = Eigen::Matrix<double, 5, 5>;

constexpr int most_newton_steps = 30, most_halvings = 12;
constexpr double first_weight = 1e-2, least_weight = 1e-9, most_weight = 1e3;

/// Where a contact with trial impulses y goes, and the derivative of that.
/// Convex: onto the cone. Exact: n on what presses, parts on the disks that n allows.
void set_projection(AssembledModel model, const RollingCone& cone, const double* y, double* x,
                    Block& derivative) {
  const double size[2] = {std::hypot(y[1], y[2]), std::hypot(y[3], y[4])};
  const double mu[2] = {cone.mu, cone.mu_r};
  Eigen::Matrix<double, 1, 5> dn = Eigen::Matrix<double, 1, 5>::Zero();
  double n = std::max(0.0, y[0]);
  dn(0) = 1;
  if (model == AssembledModel::convex) {
    const BoundedPart<double> parts[2] = {{mu[0], 1, size[0]}, {mu[1], 1, size[1]}};
    n = shared_normal(1.0, y[0], parts);
    double stiffness = 1;
    for (int k = 0; k < 2; ++k)
      if (size[k] > mu[k] * n) {
        stiffness += mu[k] * mu[k];
        for (int i = 1 + 2 * k; i < 3 + 2 * k; ++i) dn(i) = mu[k] * y[i] / size[k];
      }
    dn /= stiffness;
  }
  derivative.setZero();
  std::fill(x, x + 5, 0.0);
  if (!(n > 0)) return;
  x[0] = n;
  derivative.row(0) = dn;
  for (int k = 0; k < 2; ++k) {
    const int at = 1 + 2 * k;
    const bool inside = size[k] <= mu[k] * n;
    const double keep = inside ? 1 : mu[k] * n / size[k];
    for (int i = at; i < at + 2; ++i) {
      x[i] = keep * y[i];
      derivative(i, i) = keep;
      if (inside) continue;
      derivative.row(i) += mu[k] * y[i] / size[k] * dn;
      for (int j = at; j < at + 2; ++j)
        derivative(i, j) -= keep * y[i] * y[j] / (size[k] * size[k]);
    }
  }
}

/// F(x) = x - P(x - s v) with v = W x + q + a (x - center), and its derivative.
class ProximalProblem {
 public:
  ProximalProblem(const RollingProblem& p, AssembledModel model)
      : p_(p), model_(model), rows_(5 * p.contact_count), step_(rows_) {
    std::vector<Eigen::Triplet<double>> entries;
    Vector diagonal = Vector::Zero(rows_);
    for (int row = 0; row < rows_; ++row)
      for (int k = p.row_start[row]; k < p.row_start[row + 1]; ++k) {
        entries.emplace_back(row, p.column[k], p.value[k]);
        if (p.column[k] == row) diagonal(row) = p.value[k];
      }
    for (int row = 0; row < rows_; ++row) entries.emplace_back(row, row, 0.0);
    W_.resize(rows_, rows_);
    W_.setFromTriplets(entries.begin(), entries.end());
    // One step for all rows of a contact: another one for its parts would be another cone.
    for (int c = 0; c < p.contact_count; ++c)
      step_.segment<5>(5 * c).setConstant(1 /
                                          std::max(1e-3, diagonal.segment<5>(5 * c).maxCoeff()));
  }

  const Matrix& W() const { return W_; }

  Vector velocity(const Vector& x) const {
    return W_ * x + Eigen::Map<const Vector>(p_.q.data(), rows_);
  }

  Vector value(double weight, const Vector& center, const Vector& x, const Vector& u,
               std::vector<Block>* derivatives = nullptr) const {
    const Vector y = x - step_.cwiseProduct(u + weight * (x - center));
    Vector projected(rows_);
    Block derivative;
    if (derivatives != nullptr) derivatives->clear();
    for (int c = 0; c < p_.contact_count; ++c) {
      set_projection(model_, cone_of(p_, c), &y(5 * c), &projected(5 * c), derivative);
      if (derivatives != nullptr) derivatives->push_back(derivative);
    }
    return x - projected;
  }

  /// I - D + D s (W + a), D the blocks of derivatives: the same places whatever D is.
  Matrix derivative(double weight, const std::vector<Block>& blocks) const {
    std::vector<Eigen::Triplet<double>> d, rest;
    for (int c = 0; c < p_.contact_count; ++c)
      for (int i = 0; i < 5; ++i)
        for (int j = 0; j < 5; ++j) {
          const double value = blocks[c](i, j);
          d.emplace_back(5 * c + i, 5 * c + j, value * step_(5 * c + j));
          rest.emplace_back(5 * c + i, 5 * c + j,
                            (i == j) - value * (1 - weight * step_(5 * c + j)));
        }
    Matrix D(rows_, rows_), sum(rows_, rows_);
    D.setFromTriplets(d.begin(), d.end());
    sum.setFromTriplets(rest.begin(), rest.end());
    return sum + Matrix(D * W_);
  }

 private:
  const RollingProblem& p_;
  AssembledModel model_;
  int rows_;
  Vector step_;
  Matrix W_;
};

/// Newton's method with a line search on |F| from x. @return whether it got to `goal`
bool newton(const ProximalProblem& problem, double weight, const Vector& center, double share,
            Eigen::SparseLU<Matrix>& factors, bool& analyzed, Vector& x, int& products,
            RollingMonitor& monitor) {
  std::vector<Block> blocks;
  Vector u = problem.velocity(x);
  ++products;
  Vector f = problem.value(weight, center, x, u, &blocks);
  const double start = f.norm();
  for (int k = 0; k < most_newton_steps; ++k) {
    if (f.norm() <= share * std::min(start, weight * (x - center).norm())) return true;
    Matrix a = problem.derivative(weight, blocks);
    a.makeCompressed();
    if (monitor.out_of_time()) return false;
    if (!analyzed) factors.analyzePattern(a);
    analyzed = true;
    factors.factorize(a);
    monitor.count_factorizations(1);
    if (factors.info() != Eigen::Success) return false;
    const Vector step = factors.solve(f);
    if (!step.allFinite()) return false;
    const Vector moved = problem.W() * step;
    ++products;
    double t = 1;
    Vector trial, trial_u, trial_f;
    int halving = 0;
    for (; halving < most_halvings; ++halving, t *= 0.5) {
      trial = x - t * step;
      trial_u = u - t * moved;
      trial_f = problem.value(weight, center, trial, trial_u, &blocks);
      if (trial_f.norm() <= (1 - 1e-4 * t) * f.norm()) break;
    }
    if (halving == most_halvings) return f.norm() <= 1e-3 * start;
    x = trial;
    u = trial_u;
    f = trial_f;
  }
  return f.norm() <= 1e-1 * start;
}

}  // namespace

void run_rolling_proximal(const RollingProblem& p, AssembledModel model, std::vector<double>& x,
                          RollingMonitor& monitor) {
  const ProximalProblem problem(p, model);
  Eigen::SparseLU<Matrix> factors;
  bool analyzed = false;
  double weight = first_weight;
  while (!monitor.over(x)) {
    const Vector center = Eigen::Map<const Vector>(x.data(), static_cast<int>(x.size()));
    Vector next = center;
    int products = 0;
    const bool solved =
        newton(problem, weight, center, 0.1, factors, analyzed, next, products, monitor);
    monitor.count(products);
    if (solved) {
      x.assign(next.data(), next.data() + next.size());
      weight = std::max(least_weight, weight * 0.2);
    } else {
      weight *= 10;
      if (weight > most_weight) return;
    }
  }
}

}  // namespace scree
