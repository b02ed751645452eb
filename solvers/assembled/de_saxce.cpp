// The De Saxce fixed point around the convex problems, each of them solved by the proximal method.
//
// For the convex model this is one solve by `proximal`. The same loop gives every solver that only
// knows the convex model its exact one, see de_saxce_loop.h, which has source and cost;
// memory passes are those of proximal.

#include "solvers/assembled/de_saxce_loop.h"
#include "solvers/assembled/proximal_method.h"

namespace scree {
namespace {

class DeSaxce final : public AssembledSolver {
 public:
  AssembledTraits traits() const override {
    return {"de_saxce", "De Saxce fixed point around convex proximal solves", false, true, 500, 1};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    run_proximal(p, o, {}, monitor);
  }
};

}  // namespace

std::unique_ptr<AssembledSolver> make_assembled_de_saxce() { return std::make_unique<DeSaxce>(); }

}  // namespace scree
