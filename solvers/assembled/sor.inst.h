// Successive over-relaxation: nonlinear Gauss-Seidel whose every move is taken `relaxation` times,
// then projected on the cone.
//
// One iteration is a sweep with the memory passes of nlgs. 1.2 by default: more speeds up some
// packings of rigid bodies and breaks others; less than 1 helps some elastic ones. Source:
// Mangasarian, JOTA 22, 1977; for friction Acary, Bremond and Huber, INRIA RR-9118, 2018.

#include "solvers/assembled/backend_solver.h"
#include "solvers/assembled/sweep_method.h"

namespace scree {
namespace {

class Sor final : public BackendSolver<BuildBackend> {
 public:
  using BackendSolver::BackendSolver;

  AssembledTraits traits() const override {
    return {"sor", "over-relaxed nonlinear Gauss-Seidel", true, true, 20000, 10, "cone", true};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    const double relaxation = o.relaxation > 0 ? o.relaxation : 1.2;
    run_sweeps(upload_problem(p), o.model, relaxation, o.guess, monitor);
  }
};

}  // namespace

template <>
std::unique_ptr<AssembledSolver> make_assembled_sor<BuildBackend>(
    std::shared_ptr<BuildBackend> backend) {
  return std::make_unique<Sor>(std::move(backend));
}

}  // namespace scree
