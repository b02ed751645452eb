// The solver to take when in doubt. For both models, by turns from the guess:
//
//   1. sweeps of nonlinear Gauss-Seidel: enough for easy problems, and a start for others. As many
//      as there are contacts at first, but 50 to 4000; then 2000 at least, and twice as many as in
//      the turn before. They go on from the sweeps of that turn;
//   2. the proximal method, until it no longer gains: around Newton, or around Gauss-Seidel alone
//      where the factors of a matrix of more than 30,000 contacts would be too costly. From where
//      the sweeps led, with a first weight no larger than their residual; but where exact friction
//      makes Newton fail from there twice at once, from the guess, with the weight that `proximal`
//      takes, and in later turns with the root of the residual, as regularized Newton methods do.
//
// Sweeps leave contacts at the edge between stick and slip. With exact friction Newton may fail
// there unless the weight is large, and a failure costs tens of products and 100 sweeps: then
// failures in a row raise the weight faster and faster. From zero it does not fail, but takes many
// more steps where it would not have failed from the sweeps. And proximal points of the
// exact law need not attract, and larger weights may lead away from impulses that are nearly
// solutions. Where they have diverged the sweeps have not, so that each turn starts another
// attempt from a better place. An iteration is a sweep or an outer iteration; memory passes are
// those of nlgs and proximal. Source: those of both; the turns are ours.

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/assembled/proximal_method.h"
#include "solvers/assembled/sweep.h"

namespace scree {
namespace {

/// Contacts from which on nothing is factorized.
constexpr int too_many_for_factors = 30000;
constexpr int least_sweeps = 50, most_first_sweeps = 4000, second_sweeps = 2000;

/// Of the next turn. Turns that end at once are soon very many.
int more_sweeps(int sweeps) {
  return std::max(second_sweeps, 2 * std::min(sweeps, std::numeric_limits<int>::max() / 2));
}

/// Outer iterations without half the residual that are worth their time. Factors cost about the
/// square of the contacts, sweeps only their number, and small problems can wait for luck.
int patience_of(int contacts) {
  const double n = contacts;
  return 12 + static_cast<int>(std::min(1e8 / (n * n), 1e4));
}

class Auto final : public AssembledSolver {
 public:
  AssembledTraits traits() const override {
    return {"auto", "nonlinear Gauss-Seidel and proximal Newton by turns", true, true, 100000, 10};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    std::vector<double> swept = o.guess;
    ProximalSettings settings;
    settings.newton = p.contact_count < too_many_for_factors;
    settings.adapts = settings.newton;
    settings.patience = patience_of(p.contact_count);
    if (settings.newton && o.model == AssembledModel::exact) settings.most_opening_failures = 2;
    bool fails = false;  // Newton, from where sweeps led
    for (int sweeps = std::clamp(p.contact_count, least_sweeps, most_first_sweeps);
         monitor.next_phase(sweeps, 10); sweeps = more_sweeps(sweeps)) {
      for (int k = 0; !monitor.look_if_due(k, swept); ++k) {
        sweep(p, o.model, swept);
        monitor.count_applications();
      }
      if (!monitor.next_phase(1500, 1)) return;
      AssembledOptions from = o;
      from.guess = swept;
      const double left = monitor.last().relative;
      settings.first_weight = std::clamp(fails ? std::sqrt(left) : left, 1e-6, 1e-2);
      if (run_proximal(p, from, settings, monitor)) continue;
      fails = true;
      settings.most_opening_failures = 0;
      settings.largest_growth = 16;
      settings.first_weight = ProximalSettings().first_weight;
      if (!monitor.next_phase(1500, 1)) return;
      run_proximal(p, o, settings, monitor);
    }
  }
};

}  // namespace

std::unique_ptr<AssembledSolver> make_assembled_auto() { return std::make_unique<Auto>(); }

}  // namespace scree
