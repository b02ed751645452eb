// Proximal point around nonlinear Gauss-Seidel alone: the method of proximal without
// Newton, on any backend.
//
// Inner problems, with W + a D, have a unique solution of the convex model even where contacts are
// redundant, and the larger a is, the fewer sweeps come to it; the smaller, the fewer outer
// iterations there are. So `a` follows the sweeps as it follows Newton in proximal: it falls where
// a third of the allowed ones is enough and doubles where all are not.
//
// An outer iteration costs up to 1000 sweeps, each one pass over W (100 bytes a block) and 80 bytes
// a contact, one product with W every ten of them, and one on the host to measure r; it sends
// W + a D to the backend again. Source: as proximal; inner problems as nlgs.

#include "solvers/assembled/backend_solver.h"
#include "solvers/assembled/proximal_method.h"
#include "solvers/assembled/sweep_method.h"

namespace scree {
namespace {

class ProximalGaussSeidel final : public BackendSolver<BuildBackend> {
 public:
  using BackendSolver::BackendSolver;

  AssembledTraits traits() const override {
    return {"proximal_gauss_seidel",
            "proximal point around nonlinear Gauss-Seidel",
            true,
            true,
            1000,
            1};
  }

  void run(const AssembledProblem& problem, const AssembledOptions& options,
           AssembledMonitor& monitor) const override {
    ProximalSettings settings;
    settings.newton = false;
    settings.sweeps = 1000;
    ProximalMethods methods;
    methods.sweeps = [this](const AssembledProblem& p, const AssembledOptions& o,
                            AssembledMonitor& inner) {
      run_sweeps(upload_problem(p), o.model, 1, o.guess, inner);
    };
    run_proximal(problem, options, settings, monitor, methods);
  }
};

}  // namespace

template <>
std::unique_ptr<AssembledSolver> make_assembled_proximal_gauss_seidel<BuildBackend>(
    std::shared_ptr<BuildBackend> backend) {
  return std::make_unique<ProximalGaussSeidel>(std::move(backend));
}

}  // namespace scree
