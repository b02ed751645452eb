// Block Gauss-Seidel for the convex model: each contact's 3x3 problem is solved to rounding.
//
// One iteration is a sweep: one pass over W, 100 bytes a block with the impulses that it gathers,
// and 80 bytes a contact; at slipping contacts some ten 2x2 solves. The objective never rises,
// and with a positive semidefinite W it converges to the minimum, linearly. The exact model is
// reached by the De Saxce fixed point; nlgs solves it in the sweep.
// Source: Tseng, JOTA 109, 2001 (convergence); one_contact.h.

#include "solvers/assembled/backend_solver.h"
#include "solvers/assembled/sweep_method.h"

namespace scree {
namespace {

class GaussSeidel final : public BackendSolver<BuildBackend> {
 public:
  using BackendSolver::BackendSolver;

  AssembledTraits traits() const override {
    return {"gauss_seidel", "block Gauss-Seidel, exact 3x3 solves of the convex model",
            false,          true,
            20000,          10};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    run_sweeps(upload_problem(p), AssembledModel::convex, 1, o.guess, monitor);
  }
};

}  // namespace

template <>
std::unique_ptr<AssembledSolver> make_assembled_gauss_seidel<BuildBackend>(
    std::shared_ptr<BuildBackend> backend) {
  return std::make_unique<GaussSeidel>(std::move(backend));
}

}  // namespace scree
