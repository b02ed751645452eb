#pragma once
// Projected Gauss-Seidel over the edges of friction pyramids.

#include <numbers>
#include <string>

#include "solvers/assembled/settling_sweeps.h"

namespace scree {

/// Unit tangent that an edge of a pyramid leans to.
struct PyramidEdge {
  double t1 = 0, t2 = 0;
};

/// Edges at equal angles, the first along the first tangent.
struct Pyramid {
  static constexpr int most_sides = 8;
  int sides;
  PyramidEdge edge[most_sides];

  /// @param count  even, 4 to most_sides
  explicit Pyramid(int count) : sides(count) {
    for (int j = 0; j < sides; ++j) {
      const double angle = 2 * std::numbers::pi * j / sides;
      edge[j] = {std::cos(angle), std::sin(angle)};
    }
  }

  /// Multipliers of an impulse, of the nearest part of the pyramid in the same direction.
  SCREE_HD void split(double mu, const double* r, double* l) const {
    for (int j = 0; j < sides; ++j) l[j] = 0;
    if (!(r[0] > 0)) return;
    double used = 0;
    if (mu > 0) {
      const double t1 = r[1] / mu, t2 = r[2] / mu;
      for (int j = 0; j < sides; ++j) {
        const PyramidEdge a = edge[j], b = edge[(j + 1) % sides];
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

  /// The impulse sum_j l_j (1, mu e_j).
  SCREE_HD void sum_up(double mu, const double* l, double* r) const {
    r[0] = r[1] = r[2] = 0;
    for (int j = 0; j < sides; ++j) {
      r[0] += l[j];
      r[1] += mu * edge[j].t1 * l[j];
      r[2] += mu * edge[j].t2 * l[j];
    }
  }
};

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
    double lift = 0;
    for (int j = 0; model == AssembledModel::exact && j < pyramid.sides; ++j) {
      const double against = -mu[c] * (e[j].t1 * u[1] + e[j].t2 * u[2]);
      if (against > lift) lift = against;
    }
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
/// e_0 the first tangent: a pyramid inside the cone. One row a multiplier. For the convex model the
/// objective over the pyramids is minimized. For the exact one the normal row is lifted by
/// mu max_j(-e_j.u_t), which is to pyramids what De Saxce's term is to cones; it is taken anew at
/// every visit.
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
