#pragma once
// Block Gauss-Seidel with exact one-contact solves on a backend, for gauss_seidel, nlgs and sor.

#include <utility>

#include "solvers/assembled/sweep.h"
#include "solvers/assembled/sweep_order.h"

namespace scree {

/// Sweeps from the guess until the monitor stops. A check costs one product with W. Held rows keep
/// their impulses in a sweep and follow behind it, all at once: block Gauss-Seidel, with them as one
/// block.
template <class B>
void run_sweeps(const BackendProblem<B>& p, AssembledModel model, double relaxation,
                const std::vector<double>& guess, AssembledMonitor& monitor) {
  const SweepOrder<B> order(p);
  Buffer<B, double> r = p.vector(guess), moved = p.vector();
  Buffer<B, double> q = p.vector(p.host().q);
  const SweepContact visit{model,    relaxation,
                           p.rows(), std::as_const(q).view(p.row_count()),
                           p.mu(),   r.view(p.row_count())};
  for (int k = 0;; ++k) {
    if (monitor.due(k)) {
      p.multiply(r, moved);
      monitor.count_applications();
      if (p.check(monitor, k, r, moved)) return;
    }
    p.hold_rows(r, q);
    order.run(visit);
    monitor.count_applications();
  }
}

}  // namespace scree
