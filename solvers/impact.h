#pragma once
// The solver of impacts: APGD on cones that are cut off below a least normal impulse, which
// ContactProblem::adhesion holds. Not one that users choose: impacts are small problems, of the
// bodies that bounce and of those that touch them.

#include "kernels/contact/impact_rows.h"
#include "solvers/apgd.h"

namespace scree {

template <class R>
struct RowsOfImpact : std::type_identity<ImpactRows<R>> {};

template <class B, class Real>
std::unique_ptr<Solver<B, Real>> make_impact(const SolverParams& params) {
  return std::make_unique<Apgd<B, Real, RowsOfImpact>>(params);
}

}  // namespace scree
