// Alternating direction method of multipliers on r = z: linear systems with W + rho D, whose
// factors are kept, by turns with projections on the cones. D is the scale of each contact.
//
//   r+ = (W + rho D)^-1 (rho D (z - w) - q),  r' = 1.6 r+ - 0.6 z
//   z+ = P_K(r' + w),  w+ = w + r' - z+
//
// An iteration costs one pass over the factor for each of two triangular solves, some 20 vectors
// read or written, and no product with W but at looks. rho is multiplied or divided so that r - z
// and rho (z+ - z) stay alike, each time with a new Cholesky factorization, at growing intervals: a
// rho that changes forever need not converge. Source: Boyd et al., Found. Trends Mach. Learn. 3,
// 2011; rule for rho as in Stellato et al., Math. Program. Comput. 12, 2020.

#include <algorithm>

#include "solvers/assembled/assembled_solver.h"
#include "solvers/assembled/cone_vectors.h"
#include "solvers/assembled/shifted_factors.h"

namespace scree {
namespace {

constexpr double over_relaxation = 1.6;

class Admm final : public AssembledSolver {
 public:
  AssembledTraits traits() const override {
    return {"admm", "alternating directions, sparse Cholesky, balanced penalty",
            false,  true,
            50000,  10,
            "cone", true};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    const ScaledProblem scaled(p);
    const AssembledProblem& s = scaled.problem;
    const std::size_t rows = p.q.size();
    const double relaxation = o.relaxation > 0 ? o.relaxation : over_relaxation;
    ShiftedFactors factors(s);
    double rho = 1;
    const auto factorize = [&] {
      monitor.count_factorizations();
      return factors.factorize(
          std::vector<Block3>(p.contact_count, Block3{rho, 0, 0, 0, rho, 0, 0, 0, rho}));
    };
    if (!factorize()) return monitor.fail(AssembledStatus::singular, "W is not semidefinite");
    std::vector<double> z = scaled.scaled(o.guess), w(rows), b(rows), x;
    project_on_cones(p, z);
    // -rho w is the velocity at a solution.
    multiply(s, z, w);
    monitor.count_applications();
    for (std::size_t i = 0; i < rows; ++i) w[i] = -(w[i] + s.q[i]) / rho;
    int next_change = 10;
    for (int k = 0; !monitor.look_if_due(k, scaled.unscaled(z)); ++k) {
      for (std::size_t i = 0; i < rows; ++i) b[i] = rho * (z[i] - w[i]) - s.q[i];
      factors.solve(b, x);
      std::vector<double> trial(rows), last = z;
      for (std::size_t i = 0; i < rows; ++i) {
        trial[i] = relaxation * x[i] + (1 - relaxation) * z[i];
        z[i] = trial[i] + w[i];
      }
      project_on_cones(p, z);
      double primal = 0, dual = 0, size = dot(x, x), dual_size = 0;
      for (std::size_t i = 0; i < rows; ++i) {
        w[i] += trial[i] - z[i];
        primal += (x[i] - z[i]) * (x[i] - z[i]);
        dual += (z[i] - last[i]) * (z[i] - last[i]);
        dual_size += w[i] * w[i];
      }
      if (k < next_change) continue;
      next_change = k + std::max(10, k / 4);
      // Relative to the impulses and to the velocities rho w.
      const double balance = std::sqrt((primal / std::max(size, 1e-300)) /
                                       std::max(dual / std::max(dual_size, 1e-300), 1e-300));
      const double factor = std::clamp(std::sqrt(balance), 0.1, 10.0);
      if (factor > 0.5 && factor < 2) continue;
      const double before = rho;
      rho = std::clamp(rho * factor, 1e-8, 1e8);
      for (double& v : w) v *= before / rho;
      if (!factorize()) return monitor.fail(AssembledStatus::singular, "W is not semidefinite");
    }
  }
};

}  // namespace

std::unique_ptr<AssembledSolver> make_assembled_admm() { return std::make_unique<Admm>(); }

}  // namespace scree
