#pragma once
// Projected Gauss-Seidel, row by row, with friction bounded by a box.

#include <string>

#include "solvers/assembled/settling_sweeps.h"

namespace scree {

/// Where the normal impulse in the bound |r_t1|, |r_t2| <= mu r_n comes from.
enum class BoxBounds {
  coupled,  ///< of the moment: the normal row of the same contact has just been solved
  lagged    ///< of the sweep before, so that a sweep has fixed bounds
};

/// Element program: the three rows of a contact, one after another by their own diagonal entries.
struct PgsBoxContact {
  static constexpr const char* name = "pgs_box_contact";
  BoxBounds bounds;
  double relaxation;
  BlockRows w;
  Span<const double> q, mu;
  Span<double> r;       ///< in and out; a contact's bound is that of its own r_n
  Span<double> change;  ///< out: square of the change, as velocity

  SCREE_HD void operator()(Index c) const {
    const Block3& d = w.diagonal(c);
    double* rc = &r[3 * static_cast<Offset>(c)];
    double bound = mu[c] * (rc[0] > 0 ? rc[0] : 0);
    std::array<double, 3> u = row_product(w, c, r.data);
    for (int i = 0; i < 3; ++i) u[i] += q[3 * static_cast<Offset>(c) + i];
    double moved = 0;
    for (int i = 0; i < 3; ++i) {
      if (!(d[4 * i] > 0)) continue;
      const double wanted = rc[i] - relaxation * u[i] / d[4 * i];
      const double least = i == 0 ? 0 : -bound;
      double next = wanted < least ? least : wanted;
      if (i > 0 && next > bound) next = bound;
      const double by = next - rc[i];
      for (int j = 0; j < 3; ++j) u[j] += d[3 * j + i] * by;
      moved += d[4 * i] * by * d[4 * i] * by;
      rc[i] = next;
      if (i == 0 && bounds == BoxBounds::coupled) bound = mu[c] * next;
    }
    change[c] = moved;
  }
};

/// Runs from the guess until sweeps move nothing any more, in units of the tolerance, and says so
/// as a stall with a note: the residual is that of another law.
template <class B>
void run_pgs_box(const BackendProblem<B>& p, const AssembledOptions& o, BoxBounds bounds,
                 AssembledMonitor& monitor) {
  const SweepOrder<B> order(p);
  Buffer<B, double> r = p.vector(o.guess), change(p.backend(), p.contact_count());
  const PgsBoxContact visit{bounds,       o.relaxation > 0 ? o.relaxation : 1,
                            p.rows(),     p.q(),
                            p.mu(),       r.view(p.row_count()),
                            change.view()};
  run_settling_sweeps(p, r, change, o, "solved with box friction, which is not the cone", monitor,
                      [&] { order.run(visit); });
}

}  // namespace scree
