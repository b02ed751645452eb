#pragma once
// Largest stretch of vectors by W on a backend, in the metric of the contacts' scales.

#include <cmath>

#include "solvers/assembled/backend_problem.h"

namespace scree {

/// Squares of v in the metric of D, and of W v in that of 1 / D.
struct PowerSums {
  static constexpr const char* name = "power_sums";
  Span<const double> scale, v, moved;
  SCREE_HD Sums<2> operator()(Index c) const {
    Sums<2> sums;
    for (int i = 0; i < 3; ++i) {
      const Offset at = 3 * static_cast<Offset>(c) + i;
      sums.value[0] += scale[c] * v[at] * v[at];
      sums.value[1] += moved[at] * moved[at] / scale[c];
    }
    return sums;
  }
};

/// v = W v / D, at the length of v.
struct PowerStep {
  static constexpr const char* name = "power_step";
  const Sums<2>* sums;
  Span<const double> scale, moved;
  Span<double> v;
  SCREE_HD void operator()(Index c) const {
    const double stretch = std::sqrt(sums->value[1] / sums->value[0]);
    for (int i = 0; i < 3; ++i) {
      const Offset at = 3 * static_cast<Offset>(c) + i;
      v[at] = moved[at] / (scale[c] * (stretch > 0 ? stretch : 1));
    }
  }
};

/// |S^-1 W S^-1| with S^2 = D by 20 steps of the power method from a fixed vector, from below; 0
/// when W is zero.
/// @param scale  D [contact_count]
template <class B>
double largest_stretch(const BackendProblem<B>& p, const Buffer<B, double>& scale,
                       AssembledMonitor& monitor) {
  constexpr int steps = 20;
  B& b = p.backend();
  const Index n = p.contact_count();
  const std::vector<double> host_scale = download(b, scale.view(n));
  std::vector<double> start(p.row_count());
  for (std::size_t i = 0; i < start.size(); ++i)
    start[i] = (1 + 0.3 * std::sin(static_cast<double>(i))) / std::sqrt(host_scale[i / 3]);
  Buffer<B, double> v = p.vector(start), moved = p.vector();
  Buffer<B, Sums<2>> sums(b, 1);
  for (int k = 0; k < steps; ++k) {
    if (k > 0) for_each(b, n, PowerStep{sums.data(), scale.view(n), moved.view(), v.view()});
    p.multiply(v, moved);
    monitor.count_applications();
    reduce<Sums<2>>(b, n, PowerSums{scale.view(n), v.view(), moved.view()},
                    StoreResult<Sums<2>>{sums.data()});
  }
  const Sums<2> last = fetch(b, sums.data());
  return last.value[0] > 0 ? std::sqrt(last.value[1] / last.value[0]) : 0;
}

}  // namespace scree
