#pragma once
// The measures that all solvers of assembled problems are judged by, in one place.

#include <array>
#include <cmath>
#include <vector>

#include "kernels/contact/cone.h"
#include "solvers/assembled/assembled_problem.h"

namespace scree {

/// The law between u = W r + q and r. K = {|r_t| <= mu r_n}.
enum class AssembledModel {
  convex,  ///< K* contains u, perpendicular to r in K: a minimization when W is symmetric
  exact    ///< Coulomb: the same for u + mu |u_t| e_n
};

/// As files and reports say it.
inline const char* name_of(AssembledModel model) {
  return model == AssembledModel::exact ? "exact" : "convex";
}

/// What a contact does, by where r - v / d lies: below the polar cone, within the cone, between.
enum class ContactState : unsigned char { open, stick, slip };

/// How far impulses are from a solution. v is u for the convex model and the De Saxce velocity
/// u + mu |u_t| e_n for the exact one, P the Euclidean projection on the cones;
/// norms are over all contacts, and over bilateral rows where these contradict each other: those that
/// do not are fulfilled by all impulses, as theirs follow.
struct AssembledResidual {
  double absolute = 0;  ///< |r - P(r - v)|, impulses and velocities as they are (rho = 1)
  /// The same over |q|: the error of FCLIB's collection. What tolerances mean by default.
  double relative = 0;
  /// The same over max(|q|, |r|, |u|), as newer versions of Siconos have it.
  double to_largest = 0;
  /// |x - P(x - w)| / |D^-1/2 q| with x = D^1/2 r, w = D^-1/2 v and D = contact_scales: the same in
  /// all units, and for contacts on light and heavy bodies.
  double unit_free = 0;
  double objective = 0;  ///< 1/2 r.W r + q.r [J]
};

/// Which of the residuals a tolerance is on.
enum class AssembledMeasure { relative, absolute, unit_free };

inline double value_of(const AssembledResidual& residual, AssembledMeasure measure) {
  switch (measure) {
    case AssembledMeasure::absolute:
      return residual.absolute;
    case AssembledMeasure::unit_free:
      return residual.unit_free;
    case AssembledMeasure::relative:
      break;
  }
  return residual.relative;
}

/// a / b, and a where b is zero: at rest without loads every number is an error as it stands.
inline double ratio(double a, double b) { return b > 0 ? a / b : a; }

/// Euclidean projection of three numbers on the cone, in place.
SCREE_HD inline void project_on_cone(double mu, double* x) {
  const ContactVec<double> y = project_cone(mu, ContactVec<double>{x[0], x[1], x[2]});
  x[0] = y.n;
  x[1] = y.t1;
  x[2] = y.t2;
}

/// v of three numbers: adds mu |u_t| to the normal one for the exact model.
SCREE_HD inline std::array<double, 3> law_velocity(AssembledModel model, double mu,
                                                   const double* u) {
  const double lift =
      model == AssembledModel::exact ? mu * std::sqrt(u[1] * u[1] + u[2] * u[2]) : 0;
  return {u[0] + lift, u[1], u[2]};
}

/// @param u      W r + q
/// @param scale  contact_scales(p)
/// @param state  when given: the state of every contact
AssembledResidual measure(const AssembledProblem& p, AssembledModel model,
                          const std::vector<double>& scale, const std::vector<double>& r,
                          const std::vector<double>& u, std::vector<ContactState>* state = nullptr);

/// The same with u computed: one product with W.
AssembledResidual measure(const AssembledProblem& p, AssembledModel model,
                          const std::vector<double>& r);

}  // namespace scree
