#pragma once
// The points of an accelerated gradient method with their products with W.

#include <utility>
#include <vector>

#include "solvers/assembled/assembled_problem.h"

namespace scree {

/// Iterate r, trial `next` and extrapolated point y, and W times each [3 contact_count].
struct AcceleratedPoints {
  std::vector<double> r, next, y;
  std::vector<double> moved, next_moved, y_moved;

  /// All points at r. One product with W.
  AcceleratedPoints(const AssembledProblem& p, std::vector<double> start)
      : r(std::move(start)), next(r.size()), y(r) {
    multiply(p, r, moved);
    y_moved = moved;
  }
  /// The gradient at y times the step that was taken, next - r: positive when it leads uphill.
  double uphill(const std::vector<double>& q) const {
    double sum = 0;
    for (std::size_t i = 0; i < q.size(); ++i) sum += (y_moved[i] + q[i]) * (next[i] - r[i]);
    return sum;
  }
  /// Takes the trial as iterate, and y = r + momentum (r - the iterate before) + second (r - y): its
  /// product follows from those of the three.
  void advance(double momentum, double second = 0) {
    for (std::size_t i = 0; i < r.size(); ++i) {
      y[i] = next[i] + momentum * (next[i] - r[i]) + second * (next[i] - y[i]);
      y_moved[i] = next_moved[i] + momentum * (next_moved[i] - moved[i]) +
                   second * (next_moved[i] - y_moved[i]);
    }
    r.swap(next);
    moved.swap(next_moved);
  }
  /// u = W r + q.
  void velocity(const std::vector<double>& q, std::vector<double>& u) const {
    u.resize(q.size());
    for (std::size_t i = 0; i < q.size(); ++i) u[i] = moved[i] + q[i];
  }
};

}  // namespace scree
