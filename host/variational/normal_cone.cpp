#include "host/variational/normal_cone.h"

#include <Eigen/QR>
#include <algorithm>
#include <limits>
#include <vector>

namespace scree::variational {
namespace {

/// Least squares over the columns that are in use; all other entries are zero.
Vector solve_among(const Matrix& a, const Vector& b, const std::vector<Eigen::Index>& used) {
  Matrix columns(a.rows(), static_cast<Eigen::Index>(used.size()));
  for (std::size_t k = 0; k < used.size(); ++k)
    columns.col(static_cast<Eigen::Index>(k)) = a.col(used[k]);
  const Vector values = columns.completeOrthogonalDecomposition().solve(b);
  Vector x = Vector::Zero(a.cols());
  for (std::size_t k = 0; k < used.size(); ++k) x[used[k]] = values[static_cast<Eigen::Index>(k)];
  return x;
}

/// Walks from x towards y until the first entry in use would be negative, and takes such entries out of use.
void walk_to(const Vector& y, Vector& x, std::vector<Eigen::Index>& used) {
  double share = 1;
  for (const Eigen::Index j : used)
    if (y[j] <= 0) share = std::min(share, x[j] / (x[j] - y[j]));
  x += share * (y - x);
  std::erase_if(used, [&](Eigen::Index j) {
    const bool is_out = y[j] <= 0 && x[j] <= 4 * std::numeric_limits<double>::epsilon() * x.norm();
    if (is_out) x[j] = 0;
    return is_out;
  });
}

}  // namespace

ConeProjection project_on_normal_cone(const Metric& metric, const Matrix& gradients,
                                      const Vector& p) {
  const Matrix a = metric.whitened(gradients);
  const Vector b = -metric.whitened(p);
  const Eigen::Index count = a.cols();
  const double rounding = 16 * std::numeric_limits<double>::epsilon() * b.norm();
  Vector x = Vector::Zero(count);
  std::vector<Eigen::Index> used;
  // Each round adds a column; the method ends after finitely many, in practice after `count`.
  for (Eigen::Index round = 0; round < 3 * count + 3; ++round) {
    const Vector descent = a.transpose() * (b - a * x);
    Eigen::Index next = -1;
    for (Eigen::Index j = 0; j < count; ++j) {
      const bool is_used = std::find(used.begin(), used.end(), j) != used.end();
      if (!is_used && descent[j] > rounding * a.col(j).norm() &&
          (next < 0 || descent[j] > descent[next]))
        next = j;
    }
    if (next < 0) break;
    used.push_back(next);
    Vector y = solve_among(a, b, used);
    while (!used.empty() && (y.array() < 0).any()) {
      walk_to(y, x, used);
      y = solve_among(a, b, used);
    }
    x = y;
  }
  return {x, (b - a * x).norm()};
}

}  // namespace scree::variational
