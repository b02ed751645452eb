#pragma once
// The linear systems of Newton's method on contact functions.

#include <memory>
#include <vector>

#include "solvers/assembled/contact_function.h"

namespace scree {

/// Gradient J^T D F of the merit function 1/2 |D^1/2 F|^2, with J as of NewtonSystem.
/// @param at  functions of all contacts [contact_count]
std::vector<double> merit_gradient(const AssembledProblem& p, const std::vector<double>& scale,
                                   double shift, const std::vector<ContactFunction>& at);

/// J = dF/dr + dF/du (W + shift D) at one point, D the scales of contacts.
///
/// A contact whose function does not depend on u (an open one) is no unknown: its step follows from
/// its own block. The others are solved by sparse LU with pivots sought in whole columns where they
/// are few, and by block factors where they are many, whose fronts are dense: there refinement
/// makes up for pivots that are sought in fronts only. Held rows are unknowns too, so that W' is not
/// formed.
class NewtonSystem {
 public:
  /// All must outlive this.
  NewtonSystem(const AssembledProblem& p, const std::vector<double>& scale, double shift);
  ~NewtonSystem();
  NewtonSystem(const NewtonSystem&) = delete;
  NewtonSystem& operator=(const NewtonSystem&) = delete;

  /// @param at  functions of all contacts [contact_count]
  /// @return    whether J is regular to rounding
  bool factorize(const std::vector<ContactFunction>& at);

  /// J^-1 b, of the last J that was factorized. @param b  [3 contact_count]
  /// @param products  counts products with W
  std::vector<double> solve(const std::vector<double>& b, long& products) const;

  /// merit_gradient() where J was factorized last.
  std::vector<double> gradient() const;

 private:
  struct Factors;
  std::unique_ptr<Factors> factors_;
};

}  // namespace scree
