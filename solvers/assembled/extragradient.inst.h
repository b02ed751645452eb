// Extragradient: a trial step r' = P_K(r - s v(r)), then the step r+ = P_K(r - s v(r')), v of the
// model and the step s in units of 1 / D, the inverse scale of each contact.
//
// s adapts itself: with a = s |v(r) - v(r')| / |r - r'| (in the metric of D) it shrinks and
// the trial is repeated while a > 0.9, and grows when a < 0.3. Two products with W and 16 vectors
// read or written an iteration, and as much per repeated trial. Converges for monotone problems,
// the convex model among them. Source: Korpelevich 1976; Khobotov, USSR Comput. Math.
// Math. Phys. 27, 1987.

#include <cmath>

#include "solvers/assembled/backend_problem.h"
#include "solvers/assembled/backend_solver.h"

namespace scree {
namespace {

struct ExtragradientState {
  double step = 1;      ///< of the next trial
  double used = 1;      ///< of the last one
  bool accept = false;  ///< whether the last one is good enough to step by
  int repeated = 0;     ///< trials since the last accepted one
  Index accepted = 0;
};

/// Velocities of one contact under the law, from W r.
struct LawVelocities {
  AssembledModel model;
  Span<const double> q, mu;
  SCREE_HD std::array<double, 3> operator()(Index c, const Span<const double>& moved) const {
    const Offset at = 3 * static_cast<Offset>(c);
    const double u[3] = {moved[at] + q[at], moved[at + 1] + q[at + 1], moved[at + 2] + q[at + 2]};
    return law_velocity(model, mu[c], u);
  }
};

/// trial = P_K(r - s v(r) / D).
struct ExtragradientTrial {
  static constexpr const char* name = "extragradient_trial";
  LawVelocities law;
  Span<const double> scale;
  const ExtragradientState* state;
  Span<const double> r, moved;
  Span<double> trial;
  SCREE_HD void operator()(Index c) const {
    const Offset at = 3 * static_cast<Offset>(c);
    const std::array<double, 3> v = law(c, moved);
    for (int i = 0; i < 3; ++i) trial[at + i] = r[at + i] - state->step / scale[c] * v[i];
    project_on_cone(law.mu[c], &trial[at]);
  }
};

/// Squares of v(r) - v(r') and r - r' in the metric of D.
struct ExtragradientSums {
  static constexpr const char* name = "extragradient_sums";
  LawVelocities law;
  Span<const double> scale;
  Span<const double> r, moved, trial, trial_moved;
  SCREE_HD Sums<2> operator()(Index c) const {
    const Offset at = 3 * static_cast<Offset>(c);
    const std::array<double, 3> v = law(c, moved), w = law(c, trial_moved);
    Sums<2> sums;
    for (int i = 0; i < 3; ++i) {
      const double dv = v[i] - w[i], dr = r[at + i] - trial[at + i];
      sums.value[0] += dv * dv / scale[c];
      sums.value[1] += dr * dr * scale[c];
    }
    return sums;
  }
};

struct ExtragradientRules {
  ExtragradientState* state;
  SCREE_HD void operator()(const Sums<2>& sums) const {
    ExtragradientState& s = *state;
    const double steep =
        sums.value[1] > 0 ? s.step * std::sqrt(sums.value[0] / sums.value[1]) : 0.0;
    s.used = s.step;
    s.accept = !(steep > 0.9) || s.repeated == 60;
    if (s.accept) {
      ++s.accepted;
      s.repeated = 0;
      if (steep < 0.3) s.step *= 1.5;
    } else {
      ++s.repeated;
      s.step *= 2.0 / 3.0 * (steep > 1 ? 1 / steep : 1);
    }
  }
};

/// r = P_K(r - s v(r') / D) after an accepted trial.
struct ExtragradientStep {
  static constexpr const char* name = "extragradient_step";
  LawVelocities law;
  Span<const double> scale;
  const ExtragradientState* state;
  Span<const double> trial_moved;
  Span<double> r;
  SCREE_HD void operator()(Index c) const {
    if (!state->accept) return;
    const Offset at = 3 * static_cast<Offset>(c);
    const std::array<double, 3> v = law(c, trial_moved);
    for (int i = 0; i < 3; ++i) r[at + i] -= state->used / scale[c] * v[i];
    project_on_cone(law.mu[c], &r[at]);
  }
};

class Extragradient final : public BackendSolver<BuildBackend> {
 public:
  using BackendSolver::BackendSolver;

  AssembledTraits traits() const override {
    return {"extragradient", "extragradient with a self-adaptive step", true, true, 20000, 10};
  }

  void run(const AssembledProblem& problem, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    BuildBackend& b = backend();
    const auto p = upload_problem(problem);
    const Offset n = p.row_count();
    Buffer<BuildBackend, double> scale(b), r = p.vector(o.guess), trial = p.vector(),
                                           moved = p.vector(), trial_moved = p.vector();
    upload(b, contact_scales(problem), scale);
    Buffer<BuildBackend, ExtragradientState> state(b, 1);
    const ExtragradientState first;
    upload(b, &first, state.view());
    const auto multiply = [&](const auto& x, auto& y) {
      p.multiply(x, y);
      monitor.count_applications();
    };
    const LawVelocities law{o.model, p.q(), p.mu()};
    multiply(r, moved);
    for (int k = 0;; k = fetch(b, state.data()).accepted) {
      if (monitor.due(k) && p.check(monitor, k, r, moved)) return;
      for (int left = monitor.until_due(k); left > 0; --left) {
        for_each(b, p.contact_count(),
                 ExtragradientTrial{law, scale.view(), state.data(), r.view(n), moved.view(n),
                                    trial.view(n)});
        multiply(trial, trial_moved);
        reduce<Sums<2>>(b, p.contact_count(),
                        ExtragradientSums{law, scale.view(), r.view(n), moved.view(n),
                                          trial.view(n), trial_moved.view(n)},
                        ExtragradientRules{state.data()});
        for_each(
            b, p.contact_count(),
            ExtragradientStep{law, scale.view(), state.data(), trial_moved.view(n), r.view(n)});
        multiply(r, moved);
      }
    }
  }
};

}  // namespace

template <>
std::unique_ptr<AssembledSolver> make_assembled_extragradient<BuildBackend>(
    std::shared_ptr<BuildBackend> backend) {
  return std::make_unique<Extragradient>(std::move(backend));
}

}  // namespace scree
