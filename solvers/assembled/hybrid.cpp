// Sweeps of nonlinear Gauss-Seidel, then Newton from where they led, by turns.
//
// The sweeps find which contacts are open, stick and slip; Newton finishes, and may go on as long
// as eight of its steps halve the residual. Then the best impulses so far are taken up again with
// twice as many sweeps. A hundred thousandth of the contact scales is added to the Jacobian: that
// makes it regular where contacts are redundant, whose impulses are not unique, and any of them
// will do. Less leaves Newton to rounding there, more makes it slow. Costs and memory passes: those
// of nlgs and newton. Source: Acary, Bremond and Huber, INRIA RR-9118, 2018, start Newton by a
// first-order method too; the rest is ours.

#include <algorithm>

#include "solvers/assembled/newton_method.h"
#include "solvers/assembled/sweep.h"

namespace scree {
namespace {

constexpr int first_sweeps = 100, most_sweeps = 2000;
constexpr int newton_steps = 8;  ///< that halve the residual, or Newton is given up

class Hybrid final : public AssembledSolver {
 public:
  AssembledTraits traits() const override {
    return {"hybrid", "nonlinear Gauss-Seidel, then Newton, by turns", true, true, 20000, 10};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    std::vector<double> r = o.guess;
    for (int sweeps = first_sweeps; monitor.next_phase(sweeps, 10);
         sweeps = std::min(2 * sweeps, most_sweeps)) {
      for (int k = 0; !monitor.look_if_due(k, r); ++k) {
        sweep(p, o.model, r);
        monitor.count_applications();
      }
      const double swept = monitor.best_residual().unit_free;
      newton_while_it_pays(p, o, r, monitor);
      if (monitor.best_residual().unit_free < swept) r = monitor.best();
    }
  }

 private:
  /// Newton from r, until it converges or eight steps do not halve the residual.
  static void newton_while_it_pays(const AssembledProblem& p, const AssembledOptions& o,
                                   const std::vector<double>& r, AssembledMonitor& monitor) {
    NewtonSettings settings;
    settings.shift = 1e-5;
    AssembledOptions from = o;
    from.guess = r;
    double before = monitor.last().unit_free;
    while (monitor.next_phase(newton_steps, 1)) {
      run_newton(p, from, settings, monitor);
      const double after = monitor.last().unit_free;
      if (!(after < 0.5 * before)) return;
      before = after;
      from.guess = monitor.last_impulses();
    }
  }
};

}  // namespace

std::unique_ptr<AssembledSolver> make_assembled_hybrid() { return std::make_unique<Hybrid>(); }

}  // namespace scree
