#pragma once
// Projected Gauss-Seidel over the edges of friction pyramids.

#include <string>

#include "solvers/assembled/friction_pyramid.h"
#include "solvers/assembled/settling_sweeps.h"

namespace scree {

/// Element program: multipliers of the impulses r, and the impulses that they have.
struct SplitImpulses {
  static constexpr const char* name = "split_impulses";
  Pyramid pyramid;
  Span<const double> mu;
  Span<double> r, l;
  SCREE_HD void operator()(Index c) const {
    double* lc = &l[pyramid.sides * static_cast<Offset>(c)];
    double* rc = &r[3 * static_cast<Offset>(c)];
    pyramid.split(mu[c], rc, lc);
    pyramid.sum_up(mu[c], lc, rc);
  }
};

/// Element program: the multipliers of a contact, one after another.
struct PgsPyramidContact {
  static constexpr const char* name = "pgs_pyramid_contact";
  Pyramid pyramid;
  AssembledModel model;
  double relaxation;
  BlockRows w;
  Span<const double> q, mu;
  Span<double> r, l;    ///< impulses [3 contact_count] and multipliers [sides contact_count]
  Span<double> change;  ///< out: square of the change, as velocity

  SCREE_HD void operator()(Index c) const {
    const Block3& d = w.diagonal(c);
    const PyramidEdge* e = pyramid.edge;
    double* rc = &r[3 * static_cast<Offset>(c)];
    double* lc = &l[pyramid.sides * static_cast<Offset>(c)];
    const double before[3] = {rc[0], rc[1], rc[2]};
    std::array<double, 3> u = row_product(w, c, r.data);
    for (int i = 0; i < 3; ++i) u[i] += q[3 * static_cast<Offset>(c) + i];
    const double lift = model == AssembledModel::exact ? pyramid.lift(mu[c], u.data()) : 0;
    for (int j = 0; j < pyramid.sides; ++j) {
      const double v[3] = {1, mu[c] * e[j].t1, mu[c] * e[j].t2};
      double wv[3], stiffness = 0, slope = lift;
      for (int i = 0; i < 3; ++i) {
        wv[i] = d[3 * i] * v[0] + d[3 * i + 1] * v[1] + d[3 * i + 2] * v[2];
        stiffness += v[i] * wv[i];
        slope += v[i] * u[i];
      }
      if (!(stiffness > 0)) continue;
      const double wanted = lc[j] - relaxation * slope / stiffness;
      const double next = wanted < 0 ? 0 : wanted;
      for (int i = 0; i < 3; ++i) u[i] += wv[i] * (next - lc[j]);
      lc[j] = next;
    }
    pyramid.sum_up(mu[c], lc, rc);
    double moved = 0;
    for (int i = 0; i < 3; ++i) {
      const double by = d[4 * i] * (rc[i] - before[i]);
      moved += by * by;
    }
    change[c] = moved;
  }
};

/// Impulses of a contact are sums l_j (1, mu e_j), l_j >= 0, with e_j unit vectors at equal angles,
/// e_0 the first tangent: a pyramid inside the cone. One row a multiplier.
/// For the convex model the objective over the pyramids is minimized. For the exact one the normal
/// row is lifted by mu max_j(-e_j.u_t), which is to pyramids what De Saxce's term is to cones;
/// it is taken anew at every visit.
///
/// Runs from the guess until sweeps move nothing any more, in units of the tolerance, and says so
/// as a stall with a note: the residual is that of the cone.
/// @param sides  even, 4 or more
/// Source: Stewart and Trinkle, IJNME 39, 1996; Anitescu, Math. Program. 105, 2006 (convex).
template <class B>
void run_pgs_pyramid(const BackendProblem<B>& p, const AssembledOptions& o, int sides,
                     AssembledMonitor& monitor) {
  const Pyramid pyramid(sides);
  const SweepOrder<B> order(p);
  Buffer<B, double> r = p.vector(o.guess), change(p.backend(), p.contact_count()),
                    l(p.backend(), sides * static_cast<Offset>(p.contact_count()));
  for_each(p.backend(), p.contact_count(),
           SplitImpulses{pyramid, p.mu(), r.view(p.row_count()), l.view()});
  const PgsPyramidContact visit{pyramid,
                                o.model,
                                o.relaxation > 0 ? o.relaxation : 1,
                                p.rows(),
                                p.q(),
                                p.mu(),
                                r.view(p.row_count()),
                                l.view(),
                                change.view()};
  run_settling_sweeps(p, r, change, o,
                      "solved with " + std::to_string(sides) + "-sided pyramids, not the cone",
                      monitor, [&] { order.run(visit); });
}

}  // namespace scree
