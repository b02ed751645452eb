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
#include <utility>

#include "solvers/assembled/accelerated_points.h"
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
    std::vector<double> start = o.guess, u;
    project_on_cones(p, start);
    AcceleratedPoints at(p, std::move(start));
    // |W (r - 1)| / |r - 1|.
    std::vector<double> from_ones(at.r), spread;
    for (double& x : from_ones) x -= 1;
    if (!(norm(from_ones) > 0)) from_ones[0] = 1;
    multiply(p, from_ones, spread);
    monitor.count_applications(2);
    double lipschitz = norm(spread) / norm(from_ones);
    if (!(lipschitz > 0)) lipschitz = 1;
    // Where nothing resists, steps would grow until the impulses absorb the velocities.
    const double least = 1e-6 * lipschitz;
    double theta = 1;
    for (int k = 0;; ++k) {
      if (monitor.due(k)) {
        at.velocity(p.q, u);
        if (monitor.look(k, at.r, u)) return;
      }
      for (;; lipschitz *= 2) {
        for (std::size_t i = 0; i < rows; ++i)
          at.next[i] = at.y[i] - (at.y_moved[i] + p.q[i]) / lipschitz;
        project_on_cones(p, at.next);
        multiply(p, at.next, at.next_moved);
        monitor.count_applications();
        double curvature = 0, square = 0;
        for (std::size_t i = 0; i < rows; ++i) {
          const double d = at.next[i] - at.y[i];
          curvature += d * (at.next_moved[i] - at.y_moved[i]);
          square += d * d;
        }
        // "not more" as infinities end in the monitor
        if (!(curvature > lipschitz * square)) break;
      }
      const double square = theta * theta;
      double theta_next = 0.5 * (std::sqrt(square * square + 4 * square) - square);
      double momentum = theta * (1 - theta) / (square + theta_next);
      if (at.uphill(p.q) > 0) {
        theta_next = 1;
        momentum = 0;
      }
      at.advance(momentum);
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
