// Projected Jacobi: r+ = P_K(r - omega v / s) for all contacts at once, v of the model.
//
// s_c is the sum over the block row of sqrt(d_c / d_k) times the largest stretch of W_ck. It bounds
// W from above as the mass-split metric does, but from W alone, so with a symmetric W and the
// convex model every step descends for omega < 2. One iteration is one product with W. Source:
// Tonge, Benevolenski and Voroshilov, ACM TOG 31(4), 2012, with the bound taken from W by the test
// of Schur.

#include <algorithm>
#include <cmath>

#include "solvers/assembled/assembled_solver.h"

namespace scree {
namespace {

/// Frobenius norm, at least the largest stretch of a block.
double size_of(const Block3& b) {
  double sum = 0;
  for (const double x : b) sum += x * x;
  return std::sqrt(sum);
}

/// s_c of all contacts [1/kg]. sum_k |W_ck| w_k <= s_c w_c with w = d^-1/2 gives W <= diag(s).
std::vector<double> row_bounds(const AssembledProblem& p) {
  const std::vector<double> scale = contact_scales(p);
  std::vector<double> bound(p.contact_count, 0.0);
  for (int c = 0; c < p.contact_count; ++c) {
    for (int k = p.row_start[c]; k < p.row_start[c + 1]; ++k)
      bound[c] += size_of(p.block[k]) * std::sqrt(scale[c] / scale[p.column[k]]);
    bound[c] = std::max(bound[c], scale[c]);
  }
  return bound;
}

class Jacobi final : public AssembledSolver {
 public:
  AssembledTraits traits() const override {
    return {"jacobi", "projected Jacobi, steps bounded by block row sums", true, true, 20000, 10};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    const double relaxation = o.relaxation > 0 ? o.relaxation : 1.5;
    const std::vector<double> bound = row_bounds(p);
    std::vector<double> r = o.guess, u;
    for (int k = 0;; ++k) {
      multiply(p, r, u);
      monitor.count_applications();
      for (std::size_t i = 0; i < u.size(); ++i) u[i] += p.q[i];
      if (monitor.due(k) && monitor.look(k, r, u)) return;
      for (int c = 0; c < p.contact_count; ++c) {
        const std::array<double, 3> v = law_velocity(o.model, p.mu[c], &u[3 * c]);
        for (int i = 0; i < 3; ++i) r[3 * c + i] -= relaxation / bound[c] * v[i];
        project_on_cone(p.mu[c], &r[3 * c]);
      }
    }
  }
};

}  // namespace

std::unique_ptr<AssembledSolver> make_assembled_jacobi() { return std::make_unique<Jacobi>(); }

}  // namespace scree
