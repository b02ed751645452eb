// Semi-smooth Newton on the min-max form of box friction with coupled bounds, |r_t1|, |r_t2| <= mu
// r_n, the law of pgs_box, with backtracking on the merit function 1/2 |D^1/2 F|^2 and a sparse LU
// decomposition:
//
//   F_n = min(r_n, rho_n u_n),   F_t = max(r_t - mu r_n, min(r_t + mu r_n, rho_t u_t))
//
// row by row, with rho the inverse diagonal entry; bounds of a negative r_n are zero. Row by row F
// is the middle one of three terms, so a row of the Jacobian is one of W or has one or two entries:
// once the right terms are picked the step is exact. Costs as in newton.cpp. It ends as "singular"
// where redundant contacts stick, and as "stalled" where picks do not settle, with a note that
// tells a Newton step that does not lead down from a trap, where the gradient does not either.
// Source: Ortiz-Rosado, PhD thesis, University of Iowa, 2007, as described by Preclik, Iglberger
// and Ruede, Iterative rigid multibody dynamics, 2009.

#include <algorithm>

#include "solvers/assembled/newton_method.h"

namespace scree {
namespace {

/// @param rho  [3] impulse per velocity [kg]
ContactFunction min_max(double mu, const double* rho, const double* r, const double* u) {
  ContactFunction f{};
  if (r[0] <= rho[0] * u[0]) {
    f.value[0] = r[0];
    f.by_r[0] = 1;
  } else {
    f.value[0] = rho[0] * u[0];
    f.by_u[0] = rho[0];
  }
  const double bound = mu * std::max(0.0, r[0]), slope = r[0] > 0 ? mu : 0;
  for (int i = 1; i < 3; ++i) {
    const double above = r[i] - bound, below = r[i] + bound, still = rho[i] * u[i];
    f.value[i] = std::max(above, std::min(below, still));
    if (still > above && still < below) {
      f.by_u[4 * i] = rho[i];
    } else {
      f.by_r[4 * i] = 1;
      f.by_r[3 * i] = still <= above ? -slope : slope;
    }
  }
  return f;
}

class NewtonMinMax final : public AssembledSolver {
 public:
  AssembledTraits traits() const override {
    return {"newton_minmax",
            "semi-smooth Newton on the min-max form of box friction, sparse LU",
            true,
            false,
            200,
            1,
            "box"};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    monitor.keep_last();
    const std::vector<double> scale = contact_scales(p);
    std::vector<double> rho(p.q.size());
    for (std::size_t k = 0; k < rho.size(); ++k) {
      const std::size_t c = k / 3;
      rho[k] = 1 / std::max(p.diagonal(static_cast<int>(c))[4 * (k % 3)], 1e-6 * scale[c]);
    }
    NewtonSettings settings;
    settings.law = {"box friction", [&](int c, const double* r, const double* u) {
                      return min_max(p.mu[c], &rho[3 * c], r, u);
                    }};
    run_newton(p, o, settings, monitor);
  }
};

}  // namespace

std::unique_ptr<AssembledSolver> make_assembled_newton_minmax() {
  return std::make_unique<NewtonMinMax>();
}

}  // namespace scree
