#pragma once
// The problem that is solved for a model, whatever the rows of a contact.

#include <cstdio>
#include <string>

#include "solvers/assembled/assembled_measures.h"

namespace scree {

/// Products of rounding apart, W is symmetric where its asymmetry is not above this.
inline constexpr double symmetric_to = 1e-12;

/// A problem as it is; for the convex model with the symmetric part of W, as it is a minimization
/// with a symmetric one only. The problem given must outlive this.
template <class Problem>
class ModelProblem {
 public:
  ModelProblem(const Problem& given, AssembledModel model)
      : given_(given), asymmetry_(model == AssembledModel::convex ? asymmetry(given) : 0) {
    if (is_replaced()) symmetric_ = symmetrized(given);
  }
  ModelProblem(const ModelProblem&) = delete;
  ModelProblem& operator=(const ModelProblem&) = delete;

  const Problem& get() const { return is_replaced() ? symmetric_ : given_; }
  /// For the result: says whether it is another problem; else empty.
  std::string note() const {
    if (!is_replaced()) return {};
    char text[80];
    std::snprintf(text, sizeof text, "W symmetrized (unsymmetric by %.1e)", asymmetry_);
    return text;
  }

 private:
  bool is_replaced() const { return asymmetry_ > symmetric_to; }

  const Problem& given_;
  double asymmetry_;  ///< 0 where it does not matter
  Problem symmetric_;
};

}  // namespace scree
