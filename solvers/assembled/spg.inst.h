// Spectral projected gradient: steps of Barzilai and Borwein, a nonmonotone line search, in the
// metric of the contacts' scales.
//
// d = P_K(r - a g / D) - r with D = contact_scales; along d the objective is a parabola whose
// curvature is known with W d, so the search over step lengths costs no further product: one
// product with W an iteration and 14 vectors read or written beside it. A step is taken whole when
// the objective then lies below the largest of the last 50 by enough, and else ends at the vertex
// of the parabola. Where contacts are redundant, 50 instead of the usual 10 and two kinds of steps
// by turns save most iterations. The best iterate that was checked is kept. Source: Birgin,
// Martinez and Raydan, SIAM J. Optim. 10, 2000 (SPG2); turns of steps: Bonettini, Zanella and
// Zanni, Inverse Problems 25, 2009; for contacts Heyn, Anitescu, Tasora and Negrut, IJNME 95, 2013.

#include <cmath>

#include "solvers/assembled/backend_problem.h"
#include "solvers/assembled/backend_solver.h"

namespace scree {
namespace {

constexpr double least_descent = 1e-4;
constexpr double least_step = 1e-6, largest_step = 1e6;  ///< in units of 1 / D

SCREE_HD double clamped(double x) {
  return x < least_step ? least_step : (x > largest_step ? largest_step : x);
}

/// The last `Count` of many values, in backend memory.
template <int Count>
struct Latest {
  double value[Count] = {};
  int size = 0;
  int next = 0;
  SCREE_HD void push(double x) {
    value[next] = x;
    next = (next + 1) % Count;
    if (size < Count) ++size;
  }
  SCREE_HD double newest() const { return value[(next + Count - 1) % Count]; }
  SCREE_HD double least() const {
    double x = value[0];
    for (int k = 1; k < size; ++k) x = value[k] < x ? value[k] : x;
    return x;
  }
  SCREE_HD double largest() const {
    double x = value[0];
    for (int k = 1; k < size; ++k) x = value[k] > x ? value[k] : x;
    return x;
  }
};

/// Chooses between the two steps of Barzilai and Borwein, in units of 1 / D.
struct SpectralStep {
  double last = 1;
  double threshold = 0.5;
  Latest<5> shorter_ones;

  /// After a move s that changed the gradient by y: s.s / s.y, or, where that is much longer than
  /// s.y / y.y, the shortest of the last of those. What "much" is adapts, so that both have turns.
  SCREE_HD double next(double ss, double sy, double yy) {
    if (!(ss > 0)) return last;
    if (!(sy > 0)) return last = 10 * last < largest_step ? 10 * last : largest_step;
    const double longer = clamped(ss / sy), shorter = clamped(sy / yy);
    shorter_ones.push(shorter);
    const bool take_longer = shorter >= threshold * longer;
    threshold *= take_longer ? 1.1 : 0.9;
    return last = take_longer ? longer : shorter_ones.least();
  }
};

struct SpgState {
  Latest<50> objectives;
  SpectralStep spectral;
  double step = 1;
  double slope = 0;   ///< g.d
  double length = 1;  ///< of the move along d
};

/// d = P_K(r - a g / D) - r, and the slope g.d.
struct SpgDirection {
  static constexpr const char* name = "spg_direction";
  Span<const double> mu, scale, r, g;
  const SpgState* state;
  Span<double> d;
  SCREE_HD Sums<1> operator()(Index c) const {
    const Offset at = 3 * static_cast<Offset>(c);
    Sums<1> slope;
    double y[3];
    for (int i = 0; i < 3; ++i) y[i] = r[at + i] - state->step / scale[c] * g[at + i];
    project_on_cone(mu[c], y);
    for (int i = 0; i < 3; ++i) {
      d[at + i] = y[i] - r[at + i];
      slope.value[0] += g[at + i] * d[at + i];
    }
    return slope;
  }
};

struct SpgSlope {
  SpgState* state;
  SCREE_HD void operator()(const Sums<1>& slope) const { state->slope = slope.value[0]; }
};

/// d.W d, and the squares of d and W d in the metric of D.
struct SpgCurvature {
  static constexpr const char* name = "spg_curvature";
  Span<const double> scale, d, moved;
  SCREE_HD Sums<3> operator()(Index c) const {
    Sums<3> sums;
    for (int i = 0; i < 3; ++i) {
      const Offset at = 3 * static_cast<Offset>(c) + i;
      sums.value[0] += d[at] * moved[at];
      sums.value[1] += scale[c] * d[at] * d[at];
      sums.value[2] += moved[at] * moved[at] / scale[c];
    }
    return sums;
  }
};

/// How far to go along d, and the step of the next direction.
struct SpgRules {
  SpgState* state;
  SCREE_HD void operator()(const Sums<3>& sums) const {
    SpgState& s = *state;
    const double curvature = sums.value[0], newest = s.objectives.newest();
    // What an objective is rounded to is no reason to stop: near the end it is all that is left.
    const double allowed =
        s.objectives.largest() - newest + least_descent * s.slope + 1e-14 * std::abs(newest);
    s.length = 1;
    if (s.slope < 0 && curvature > 0 && s.slope + 0.5 * curvature > allowed)
      s.length = -s.slope < curvature ? -s.slope / curvature : 1;
    s.step = s.spectral.next(sums.value[1], curvature, sums.value[2]);
  }
};

/// Moves r and its gradient, and adds up the objective there.
struct SpgMove {
  static constexpr const char* name = "spg_move";
  Span<const double> q, d, moved;
  const SpgState* state;
  Span<double> r, g;
  SCREE_HD Sums<1> operator()(Index c) const {
    Sums<1> objective;
    for (int i = 0; i < 3; ++i) {
      const Offset at = 3 * static_cast<Offset>(c) + i;
      r[at] += state->length * d[at];
      g[at] += state->length * moved[at];
      objective.value[0] += 0.5 * r[at] * (g[at] + q[at]);
    }
    return objective;
  }
};

struct SpgObjective {
  SpgState* state;
  SCREE_HD void operator()(const Sums<1>& sum) const { state->objectives.push(sum.value[0]); }
};

/// g = W r + q, and the objective.
struct SpgGradient {
  static constexpr const char* name = "spg_gradient";
  Span<const double> q, moved, r;
  Span<double> g;
  SCREE_HD Sums<1> operator()(Index c) const {
    Sums<1> objective;
    for (int i = 0; i < 3; ++i) {
      const Offset at = 3 * static_cast<Offset>(c) + i;
      g[at] = moved[at] + q[at];
      objective.value[0] += 0.5 * r[at] * (g[at] + q[at]);
    }
    return objective;
  }
};

class Spg final : public BackendSolver<BuildBackend> {
 public:
  using BackendSolver::BackendSolver;

  AssembledTraits traits() const override {
    return {"spg", "spectral projected gradient (Barzilai-Borwein, nonmonotone)",
            false, true,
            50000, 10};
  }

  void run(const AssembledProblem& problem, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    BuildBackend& b = backend();
    const auto p = upload_problem(problem);
    const Offset n = p.row_count();
    Buffer<BuildBackend, double> scale(b), r = p.vector(o.guess), g = p.vector(), d = p.vector(),
                                           moved = p.vector();
    upload(b, contact_scales(problem), scale);
    Buffer<BuildBackend, SpgState> state(b, 1);
    const SpgState first;
    upload(b, &first, state.view());
    for_each(b, p.contact_count(), ProjectOnCones{p.mu(), r.view(n)});
    const auto multiply = [&](const auto& from, auto& to) {
      p.multiply(from, to);
      monitor.count_applications();
    };
    for (int k = 0;; ++k) {
      if (monitor.due(k)) {
        multiply(r, moved);
        if (p.check(monitor, k, r, moved)) return;
        // g is carried along; here its rounding is cut off.
        const SpgGradient gradient{p.q(), moved.view(n), r.view(n), g.view(n)};
        if (k == 0) {
          reduce<Sums<1>>(b, p.contact_count(), gradient, SpgObjective{state.data()});
        } else {
          reduce<Sums<1>>(b, p.contact_count(), gradient);
        }
      }
      reduce<Sums<1>>(
          b, p.contact_count(),
          SpgDirection{p.mu(), scale.view(), r.view(n), g.view(n), state.data(), d.view(n)},
          SpgSlope{state.data()});
      multiply(d, moved);
      reduce<Sums<3>>(b, p.contact_count(), SpgCurvature{scale.view(), d.view(n), moved.view(n)},
                      SpgRules{state.data()});
      reduce<Sums<1>>(b, p.contact_count(),
                      SpgMove{p.q(), d.view(n), moved.view(n), state.data(), r.view(n), g.view(n)},
                      SpgObjective{state.data()});
    }
  }
};

}  // namespace

template <>
std::unique_ptr<AssembledSolver> make_assembled_spg<BuildBackend>(
    std::shared_ptr<BuildBackend> backend) {
  return std::make_unique<Spg>(std::move(backend));
}

}  // namespace scree
