// Projected Gauss-Seidel on box friction, lagged bounds: |r_t1|, |r_t2| <= mu r_n with r_n of the
// sweep before. Fixed points, and all else, as for pgs_box; within a sweep the bounds stand still,
// so that a sweep is one of a quadratic program with boxes.

#include "solvers/assembled/pgs_box_method.h"

namespace scree {
namespace {

class PgsBoxLagged final : public AssembledSolver {
 public:
  AssembledTraits traits() const override {
    return {"pgs_box_lagged",
            "projected Gauss-Seidel on box friction, lagged bounds",
            true,
            false,
            20000,
            10,
            "box"};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    run_pgs_box(p, o, BoxBounds::lagged, monitor);
  }
};

}  // namespace

std::unique_ptr<AssembledSolver> make_assembled_pgs_box_lagged() {
  return std::make_unique<PgsBoxLagged>();
}

}  // namespace scree
