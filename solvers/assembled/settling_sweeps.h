#pragma once
// Sweeps of methods whose friction is not the cone: they end when nothing moves any more, as their
// residual, which is that of the cone, does not say when.

#include <cmath>
#include <string>

#include "solvers/assembled/cone_vectors.h"
#include "solvers/assembled/sweep_order.h"

namespace scree {

/// Reads what visits left: the square of the change of a contact in a sweep, as velocity.
struct SumOfChanges {
  static constexpr const char* name = "sum_of_changes";
  Span<const double> change;
  SCREE_HD Sums<1> operator()(Index c) const { return {{change[c]}}; }
};

/// Sweeps until the monitor stops or a sweep moves less than the tolerance times |q|, which is
/// asked whenever the monitor checks, and then is a stall with a note. A check costs one product.
/// @param r       impulses, which `sweep` changes
/// @param change  [contact_count] which `sweep` fills
/// @param sweep   does one
template <class B, class Sweep>
void run_settling_sweeps(const BackendProblem<B>& p, const Buffer<B, double>& r,
                         const Buffer<B, double>& change, const AssembledOptions& o,
                         const std::string& note, AssembledMonitor& monitor, Sweep sweep) {
  B& b = p.backend();
  const double settled = o.tolerance * norm(p.host().q);
  Buffer<B, double> moved = p.vector();
  Buffer<B, Sums<1>> sum(b, 1);
  monitor.keep_last();
  for (int k = 0;; ++k) {
    if (monitor.due(k)) {
      p.multiply(r, moved);
      monitor.count_applications();
      if (p.check(monitor, k, r, moved)) return;
      if (k > 0) {
        reduce<Sums<1>>(b, p.contact_count(), SumOfChanges{change.view(p.contact_count())},
                        StoreResult<Sums<1>>{sum.data()});
        if (!(std::sqrt(fetch(b, sum.data()).value[0]) > settled))
          return monitor.fail(AssembledStatus::stalled, note);
      }
    }
    sweep();
    monitor.count_applications();
  }
}

}  // namespace scree
