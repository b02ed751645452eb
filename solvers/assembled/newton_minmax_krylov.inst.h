// Semi-smooth Newton on the min-max form of box friction with coupled bounds, the law of pgs_box,
// with backtracking on the merit function, whose steps BiCGSTAB solves: newton_minmax without a
// factorization, so that W may be large and in the memory of a device.
//
// Costs and steps as in newton_krylov, endings as in newton_minmax but one: where redundant
// contacts stick BiCGSTAB may find a step all the same, as the right side is in the range of their
// W. Source: as newton_minmax and newton_krylov.

#include "solvers/assembled/backend_solver.h"
#include "solvers/assembled/min_max_function.h"
#include "solvers/assembled/newton_krylov_method.h"

namespace scree {
namespace {

class NewtonMinMaxKrylov final : public BackendSolver<BuildBackend> {
 public:
  using BackendSolver::BackendSolver;

  AssembledTraits traits() const override {
    return {"newton_minmax_krylov",
            "semi-smooth Newton on the min-max form of box friction, BiCGSTAB",
            true,
            false,
            200,
            1,
            "box"};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    monitor.keep_last();
    NewtonKrylovSettings settings;
    settings.tells_traps = true;
    settings.tolerance = o.tolerance;
    run_newton_krylov(upload_problem(p), MinMaxFunction{}, o.guess, settings, monitor);
  }
};

}  // namespace

template <>
std::unique_ptr<AssembledSolver> make_assembled_newton_minmax_krylov<BuildBackend>(
    std::shared_ptr<BuildBackend> backend) {
  return std::make_unique<NewtonMinMaxKrylov>(std::move(backend));
}

}  // namespace scree
