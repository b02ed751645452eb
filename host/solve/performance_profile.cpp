#include "host/solve/performance_profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace scree {

PerformanceProfile performance_profile(const ProfileCosts& costs) {
  // A clock can read zero: costs below this are one and the same.
  constexpr double least = 1e-9;
  PerformanceProfile profile;
  profile.solvers = costs.solvers;
  profile.ratio = {1};
  std::vector<std::vector<double>> ratios;
  for (const std::vector<double>& row : costs.cost) {
    double best = std::numeric_limits<double>::infinity();
    for (const double cost : row) best = std::min(best, std::max(cost, least));
    std::vector<double> r;
    for (const double cost : row) {
      r.push_back(std::isfinite(cost) ? std::max(cost, least) / best
                                      : std::numeric_limits<double>::infinity());
      if (std::isfinite(r.back())) profile.ratio.push_back(r.back());
    }
    ratios.push_back(r);
  }
  std::sort(profile.ratio.begin(), profile.ratio.end());
  profile.ratio.erase(std::unique(profile.ratio.begin(), profile.ratio.end()), profile.ratio.end());
  for (const double ratio : profile.ratio) {
    std::vector<double> share(costs.solvers.size(), 0.0);
    for (const std::vector<double>& row : ratios)
      for (std::size_t s = 0; s < share.size(); ++s)
        share[s] += row[s] <= ratio ? 1.0 / static_cast<double>(ratios.size()) : 0.0;
    profile.share.push_back(share);
  }
  return profile;
}

std::string to_csv(const PerformanceProfile& profile) {
  std::string text = fmt::format("ratio,{}\n", fmt::join(profile.solvers, ","));
  for (std::size_t k = 0; k < profile.ratio.size(); ++k)
    text += fmt::format("{:.9g},{:.6g}\n", profile.ratio[k], fmt::join(profile.share[k], ","));
  return text;
}

}  // namespace scree
