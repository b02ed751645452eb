// Conjugate projected gradient on 4-sided friction pyramids inside the cones, the law of
// pgs_pyramid4; cpg_pyramid_method.h.
//
// Costs and memory passes as in cpg.inst.h: one product with W an iteration, three where
// constraints change. For the convex model it converges to the minimum over the pyramids;
// W need not be regular.
// Source: Renouf and Alart, Comput. Methods Appl. Mech. Engrg. 194, 2005.

#include "solvers/assembled/backend_solver.h"
#include "solvers/assembled/cpg_pyramid_method.h"

namespace scree {
namespace {

class CpgPyramid4 final : public BackendSolver<BuildBackend> {
 public:
  using BackendSolver::BackendSolver;

  AssembledTraits traits() const override {
    return {
        "cpg_pyramid4",   "conjugate projected gradient on 4-sided pyramids", true, true, 50000, 10,
        "4-sided pyramid"};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    run_cpg_pyramid(upload_problem(p), o, 4, monitor);
  }
};

}  // namespace

template <>
std::unique_ptr<AssembledSolver> make_assembled_cpg_pyramid4<BuildBackend>(
    std::shared_ptr<BuildBackend> backend) {
  return std::make_unique<CpgPyramid4>(std::move(backend));
}

}  // namespace scree
