#include "solvers/rolling/rolling_measures.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "solvers/assembled/cone_vectors.h"

namespace scree {
namespace {

using Row5 = std::array<double, 5>;

double normal_of(const RollingCone& cone, const double* x) {
  const BoundedPart<double> parts[2] = {{cone.mu, 1, std::hypot(x[1], x[2])},
                                        {cone.mu_r, 1, std::hypot(x[3], x[4])}};
  return shared_normal(1.0, x[0], parts);
}

/// Share of a part that is beyond its bound: 0 within.
double share_beyond(double length, double bound) {
  return length > bound ? (length - bound) / length : 0;
}

/// Square of |x - P(x - w)| of one contact. With y = x - w it is w + (y - P(y)), and so it is
/// computed: where impulses are large, x - P(x - w) would lose w to rounding.
double natural_square(const RollingCone& cone, const Row5& x, const Row5& w, ContactState& state) {
  Row5 y, f = w;
  for (int k = 0; k < 5; ++k) y[k] = x[k] - w[k];
  const double n = normal_of(cone, y.data());
  const double t = std::hypot(y[1], y[2]), m = std::hypot(y[3], y[4]);
  const double beyond_t = share_beyond(t, cone.mu * n), beyond_m = share_beyond(m, cone.mu_r * n);
  if (!(n > 0)) {
    state = ContactState::open;
    f = x;
  } else {
    state = beyond_t > 0 || beyond_m > 0 ? ContactState::slip : ContactState::stick;
    f[0] -= cone.mu * beyond_t * t + cone.mu_r * beyond_m * m;
    f[1] += beyond_t * y[1];
    f[2] += beyond_t * y[2];
    f[3] += beyond_m * y[3];
    f[4] += beyond_m * y[4];
  }
  double square = 0;
  for (const double value : f) square += value * value;
  return square;
}

}  // namespace

void project_on_cone(const RollingCone& cone, double* x) {
  const double n = normal_of(cone, x);
  const double keep_t = 1 - share_beyond(std::hypot(x[1], x[2]), cone.mu * n);
  const double keep_m = 1 - share_beyond(std::hypot(x[3], x[4]), cone.mu_r * n);
  x[0] = n;
  x[1] *= keep_t;
  x[2] *= keep_t;
  x[3] *= keep_m;
  x[4] *= keep_m;
}

double lift(AssembledModel model, const RollingCone& cone, const double* u) {
  if (model == AssembledModel::convex) return 0;
  return cone.mu * std::hypot(u[1], u[2]) + cone.mu_r * std::hypot(u[3], u[4]);
}

AssembledResidual measure(const RollingProblem& p, AssembledModel model,
                          const std::vector<double>& scale, const std::vector<double>& r,
                          const std::vector<double>& u, std::vector<ContactState>* state) {
  AssembledResidual result;
  double square = 0, free_square = 0, scaled_q = 0;
  if (state != nullptr) state->resize(p.contact_count);
  for (int c = 0; c < p.contact_count; ++c) {
    const RollingCone cone = cone_of(p, c);
    Row5 impulse, v, x, w;
    for (int k = 0; k < 5; ++k) {
      const int row = 5 * c + k;
      const double d = scale[2 * c + (k < 3 ? 0 : 1)];
      impulse[k] = r[row];
      v[k] = u[row] + (k == 0 ? lift(model, cone, &u[row]) : 0);
      x[k] = std::sqrt(d) * impulse[k];
      w[k] = v[k] / std::sqrt(d);
      scaled_q += p.q[row] * p.q[row] / d;
      result.objective += 0.5 * r[row] * (u[row] + p.q[row]);
    }
    ContactState unscaled{}, now{};
    square += natural_square(cone, impulse, v, unscaled);
    const RollingCone free_cone{cone.mu, cone.mu_r * std::sqrt(scale[2 * c + 1] / scale[2 * c])};
    free_square += natural_square(free_cone, x, w, now);
    if (state != nullptr) (*state)[c] = now;
  }
  const double norm_q = norm(p.q);
  result.absolute = std::sqrt(square);
  result.relative = ratio(result.absolute, norm_q);
  result.to_largest = ratio(result.absolute, std::max({norm_q, norm(r), norm(u)}));
  result.unit_free = ratio(std::sqrt(free_square), std::sqrt(scaled_q));
  return result;
}

}  // namespace scree
