// Projected Gauss-Seidel on 8-sided friction pyramids inside the cones: another law than the cone,
// friction being less between the edges, by up to 8 %, and turned towards them.
//
// Unknowns are the 8 multipliers of a contact's edges, pgs_pyramid_method.h. One iteration is a
// sweep: one pass over W, 100 bytes a block with the impulses that it gathers, 216 bytes and 8
// scalar updates a contact. For the convex model it converges to the minimum over the pyramids; W
// need not be regular.
// Source: Stewart and Trinkle, IJNME 39, 1996 (pyramids); Luo and Tseng, JOTA 72, 1992 (convergence
// of Gauss-Seidel with bounds).

#include "solvers/assembled/backend_solver.h"
#include "solvers/assembled/pgs_pyramid_method.h"

namespace scree {
namespace {

class PgsPyramid8 final : public BackendSolver<BuildBackend> {
 public:
  using BackendSolver::BackendSolver;

  AssembledTraits traits() const override {
    return {"pgs_pyramid8",
            "projected Gauss-Seidel on 8-sided pyramids",
            true,
            true,
            20000,
            10,
            "8-sided pyramid",
            true,
            false};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    run_pgs_pyramid(upload_problem(p), o, 8, monitor);
  }
};

}  // namespace

template <>
std::unique_ptr<AssembledSolver> make_assembled_pgs_pyramid8<BuildBackend>(
    std::shared_ptr<BuildBackend> backend) {
  return std::make_unique<PgsPyramid8>(std::move(backend));
}

}  // namespace scree
