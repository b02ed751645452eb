#pragma once
// Performance profiles: which share of problems each solver solves within so many times the best.

#include <string>
#include <vector>

namespace scree {

/// Cost of every solver on every problem.
struct ProfileCosts {
  std::vector<std::string> solvers;
  /// [problem][solver] cost, infinity where the solver did not reach the tolerance
  std::vector<std::vector<double>> cost;
};

/// A step function per solver: share of problems with cost <= ratio * cost of the best solver
/// there. Problems that no solver solved count as unsolved by all.
struct PerformanceProfile {
  std::vector<std::string> solvers;
  std::vector<double> ratio;               ///< where any curve steps, ascending, from 1
  std::vector<std::vector<double>> share;  ///< [ratio][solver], in [0, 1]
};

/// Source: Dolan and More, Math. Program. 91, 2002.
PerformanceProfile performance_profile(const ProfileCosts& costs);

/// "ratio,<solver>,...", one line a step.
std::string to_csv(const PerformanceProfile& profile);

}  // namespace scree
