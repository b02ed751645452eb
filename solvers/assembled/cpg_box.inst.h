// Conjugate projected gradient on box friction: |r_t1|, |r_t2| <= mu r_n, the law of pgs_box.
// With bounds that stand still it is a quadratic program over intervals, where the method
// is at home; bounds are taken from the normal impulses whenever the error of that program
// has fallen to a tenth.
//
// Costs and memory passes as in cpg.inst.h; an iteration is one of the inner program. Bounds follow
// impulses, so nothing is minimized as a whole and nothing proven; where friction carries much,
// bounds may never settle. Source: Renouf and Alart, Comput. Methods Appl. Mech. Engrg. 194, 2005
// (diagonalized, i.e. with bounds by fixed point).

#include "solvers/assembled/backend_solver.h"
#include "solvers/assembled/cpg_method.h"

namespace scree {
namespace {

struct BoxLaw {
  static constexpr double rounding = 0;
  Span<const double> mu;
  Span<double> bound;  ///< [contact_count] mu r_n of the last renewal
  SCREE_HD void project(Index c, double* r) const {
    if (r[0] < 0) r[0] = 0;
    for (int i = 1; i < 3; ++i) {
      if (r[i] < -bound[c]) r[i] = -bound[c];
      if (r[i] > bound[c]) r[i] = bound[c];
    }
  }
  SCREE_HD void project_on_tangent(Index c, const double* r, double* v) const {
    if (!(r[0] > 0) && v[0] < 0) v[0] = 0;
    for (int i = 1; i < 3; ++i) {
      if (!(r[i] > -bound[c]) && v[i] < 0) v[i] = 0;
      if (!(r[i] < bound[c]) && v[i] > 0) v[i] = 0;
    }
  }
  SCREE_HD double lift(Index /*c*/) const { return 0; }
  SCREE_HD void renew(Index c, const double* r, const double* /*u*/) const {
    bound[c] = r[0] > 0 ? mu[c] * r[0] : 0;
  }
};

class CpgBox final : public BackendSolver<BuildBackend> {
 public:
  using BackendSolver::BackendSolver;

  AssembledTraits traits() const override {
    return {"cpg_box", "conjugate projected gradient on box friction, bounds by fixed point",
            true,      false,
            50000,     10,
            "box"};
  }

  void run(const AssembledProblem& problem, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    monitor.keep_last();
    const auto p = upload_problem(problem);
    Buffer<BuildBackend, double> bound(backend(), p.contact_count());
    run_cpg(p, o, BoxLaw{p.mu(), bound.view()}, "box friction", monitor);
  }
};

}  // namespace

template <>
std::unique_ptr<AssembledSolver> make_assembled_cpg_box<BuildBackend>(
    std::shared_ptr<BuildBackend> backend) {
  return std::make_unique<CpgBox>(std::move(backend));
}

}  // namespace scree
