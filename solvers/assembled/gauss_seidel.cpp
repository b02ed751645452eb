// Block Gauss-Seidel for the convex model: each contact's 3x3 problem is solved to rounding.
//
// One iteration is a sweep: one product with W and, at slipping contacts, some ten 2x2 solves. The
// objective never rises, and with a positive semidefinite W it converges to the minimum, linearly.
// The exact model is reached by the De Saxce fixed point; nlgs solves it in the sweep.
// Source: Tseng, JOTA 109, 2001 (convergence); one_contact.h.

#include "solvers/assembled/assembled_solver.h"
#include "solvers/assembled/sweep.h"

namespace scree {
namespace {

class GaussSeidel final : public AssembledSolver {
 public:
  AssembledTraits traits() const override {
    return {"gauss_seidel", "block Gauss-Seidel, exact 3x3 solves of the convex model",
            false,          true,
            20000,          10};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    std::vector<double> r = o.guess;
    for (int k = 0; !monitor.look_if_due(k, r); ++k) {
      sweep(p, AssembledModel::convex, 1, false, r);
      monitor.count_applications();
    }
  }
};

}  // namespace

std::unique_ptr<AssembledSolver> make_assembled_gauss_seidel() {
  return std::make_unique<GaussSeidel>();
}

}  // namespace scree
