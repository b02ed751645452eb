// Accelerated projected gradient descent with the rules of docs/theory.md, section "APGD": slower
// momentum from theta = 1/4, a step rule that accepts what still descends, restarts, and a diagonal
// metric H = (P D^2)^(1/3).
//
// D and P have one number for the normal row of a contact and one for both tangential ones. D is
// that of its own block (the larger stretch of the tangential part). P bounds W from above: the
// sum over the block row of |W_ij| (d_i / d_j)^1/2, so that P - W is semidefinite by the test of
// Schur; with bodies at hand it is the mass-split bound. One iteration is one product with W, as
// the product of the extrapolated point follows from those of the iterates; a rejected step, which
// is rare, costs one more. Source: Mazhar, Heyn, Negrut and Tasora, ACM TOG 34(3), 2015; momentum
// of Chambolle and Dossal, JOTA 166, 2015; the other rules in docs/theory.md.

#include <algorithm>
#include <utility>

#include "kernels/apgd_passes.h"
#include "solvers/assembled/accelerated_points.h"
#include "solvers/assembled/assembled_solver.h"
#include "solvers/assembled/cone_vectors.h"

namespace scree {
namespace {

/// Two weights of a contact [1/kg].
struct Weights {
  double normal = 1;
  double tangential = 1;
  double of(int row) const { return row == 0 ? normal : tangential; }
};

Weights floored(Weights w, double scale) {
  return {std::max(w.normal, 1e-3 * scale), std::max(w.tangential, 1e-3 * scale)};
}

std::vector<Weights> block_weights(const AssembledProblem& p) {
  const std::vector<double> scale = contact_scales(p);
  std::vector<Weights> d(p.contact_count);
  for (int c = 0; c < p.contact_count; ++c) {
    const Block3& w = p.diagonal(c);
    const double mean = 0.5 * (w[4] + w[8]), off = 0.5 * (w[5] + w[7]);
    d[c] = floored({w[0], mean + std::hypot(0.5 * (w[4] - w[8]), off)}, scale[c]);
  }
  return d;
}

/// P with W <= P.
std::vector<Weights> bounds(const AssembledProblem& p, const std::vector<Weights>& d) {
  std::vector<Weights> bound(p.contact_count);
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

/// Projection in the metric, in place.
void project(double mu, const Weights& h, double* x) {
  const Vec3<double> y = project_cone(mu, Vec3<double>{1, 0, 0}, Vec3<double>{x[0], x[1], x[2]},
                                      h.normal, h.tangential);
  x[0] = y.x, x[1] = y.y, x[2] = y.z;
}

class Apgd final : public AssembledSolver {
 public:
  AssembledTraits traits() const override {
    return {"apgd", "accelerated projected gradient, diagonal metric", false, true, 50000, 10};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    const std::vector<Weights> block = block_weights(p), bound = bounds(p, block);
    std::vector<Weights> metric(p.contact_count);
    double largest = 0;
    for (int c = 0; c < p.contact_count; ++c) {
      const auto mean = [](double above, double own) { return own * std::cbrt(above / own); };
      metric[c] = {mean(bound[c].normal, block[c].normal),
                   mean(bound[c].tangential, block[c].tangential)};
      largest = std::max({largest, bound[c].normal / metric[c].normal,
                          bound[c].tangential / metric[c].tangential});
    }
    largest *= 1 + 1e-5;

    std::vector<double> start = o.guess, u;
    project_on_cones(p, start);
    AcceleratedPoints at(p, std::move(start));
    monitor.count_applications();
    // Where nothing resists, steps would grow until the impulses absorb the velocities.
    const double least = 1e-6 * largest;
    ApgdState state;  // the rules are those of the solver of steps
    state.lipschitz_max = largest;
    state.set_lipschitz(largest / 4);
    state.set_point(ApgdStart::kTheta, 0);
    for (;;) {
      if (monitor.due(state.iterations)) {
        at.velocity(p.q, u);
        if (monitor.look(state.iterations, at.r, u)) return;
      }
      for (int c = 0; c < p.contact_count; ++c) {
        for (int i = 0; i < 3; ++i) {
          const int row = 3 * c + i;
          at.next[row] = at.y[row] - state.step / metric[c].of(i) * (at.y_moved[row] + p.q[row]);
        }
        project(p.mu[c], metric[c], &at.next[3 * c]);
      }
      multiply(p, at.next, at.next_moved);
      monitor.count_applications();
      double curvature = 0;
      state.step_squares = 0;
      for (std::size_t i = 0; i < at.r.size(); ++i) {
        const double d = at.next[i] - at.y[i];
        curvature += d * (at.next_moved[i] - at.y_moved[i]);
        state.step_squares += metric[i / 3].of(static_cast<int>(i % 3)) * d * d;
      }
      state.descent = at.uphill(p.q);
      const double beta = state.next_beta, delta = state.next_delta;
      ApgdBodyFinish{&state}({{curvature}});
      if (state.lipschitz < least) state.set_lipschitz(least);
      at.advance(state.follow * beta, state.follow * delta);
    }
  }
};

}  // namespace

std::unique_ptr<AssembledSolver> make_assembled_apgd() { return std::make_unique<Apgd>(); }

}  // namespace scree
