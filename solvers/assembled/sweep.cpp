#include "solvers/assembled/sweep.h"

#include <cmath>

#include "solvers/assembled/one_contact.h"

namespace scree {

double sweep(const AssembledProblem& p, AssembledModel model, double relaxation, bool backward,
             std::vector<double>& r) {
  double moved = 0, size = 0;
  for (int k = 0; k < p.contact_count; ++k) {
    const int c = backward ? p.contact_count - 1 - k : k;
    const Block3& d = p.diagonal(c);
    double* rc = &r[3 * c];
    const std::array<double, 3> full = row_product(p, c, r.data());
    double b[3], x[3] = {rc[0], rc[1], rc[2]};
    for (int i = 0; i < 3; ++i)
      b[i] = p.q[3 * c + i] + full[i] -
             (d[3 * i] * rc[0] + d[3 * i + 1] * rc[1] + d[3 * i + 2] * rc[2]);
    solve_one_contact(model, d, b, p.mu[c], x);
    if (std::abs(relaxation - 1) > 0) {
      for (int i = 0; i < 3; ++i) x[i] = rc[i] + relaxation * (x[i] - rc[i]);
      project_on_cone(p.mu[c], x);
    }
    const double scale = d[0] + d[4] + d[8];
    for (int i = 0; i < 3; ++i) {
      moved += scale * (x[i] - rc[i]) * (x[i] - rc[i]);
      size += scale * x[i] * x[i];
      rc[i] = x[i];
    }
  }
  return size > 0 ? std::sqrt(moved / size) : std::sqrt(moved);
}

}  // namespace scree
