#pragma once
// Sums and projections of impulse vectors, three numbers a contact.

#include <cmath>
#include <vector>

#include "solvers/assembled/assembled_measures.h"

namespace scree {

inline double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

inline double norm(const std::vector<double>& a) { return std::sqrt(dot(a, a)); }

/// Euclidean projection of all contacts on their cones, in place.
inline void project_on_cones(const AssembledProblem& p, std::vector<double>& x) {
  for (int c = 0; c < p.contact_count; ++c) project_on_cone(p.mu[c], &x[3 * c]);
}

/// The problem in x = S r with S = contact_scales^1/2: S^-1 W S^-1 and S^-1 q. Diagonal blocks have
/// the mean diagonal 1, and as S is one number a contact the cones stay what they are.
struct ScaledProblem {
  AssembledProblem problem;
  std::vector<double> root;  ///< S [contact_count]

  explicit ScaledProblem(const AssembledProblem& p) : problem(p), root(contact_scales(p)) {
    for (double& s : root) s = std::sqrt(s);
    for (int c = 0; c < p.contact_count; ++c) {
      for (int k = 0; k < 3; ++k) problem.q[3 * c + k] /= root[c];
      for (int k = p.row_start[c]; k < p.row_start[c + 1]; ++k)
        for (double& w : problem.block[k]) w /= root[c] * root[p.column[k]];
    }
    if (p.held) problem.held = p.held->scaled(unscaled(std::vector<double>(p.q.size(), 1.0)));
  }
  std::vector<double> scaled(const std::vector<double>& r) const {
    std::vector<double> x(r);
    for (std::size_t k = 0; k < x.size(); ++k) x[k] *= root[k / 3];
    return x;
  }
  std::vector<double> unscaled(const std::vector<double>& x) const {
    std::vector<double> r(x);
    for (std::size_t k = 0; k < r.size(); ++k) r[k] /= root[k / 3];
    return r;
  }
};

}  // namespace scree
