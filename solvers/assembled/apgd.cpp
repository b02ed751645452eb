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

/// Projection in the metric, docs/theory.md eq. (7).
void project(double mu, const Weights& h, double* x) {
  const double t = std::hypot(x[1], x[2]);
  if (t <= mu * x[0]) return;
  const double pull = h.normal * x[0] + mu * h.tangential * t;
  const double n = pull > 0 ? pull / (h.normal + mu * mu * h.tangential) : 0;
  const double shrink = t > 0 ? mu * n / t : 0;
  x[0] = n;
  x[1] *= shrink;
  x[2] *= shrink;
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

    const std::size_t rows = p.q.size();
    std::vector<double> r = o.guess, next(rows), u(rows);
    std::vector<double> moved, next_moved, y_moved;  // products with W
    project_on_cones(p, r);
    multiply(p, r, moved);
    monitor.count_applications();
    std::vector<double> y = r;
    y_moved = moved;
    // Where nothing resists, steps would grow until the impulses absorb the velocities.
    const double least = 1e-6 * largest;
    double theta = 0.25, lipschitz = largest / 4;
    for (int k = 0;; ++k) {
      if (monitor.due(k)) {
        for (std::size_t i = 0; i < rows; ++i) u[i] = moved[i] + p.q[i];
        if (monitor.look(k, r, u)) return;
      }
      double ratio = 0;
      for (;; lipschitz = std::min(1.1 * ratio, largest)) {
        double curvature = 0, square = 0;
        for (int c = 0; c < p.contact_count; ++c) {
          for (int i = 0; i < 3; ++i) {
            const int row = 3 * c + i;
            next[row] = y[row] - (y_moved[row] + p.q[row]) / (lipschitz * metric[c].of(i));
          }
          project(p.mu[c], metric[c], &next[3 * c]);
        }
        multiply(p, next, next_moved);
        monitor.count_applications();
        for (std::size_t i = 0; i < rows; ++i) {
          const double d = next[i] - y[i];
          curvature += d * (next_moved[i] - y_moved[i]);
          square += metric[i / 3].of(static_cast<int>(i % 3)) * d * d;
        }
        ratio = square > 0 ? curvature / square : 0;
        if (!(ratio > 2 * lipschitz) || lipschitz >= largest) break;
      }
      double theta_next = theta / (1 + theta / 3);
      double momentum = (1 - theta) / (1 + theta / 3);
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
      lipschitz = std::clamp(ratio > lipschitz ? 1.1 * ratio : 0.95 * lipschitz, least, largest);
    }
  }
};

}  // namespace

std::unique_ptr<AssembledSolver> make_assembled_apgd() { return std::make_unique<Apgd>(); }

}  // namespace scree
