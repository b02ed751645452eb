// Semi-smooth Newton on the Alart-Curnier function (exact model) or the natural map (convex one),
// with backtracking on the merit function 1/2 |D^1/2 F|^2 and a sparse LU decomposition.
//
// Where that fails from the guess it starts once more, after 30 sweeps of nonlinear Gauss-Seidel,
// which tell open contacts from others: from zero there often is no step that leads down. A
// millionth of the contact scales is then added to the Jacobian, which has no inverse where
// redundant contacts stick; any of their impulses will do.
//
// One iteration takes one factorization of a matrix of three rows a contact that touches, from rows
// of W (newton_system.h), and a product with W per trial step; a sweep counts as an iteration, too.
// Quadratic once states no longer change. Ends as "stalled" in a local minimum of the merit
// function: hybrid and proximal get past that. Source: Alart and Curnier, CMAME 92, 1991; Acary,
// Bremond and Huber, INRIA RR-9118, 2018.

#include "solvers/assembled/newton_method.h"
#include "solvers/assembled/sweep.h"

namespace scree {
namespace {

constexpr int sweeps = 30;  ///< before the second attempt

class Newton final : public AssembledSolver {
 public:
  AssembledTraits traits() const override {
    return {
        "newton",
        "semi-smooth Newton (Alart-Curnier), line search, sparse LU; from sweeps where that fails",
        true,
        true,
        200,
        1};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    run_newton(p, o, {}, monitor);
    if (!monitor.next_phase(sweeps, sweeps)) return;
    AssembledOptions from = o;
    for (int k = 0; !monitor.look_if_due(k, from.guess); ++k) {
      sweep(p, o.model, from.guess);
      monitor.count_applications();
    }
    if (!monitor.next_phase()) return;
    NewtonSettings settings;
    settings.shift = 1e-6;
    run_newton(p, from, settings, monitor);
  }
};

}  // namespace

std::unique_ptr<AssembledSolver> make_assembled_newton() { return std::make_unique<Newton>(); }

}  // namespace scree
