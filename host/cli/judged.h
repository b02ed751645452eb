#pragma once
// A step as progress lines, totals and benchmarks tell it. Internal to host/cli.

#include "host/scene.h"
#include "host/world.h"

namespace scree {

/// The report with the residual of the model that is solved: of an exact step the exact one.
inline StepReport judged(StepReport report, const SolverSettings& solver) {
  if (!solver.exact_coulomb) return report;
  if (report.residual_rms > 0)
    report.residual_relative *= report.exact_residual_rms / report.residual_rms;
  report.residual_rms = report.exact_residual_rms;
  return report;
}

}  // namespace scree
