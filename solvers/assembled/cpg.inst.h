// Conjugate projected gradient: directions of conjugate gradients, bent into the tangent cone of
// the constraints at the present impulses. Here for the cones of the convex model.
//
// In the metric of D = contact_scales, in which <a, b> is a.D b; with g = W r + q and T the tangent
// cone of K at r:
//   w = P_T(-g / D),  p+ = w + b P_T(p),  b = -w.W p / p.W p
//   trial = P_K(r + a p+),  a = -g.p+ / p+.W p+
// Corrected line search: where the projection changed the trial, the objective is minimized
// between r and the trial. That alone zigzags between constraints forever, so a projected
// gradient step of 1 / |W| follows, and directions start again. An iteration costs one product
// with W and 23 vectors read or written beside it, three and 40 where the trial was changed.
// The best iterate that was checked is kept. Source: Renouf and Alart, Comput. Methods Appl.
// Mech. Engrg. 194, 2005; gradient steps after changed ones as in Dostal and Schoeberl, Comput.
// Optim. Appl. 30, 2005.

#include <cmath>

#include "solvers/assembled/backend_solver.h"
#include "solvers/assembled/cpg_method.h"

namespace scree {
namespace {

/// How close to the surface, relative to mu n, is on it.
constexpr double on_surface = 1e-10;

/// Projects v on the tangent cone of the friction cone at x.
SCREE_HD void project_on_tangent_cone(double mu, const double* x, double* v) {
  const double t = std::hypot(x[1], x[2]);
  if (!(x[0] > 0)) return project_on_cone(mu, v);  // the apex
  if (mu > 0 && t < mu * x[0] * (1 - on_surface)) return;
  if (!(t > 0)) {  // without friction the cone is a ray
    v[1] = v[2] = 0;
    return;
  }
  const double e[2] = {x[1] / t, x[2] / t};
  const double outward = e[0] * v[1] + e[1] * v[2] - mu * v[0];
  if (outward <= 0) return;
  const double back = outward / (1 + mu * mu);
  v[0] += mu * back;
  v[1] -= e[0] * back;
  v[2] -= e[1] * back;
}

struct ConeLaw {
  static constexpr double rounding = 0;
  Span<const double> mu;
  SCREE_HD void project(Index c, double* r) const { project_on_cone(mu[c], r); }
  SCREE_HD void project_on_tangent(Index c, const double* r, double* v) const {
    project_on_tangent_cone(mu[c], r, v);
  }
  SCREE_HD double lift(Index /*c*/) const { return 0; }
  SCREE_HD void renew(Index /*c*/, const double* /*r*/, const double* /*u*/) const {}
};

class Cpg final : public BackendSolver<BuildBackend> {
 public:
  using BackendSolver::BackendSolver;

  AssembledTraits traits() const override {
    return {"cpg", "conjugate projected gradient (tangent cones, corrected line search)",
            false, true,
            50000, 10};
  }

  void run(const AssembledProblem& problem, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    const auto p = upload_problem(problem);
    run_cpg(p, o, ConeLaw{p.mu()}, "", monitor);
  }
};

}  // namespace

template <>
std::unique_ptr<AssembledSolver> make_assembled_cpg<BuildBackend>(
    std::shared_ptr<BuildBackend> backend) {
  return std::make_unique<Cpg>(std::move(backend));
}

}  // namespace scree
