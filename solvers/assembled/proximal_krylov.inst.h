// Proximal point around Newton with BiCGSTAB, and nonlinear Gauss-Seidel where that fails: proximal
// without a factorization, on any backend.
//
// The method is that of proximal. A weight that is too small for BiCGSTAB makes Newton fail, and so
// grows again: weights, and with them progress, end where the preconditioner does. Each outer
// iteration sends W + a D to the backend again, and measures r by a product on the host; inner
// problems cost what newton_krylov and nlgs do. Source: as proximal.

#include "solvers/assembled/backend_solver.h"
#include "solvers/assembled/newton_krylov_method.h"
#include "solvers/assembled/proximal_method.h"
#include "solvers/assembled/sweep_method.h"

namespace scree {
namespace {

class ProximalKrylov final : public BackendSolver<BuildBackend> {
 public:
  using BackendSolver::BackendSolver;

  AssembledTraits traits() const override {
    return {"proximal_krylov",
            "proximal point around Newton with BiCGSTAB, Gauss-Seidel where that fails",
            true,
            true,
            500,
            1};
  }

  void run(const AssembledProblem& problem, const AssembledOptions& options,
           AssembledMonitor& monitor) const override {
    ProximalMethods methods;
    methods.newton = [this](const AssembledProblem& p, const AssembledOptions& o,
                            AssembledMonitor& inner) {
      run_newton_krylov(upload_problem(p), ConeFunction{o.model}, o.guess, {}, inner);
    };
    methods.sweeps = [this](const AssembledProblem& p, const AssembledOptions& o,
                            AssembledMonitor& inner) {
      run_sweeps(upload_problem(p), o.model, 1, o.guess, inner);
    };
    run_proximal(problem, options, {}, monitor, methods);
  }
};

}  // namespace

template <>
std::unique_ptr<AssembledSolver> make_assembled_proximal_krylov<BuildBackend>(
    std::shared_ptr<BuildBackend> backend) {
  return std::make_unique<ProximalKrylov>(std::move(backend));
}

}  // namespace scree
