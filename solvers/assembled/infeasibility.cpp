#include "solvers/assembled/infeasibility.h"

#include <algorithm>
#include <cmath>

namespace scree {

int untouchable_contact(const AssembledProblem& p) {
  for (int c = 0; c < p.contact_count; ++c) {
    if (!(p.q[3 * c] < 0)) continue;
    bool zero = true;
    for (int k = p.row_start[c]; zero && k < p.row_start[c + 1]; ++k)
      zero = std::all_of(p.block[k].begin(), p.block[k].end(),
                         [](double x) { return !(std::abs(x) > 0); });
    if (zero) return c;
  }
  return -1;
}

bool grows_without_bound(const AssembledProblem& p, const std::vector<double>& r) {
  if (r.size() != p.q.size()) return false;
  const std::vector<double> scale = contact_scales(p);
  std::vector<double> resisted;
  multiply(p, r, resisted);
  double along = 0, resistance = 0, loads = 0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    along += p.q[i] * r[i];
    resistance += resisted[i] * resisted[i] / scale[i / 3];
    loads += p.q[i] * p.q[i] / scale[i / 3];
  }
  // |q.d| / |W d| in the metric of the scales, against |q| / D.
  return along < 0 && -along > 1e3 * std::sqrt(resistance * loads);
}

}  // namespace scree
