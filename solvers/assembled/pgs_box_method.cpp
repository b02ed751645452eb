#include "solvers/assembled/pgs_box_method.h"

#include <algorithm>

#include "solvers/assembled/cone_vectors.h"

namespace scree {

void run_pgs_box(const AssembledProblem& p, const AssembledOptions& o, BoxBounds bounds,
                 AssembledMonitor& monitor) {
  const double omega = o.relaxation > 0 ? o.relaxation : 1;
  monitor.keep_last();
  const double settled = o.tolerance * norm(p.q);
  std::vector<double> r = o.guess, bound(p.contact_count);
  for (int k = 0; !monitor.look_if_due(k, r); ++k) {
    for (int c = 0; c < p.contact_count; ++c) bound[c] = p.mu[c] * std::max(0.0, r[3 * c]);
    double moved = 0;  // square of the change, as velocity
    for (int c = 0; c < p.contact_count; ++c) {
      const Block3& d = p.diagonal(c);
      std::array<double, 3> u = row_product(p, c, r.data());
      for (int i = 0; i < 3; ++i) u[i] += p.q[3 * c + i];
      for (int i = 0; i < 3; ++i) {
        if (!(d[4 * i] > 0)) continue;
        double& x = r[3 * c + i];
        double next = x - omega * u[i] / d[4 * i];
        next = i == 0 ? std::max(0.0, next) : std::clamp(next, -bound[c], bound[c]);
        const double change = next - x;
        for (int j = 0; j < 3; ++j) u[j] += d[3 * j + i] * change;
        moved += d[4 * i] * change * d[4 * i] * change;
        x = next;
        if (i == 0 && bounds == BoxBounds::coupled) bound[c] = p.mu[c] * next;
      }
    }
    monitor.count_applications();
    if (!(std::sqrt(moved) > settled)) {
      if (!monitor.look(k + 1, r))
        monitor.fail(AssembledStatus::stalled, "solved with box friction, which is not the cone");
      return;
    }
  }
}

}  // namespace scree
