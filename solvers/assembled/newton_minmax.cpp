// Semi-smooth Newton on the min-max form of box friction with coupled bounds, the law of pgs_box,
// with backtracking on the merit function 1/2 |D^1/2 F|^2 and a sparse LU decomposition.
//
// Costs as in newton.cpp. It ends as "singular" where redundant contacts stick, and as "stalled"
// where picks do not settle, with a note that tells a Newton step that does not lead down from a
// trap, where the gradient does not either. Source: that of min_max_function.h.

#include "solvers/assembled/min_max_function.h"
#include "solvers/assembled/newton_method.h"

namespace scree {
namespace {

class NewtonMinMax final : public AssembledSolver {
 public:
  AssembledTraits traits() const override {
    return {"newton_minmax",
            "semi-smooth Newton on the min-max form of box friction, sparse LU",
            true,
            false,
            200,
            1,
            "box"};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    monitor.keep_last();
    const std::vector<double> scale = contact_scales(p);
    NewtonSettings settings;
    settings.law = {MinMaxFunction::other_law, [&](int c, const double* r, const double* u) {
                      return MinMaxFunction{}(p.mu[c], p.diagonal(c), scale[c], r, u);
                    }};
    run_newton(p, o, settings, monitor);
  }
};

}  // namespace

std::unique_ptr<AssembledSolver> make_assembled_newton_minmax() {
  return std::make_unique<NewtonMinMax>();
}

}  // namespace scree
