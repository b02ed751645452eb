// Nonlinear Gauss-Seidel: each contact's Coulomb problem is solved exactly with the others held.
//
// One iteration is a sweep: one pass over W, 100 bytes a block with the impulses that it gathers,
// and 80 bytes a contact; at slipping contacts some ten 2x2 solves. W may be unsymmetric.
// No proof of convergence; in practice quick to 1e-4, then slow where contacts are redundant.
// Solves the convex model too, then as gauss_seidel. Source: Jean, CMAME 177, 1999;
// the one-contact solve of one_contact.h.

#include "solvers/assembled/backend_solver.h"
#include "solvers/assembled/sweep_method.h"

namespace scree {
namespace {

class Nlgs final : public BackendSolver<BuildBackend> {
 public:
  using BackendSolver::BackendSolver;

  AssembledTraits traits() const override {
    return {"nlgs", "nonlinear Gauss-Seidel, exact one-contact Coulomb solves", true, true, 20000,
            10};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    run_sweeps(upload_problem(p), o.model, 1, o.guess, monitor);
  }
};

}  // namespace

template <>
std::unique_ptr<AssembledSolver> make_assembled_nlgs<BuildBackend>(
    std::shared_ptr<BuildBackend> backend) {
  return std::make_unique<Nlgs>(std::move(backend));
}

}  // namespace scree
