// Semi-smooth Newton on the Alart-Curnier function (exact model) or the natural map (convex one),
// with backtracking on the merit function, whose steps BiCGSTAB solves: newton without a
// factorization, so that W may be large and in the memory of a device.
//
// One iteration takes two products with W for each of BiCGSTAB's, and one per trial step. The
// preconditioner is the inverse of the Jacobian's diagonal blocks, and each system is solved as
// well as the last step was good. Ends as "singular" where redundant contacts stick and BiCGSTAB
// makes no progress, and as "stalled" where no point of a step is lower, with a note that tells a
// wrong step from a trap; hybrid_krylov gets past both. Source: as newton; Eisenstat and Walker,
// SIAM J. Sci. Comput. 17, 1996.

#include "solvers/assembled/backend_solver.h"
#include "solvers/assembled/newton_krylov_method.h"

namespace scree {
namespace {

class NewtonKrylov final : public BackendSolver<BuildBackend> {
 public:
  using BackendSolver::BackendSolver;

  AssembledTraits traits() const override {
    return {"newton_krylov",
            "semi-smooth Newton (Alart-Curnier), line search, BiCGSTAB",
            true,
            true,
            200,
            1};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    NewtonKrylovSettings settings;
    settings.tells_traps = true;
    run_newton_krylov(upload_problem(p), ConeFunction{o.model}, o.guess, settings, monitor);
  }
};

}  // namespace

template <>
std::unique_ptr<AssembledSolver> make_assembled_newton_krylov<BuildBackend>(
    std::shared_ptr<BuildBackend> backend) {
  return std::make_unique<NewtonKrylov>(std::move(backend));
}

}  // namespace scree
