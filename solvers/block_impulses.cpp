#include "solvers/block_impulses.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "solvers/assembled/interior_point.h"

namespace scree {
namespace {

/// Of the interior point method, which takes 10 to 60.
constexpr int kMostIterations = 100;
/// Residual, over that of the impulses so far, from which on others are worth starting from.
constexpr double kEnough = 0.5;

double dot6(const double (&x)[6], const double (&y)[6]) {
  double sum = 0;
  for (int k = 0; k < 6; ++k) sum += x[k] * y[k];
  return sum;
}

/// W of the contacts over `scale`.
std::vector<PlacedBlock> operator_of(const std::vector<BlockContact>& contacts, double scale) {
  struct Side {
    int contact, side;
  };
  std::map<Index, std::vector<Side>> of_body;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    for (int side = 0; side < 2; ++side) {
      const Index body = contacts[c].body[side];
      if (body >= 0) of_body[body].push_back({static_cast<int>(c), side});
    }
  }
  std::vector<PlacedBlock> blocks;
  for (const auto& [body, sides] : of_body) {
    for (const Side& x : sides) {
      for (const Side& y : sides) {
        PlacedBlock block{x.contact, y.contact, {}};
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j) {
            block.value[3 * i + j] =
                dot6(contacts[x.contact].wrench[x.side][i], contacts[y.contact].motion[y.side][j]) /
                scale;
          }
        }
        blocks.push_back(block);
      }
    }
  }
  return blocks;
}

}  // namespace

std::vector<Vec3<double>> block_impulses(const std::vector<BlockContact>& contacts, double contrast,
                                         double tolerance) {
  const auto n = static_cast<int>(contacts.size());
  // In units in which the largest diagonal entry is about 1, that of light bodies, the error of the
  // solver is the residual of their contacts.
  double scale = 0;
  for (const BlockContact& c : contacts) {
    double trace = 0;
    for (int side = 0; side < 2; ++side)
      for (int row = 0; row < 3; ++row) trace += dot6(c.wrench[side][row], c.motion[side][row]);
    scale = std::max(scale, trace / 3);
  }
  if (!(scale > 0)) return {};

  std::vector<double> q(3 * contacts.size()), mu, start(q.size());
  for (int c = 0; c < n; ++c) {
    mu.push_back(contacts[c].friction);
    for (int row = 0; row < 3; ++row) start[3 * c + row] = scale * contacts[c].impulse[row];
  }
  AssembledProblem problem = assemble(n, operator_of(contacts, scale), q, mu);
  std::vector<double> moved;
  multiply(problem, start, moved);
  double square = 0;
  for (int k = 0; k < 3 * n; ++k) {
    problem.q[k] = contacts[k / 3].velocity[k % 3] - moved[k];
    square += problem.q[k] * problem.q[k];
  }
  if (!(square > 0)) return {};

  AssembledOptions options;
  options.model = AssembledModel::convex;
  options.tolerance = tolerance * std::sqrt(n / square);
  options.tell_unsolvable = false;
  options.max_iterations = kMostIterations;
  options.check_every = 1;
  AssembledMonitor monitor(problem, options, nullptr);
  run_interior_point(problem, options, kLeastGrowth * contrast, monitor);
  const AssembledResult result = monitor.finish();
  // Rounding may end the method above the tolerance.
  const double before = measure(problem, AssembledModel::convex, start).relative;
  if (!(result.residual.relative < kEnough * before)) return {};

  std::vector<Vec3<double>> impulses;
  for (int c = 0; c < n; ++c) {
    Vec3<double> sum;
    for (int row = 0; row < 3; ++row) {
      const double(&axis)[3] = contacts[c].axis[row];
      sum += result.r[3 * c + row] / scale * Vec3<double>{axis[0], axis[1], axis[2]};
    }
    impulses.push_back(sum);
  }
  return impulses;
}

}  // namespace scree
