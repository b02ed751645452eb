// Projected Gauss-Seidel on box friction, coupled bounds: |r_t1|, |r_t2| <= mu r_n with r_n of the
// same visit. Another law than the cone: up to sqrt(2) times the friction along the diagonal.
//
// Rows are solved one after another by their own diagonal entry; one iteration is a sweep: one
// pass over W, 100 bytes a block with the impulses that it gathers, and 88 bytes a contact. Bounds
// follow impulses, so nothing is minimized and nothing proven; in practice quick to a few digits.
// What rigid-body engines for games do. Source: Jourdan, Alart and Jean, CMAME 155, 1998
// (Gauss-Seidel); Catto, Iterative dynamics with temporal coherence, GDC 2005 (box bounds).

#include "solvers/assembled/backend_solver.h"
#include "solvers/assembled/pgs_box_method.h"

namespace scree {
namespace {

class PgsBox final : public BackendSolver<BuildBackend> {
 public:
  using BackendSolver::BackendSolver;

  AssembledTraits traits() const override {
    return {"pgs_box", "projected Gauss-Seidel on box friction, coupled bounds",
            true,      false,
            20000,     10,
            "box",     true,
            false};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    run_pgs_box(upload_problem(p), o, BoxBounds::coupled, monitor);
  }
};

}  // namespace

template <>
std::unique_ptr<AssembledSolver> make_assembled_pgs_box<BuildBackend>(
    std::shared_ptr<BuildBackend> backend) {
  return std::make_unique<PgsBox>(std::move(backend));
}

}  // namespace scree
