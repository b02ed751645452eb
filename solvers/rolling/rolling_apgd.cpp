#include <algorithm>
#include <cmath>

#include "solvers/rolling/rolling_methods.h"

namespace scree {
namespace {

using Values = std::vector<double>;

void project(const RollingProblem& p, Values& x) {
  for (int c = 0; c < p.contact_count; ++c) project_on_cone(cone_of(p, c), &x[5 * c]);
}

Values lifts(const RollingProblem& p, AssembledModel model, const Values& Wx) {
  Values add(p.q.size(), 0.0);
  for (int c = 0; c < p.contact_count; ++c) {
    double u[5];
    for (int i = 0; i < 5; ++i) u[i] = Wx[5 * c + i] + p.q[5 * c + i];
    add[5 * c] = lift(model, cone_of(p, c), u);
  }
  return add;
}

/// |x - P(x - (W x + q + add))|
double natural_residual(const RollingProblem& p, const Values& x, const Values& Wx,
                        const Values& add) {
  Values y = x;
  for (std::size_t k = 0; k < y.size(); ++k) y[k] -= Wx[k] + p.q[k] + add[k];
  project(p, y);
  double square = 0;
  for (std::size_t k = 0; k < y.size(); ++k) square += (x[k] - y[k]) * (x[k] - y[k]);
  return std::sqrt(square);
}

}  // namespace

void run_rolling_apgd(const RollingProblem& p, AssembledModel model, Values& x,
                      RollingMonitor& monitor) {
  constexpr double follows_at = 0.1;
  project(p, x);
  Values Wx = multiply(p, x), add = lifts(p, model, Wx);
  Values y = x, Wy = Wx, next(x.size()), Wnext;
  double bound = 1;  // on the eigenvalues of W, whose diagonal is about one
  double theta = 1;
  const auto restart = [&] {
    y = x;
    Wy = Wx;
    theta = 1;
  };
  while (!monitor.over(x)) {
    if (model == AssembledModel::exact && monitor.looked()) {
      Values now = lifts(p, model, Wx);
      if (natural_residual(p, x, Wx, add) <= follows_at * natural_residual(p, x, Wx, now)) {
        add = std::move(now);
        restart();
      }
    }
    int products = 0;
    double step_square = 0, curvature = 0;
    for (;;) {
      for (std::size_t k = 0; k < x.size(); ++k) next[k] = y[k] - (Wy[k] + p.q[k] + add[k]) / bound;
      project(p, next);
      Wnext = multiply(p, next);
      ++products;
      step_square = curvature = 0;
      for (std::size_t k = 0; k < x.size(); ++k) {
        const double d = next[k] - y[k];
        step_square += d * d;
        curvature += d * (Wnext[k] - Wy[k]);
      }
      // Written so that numbers that are not finite end it too.
      if (!(curvature > bound * step_square * (1 + 1e-12)) || bound > 1e100) break;
      bound *= 2;
    }
    double uphill = 0;
    for (std::size_t k = 0; k < x.size(); ++k) uphill += (y[k] - next[k]) * (next[k] - x[k]);
    const double root = std::sqrt(theta * theta + 4);
    const double next_theta = 0.5 * theta * (root - theta);
    const double momentum = theta * (1 - theta) / (theta * theta + next_theta);
    for (std::size_t k = 0; k < x.size(); ++k) {
      y[k] = next[k] + momentum * (next[k] - x[k]);
      Wy[k] = Wnext[k] + momentum * (Wnext[k] - Wx[k]);
    }
    theta = next_theta;
    x.swap(next);
    Wx.swap(Wnext);
    if (uphill > 0) restart();
    bound *= 0.99;
    monitor.count(products);
  }
}

}  // namespace scree
