// Accelerated projected gradient descent with the rules of docs/theory.md, section "APGD": slower
// momentum from theta = 1/4, a step rule that accepts what still descends, restarts, and a diagonal
// metric H = (P D^2)^(1/3).
//
// D and P have one number for the normal row of a contact and one for both tangential ones. D is
// that of its own block (the larger stretch of the tangential part). P bounds W from above: the
// sum over the block row of |W_ij| (d_i / d_j)^1/2, so that P - W is semidefinite by the test of
// Schur; with bodies at hand it is the mass-split bound. One iteration is one product with W, as
// the product of the extrapolated point follows from those of the iterates, and 14 vectors read or
// written beside it; a rejected step, which is rare, costs as much. Source: Mazhar, Heyn, Negrut
// and Tasora, ACM TOG 34(3), 2015; momentum of Chambolle and Dossal, JOTA 166, 2015; the other
// rules in docs/theory.md.

#include <algorithm>
#include <cmath>

#include "kernels/solve/apgd_passes.h"
#include "solvers/assembled/accelerated_points.h"
#include "solvers/assembled/backend_solver.h"

namespace scree {
namespace {

RowWeights floored(RowWeights w, double scale) {
  return {std::max(w.normal, 1e-3 * scale), std::max(w.tangential, 1e-3 * scale)};
}

std::vector<RowWeights> block_weights(const AssembledProblem& p) {
  const std::vector<double> scale = contact_scales(p);
  std::vector<RowWeights> d(p.contact_count);
  for (int c = 0; c < p.contact_count; ++c) {
    const Block3& w = p.diagonal(c);
    const double mean = 0.5 * (w[4] + w[8]), off = 0.5 * (w[5] + w[7]);
    d[c] = floored({w[0], mean + std::hypot(0.5 * (w[4] - w[8]), off)}, scale[c]);
  }
  return d;
}

/// P with W <= P.
std::vector<RowWeights> bounds(const AssembledProblem& p, const std::vector<RowWeights>& d) {
  std::vector<RowWeights> bound(p.contact_count);
  for (int c = 0; c < p.contact_count; ++c) {
    double sum[3] = {0, 0, 0};
    for (int k = p.row_start[c]; k < p.row_start[c + 1]; ++k)
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          sum[i] += std::abs(p.block[k][3 * i + j]) * std::sqrt(d[c].of(i) / d[p.column[k]].of(j));
    bound[c] = {std::max(sum[0], d[c].normal), std::max({sum[1], sum[2], d[c].tangential})};
  }
  return bound;
}

/// The rules of the solver of steps, for a trial on the assembled operator. A rejected one is
/// repeated from the iterate itself.
struct ApgdRules {
  AcceleratedState* points;
  ApgdState* state;
  double least;  ///< L is never less: where nothing resists, steps would grow until the impulses
                 ///< absorb the velocities

  SCREE_HD void operator()(const Sums<3>& sums) const {
    const Index before = state->accepted;
    state->step_squares = sums.value[1];
    state->descent = sums.value[2];
    ApgdBodyFinish{state}({{sums.value[0]}});
    if (state->lipschitz < least) state->set_lipschitz(least);
    *points = {state->step, state->beta,
               state->accepted == before ? TrialFrom::iterate : TrialFrom::extrapolated,
               state->accepted};
  }
};

class Apgd final : public BackendSolver<BuildBackend> {
 public:
  using BackendSolver::BackendSolver;

  AssembledTraits traits() const override {
    return {"apgd", "accelerated projected gradient, diagonal metric", false, true, 50000, 10};
  }

  void run(const AssembledProblem& problem, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    const std::vector<RowWeights> block = block_weights(problem), bound = bounds(problem, block);
    std::vector<RowWeights> metric(problem.contact_count);
    double largest = 0;
    for (int c = 0; c < problem.contact_count; ++c) {
      const auto mean = [](double above, double own) { return own * std::cbrt(above / own); };
      metric[c] = {mean(bound[c].normal, block[c].normal),
                   mean(bound[c].tangential, block[c].tangential)};
      largest = std::max({largest, bound[c].normal / metric[c].normal,
                          bound[c].tangential / metric[c].tangential});
    }
    largest *= 1 + 1e-5;

    ApgdState first;
    first.lipschitz_max = largest;
    first.set_lipschitz(largest / 4);
    first.set_momentum(kFirstTheta, 0);
    const auto p = upload_problem(problem);
    Buffer<BuildBackend, ApgdState> state(backend(), 1);
    upload(backend(), &first, state.view());
    AcceleratedPoints<BuildBackend> points(p, o.guess, metric, monitor);
    points.run({.step = first.step}, ApgdRules{points.state(), state.data(), 1e-6 * largest});
  }
};

}  // namespace

template <>
std::unique_ptr<AssembledSolver> make_assembled_apgd<BuildBackend>(
    std::shared_ptr<BuildBackend> backend) {
  return std::make_unique<Apgd>(std::move(backend));
}

}  // namespace scree
