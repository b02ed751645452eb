// Extragradient: a trial step r' = P_K(r - s v(r)), then the step r+ = P_K(r - s v(r')), v of the
// model and the step s in units of 1 / D, the inverse scale of each contact.
//
// s adapts itself: with a = s |v(r) - v(r')| / |r - r'| (in the metric of D) it shrinks and the
// trial is repeated while a > 0.9, and grows when a < 0.3. Two products with W an iteration, one
// more per repeated trial. Converges for monotone problems, the convex model among them. Source:
// Korpelevich 1976; Khobotov, USSR Comput. Math. Math. Phys. 27, 1987.

#include <algorithm>
#include <cmath>

#include "solvers/assembled/assembled_solver.h"

namespace scree {
namespace {

class Extragradient final : public AssembledSolver {
 public:
  AssembledTraits traits() const override {
    return {"extragradient", "extragradient with a self-adaptive step", true, true, 20000, 10};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    const std::vector<double> scale = contact_scales(p);
    std::vector<double> r = o.guess, trial(r.size()), u, u_trial;
    const auto velocity = [&](const std::vector<double>& at, std::vector<double>& out) {
      multiply(p, at, out);
      monitor.count_applications();
      for (std::size_t i = 0; i < out.size(); ++i) out[i] += p.q[i];
    };
    const auto move = [&](double step, const std::vector<double>& by, std::vector<double>& to) {
      for (int c = 0; c < p.contact_count; ++c) {
        const std::array<double, 3> v = law_velocity(o.model, p.mu[c], &by[3 * c]);
        for (int i = 0; i < 3; ++i) to[3 * c + i] = r[3 * c + i] - step / scale[c] * v[i];
        project_on_cone(p.mu[c], &to[3 * c]);
      }
    };
    /// s |v(r) - v(r')|_1/D over |r - r'|_D
    const auto steepness = [&](double step) {
      double above = 0, below = 0;
      for (int c = 0; c < p.contact_count; ++c) {
        const std::array<double, 3> v = law_velocity(o.model, p.mu[c], &u[3 * c]);
        const std::array<double, 3> w = law_velocity(o.model, p.mu[c], &u_trial[3 * c]);
        for (int i = 0; i < 3; ++i) {
          const double dv = v[i] - w[i], dr = r[3 * c + i] - trial[3 * c + i];
          above += dv * dv / scale[c];
          below += dr * dr * scale[c];
        }
      }
      return below > 0 ? step * std::sqrt(above / below) : 0.0;
    };
    double step = 1;
    for (int k = 0;; ++k) {
      velocity(r, u);
      if (monitor.due(k) && monitor.look(k, r, u)) return;
      double steep = 0;
      for (int t = 0; t < 60; ++t) {
        move(step, u, trial);
        velocity(trial, u_trial);
        steep = steepness(step);
        if (!(steep > 0.9)) break;
        step *= 2.0 / 3.0 * std::min(1.0, 1 / steep);
      }
      move(step, u_trial, r);
      if (steep < 0.3) step *= 1.5;
    }
  }
};

}  // namespace

std::unique_ptr<AssembledSolver> make_assembled_extragradient() {
  return std::make_unique<Extragradient>();
}

}  // namespace scree
