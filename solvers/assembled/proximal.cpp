// Proximal point: each outer iteration solves the problem with W + a D and q - a D r_k, which is
// regular, for r_k+1; D is the scale of each contact. Inner problems go to Newton, and where that
// fails to nonlinear Gauss-Seidel. `a` falls when Newton is quick and doubles when it fails; what
// sweeps then reach is taken as it is, as going back to better impulses was found to lead nowhere.
//
// Where contacts are redundant W is singular, Newton breaks down and Gauss-Seidel is slow; inner
// problems are neither, and r_k+1 = r_k solves the original. An outer iteration copies the
// diagonal blocks, takes one product with W to measure r, and costs what the inner solver does: the
// memory passes of newton, or of nlgs. For the exact model W is used as it is.
// Source: Rockafellar, SIAM J. Control Optim. 14, 1976; for friction Acary, Bremond and Huber,
// INRIA RR-9118, 2018; the rule for a is ours.

#include "solvers/assembled/proximal_method.h"

namespace scree {
namespace {

class Proximal final : public AssembledSolver {
 public:
  AssembledTraits traits() const override {
    return {"proximal", "proximal point around Newton, Gauss-Seidel where that fails",
            true,       true,
            500,        1};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    run_proximal(p, o, {}, monitor);
  }
};

}  // namespace

std::unique_ptr<AssembledSolver> make_assembled_proximal() { return std::make_unique<Proximal>(); }

}  // namespace scree
