// Projected Gauss-Seidel on box friction, lagged bounds: |r_t1|, |r_t2| <= mu r_n with r_n of the
// sweep before. Fixed points and memory passes as for pgs_box; within a sweep the bounds stand
// still, so that a sweep is one of a quadratic program with boxes.
// Source: Preclik, Iglberger and Ruede, Iterative rigid multibody dynamics, 2009 (projections row
// by row, bounds coupled to unknowns or not); as pgs_box.

#include "solvers/assembled/backend_solver.h"
#include "solvers/assembled/pgs_box_method.h"

namespace scree {
namespace {

class PgsBoxLagged final : public BackendSolver<BuildBackend> {
 public:
  using BackendSolver::BackendSolver;

  AssembledTraits traits() const override {
    return {"pgs_box_lagged",
            "projected Gauss-Seidel on box friction, lagged bounds",
            true,
            false,
            20000,
            10,
            "box",
            true,
            false};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    run_pgs_box(upload_problem(p), o, BoxBounds::lagged, monitor);
  }
};

}  // namespace

template <>
std::unique_ptr<AssembledSolver> make_assembled_pgs_box_lagged<BuildBackend>(
    std::shared_ptr<BuildBackend> backend) {
  return std::make_unique<PgsBoxLagged>(std::move(backend));
}

}  // namespace scree
