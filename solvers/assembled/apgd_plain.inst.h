// Accelerated projected gradient descent as published: Nesterov's momentum, a step 1/L that is
// halved where the objective does not fall as predicted, and restarts.
//
//   t = 1/L, g = W y + q, r+ = P_K(y - t g); while (r+ - y).W (r+ - y) > L |r+ - y|^2: L = 2 L
//   theta+ = (sqrt(theta^4 + 4 theta^2) - theta^2) / 2, b = theta (1 - theta) / (theta^2 + theta+)
//   y+ = r+ + b (r+ - r), but y+ = r+ and theta+ = 1 if g.(r+ - r) > 0;  L = 0.9 L
//
// One iteration is one product with W, 14 vectors read or written beside it, and the same once
// more for every halving. The best iterate that was checked is kept, as in the paper. Steps are
// the same for all contacts, whatever their masses: apgd is the same method in a better metric.
// Source: Mazhar, Heyn, Negrut and Tasora, ACM TOG 34(3), 2015, algorithm "APGD".

#include <cmath>

#include "solvers/assembled/accelerated_points.h"
#include "solvers/assembled/backend_solver.h"
#include "solvers/assembled/cone_vectors.h"

namespace scree {
namespace {

struct PlainState {
  double lipschitz = 1;
  double least = 0;  ///< L is never less: where nothing resists, steps would grow until the
                     ///< impulses absorb the velocities
  double theta = 1;
};

struct PlainRules {
  AcceleratedState* points;
  PlainState* state;

  SCREE_HD void operator()(const Sums<3>& sums) const {
    PlainState& s = *state;
    // "not more" as infinities end in the monitor
    if (sums.value[0] > s.lipschitz * sums.value[1]) {
      s.lipschitz *= 2;
      points->from = TrialFrom::same_point;
    } else {
      const double square = s.theta * s.theta;
      double theta_next = 0.5 * (std::sqrt(square * square + 4 * square) - square);
      double momentum = s.theta * (1 - s.theta) / (square + theta_next);
      if (sums.value[2] > 0) {
        theta_next = 1;
        momentum = 0;
      }
      s.theta = theta_next;
      const double shorter = 0.9 * s.lipschitz;
      s.lipschitz = shorter < s.least ? s.least : shorter;
      points->momentum = momentum;
      points->from = TrialFrom::extrapolated;
      ++points->accepted;
    }
    points->step = 1 / s.lipschitz;
  }
};

class ApgdPlain final : public BackendSolver<BuildBackend> {
 public:
  using BackendSolver::BackendSolver;

  AssembledTraits traits() const override {
    return {"apgd_plain", "accelerated projected gradient as published (Euclidean metric)",
            false,        true,
            50000,        10};
  }

  void run(const AssembledProblem& problem, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    // |W (r - 1)| / |r - 1|.
    std::vector<double> from_ones = o.guess, spread;
    project_on_cones(problem, from_ones);
    for (double& x : from_ones) x -= 1;
    if (!(norm(from_ones) > 0)) from_ones[0] = 1;
    multiply(problem, from_ones, spread);
    monitor.count_applications();
    PlainState first;
    first.lipschitz = norm(spread) / norm(from_ones);
    if (!(first.lipschitz > 0)) first.lipschitz = 1;
    first.least = 1e-6 * first.lipschitz;

    const auto p = upload_problem(problem);
    Buffer<BuildBackend, PlainState> state(backend(), 1);
    upload(backend(), &first, state.view());
    AcceleratedPoints<BuildBackend> points(p, o.guess, {}, monitor);
    points.run({.step = 1 / first.lipschitz}, PlainRules{points.state(), state.data()});
  }
};

}  // namespace

template <>
std::unique_ptr<AssembledSolver> make_assembled_apgd_plain<BuildBackend>(
    std::shared_ptr<BuildBackend> backend) {
  return std::make_unique<ApgdPlain>(std::move(backend));
}

}  // namespace scree
