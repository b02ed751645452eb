#include "solvers/assembled/pgs_pyramid_method.h"

#include <algorithm>

#include "solvers/assembled/cone_vectors.h"
#include "solvers/assembled/friction_pyramid.h"

namespace scree {
namespace {

/// Multipliers of an impulse, of the nearest part of the pyramid in the same direction.
void split(const std::vector<PyramidEdge>& e, double mu, const double* r, double* l) {
  const int sides = static_cast<int>(e.size());
  std::fill(l, l + sides, 0.0);
  if (!(r[0] > 0)) return;
  double used = 0;
  if (mu > 0) {
    const double t1 = r[1] / mu, t2 = r[2] / mu;
    for (int j = 0; j < sides; ++j) {
      const PyramidEdge &a = e[j], &b = e[(j + 1) % sides];
      const double det = a.t1 * b.t2 - a.t2 * b.t1;
      const double la = (t1 * b.t2 - t2 * b.t1) / det, lb = (a.t1 * t2 - a.t2 * t1) / det;
      if (la < 0 || lb < 0) continue;
      const double shrink = la + lb > r[0] ? r[0] / (la + lb) : 1;
      l[j] += shrink * la;
      l[(j + 1) % sides] += shrink * lb;
      used = shrink * (la + lb);
      break;
    }
  }
  for (int j = 0; j < sides; ++j) l[j] += (r[0] - used) / sides;  // opposite ones cancel
}

}  // namespace

void run_pgs_pyramid(const AssembledProblem& p, const AssembledOptions& o, int sides,
                     AssembledMonitor& monitor) {
  const std::vector<PyramidEdge> e = pyramid_edges(sides);
  const double omega = o.relaxation > 0 ? o.relaxation : 1;
  monitor.keep_last();
  const double settled = o.tolerance * norm(p.q);
  std::vector<double> r(o.guess.size()), l(static_cast<std::size_t>(sides) * p.contact_count);
  const auto sum_up = [&](int c) {
    double* rc = &r[3 * c];
    rc[0] = rc[1] = rc[2] = 0;
    for (int j = 0; j < sides; ++j) {
      const double x = l[sides * c + j];
      rc[0] += x;
      rc[1] += p.mu[c] * e[j].t1 * x;
      rc[2] += p.mu[c] * e[j].t2 * x;
    }
  };
  for (int c = 0; c < p.contact_count; ++c) {
    split(e, p.mu[c], &o.guess[3 * c], &l[sides * c]);
    sum_up(c);
  }
  for (int k = 0; !monitor.look_if_due(k, r); ++k) {
    double moved = 0;  // square of the change, as velocity
    for (int c = 0; c < p.contact_count; ++c) {
      const Block3& d = p.diagonal(c);
      const double mu = p.mu[c];
      const double before[3] = {r[3 * c], r[3 * c + 1], r[3 * c + 2]};
      std::array<double, 3> u = row_product(p, c, r.data());
      for (int i = 0; i < 3; ++i) u[i] += p.q[3 * c + i];
      const double lift = o.model == AssembledModel::exact ? pyramid_lift(e, mu, u.data()) : 0;
      for (int j = 0; j < sides; ++j) {
        const double v[3] = {1, mu * e[j].t1, mu * e[j].t2};
        double wv[3], stiffness = 0, slope = lift;
        for (int i = 0; i < 3; ++i) {
          wv[i] = d[3 * i] * v[0] + d[3 * i + 1] * v[1] + d[3 * i + 2] * v[2];
          stiffness += v[i] * wv[i];
          slope += v[i] * u[i];
        }
        if (!(stiffness > 0)) continue;
        double& x = l[sides * c + j];
        const double next = std::max(0.0, x - omega * slope / stiffness);
        for (int i = 0; i < 3; ++i) u[i] += wv[i] * (next - x);
        x = next;
      }
      sum_up(c);
      for (int i = 0; i < 3; ++i) {
        const double change = d[4 * i] * (r[3 * c + i] - before[i]);
        moved += change * change;
      }
    }
    monitor.count_applications();
    if (!(std::sqrt(moved) > settled)) {
      if (!monitor.look(k + 1, r))
        monitor.fail(AssembledStatus::stalled,
                     "solved with " + std::to_string(sides) + "-sided pyramids, not the cone");
      return;
    }
  }
}

}  // namespace scree
