#pragma once
// Signs that a contact problem has no solution.

#include <string>

#include "solvers/assembled/assembled_measures.h"

namespace scree {

/// A contact that approaches (q_n < 0) and whose rows of W are zero, so that nothing can be done
/// about it; -1 when there is none.
int untouchable_contact(const AssembledProblem& p);
/// What a result says of such a contact.
inline std::string untouchable_note(int contact) {
  return "contact " + std::to_string(contact) + " approaches and no impulse acts on it";
}

/// Whether impulses r of the cones, far from a solution, point along a direction d with
/// W d = 0 and q.d < 0. For a symmetric W no impulses then give velocities in the dual cones,
/// as d.u = d.q < 0 for all of them: the convex problem has no solution. With W d small instead
/// of zero there is none below |q.d| / |W d|, and "small" means: a thousand times what the loads
/// ask of single contacts.
/// @param moved  W r, where it is known
bool grows_without_bound(const AssembledProblem& p, const std::vector<double>& r,
                         const std::vector<double>& moved);
bool grows_without_bound(const AssembledProblem& p, const std::vector<double>& r);

/// Whether a problem is shown to have no solution, by the interior point method: its impulses grow
/// by factors along such a direction where those of others grow by sums, and those of a high tower,
/// which are large, end somewhere.
///
/// That direction decides for the convex model. Velocities of the exact model need not be in the
/// dual cones, only their normal parts must not be negative: without a solution for want of such
/// velocities it is, whatever the friction, where normal impulses d >= 0 have W^T d = 0 and
/// q.d < 0, as then d.u = d.q < 0 for all impulses. Where W is symmetric and not indefinite these d
/// exist when the problem without friction has no solution, and only then; so the method is asked
/// about that one, and W^T d is checked. A problem of the exact model can have velocities and no
/// solution all the same (contacts that jam); nothing here shows that.
/// @param p            with a symmetric W for the convex model
/// @param max_seconds  0: no limit; false when they do not suffice
bool has_no_solution(const AssembledProblem& p, AssembledModel model, double max_seconds);

}  // namespace scree
