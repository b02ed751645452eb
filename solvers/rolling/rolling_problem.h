#pragma once
// Contact problems with rolling friction by matrices: W by compressed rows, q, mu and mu_r, in
// double on the host.
//
// u = W r + q, five rows a contact: velocity along the normal and two tangents [m/s], then the
// rolling rates about the tangents [rad/s]; r holds the impulse [N s] and the rolling moments
// [N m s]. The cone is K = {|r_t| <= mu r_n, |r_m| <= mu_r r_n}, its axis the normal.

#include <vector>

namespace scree {

struct RollingProblem {
  int contact_count = 0;
  std::vector<int> row_start;  ///< [5 contact_count + 1]
  std::vector<int> column;     ///< [entries], ascending within a row
  std::vector<double> value;   ///< [entries] of W
  std::vector<double> q;       ///< u without impulses [5 contact_count]
  std::vector<double> mu;      ///< friction coefficient [contact_count] [-]
  std::vector<double> mu_r;    ///< rolling friction coefficient [contact_count] [m]
};

/// (W x)_row
double row_product(const RollingProblem& p, int row, const std::vector<double>& x);

/// W x. @param x  [5 contact_count]
std::vector<double> multiply(const RollingProblem& p, const std::vector<double>& x);

/// u = W r + q
std::vector<double> contact_velocity(const RollingProblem& p, const std::vector<double>& r);

/// Largest |W - W^T| over largest |W|.
double asymmetry(const RollingProblem& p);

/// The problem with (W + W^T) / 2, for which the convex model is a minimization.
RollingProblem symmetrized(const RollingProblem& p);

/// Mean diagonal of W over the three rows of velocities [1/kg] and over the two of rates
/// [1/(kg m^2)], contact by contact; where one is not positive, the mean of the others of its kind,
/// or 1 [2 contact_count].
std::vector<double> contact_scales(const RollingProblem& p);

/// The problem in x = S r, S the roots of contact_scales for every row: S^-1 W S^-1, S^-1 q, and
/// mu_r in units of its contact. Both laws are the same in these variables, whatever the units.
RollingProblem scaled(const RollingProblem& p, const std::vector<double>& scales);

}  // namespace scree
