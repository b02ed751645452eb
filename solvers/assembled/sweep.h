#pragma once
// One visit of block Gauss-Seidel to a contact, and a pass over all of them on the host.

#include <cmath>
#include <vector>

#include "solvers/assembled/one_contact.h"

namespace scree {

/// Element program over contacts, which must not touch each other when they are visited at once:
/// solves the contact exactly with the others held, and moves by `relaxation` times the change; the
/// result is projected where that is not 1. Bytes: one row of W, 100 a block, and 80.
struct SweepContact {
  static constexpr const char* name = "sweep_contact";
  AssembledModel model;
  double relaxation;
  BlockRows w;
  Span<const double> q, mu;
  Span<double> r;  ///< impulses, in and out [3 contact_count]

  SCREE_HD void operator()(Index c) const {
    const Block3& d = w.diagonal(c);
    double* rc = &r[3 * static_cast<Offset>(c)];
    const double* qc = &q[3 * static_cast<Offset>(c)];
    const std::array<double, 3> full = row_product(w, c, r.data);
    double b[3], x[3] = {rc[0], rc[1], rc[2]};
    for (int i = 0; i < 3; ++i)
      b[i] = qc[i] + full[i] - (d[3 * i] * rc[0] + d[3 * i + 1] * rc[1] + d[3 * i + 2] * rc[2]);
    solve_one_contact(model, d, b, mu[c], x);
    if (std::abs(relaxation - 1) > 0) {
      for (int i = 0; i < 3; ++i) x[i] = rc[i] + relaxation * (x[i] - rc[i]);
      project_on_cone(mu[c], x);
    }
    for (int i = 0; i < 3; ++i) rc[i] = x[i];
  }
};

/// Visits contact after contact on the host; held rows follow behind. One product with W, or W'.
/// @param r  in and out
inline void sweep(const AssembledProblem& p, AssembledModel model, std::vector<double>& r) {
  const auto size = static_cast<Offset>(r.size());
  std::vector<double> q;
  if (p.held) {
    q = p.held->change(r);
    for (std::size_t i = 0; i < q.size(); ++i) q[i] = p.q[i] - q[i];
  }
  const SweepContact visit{model,
                           1,
                           p.rows(),
                           {p.held ? q.data() : p.q.data(), size},
                           {p.mu.data(), static_cast<Offset>(p.mu.size())},
                           {r.data(), size}};
  for (int c = 0; c < p.contact_count; ++c) visit(c);
}

}  // namespace scree
