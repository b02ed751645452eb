#pragma once
// Contact problems given by matrices, with no bodies behind them: what FCLIB files hold.
//
// Rows of a contact are consecutive: normal first, then two tangents (one in 2-D). The normal
// impulse pushes apart when it is positive, the normal velocity separates when it is positive.
// Coulomb's law is K* contains u + mu |u_t| e_n _|_ r in K = {|r_t| <= mu r_n} for every contact.
//
// With rolling friction a contact has two rows more, the rolling rates about the tangents
// [rad/s] and the moments r_m [N m s] in r: K = {|r_t| <= mu r_n, |r_m| <= mu_r r_n}, and mu_r
// |u_m| e_n is added as well.

#include <string>
#include <vector>

#include "host/problems/sparse_matrix.h"

namespace scree {

/// Reduced form: u = W r + V l + q, 0 = V^T r + R l + s. W is the Delassus matrix and may be
/// slightly unsymmetric.
struct LocalProblem {
  int dimension = 3;         ///< rows per contact: 2, 3, or 5 with rolling friction
  SparseMatrix W;            ///< [rows x rows] [1/kg]
  std::vector<double> q;     ///< free contact velocity [rows] [m/s]
  std::vector<double> mu;    ///< friction coefficient [contact_count] [-]
  std::vector<double> mu_r;  ///< of rolling [contact_count] [m]; empty without five rows a contact
  SparseMatrix V;            ///< [rows x p], empty without bilateral constraints
  SparseMatrix R;            ///< [p x p]
  std::vector<double> s;     ///< [p]

  int contact_count() const { return static_cast<int>(mu.size()); }
  friend bool operator==(const LocalProblem&, const LocalProblem&) = default;
};

/// Unreduced form: M v = H r + G l + f, u = H^T v + w, 0 = G^T v + b.
struct GlobalProblem {
  int dimension = 3;         ///< rows per contact: 2, 3, or 5 with rolling friction
  SparseMatrix M;            ///< mass [n x n]
  SparseMatrix H;            ///< transposed contact Jacobian [n x rows]
  std::vector<double> f;     ///< M v* [n] [N s]
  std::vector<double> w;     ///< bias [rows] [m/s]
  std::vector<double> mu;    ///< friction coefficient [contact_count] [-]
  std::vector<double> mu_r;  ///< of rolling [contact_count] [m]; empty without five rows a contact
  SparseMatrix G;            ///< transposed Jacobian of bilateral constraints [n x p], or empty
  std::vector<double> b;     ///< [p]

  int contact_count() const { return static_cast<int>(mu.size()); }
  friend bool operator==(const GlobalProblem&, const GlobalProblem&) = default;
};

/// Values of the unknowns, a guess or a solution. What was not stored is empty.
///
/// In files written by Siconos the impulses of the solution are all zero and mean nothing.
struct ProblemPoint {
  std::vector<double> v;  ///< velocities [n], global problems
  std::vector<double> u;  ///< contact velocities [rows] [m/s]
  std::vector<double> r;  ///< contact impulses [rows] [N s]
  std::vector<double> l;  ///< impulses of bilateral constraints [p]
  friend bool operator==(const ProblemPoint&, const ProblemPoint&) = default;
};

/// Texts that FCLIB files carry, any of them empty. Bytes as stored, not always UTF-8.
struct ProblemInfo {
  std::string title;
  std::string description;
  std::string math_info;
  friend bool operator==(const ProblemInfo&, const ProblemInfo&) = default;
};

/// Checks sizes, signs and that all numbers are finite.
/// @throws InputError naming what is wrong, its value and what was expected
void validate(const LocalProblem& problem);
void validate(const GlobalProblem& problem);

/// Checks that what a point holds has the sizes of the problem and is finite.
/// @param name  of the point in messages
/// @throws InputError
void validate(const ProblemPoint& point, const LocalProblem& problem, const std::string& name);
void validate(const ProblemPoint& point, const GlobalProblem& problem, const std::string& name);

}  // namespace scree
