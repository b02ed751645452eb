// Projected Jacobi: r+ = P_K(r - omega v / s) for all contacts at once, v of the model.
//
// s_c is the sum over the block row of sqrt(d_c / d_k) times the largest stretch of W_ck. It bounds
// W from above as the mass-split metric does, but from W alone, so with a symmetric W and the
// convex model every step descends for omega < 2. One iteration is one product with W and 4 vectors
// read or written beside it. Source:
// Tonge, Benevolenski and Voroshilov, ACM TOG 31(4), 2012, with the bound taken from W
// by the test of Schur.

#include <algorithm>
#include <cmath>

#include "solvers/assembled/backend_problem.h"
#include "solvers/assembled/backend_solver.h"

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

/// r = P_K(r - omega v / s), contact by contact.
struct JacobiStep {
  static constexpr const char* name = "assembled_jacobi_step";
  AssembledModel model;
  double relaxation;
  Span<const double> q, mu, bound;
  Span<const double> moved;  ///< W r
  Span<double> r;
  SCREE_HD void operator()(Index c) const {
    const Offset at = 3 * static_cast<Offset>(c);
    const double u[3] = {moved[at] + q[at], moved[at + 1] + q[at + 1], moved[at + 2] + q[at + 2]};
    const std::array<double, 3> v = law_velocity(model, mu[c], u);
    for (int i = 0; i < 3; ++i) r[at + i] -= relaxation / bound[c] * v[i];
    project_on_cone(mu[c], &r[at]);
  }
};

class Jacobi final : public BackendSolver<BuildBackend> {
 public:
  using BackendSolver::BackendSolver;

  AssembledTraits traits() const override {
    return {"jacobi", "projected Jacobi, steps bounded by block row sums",
            true,     true,
            20000,    10,
            "cone",   true};
  }

  void run(const AssembledProblem& problem, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    const auto p = upload_problem(problem);
    const Offset n = p.row_count();
    Buffer<BuildBackend, double> bound(backend()), r = p.vector(o.guess), moved = p.vector();
    upload(backend(), row_bounds(problem), bound);
    const JacobiStep step{
        o.model,  o.relaxation > 0 ? o.relaxation : 1.5, p.q(), p.mu(), bound.view(), moved.view(n),
        r.view(n)};
    for (int k = 0;; ++k) {
      p.multiply(r, moved);
      monitor.count_applications();
      if (monitor.due(k) && p.check(monitor, k, r, moved)) return;
      for_each(backend(), p.contact_count(), step);
    }
  }
};

}  // namespace

template <>
std::unique_ptr<AssembledSolver> make_assembled_jacobi<BuildBackend>(
    std::shared_ptr<BuildBackend> backend) {
  return std::make_unique<Jacobi>(std::move(backend));
}

}  // namespace scree
