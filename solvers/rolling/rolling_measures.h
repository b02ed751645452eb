#pragma once
// The measures of solvers of problems with rolling friction: those of assembled_measures.h for five
// rows a contact.

#include <vector>

#include "solvers/assembled/assembled_measures.h"
#include "solvers/rolling/rolling_problem.h"

namespace scree {

/// K = {|t| <= mu n, |m| <= mu_r n} of one contact.
struct RollingCone {
  double mu;    ///< [-]
  double mu_r;  ///< [m]
};

inline RollingCone cone_of(const RollingProblem& p, int contact) {
  return {p.mu[contact], p.mu_r[contact]};
}

/// Euclidean projection of five numbers on the cone, in place.
void project_on_cone(const RollingCone& cone, double* x);

/// What the model adds to the normal velocity: nothing for the convex one, mu |u_t| + mu_r |w| for
/// the exact one. Source: Acary & Bourrier, Multibody Syst. Dyn. 52, 2021.
double lift(AssembledModel model, const RollingCone& cone, const double* u);

/// As for problems of three rows. The scale of the unit-free measure is contact_scales.
/// @param u      W r + q
/// @param scale  contact_scales(p)
/// @param state  when given: the state of every contact; rolling at its bound is slip too
AssembledResidual measure(const RollingProblem& p, AssembledModel model,
                          const std::vector<double>& scale, const std::vector<double>& r,
                          const std::vector<double>& u, std::vector<ContactState>* state = nullptr);

}  // namespace scree
