// The solver to take when in doubt. For both models, from the guess:
//
//   1. up to 50 sweeps of nonlinear Gauss-Seidel: enough for easy problems, and a start for others;
//   2. the proximal method, up to 1500 outer iterations: around Newton, or around Gauss-Seidel
//   alone
//      where the factors of a matrix of more than 30,000 contacts would be too costly;
//   3. by turns, from the best impulses so far, 2000 sweeps of Gauss-Seidel and 1500 more outer
//      iterations of the proximal method with Gauss-Seidel in it, until iterations or time are out.
//
// An iteration is a sweep or an outer iteration.

#include "solvers/assembled/proximal_method.h"
#include "solvers/assembled/sweep.h"

namespace scree {
namespace {

/// Contacts from which on nothing is factorized.
constexpr int many_contacts = 30000;

class Auto final : public AssembledSolver {
 public:
  AssembledTraits traits() const override {
    return {"auto", "nonlinear Gauss-Seidel, then proximal Newton, then both by turns",
            true,   true,
            5000,   10};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    AssembledOptions from = o;
    ProximalSettings settings;
    settings.newton = p.contact_count < many_contacts;
    for (int sweeps = 50; monitor.next_phase(sweeps, 10); sweeps = 2000) {
      for (int k = 0; !monitor.look_if_due(k, from.guess); ++k) {
        sweep(p, o.model, from.guess);
        monitor.count_applications();
      }
      from.guess = monitor.best();
      if (!monitor.next_phase(1500, 1)) return;
      run_proximal(p, from, settings, monitor);
      from.guess = monitor.best();
      settings.newton = false;
    }
  }
};

}  // namespace

std::unique_ptr<AssembledSolver> make_assembled_auto() { return std::make_unique<Auto>(); }

}  // namespace scree
