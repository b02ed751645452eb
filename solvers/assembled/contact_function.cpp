#include "solvers/assembled/contact_function.h"

#include <algorithm>
#include <cmath>

namespace scree {
namespace {

constexpr Block3 identity{1, 0, 0, 0, 1, 0, 0, 0, 1};

ContactFunction alart_curnier(double mu, const ContactWeights& rho, const double* r,
                              const double* u) {
  const double x = r[0] - rho.normal * u[0];
  const double y[2] = {r[1] - rho.tangential * u[1], r[2] - rho.tangential * u[2]};
  if (!(x > 0)) return {{r[0], r[1], r[2]}, identity, {}};
  ContactFunction f{};
  f.value[0] = rho.normal * u[0];
  f.by_u[0] = rho.normal;
  const double radius = mu * x, size = std::hypot(y[0], y[1]);
  if (size <= radius) {
    f.value[1] = rho.tangential * u[1];
    f.value[2] = rho.tangential * u[2];
    f.by_u[4] = f.by_u[8] = rho.tangential;
    return f;
  }
  const double e[2] = {y[0] / size, y[1] / size};
  const double shrink = radius / size;
  for (int i = 0; i < 2; ++i) {
    const int row = 3 * (i + 1);
    f.value[i + 1] = r[i + 1] - radius * e[i];
    f.by_r[row] = -mu * e[i];
    f.by_u[row] = mu * rho.normal * e[i];
    for (int j = 0; j < 2; ++j) {
      const double turn = shrink * ((i == j ? 1.0 : 0.0) - e[i] * e[j]);
      f.by_r[row + 1 + j] = (i == j ? 1.0 : 0.0) - turn;
      f.by_u[row + 1 + j] = rho.tangential * turn;
    }
  }
  return f;
}

ContactFunction natural_map(double mu, double rho, const double* r, const double* u) {
  const double x = r[0] - rho * u[0];
  const double y[2] = {r[1] - rho * u[1], r[2] - rho * u[2]};
  const double size = std::hypot(y[0], y[1]);
  if (mu * size <= -x) return {{r[0], r[1], r[2]}, identity, {}};
  ContactFunction f{};
  if (size <= mu * x) {
    for (int k = 0; k < 3; ++k) {
      f.value[k] = rho * u[k];
      f.by_u[4 * k] = rho;
    }
    return f;
  }
  const double e[2] = {y[0] / size, y[1] / size};
  const double n = (x + mu * size) / (1 + mu * mu), shrink = mu * n / size;
  Block3 slope{};  // of the projection
  slope[0] = 1 / (1 + mu * mu);
  for (int i = 0; i < 2; ++i) {
    slope[1 + i] = mu * e[i] / (1 + mu * mu);
    slope[3 * (i + 1)] = slope[1 + i];
    for (int j = 0; j < 2; ++j)
      slope[3 * (i + 1) + 1 + j] =
          mu * mu / (1 + mu * mu) * e[i] * e[j] + shrink * ((i == j ? 1.0 : 0.0) - e[i] * e[j]);
  }
  f.value[0] = r[0] - n;
  f.value[1] = r[1] - mu * n * e[0];
  f.value[2] = r[2] - mu * n * e[1];
  for (int k = 0; k < 9; ++k) {
    f.by_r[k] = identity[k] - slope[k];
    f.by_u[k] = rho * slope[k];
  }
  return f;
}

}  // namespace

ContactWeights contact_weights(const Block3& W, double scale) {
  const double normal = std::max(W[0], 1e-6 * scale);
  const double mean = 0.5 * (W[4] + W[8]), off = 0.5 * (W[5] + W[7]);
  const double tangential = mean + std::hypot(0.5 * (W[4] - W[8]), off);
  return {1 / normal, 1 / std::max(tangential, 1e-6 * scale)};
}

ContactFunction contact_function(AssembledModel model, double mu, const ContactWeights& weights,
                                 double scale, const double* r, const double* u) {
  if (model == AssembledModel::exact) return alart_curnier(mu, weights, r, u);
  return natural_map(mu, 1 / scale, r, u);
}

}  // namespace scree
