#pragma once
// Stored contact problems of any form as the solvers of solvers/assembled/ take them.

#include "host/problems/stored_problem.h"
#include "solvers/assembled/assembled_problem.h"
#include "solvers/rolling/rolling_problem.h"

namespace scree {

/// W in 3x3 blocks.
///
/// A 2-D problem gets a second tangent with a diagonal entry, the mean of the contact's other two,
/// and nothing else. Its velocity is that entry times its impulse, so both laws make both zero:
/// solutions, residuals and objective are those of the 2-D problem.
///
/// Bilateral impulses follow from r, l = -R^-1 (V^T r + s), so solvers see W - V R^-1 V^T and
/// q - V R^-1 s. Where R is symmetric they stay rows beside the contacts, AssembledProblem::held, and
/// W is as sparse as it was; they may depend on each other. Where it is not they are eliminated by
/// full matrices.
/// @throws InputError when a symmetric R is not positive semidefinite, when another one is singular
///         or too large for full matrices, and for problems with rolling friction
AssembledProblem assembled_form(const LocalProblem& problem);

/// The same for any form. @throws InputError as the functions of matrix_form.h
AssembledProblem assembled_form(const StoredProblem& problem);

/// Whether matrices have five rows a contact. Problems with bodies do not.
bool has_rolling_rows(const StoredProblem& problem);

/// The same for problems that do; bilateral impulses are eliminated by full matrices. @throws InputError
RollingProblem rolling_form(const LocalProblem& problem);
RollingProblem rolling_form(const StoredProblem& problem);

/// Rows of a problem's own dimension (a stored guess, a velocity) as solvers have them, and back:
/// two become three a contact, others stay.
std::vector<double> to_three_rows(int dimension, const std::vector<double>& rows);
std::vector<double> from_three_rows(int dimension, const std::vector<double>& rows);

}  // namespace scree
