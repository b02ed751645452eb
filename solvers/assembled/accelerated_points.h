#pragma once
// The points of an accelerated gradient method on a backend, with their products with W: what apgd
// and apgd_plain have in common. All scalars stay in backend memory.

#include <algorithm>
#include <utility>
#include <vector>

#include "solvers/assembled/backend_problem.h"

namespace scree {

/// Two weights of a contact, of its normal row and of both tangential ones [1/kg].
struct RowWeights {
  double normal = 1;
  double tangential = 1;
  SCREE_HD double of(int row) const { return row == 0 ? normal : tangential; }
};

/// From which point the next trial steps.
enum class TrialFrom : int {
  iterate,       ///< r itself
  extrapolated,  ///< the last trial became the iterate: from it, with momentum
  same_point     ///< where the last trial stepped from, for another step length
};

/// What a rule for steps decides after each trial.
struct AcceleratedState {
  double step = 1;  ///< in units of the inverse metric
  double momentum = 0;
  TrialFrom from = TrialFrom::iterate;
  Index accepted = 0;  ///< trials that became iterates
};

/// Element program over contacts: takes the last trial as iterate if it was accepted, sets the
/// point y and its product, and steps from it: next = P_K(y - step H^-1 (W y + q)) in the metric H.
/// Bytes per contact: 96 to 144 read, 24 to 120 written.
struct AcceleratedTrial {
  static constexpr const char* name = "accelerated_trial";
  Span<const double> q, mu;
  Span<const RowWeights> metric;  ///< empty: Euclidean
  const AcceleratedState* state;
  Span<double> r, next, y, moved, next_moved, y_moved;

  SCREE_HD void operator()(Index c) const {
    const RowWeights h = metric.empty() ? RowWeights{} : metric[c];
    double x[3];
    for (int i = 0; i < 3; ++i) {
      const Offset at = 3 * static_cast<Offset>(c) + i;
      if (state->from == TrialFrom::extrapolated) {
        y[at] = next[at] + state->momentum * (next[at] - r[at]);
        y_moved[at] = next_moved[at] + state->momentum * (next_moved[at] - moved[at]);
        r[at] = next[at];
        moved[at] = next_moved[at];
      } else if (state->from == TrialFrom::iterate) {
        y[at] = r[at];
        y_moved[at] = moved[at];
      }
      x[i] = y[at] - state->step / h.of(i) * (y_moved[at] + q[at]);
    }
    const Vec3<double> projected = project_cone(
        mu[c], Vec3<double>{1, 0, 0}, Vec3<double>{x[0], x[1], x[2]}, h.normal, h.tangential);
    for (int i = 0; i < 3; ++i) next[3 * static_cast<Offset>(c) + i] = projected[i];
  }
};

/// What a trial met, d = next - y: curvature d.W d, square |d|^2 in the metric, and the gradient at
/// y times next - r, which is positive when the step led uphill.
struct AcceleratedSums {
  static constexpr const char* name = "accelerated_sums";
  Span<const double> q;
  Span<const RowWeights> metric;
  Span<const double> r, next, y, next_moved, y_moved;

  SCREE_HD Sums<3> operator()(Index c) const {
    const RowWeights h = metric.empty() ? RowWeights{} : metric[c];
    Sums<3> sums;
    for (int i = 0; i < 3; ++i) {
      const Offset at = 3 * static_cast<Offset>(c) + i;
      const double d = next[at] - y[at];
      sums.value[0] += d * (next_moved[at] - y_moved[at]);
      sums.value[1] += h.of(i) * d * d;
      sums.value[2] += (y_moved[at] + q[at]) * (next[at] - r[at]);
    }
    return sums;
  }
};

/// Iterate r, trial `next` and the point y it steps from, and W times each. One trial is one
/// product with W, and 14 vectors read or written beside it.
template <class B>
class AcceleratedPoints {
 public:
  /// All points at the projected start. One product with W.
  /// @param metric  empty: Euclidean. @param p, monitor  outlive this
  AcceleratedPoints(const BackendProblem<B>& p, const std::vector<double>& start,
                    const std::vector<RowWeights>& metric, AssembledMonitor& monitor)
      : p_(p),
        monitor_(monitor),
        metric_(p.backend()),
        state_(p.backend(), 1),
        r_(p.vector(start)),
        next_(p.vector()),
        y_(p.vector()),
        moved_(p.vector()),
        next_moved_(p.vector()),
        y_moved_(p.vector()) {
    B& b = p.backend();
    if (!metric.empty()) upload(b, metric, metric_);
    for_each(b, p.contact_count(), ProjectOnCones{p.mu(), r_.view(p.row_count())});
    multiply(r_, moved_);
  }

  AcceleratedState* state() { return state_.data(); }

  /// Runs trials from a first state until the monitor stops.
  /// @param rules  finish of a reduction to Sums<3>, AcceleratedSums: decides on the trial
  ///               and writes state()
  template <class Rules>
  void run(const AcceleratedState& first, Rules rules) {
    B& b = p_.backend();
    upload(b, &first, state_.view(1));
    AcceleratedState now = first;
    for (;;) {
      if (monitor_.due(now.accepted) && check(now)) return;
      for (int left = monitor_.until_due(now.accepted); left > 0; --left) trial(rules);
      now = fetch(b, state_.data());
    }
  }

 private:
  void multiply(const Buffer<B, double>& x, Buffer<B, double>& y) {
    p_.multiply(x, y);
    monitor_.count_applications();
  }
  bool check(const AcceleratedState& now) {
    const bool trial_is_iterate = now.from == TrialFrom::extrapolated;
    return p_.check(monitor_, now.accepted, trial_is_iterate ? next_ : r_,
                    trial_is_iterate ? next_moved_ : moved_);
  }
  template <class Rules>
  void trial(Rules rules) {
    B& b = p_.backend();
    const Offset n = p_.row_count();
    const Span<const RowWeights> metric = metric_.view(metric_.capacity());
    for_each(b, p_.contact_count(),
             AcceleratedTrial{p_.q(), p_.mu(), metric, state_.data(), r_.view(n), next_.view(n),
                              y_.view(n), moved_.view(n), next_moved_.view(n), y_moved_.view(n)});
    multiply(next_, next_moved_);
    reduce<Sums<3>>(b, p_.contact_count(),
                    AcceleratedSums{p_.q(), metric, r_.view(n), next_.view(n), y_.view(n),
                                    next_moved_.view(n), y_moved_.view(n)},
                    rules);
  }

  const BackendProblem<B>& p_;
  AssembledMonitor& monitor_;
  Buffer<B, RowWeights> metric_;
  Buffer<B, AcceleratedState> state_;
  Buffer<B, double> r_, next_, y_, moved_, next_moved_, y_moved_;
};

}  // namespace scree
