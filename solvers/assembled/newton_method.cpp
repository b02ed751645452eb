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

/// The function of all contacts at one point.
class Equations {
 public:
  Equations(const AssembledProblem& p, AssembledModel model)
      : p_(p), model_(model), scale_(contact_scales(p)), at_(p.contact_count) {
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
      at_[c] = contact_function(model_, p_.mu[c], weights_[c], scale_[c], &r[3 * c], &u_[3 * c]);
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
  std::vector<double> scale_;
  std::vector<ContactWeights> weights_;
  std::vector<ContactFunction> at_;
  std::vector<double> u_;
};

}  // namespace

void run_newton(const AssembledProblem& p, const AssembledOptions& o,
                const NewtonSettings& settings, AssembledMonitor& monitor) {
  Equations equations(p, o.model);
  std::vector<double> r = o.guess, trial(r.size());
  double merit = equations.evaluate(r, monitor);
  Eigen::SparseLU<Matrix> factors;
  for (int k = 0;; ++k) {
    if (monitor.due(k) && monitor.look(k, r, equations.velocity())) return;
    factors.compute(equations.jacobian(settings.shift));
    monitor.count_factorizations();
    if (factors.info() != Eigen::Success)
      return monitor.fail(AssembledStatus::singular, "the Jacobian is singular");
    const Vector step = factors.solve(equations.value());
    if (!step.allFinite())
      return monitor.fail(AssembledStatus::singular, "the Jacobian is singular to rounding");
    double length = 1;
    for (int t = 0;; ++t, length *= 0.5) {
      for (std::size_t i = 0; i < r.size(); ++i)
        trial[i] = r[i] - length * step(static_cast<int>(i));
      const double next = equations.evaluate(trial, monitor);
      if (next <= (1 - 2 * settings.least_descent * length) * merit) {
        merit = next;
        break;
      }
      if (t == settings.trials) {
        monitor.look(k, r);
        if (monitor.stopped()) return;
        return monitor.fail(AssembledStatus::stalled, "no descent of the merit function");
      }
    }
    r.swap(trial);
  }
}

}  // namespace scree
