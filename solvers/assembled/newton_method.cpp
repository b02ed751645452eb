#include "solvers/assembled/newton_method.h"

// Matrices of contacts are small: Eigen's threads would cost more than they save.
#define EIGEN_DONT_PARALLELIZE
#include <Eigen/SparseLU>
#include <cmath>
#include <vector>

#include "solvers/assembled/contact_function.h"

namespace scree {
namespace {

using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
using Vector = Eigen::VectorXd;

/// Step over value of the function, both impulses, from which a step that leads nowhere down is
/// rounding of a singular Jacobian.
constexpr double singular_from = 1e5;

/// The function of all contacts at one point.
class Equations {
 public:
  /// All must outlive this.
  Equations(const AssembledProblem& p, AssembledModel model, const NewtonLaw& law)
      : p_(p), model_(model), law_(law), scale_(contact_scales(p)), at_(p.contact_count) {
    for (int c = 0; c < p.contact_count; ++c)
      weights_.push_back(contact_weights(p.diagonal(c), scale_[c]));
  }

  /// @return the merit 1/2 |D^1/2 F|^2 [J]
  double evaluate(const std::vector<double>& r, AssembledMonitor& monitor) {
    multiply(p_, r, u_);
    monitor.count_applications();
    double sum = 0;
    for (int c = 0; c < p_.contact_count; ++c) {
      for (int k = 0; k < 3; ++k) u_[3 * c + k] += p_.q[3 * c + k];
      at_[c] = law_.name.empty() ? contact_function(model_, p_.mu[c], weights_[c], scale_[c],
                                                    &r[3 * c], &u_[3 * c])
                                 : law_.function(c, &r[3 * c], &u_[3 * c]);
      for (const double f : at_[c].value) sum += scale_[c] * f * f;
    }
    return 0.5 * sum;
  }

  const std::vector<double>& velocity() const { return u_; }

  Vector value() const {
    Vector f(3 * p_.contact_count);
    for (int c = 0; c < p_.contact_count; ++c)
      for (int k = 0; k < 3; ++k) f(3 * c + k) = at_[c].value[k];
    return f;
  }

  /// D F, by which the transposed Jacobian makes the gradient of the merit.
  Vector weighted_value() const {
    Vector f = value();
    for (int c = 0; c < p_.contact_count; ++c) f.segment<3>(3 * c) *= scale_[c];
    return f;
  }

  /// |D^-1/2 q|, which |D^1/2 F| is measured by.
  double load() const {
    double sum = 0;
    for (std::size_t k = 0; k < p_.q.size(); ++k) sum += p_.q[k] * p_.q[k] / scale_[k / 3];
    return std::sqrt(sum);
  }

  /// dF/dr + dF/du (W + shift D), rows of contacts that touch nothing being those of the identity.
  Matrix jacobian(double shift) const {
    std::vector<Eigen::Triplet<double>> entries;
    for (int c = 0; c < p_.contact_count; ++c) {
      const ContactFunction& f = at_[c];
      for (int i = 0; i < 3; ++i) {
        const double* by_u = &f.by_u[3 * i];
        const bool touches = by_u[0] != 0 || by_u[1] != 0 || by_u[2] != 0;
        for (int j = 0; j < 3; ++j) {
          const double own = f.by_r[3 * i + j] + shift * scale_[c] * by_u[j];
          if (own != 0) entries.emplace_back(3 * c + i, 3 * c + j, own);
        }
        if (!touches) continue;
        for (int k = p_.row_start[c]; k < p_.row_start[c + 1]; ++k) {
          const Block3& w = p_.block[k];
          for (int j = 0; j < 3; ++j) {
            const double value = by_u[0] * w[j] + by_u[1] * w[3 + j] + by_u[2] * w[6 + j];
            if (value != 0) entries.emplace_back(3 * c + i, 3 * p_.column[k] + j, value);
          }
        }
      }
    }
    Matrix J(3 * p_.contact_count, 3 * p_.contact_count);
    J.setFromTriplets(entries.begin(), entries.end());
    return J;
  }

 private:
  const AssembledProblem& p_;
  AssembledModel model_;
  const NewtonLaw& law_;
  std::vector<double> scale_;
  std::vector<ContactWeights> weights_;
  std::vector<ContactFunction> at_;
  std::vector<double> u_;
};

/// One solve.
class Newton {
 public:
  Newton(const AssembledProblem& p, const AssembledOptions& o, const NewtonSettings& settings,
         AssembledMonitor& monitor)
      : settings_(settings),
        monitor_(monitor),
        equations_(p, o.model, settings_.law),
        r_(o.guess),
        merit_(equations_.evaluate(r_, monitor)),
        settled_(o.tolerance * equations_.load()) {}

  void run() {
    for (int k = 0;; ++k) {
      if (monitor_.due(k) && monitor_.look(k, r_, equations_.velocity())) return;
      if (!settings_.law.name.empty() && std::sqrt(2 * merit_) <= settled_) {
        if (!monitor_.look(k, r_, equations_.velocity()))
          monitor_.fail(AssembledStatus::stalled,
                        "solved with " + settings_.law.name + ", not the cone");
        return;
      }
      const Matrix jacobian = equations_.jacobian(settings_.shift);
      factors_.compute(jacobian);
      monitor_.count_factorizations();
      if (factors_.info() != Eigen::Success)
        return monitor_.fail(AssembledStatus::singular, "the Jacobian is singular");
      const Vector value = equations_.value();
      const Vector step = factors_.solve(value);
      if (!step.allFinite())
        return monitor_.fail(AssembledStatus::singular, "the Jacobian is singular to rounding");
      const Vector slope = jacobian.transpose() * equations_.weighted_value();
      // Along a Newton step the merit falls by twice itself at first.
      if (descend(step, 2 * merit_)) continue;
      monitor_.look(k, r_);
      if (monitor_.stopped()) return;
      if (step.norm() > singular_from * value.norm())
        return monitor_.fail(AssembledStatus::singular, "the Jacobian is singular to rounding");
      const double steepest = slope.squaredNorm();
      const bool is_trapped = !descend(merit_ / steepest * slope, merit_);
      return monitor_.fail(AssembledStatus::stalled,
                           is_trapped ? "trapped at a kink or local minimum of the merit function"
                                      : "no descent of the merit function along the Newton step");
    }
  }

 private:
  /// Backtracks from r - step until the merit is less by Armijo's share of its slope.
  /// @return whether it found such a point; r is then that one, and as it was otherwise
  bool descend(const Vector& step, double slope) {
    std::vector<double> trial(r_.size());
    double length = 1;
    for (int t = 0; t <= settings_.trials; ++t, length *= 0.5) {
      for (std::size_t i = 0; i < r_.size(); ++i)
        trial[i] = r_[i] - length * step(static_cast<int>(i));
      const double next = equations_.evaluate(trial, monitor_);
      if (!(next <= merit_ - settings_.least_descent * length * slope)) continue;
      merit_ = next;
      r_.swap(trial);
      return true;
    }
    return false;
  }

  const NewtonSettings& settings_;
  AssembledMonitor& monitor_;
  Equations equations_;
  std::vector<double> r_;
  double merit_;
  double settled_;
  Eigen::SparseLU<Matrix> factors_;
};

}  // namespace

void run_newton(const AssembledProblem& p, const AssembledOptions& o,
                const NewtonSettings& settings, AssembledMonitor& monitor) {
  Newton(p, o, settings, monitor).run();
}

}  // namespace scree
