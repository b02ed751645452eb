// Sweeps of nonlinear Gauss-Seidel, then Newton from where they led, by turns.
//
// The sweeps find which contacts are open, stick and slip; Newton finishes. Where it breaks down
// the best impulses so far are taken up again with twice as many sweeps, and the Jacobian gets ten
// times more of the contact scales added, which makes it regular where contacts are redundant: the
// impulses are not unique there, and any of them will do. Costs: those of nlgs and newton.
// Source: Acary, Bremond and Huber, INRIA RR-9118, 2018, start Newton by a first-order method too;
// the rest is ours.

#include <algorithm>

#include "solvers/assembled/newton_method.h"
#include "solvers/assembled/sweep.h"

namespace scree {
namespace {

class Hybrid final : public AssembledSolver {
 public:
  AssembledTraits traits() const override {
    return {"hybrid", "nonlinear Gauss-Seidel, then Newton, by turns", true, true, 20000, 10};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    constexpr int newton_iterations = 30, most_sweeps = 2000;
    std::vector<double> r = o.guess;
    NewtonSettings settings;
    settings.shift = 1e-10;
    AssembledOptions newton_options = o;
    for (int sweeps = 30; monitor.next_phase(sweeps, 10);
         sweeps = std::min(2 * sweeps, most_sweeps)) {
      for (int k = 0; !monitor.look_if_due(k, r); ++k) {
        sweep(p, o.model, r);
        monitor.count_applications();
      }
      if (!monitor.next_phase(newton_iterations, 1)) return;
      const double before = monitor.best_residual().unit_free;
      newton_options.guess = r;
      run_newton(p, newton_options, settings, monitor);
      if (monitor.best_residual().unit_free < before) r = monitor.best();
      settings.shift = std::min(1e-3, 10 * settings.shift);
    }
  }
};

}  // namespace

std::unique_ptr<AssembledSolver> make_assembled_hybrid() { return std::make_unique<Hybrid>(); }

}  // namespace scree
