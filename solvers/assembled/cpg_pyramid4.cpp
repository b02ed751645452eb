// Conjugate projected gradient on 4-sided friction pyramids inside the cones, the law of
// pgs_pyramid4; cpg_pyramid.h.
//
// Costs as in cpg.cpp: one product with W an iteration, three where constraints change. For the
// convex model it converges to the minimum over the pyramids; W need not be regular.
// Source: Renouf and Alart, Comput. Methods Appl. Mech. Engrg. 194, 2005.

#include "solvers/assembled/cpg_pyramid.h"

namespace scree {
namespace {

class CpgPyramid4 final : public AssembledSolver {
 public:
  AssembledTraits traits() const override {
    return {
        "cpg_pyramid4",   "conjugate projected gradient on 4-sided pyramids", true, true, 50000, 10,
        "4-sided pyramid"};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    run_cpg_pyramid(p, o, 4, monitor);
  }
};

}  // namespace

std::unique_ptr<AssembledSolver> make_assembled_cpg_pyramid4() {
  return std::make_unique<CpgPyramid4>();
}

}  // namespace scree
