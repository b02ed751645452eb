// Conjugate projected gradient: directions of conjugate gradients, bent into the tangent cone of
// the constraints at the present impulses. Here for the cones of the convex model.
//
// In x = S r (ScaledProblem), with g = W x + q and T the tangent cone of K at x:
//   w = P_T(-g),  p+ = w + b P_T(p),  b = -w.W p / p.W p
//   trial = P_K(x + a p+),  a = -g.p+ / p+.W p+
// Corrected line search: where the projection changed the trial, the objective is minimized between
// x and the trial. That alone zigzags between constraints for ever, so a projected gradient step of
// 1 / |W| follows, and directions start anew. An iteration costs one product with W, three where
// the trial was changed. The best iterate that was looked at is kept. Source: Renouf and Alart,
// Comput. Methods Appl. Mech. Engrg. 194, 2005; gradient steps after changed ones as in Dostal and
// Schoeberl, Comput. Optim. Appl. 30, 2005.

#include <cmath>

#include "solvers/assembled/cpg_method.h"

namespace scree {
namespace {

/// How close to the surface, relative to mu n, is on it.
constexpr double on_surface = 1e-10;

/// Projects v on the tangent cone of the friction cone at x.
void project_on_tangent_cone(double mu, const double* x, double* v) {
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

class Cones final : public CpgLaw {
 public:
  explicit Cones(const AssembledProblem& p) : p_(p) {}
  void project(int c, double* x) const override { project_on_cone(p_.mu[c], x); }
  void project_on_tangent(int c, const double* x, double* v) const override {
    project_on_tangent_cone(p_.mu[c], x, v);
  }

 private:
  const AssembledProblem& p_;
};

class Cpg final : public AssembledSolver {
 public:
  AssembledTraits traits() const override {
    return {"cpg", "conjugate projected gradient (tangent cones, corrected line search)",
            false, true,
            50000, 10};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    Cones cones(p);
    run_cpg(p, o, cones, monitor);
  }
};

}  // namespace

std::unique_ptr<AssembledSolver> make_assembled_cpg() { return std::make_unique<Cpg>(); }

}  // namespace scree
