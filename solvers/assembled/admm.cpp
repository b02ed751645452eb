// Alternating direction method of multipliers on r = z: linear systems with W + rho D, whose
// factors are kept, by turns with projections. D is the scale of each contact.
//
//   r+ = (W + rho D)^-1 (rho D (z - w) - q),  r' = 1.6 r+ - 0.6 z
//   z+ = P(r' + w),  w+ = w + r' - z+
//
// In the convex model P projects on the cones. For exact friction P solves the contact alone with
// the block rho D: z_n = max(0, y_n), and z_t is the nearest to y_t of |z_t| <= mu z_n. That is the
// projection on the cone with De Saxce's shift mu |u_t| of the velocity u = -rho D w+ it leads to,
// so that the shift is that of each iteration and no convex problems are solved. An unsymmetric W
// is used as it is there. Nothing is proven for exact friction, whose law is not monotone.
//
// An iteration costs one pass over the factor for each of two triangular solves, some 20 vectors
// read or written, and no product with W but at checks. rho is multiplied or divided so that the
// changes of w and z stay alike, relative to the impulses and to the larger of velocities and
// loads, each time with a new factorization, at growing intervals: a rho that changes forever need
// not converge. Source: Boyd et al., Found. Trends Mach. Learn. 3, 2011; rule for rho as in
// Stellato et al., Math. Program. Comput. 12, 2020; for friction Acary, Bremond and Huber, INRIA
// RR-9118, 2018, who take the shift of the last iteration.

#include <algorithm>
#include <cmath>

#include "solvers/assembled/assembled_solver.h"
#include "solvers/assembled/cone_vectors.h"
#include "solvers/assembled/model_problem.h"
#include "solvers/assembled/shifted_factors.h"

namespace scree {
namespace {

constexpr double over_relaxation = 1.6;

/// Coulomb's law of one contact alone with u = rho (x - y), in place of y.
void solve_isotropic_contact(double mu, double* y) {
  y[0] = std::max(0.0, y[0]);
  const double bound = mu * y[0], size = std::hypot(y[1], y[2]);
  if (!(size > bound)) return;
  y[1] *= bound / size;
  y[2] *= bound / size;
}

void project(const AssembledProblem& p, AssembledModel model, std::vector<double>& y) {
  if (model == AssembledModel::convex) return project_on_cones(p, y);
  for (int c = 0; c < p.contact_count; ++c) solve_isotropic_contact(p.mu[c], &y[3 * c]);
}

void fail(AssembledMonitor& monitor, BlockFactors::Kind kind) {
  monitor.fail(AssembledStatus::singular, kind == BlockFactors::Kind::lu
                                              ? "W + rho D is singular to rounding"
                                              : "W is not semidefinite");
}

class Admm final : public AssembledSolver {
 public:
  AssembledTraits traits() const override {
    return {"admm", "alternating directions, sparse factors, balanced penalty",
            true,   true,
            50000,  10,
            "cone", true};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    if (monitor.check(0, o.guess)) return;
    const ScaledProblem scaled(p);
    const AssembledProblem& s = scaled.problem;
    const std::size_t rows = p.q.size();
    const double relaxation = o.relaxation > 0 ? o.relaxation : over_relaxation;
    const BlockFactors::Kind kind =
        asymmetry(s) > symmetric_to ? BlockFactors::Kind::lu : BlockFactors::Kind::cholesky;
    ShiftedFactors factors(s, kind);
    double rho = 1;
    const auto factorize = [&] {
      monitor.count_factorizations();
      return factors.factorize(
          std::vector<Block3>(p.contact_count, Block3{rho, 0, 0, 0, rho, 0, 0, 0, rho}));
    };
    if (!factorize()) return fail(monitor, kind);
    std::vector<double> z = scaled.scaled(o.guess), w(rows), b(rows), x;
    project(p, o.model, z);
    // -rho w is the velocity at a solution.
    multiply(s, z, w);
    monitor.count_applications();
    for (std::size_t i = 0; i < rows; ++i) w[i] = -(w[i] + s.q[i]) / rho;
    const double load = norm(s.q);
    int next_change = 10;
    for (int k = 0; k == 0 || !monitor.look_if_due(k, scaled.unscaled(z)); ++k) {
      for (std::size_t i = 0; i < rows; ++i) b[i] = rho * (z[i] - w[i]) - s.q[i];
      factors.solve(b, x);
      std::vector<double> trial(rows), last = z;
      for (std::size_t i = 0; i < rows; ++i) {
        trial[i] = relaxation * x[i] + (1 - relaxation) * z[i];
        z[i] = trial[i] + w[i];
      }
      project(p, o.model, z);
      double primal = 0, dual = 0, size = dot(x, x), dual_size = 0;
      for (std::size_t i = 0; i < rows; ++i) {
        w[i] += trial[i] - z[i];
        primal += (trial[i] - z[i]) * (trial[i] - z[i]);
        dual += (z[i] - last[i]) * (z[i] - last[i]);
        dual_size += w[i] * w[i];
      }
      dual_size = std::max(dual_size, load * load / (rho * rho));
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
      if (!factorize()) return fail(monitor, kind);
    }
  }
};

}  // namespace

std::unique_ptr<AssembledSolver> make_assembled_admm() { return std::make_unique<Admm>(); }

}  // namespace scree
