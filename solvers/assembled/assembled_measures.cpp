#include "solvers/assembled/assembled_measures.h"

#include <algorithm>
#include <array>

#include "solvers/assembled/cone_vectors.h"

namespace scree {
namespace {

ContactState state_of(double mu, const std::array<double, 3>& x) {
  const double t = std::hypot(x[1], x[2]);
  if (mu * t <= -x[0]) return ContactState::open;
  return t <= mu * x[0] ? ContactState::stick : ContactState::slip;
}

/// Square of |x - P(x - w)| of one contact. With y = x - w it is w + (y - P(y)), and so it is
/// computed: where impulses are large, x - P(x - w) would lose w to rounding.
double natural_square(double mu, const std::array<double, 3>& x, const std::array<double, 3>& w) {
  const double y[3] = {x[0] - w[0], x[1] - w[1], x[2] - w[2]};
  const double t = std::hypot(y[1], y[2]);
  std::array<double, 3> f = w;
  if (mu * t <= -y[0]) {
    f = x;
  } else if (t > mu * y[0]) {
    const double beyond = (t - mu * y[0]) / (1 + mu * mu);
    f[0] -= mu * beyond;
    f[1] += beyond * y[1] / t;
    f[2] += beyond * y[2] / t;
  }
  return f[0] * f[0] + f[1] * f[1] + f[2] * f[2];
}

}  // namespace

AssembledResidual measure(const AssembledProblem& p, AssembledModel model,
                          const std::vector<double>& scale, const std::vector<double>& r,
                          const std::vector<double>& u, std::vector<ContactState>* state) {
  AssembledResidual result;
  double square = 0, free_square = 0, scaled_q = 0;
  if (state != nullptr) state->resize(p.contact_count);
  for (int c = 0; c < p.contact_count; ++c) {
    const std::array<double, 3> impulse{r[3 * c], r[3 * c + 1], r[3 * c + 2]};
    const std::array<double, 3> v = law_velocity(model, p.mu[c], &u[3 * c]);
    const double root = std::sqrt(scale[c]);
    std::array<double, 3> x, w, trial;
    for (int k = 0; k < 3; ++k) {
      x[k] = root * impulse[k];
      w[k] = v[k] / root;
      trial[k] = x[k] - w[k];
      scaled_q += p.q[3 * c + k] * p.q[3 * c + k] / scale[c];
      result.objective += 0.5 * impulse[k] * (u[3 * c + k] + p.q[3 * c + k]);
    }
    square += natural_square(p.mu[c], impulse, v);
    free_square += natural_square(p.mu[c], x, w);
    if (state != nullptr) (*state)[c] = state_of(p.mu[c], trial);
  }
  if (p.held) {
    const double left = p.held->left();
    square += left * left;
    free_square += left * left / scale.front();
  }
  const double norm_q = norm(p.q);
  result.absolute = std::sqrt(square);
  result.relative = ratio(result.absolute, norm_q);
  result.to_largest = ratio(result.absolute, std::max({norm_q, norm(r), norm(u)}));
  result.unit_free = ratio(std::sqrt(free_square), std::sqrt(scaled_q));
  return result;
}

AssembledResidual measure(const AssembledProblem& p, AssembledModel model,
                          const std::vector<double>& r) {
  return measure(p, model, contact_scales(p), r, contact_velocity(p, r));
}

}  // namespace scree
