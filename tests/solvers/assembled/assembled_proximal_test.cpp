// How the weight of the proximal method follows what inner solves can do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "solvers/assembled/proximal_method.h"
#include "tests/assembled_samples.h"

namespace scree {
namespace {

/// Weights of the outer iterations, where Newton fails below `enough` and sweeps gain nothing.
std::vector<double> weights(const ProximalSettings& settings, double enough, int iterations) {
  const AssembledProblem p = fixtures::one_contact({1, 0, 0, 0, 1, 0, 0, 0, 1}, {-1, 2, 0}, 0.3);
  std::vector<double> seen;
  ProximalMethods methods;
  methods.newton = [&](const AssembledProblem& inner, const AssembledOptions& o,
                       AssembledMonitor& monitor) {
    seen.push_back(inner.diagonal(0)[0] - p.diagonal(0)[0]);
    monitor.check(0, o.guess);
    monitor.fail(seen.back() < enough ? AssembledStatus::stalled : AssembledStatus::converged);
  };
  methods.sweeps = [](const AssembledProblem&, const AssembledOptions& o,
                      AssembledMonitor& monitor) { monitor.check(0, o.guess); };
  AssembledOptions o;
  o.max_iterations = iterations;
  o.guess.assign(3, 0.0);
  AssembledMonitor monitor(p, o, nullptr);
  run_proximal(p, o, settings, monitor, methods);
  return seen;
}

std::vector<double> in_units_of(double unit, std::vector<double> values) {
  for (double& v : values) v /= unit;
  return values;
}

TEST(ProximalWeights, FailuresInARowRaiseThemFasterAndFasterWhereAsked) {
  using testing::DoubleNear;
  const auto near = [](double x) { return DoubleNear(x, 1e-6 * x); };
  ProximalSettings settings;
  settings.first_weight = 1e-6;
  EXPECT_THAT(in_units_of(1e-6, weights(settings, 1, 5)),
              testing::ElementsAre(near(1), near(2), near(4), near(8), near(16)));
  settings.largest_growth = 16;
  EXPECT_THAT(in_units_of(1e-6, weights(settings, 1, 6)),
              testing::ElementsAre(near(1), near(2), near(8), near(64), near(1024), near(16384)));
  // A solved problem ends the row.
  settings.least_weight = 4e-6;
  EXPECT_THAT(in_units_of(1e-6, weights(settings, 6e-6, 5)),
              testing::ElementsAre(near(1), near(2), near(8), near(5.6), near(11.2)));
}

}  // namespace
}  // namespace scree
