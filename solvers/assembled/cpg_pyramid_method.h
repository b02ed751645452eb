#pragma once
// Conjugate projected gradient on friction pyramids.

#include <string>

#include "solvers/assembled/cpg_method.h"
#include "solvers/assembled/friction_pyramid.h"
#include "solvers/assembled/pyramid_projection.h"

namespace scree {

/// Law of cpg_method.h. For the exact model normal rows are lifted by Pyramid::lift.
struct PyramidLaw {
  static constexpr double rounding = 1e-13;
  Pyramid pyramid;
  bool exact;
  Span<const double> mu;
  Span<double> lifts;  ///< [contact_count] of the last renewal [m/s]
  SCREE_HD void project(Index c, double* r) const { project_on_pyramid(pyramid.sides, mu[c], r); }
  SCREE_HD void project_on_tangent(Index c, const double* r, double* v) const {
    project_on_pyramid_tangent(pyramid.sides, mu[c], r, v);
  }
  SCREE_HD double lift(Index c) const { return lifts[c]; }
  SCREE_HD void renew(Index c, const double* /*r*/, const double* u) const {
    if (exact) lifts[c] = pyramid.lift(mu[c], u);
  }
};

/// The law of pgs_pyramid_method.h, over impulses in place of multipliers: these are not unique
/// inside of a pyramid, and block directions that impulses may take. For the convex model that is
/// one quadratic program. For the exact one the lift of the normal row stands still and is taken
/// anew whenever the error of the program has fallen to a tenth.
/// @param sides  even, 4 or more
template <class B>
void run_cpg_pyramid(const BackendProblem<B>& p, const AssembledOptions& o, int sides,
                     AssembledMonitor& monitor) {
  monitor.keep_last();
  Buffer<B, double> lifts(p.backend(), p.contact_count());
  fill(p.backend(), lifts.view(), 0.0);
  const PyramidLaw law{Pyramid(sides), o.model == AssembledModel::exact, p.mu(), lifts.view()};
  run_cpg(p, o, law, std::to_string(sides) + "-sided pyramids", monitor);
}

}  // namespace scree
