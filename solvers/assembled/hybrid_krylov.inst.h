// Sweeps of nonlinear Gauss-Seidel, then Newton with BiCGSTAB from where they led, by turns: hybrid
// without a factorization, on any backend.
//
// The sweeps find which contacts are open, stick and slip; Newton finishes. Where it breaks down
// the best impulses so far are taken up again with twice as many sweeps, and the Jacobian gets ten
// times more of the contact scales added. Costs and memory passes: those of nlgs and newton_krylov.
// Source: as hybrid.

#include <algorithm>

#include "solvers/assembled/backend_solver.h"
#include "solvers/assembled/newton_krylov_method.h"
#include "solvers/assembled/sweep_method.h"

namespace scree {
namespace {

class HybridKrylov final : public BackendSolver<BuildBackend> {
 public:
  using BackendSolver::BackendSolver;

  AssembledTraits traits() const override {
    return {"hybrid_krylov",
            "nonlinear Gauss-Seidel, then Newton with BiCGSTAB, by turns",
            true,
            true,
            20000,
            10};
  }

  void run(const AssembledProblem& problem, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    constexpr int newton_iterations = 30, most_sweeps = 2000;
    const auto p = upload_problem(problem);
    std::vector<double> r = o.guess;
    NewtonKrylovSettings settings;
    settings.shift = 1e-10;
    for (int sweeps = 30; monitor.next_phase(sweeps, 10);
         sweeps = std::min(2 * sweeps, most_sweeps)) {
      run_sweeps(p, o.model, 1, r, monitor);
      r = monitor.last_impulses();
      if (!monitor.next_phase(newton_iterations, 1)) return;
      const double before = monitor.best_residual().unit_free;
      run_newton_krylov(p, ConeFunction{o.model}, r, settings, monitor);
      if (monitor.best_residual().unit_free < before) r = monitor.best();
      settings.shift = std::min(1e-3, 10 * settings.shift);
    }
  }
};

}  // namespace

template <>
std::unique_ptr<AssembledSolver> make_assembled_hybrid_krylov<BuildBackend>(
    std::shared_ptr<BuildBackend> backend) {
  return std::make_unique<HybridKrylov>(std::move(backend));
}

}  // namespace scree
