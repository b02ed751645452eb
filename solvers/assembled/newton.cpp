// Semi-smooth Newton on the Alart-Curnier function (exact model) or the natural map (convex one),
// with backtracking on the merit function 1/2 |D^1/2 F|^2 and a sparse LU decomposition.
//
// One iteration takes one factorization of a matrix of three rows a contact that touches, from rows
// of W (newton_system.h), and a product with W per trial step. Quadratic once states no longer
// change. Ends as "singular" where redundant contacts stick, as W then has no inverse on them, and
// as "stalled" in a local minimum of the merit function: hybrid and proximal get past both. Source:
// Alart and Curnier, CMAME 92, 1991; Acary, Bremond and Huber, INRIA RR-9118, 2018.

#include "solvers/assembled/newton_method.h"

namespace scree {
namespace {

class Newton final : public AssembledSolver {
 public:
  AssembledTraits traits() const override {
    return {"newton", "semi-smooth Newton (Alart-Curnier), line search, sparse LU", true, true, 200,
            1};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    run_newton(p, o, {}, monitor);
  }
};

}  // namespace

std::unique_ptr<AssembledSolver> make_assembled_newton() { return std::make_unique<Newton>(); }

}  // namespace scree
