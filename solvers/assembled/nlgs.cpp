// Nonlinear Gauss-Seidel: each contact's Coulomb problem is solved exactly with the others held.
//
// One iteration is a sweep: one product with W and, at slipping contacts, some ten 2x2 solves. W
// may be unsymmetric. No proof of convergence; in practice quick to 1e-4, then slow where contacts
// are redundant. Solves the convex model too, then as gauss_seidel. Source: Jean, CMAME 177, 1999;
// the one-contact solve of one_contact.h.

#include "solvers/assembled/assembled_solver.h"
#include "solvers/assembled/sweep.h"

namespace scree {
namespace {

class Nlgs final : public AssembledSolver {
 public:
  AssembledTraits traits() const override {
    return {"nlgs", "nonlinear Gauss-Seidel, exact one-contact Coulomb solves", true, true, 20000,
            10};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    std::vector<double> r = o.guess;
    for (int k = 0; !monitor.look_if_due(k, r); ++k) {
      sweep(p, o.model, 1, false, r);
      monitor.count_applications();
    }
  }
};

}  // namespace

std::unique_ptr<AssembledSolver> make_assembled_nlgs() { return std::make_unique<Nlgs>(); }

}  // namespace scree
