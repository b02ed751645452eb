// Spectral projected gradient: steps of Barzilai and Borwein, a nonmonotone line search, in the
// metric of the contacts' scales.
//
// x = S r (ScaledProblem). d = P_K(x - a g) - x; along d the objective is a parabola whose
// curvature is known with W d, so the search over step lengths costs no further product: one
// product with W an iteration. A step is taken whole when the objective then lies below the largest
// of the last 50 by enough, and else ends at the vertex of the parabola. Where contacts are
// redundant, 50 instead of the usual 10 and two kinds of steps by turns save most iterations. The
// best iterate that was looked at is kept.
// Source: Birgin, Martinez and Raydan, SIAM J. Optim. 10, 2000 (SPG2); turns of steps: Bonettini,
// Zanella and Zanni, Inverse Problems 25, 2009; for contacts Heyn, Anitescu,
// Tasora and Negrut, IJNME 95, 2013.

#include <algorithm>

#include "solvers/assembled/assembled_solver.h"
#include "solvers/assembled/cone_vectors.h"

namespace scree {
namespace {

constexpr std::size_t objectives_kept = 50;
constexpr std::size_t steps_kept = 5;
constexpr double least_descent = 1e-4;
constexpr double least_step = 1e-6, largest_step = 1e6;  ///< in units of S^-2

/// Chooses between the two steps of Barzilai and Borwein, in units of S^-2.
class SpectralStep {
 public:
  /// After a move s that changed the gradient by y: s.s / s.y, or, where that is much longer than
  /// s.y / y.y, the shortest of the last of those. What "much" is adapts, so that both have turns.
  double next(double ss, double sy, double yy) {
    if (!(ss > 0)) return last_;
    if (!(sy > 0)) return last_ = std::min(10 * last_, largest_step);
    const double longer = std::clamp(ss / sy, least_step, largest_step);
    const double shorter = std::clamp(sy / yy, least_step, largest_step);
    if (shorter_.size() == steps_kept) shorter_.erase(shorter_.begin());
    shorter_.push_back(shorter);
    const bool take_longer = shorter >= threshold_ * longer;
    threshold_ *= take_longer ? 1.1 : 0.9;
    last_ = take_longer ? longer : *std::min_element(shorter_.begin(), shorter_.end());
    return last_;
  }

 private:
  double last_ = 1;
  double threshold_ = 0.5;
  std::vector<double> shorter_;
};

class Spg final : public AssembledSolver {
 public:
  AssembledTraits traits() const override {
    return {"spg", "spectral projected gradient (Barzilai-Borwein, nonmonotone)",
            false, true,
            50000, 10};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    const ScaledProblem scaled(p);
    const AssembledProblem& s = scaled.problem;
    const std::size_t rows = p.q.size();
    std::vector<double> x = scaled.scaled(o.guess), g, d(rows), moved;
    project_on_cones(p, x);
    multiply(s, x, g);
    monitor.count_applications();
    for (std::size_t i = 0; i < rows; ++i) g[i] += s.q[i];
    const auto objective = [&] {
      double sum = 0;
      for (std::size_t i = 0; i < rows; ++i) sum += 0.5 * x[i] * (g[i] + s.q[i]);
      return sum;
    };
    std::vector<double> last(1, objective());
    SpectralStep spectral;
    double step = 1;
    for (int k = 0;; ++k) {
      if (monitor.due(k)) {
        if (monitor.look(k, scaled.unscaled(x))) return;
        // g is carried along; here its rounding is cut off.
        g = scaled.gradient(monitor.last_velocity());
      }
      for (std::size_t i = 0; i < rows; ++i) d[i] = x[i] - step * g[i];
      project_on_cones(p, d);
      for (std::size_t i = 0; i < rows; ++i) d[i] -= x[i];
      const double slope = dot(g, d);
      multiply(s, d, moved);
      monitor.count_applications();
      const double curvature = dot(d, moved), square = dot(d, d);
      const double highest = *std::max_element(last.begin(), last.end());
      double length = 1;
      // What an objective is rounded to is no reason to stop: near the end it is all that is left.
      const double allowed =
          highest - last.back() + least_descent * slope + 1e-14 * std::abs(last.back());
      if (slope < 0 && curvature > 0 && slope + 0.5 * curvature > allowed)
        length = std::min(-slope / curvature, 1.0);
      for (std::size_t i = 0; i < rows; ++i) {
        x[i] += length * d[i];
        g[i] += length * moved[i];
      }
      if (last.size() == objectives_kept) last.erase(last.begin());
      last.push_back(objective());
      step = spectral.next(square, curvature, dot(moved, moved));
    }
  }
};

}  // namespace

std::unique_ptr<AssembledSolver> make_assembled_spg() { return std::make_unique<Spg>(); }

}  // namespace scree
