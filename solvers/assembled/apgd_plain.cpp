// Accelerated projected gradient descent as published: Nesterov's momentum, a step 1/L that is
// halved where the objective does not fall as foretold, and restarts.
//
//   t = 1/L, g = W y + q, r+ = P_K(y - t g); while (r+ - y).W (r+ - y) > L |r+ - y|^2: L = 2 L
//   theta+ = (sqrt(theta^4 + 4 theta^2) - theta^2) / 2, b = theta (1 - theta) / (theta^2 + theta+)
//   y+ = r+ + b (r+ - r), but y+ = r+ and theta+ = 1 if g.(r+ - r) > 0;  L = 0.9 L
//
// One iteration is one product with W, and one more for every halving. The best iterate that was
// looked at is kept, as in the paper. Steps are the same for all contacts, whatever their masses:
// apgd is the same method in a better metric.
// Source: Mazhar, Heyn, Negrut and Tasora, ACM TOG 34(3), 2015, algorithm "APGD".

#include <algorithm>

#include "solvers/assembled/assembled_solver.h"
#include "solvers/assembled/cone_vectors.h"

namespace scree {
namespace {

class ApgdPlain final : public AssembledSolver {
 public:
  AssembledTraits traits() const override {
    return {"apgd_plain", "accelerated projected gradient as published (Euclidean metric)",
            false,        true,
            50000,        10};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    const std::size_t rows = p.q.size();
    std::vector<double> r = o.guess, y, next(rows), u(rows);
    project_on_cones(p, r);
    std::vector<double> moved, next_moved, y_moved;  // products with W
    const auto apply = [&](const std::vector<double>& x, std::vector<double>& product) {
      multiply(p, x, product);
      monitor.count_applications();
    };
    apply(r, moved);
    // |W (r - 1)| / |r - 1|.
    std::vector<double> from_ones(r), spread;
    for (double& x : from_ones) x -= 1;
    if (!(norm(from_ones) > 0)) from_ones[0] = 1;
    apply(from_ones, spread);
    double lipschitz = norm(spread) / norm(from_ones);
    if (!(lipschitz > 0)) lipschitz = 1;
    // Where nothing resists, steps would grow until the impulses absorb the velocities.
    const double least = 1e-6 * lipschitz;
    y = r;
    y_moved = moved;
    double theta = 1;
    for (int k = 0;; ++k) {
      if (monitor.due(k)) {
        for (std::size_t i = 0; i < rows; ++i) u[i] = moved[i] + p.q[i];
        if (monitor.look(k, r, u)) return;
      }
      for (;; lipschitz *= 2) {
        for (std::size_t i = 0; i < rows; ++i) next[i] = y[i] - (y_moved[i] + p.q[i]) / lipschitz;
        project_on_cones(p, next);
        apply(next, next_moved);
        double curvature = 0, square = 0;
        for (std::size_t i = 0; i < rows; ++i) {
          const double d = next[i] - y[i];
          curvature += d * (next_moved[i] - y_moved[i]);
          square += d * d;
        }
        // "not more" as infinities end in the monitor
        if (!(curvature > lipschitz * square)) break;
      }
      const double square = theta * theta;
      double theta_next = 0.5 * (std::sqrt(square * square + 4 * square) - square);
      double momentum = theta * (1 - theta) / (square + theta_next);
      double uphill = 0;
      for (std::size_t i = 0; i < rows; ++i) uphill += (y_moved[i] + p.q[i]) * (next[i] - r[i]);
      if (uphill > 0) {
        theta_next = 1;
        momentum = 0;
      }
      for (std::size_t i = 0; i < rows; ++i) {
        y[i] = next[i] + momentum * (next[i] - r[i]);
        y_moved[i] = next_moved[i] + momentum * (next_moved[i] - moved[i]);
      }
      r.swap(next);
      moved.swap(next_moved);
      theta = theta_next;
      lipschitz = std::max(0.9 * lipschitz, least);
    }
  }
};

}  // namespace

std::unique_ptr<AssembledSolver> make_assembled_apgd_plain() {
  return std::make_unique<ApgdPlain>();
}

}  // namespace scree
