#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "solvers/rolling/rolling_methods.h"

namespace scree {
namespace {

constexpr int most_inner_steps = 30;
/// Inner steps end when one moves this much less than the first did.
constexpr double inner_decrease = 1e-3;

using Row5 = std::array<double, 5>;

/// The 5x5 block of a contact with itself, and steps that fit it.
struct OwnBlock {
  std::array<Row5, 5> a{};
  double normal = 0;                      ///< 1 / W_nn; 0 where that is not positive
  double whole = 0, slide = 0, roll = 0;  ///< 1 / largest eigenvalue of all, of t and of m
};

template <int Size>
double step_of(const Eigen::Matrix<double, 5, 5>& a, int start) {
  const Eigen::Matrix<double, Size, Size> block = a.block<Size, Size>(start, start);
  const double largest = Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, Size, Size>>(
                             0.5 * (block + block.transpose()), Eigen::EigenvaluesOnly)
                             .eigenvalues()(Size - 1);
  return largest > 0 ? 1 / largest : 0;
}

OwnBlock own_block(const RollingProblem& p, int c) {
  OwnBlock own;
  for (int i = 0; i < 5; ++i)
    for (int k = p.row_start[5 * c + i]; k < p.row_start[5 * c + i + 1]; ++k)
      if (p.column[k] / 5 == c) own.a[i][p.column[k] % 5] = p.value[k];
  Eigen::Matrix<double, 5, 5> a;
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j) a(i, j) = own.a[i][j];
  own.normal = own.a[0][0] > 0 ? 1 / own.a[0][0] : 0;
  own.whole = step_of<5>(a, 0);
  own.slide = step_of<2>(a, 1);
  own.roll = step_of<2>(a, 3);
  return own;
}

double velocity(const OwnBlock& own, const Row5& b, const double* x, int i) {
  double u = b[i];
  for (int j = 0; j < 5; ++j) u += own.a[i][j] * x[j];
  return u;
}

/// A step of two rows against their velocities, then to the disk.
void disk_step(const OwnBlock& own, const Row5& b, double step, double bound, int row, double* x) {
  const double u0 = velocity(own, b, x, row), u1 = velocity(own, b, x, row + 1);
  const double y0 = x[row] - step * u0, y1 = x[row + 1] - step * u1;
  const double length = std::hypot(y0, y1);
  const double keep = length > bound ? bound / length : 1;
  x[row] = keep * y0;
  x[row + 1] = keep * y1;
}

void exact_step(const OwnBlock& own, const Row5& b, const RollingCone& cone, double* x) {
  x[0] = std::max(0.0, x[0] - own.normal * velocity(own, b, x, 0));
  disk_step(own, b, own.slide, cone.mu * x[0], 1, x);
  disk_step(own, b, own.roll, cone.mu_r * x[0], 3, x);
}

void convex_step(const OwnBlock& own, const Row5& b, const RollingCone& cone, double* x) {
  Row5 u;
  for (int i = 0; i < 5; ++i) u[i] = velocity(own, b, x, i);
  for (int i = 0; i < 5; ++i) x[i] -= own.whole * u[i];
  project_on_cone(cone, x);
}

void solve_contact(const OwnBlock& own, const Row5& b, const RollingCone& cone,
                   AssembledModel model, double* x) {
  double first = 0;
  for (int k = 0; k < most_inner_steps; ++k) {
    Row5 before;
    std::copy(x, x + 5, before.begin());
    if (model == AssembledModel::exact) {
      exact_step(own, b, cone, x);
    } else {
      convex_step(own, b, cone, x);
    }
    double moved = 0;
    for (int i = 0; i < 5; ++i) moved = std::max(moved, std::abs(x[i] - before[i]));
    if (k == 0) first = moved;
    if (moved <= inner_decrease * first) return;
  }
}

}  // namespace

void run_rolling_sweeps(const RollingProblem& p, AssembledModel model, std::vector<double>& x,
                        RollingMonitor& monitor) {
  std::vector<OwnBlock> own;
  own.reserve(p.contact_count);
  for (int c = 0; c < p.contact_count; ++c) own.push_back(own_block(p, c));
  while (!monitor.over(x)) {
    for (int c = 0; c < p.contact_count; ++c) {
      Row5 b;
      for (int i = 0; i < 5; ++i) {
        const int row = 5 * c + i;
        b[i] = p.q[row] + row_product(p, row, x);
        for (int j = 0; j < 5; ++j) b[i] -= own[c].a[i][j] * x[5 * c + j];
      }
      solve_contact(own[c], b, cone_of(p, c), model, &x[5 * c]);
    }
    monitor.count();
  }
}

}  // namespace scree
