// Conjugate projected gradient on box friction: |r_t1|, |r_t2| <= mu r_n, the law of pgs_box. With
// bounds that stand still it is a quadratic program over intervals, where the method is at home;
// bounds are taken from the normal impulses whenever the error of that program has fallen to a
// tenth.
//
// Costs as in cpg.cpp; an iteration is one of the inner program. Bounds follow impulses, so nothing
// is minimized as a whole and nothing proven; where friction carries much, bounds may never settle.
// Source: Renouf and Alart, Comput. Methods Appl. Mech. Engrg. 194, 2005 (diagonalized, i.e.
// with bounds by fixed point).

#include <algorithm>

#include "solvers/assembled/cpg_method.h"

namespace scree {
namespace {

class Boxes final : public CpgLaw {
 public:
  explicit Boxes(const AssembledProblem& p) : p_(p), bound_(p.contact_count) {}
  void project(int c, double* x) const override {
    x[0] = std::max(0.0, x[0]);
    for (int i = 1; i < 3; ++i) x[i] = std::clamp(x[i], -bound_[c], bound_[c]);
  }
  void project_on_tangent(int c, const double* x, double* v) const override {
    if (!(x[0] > 0)) v[0] = std::max(0.0, v[0]);
    for (int i = 1; i < 3; ++i) {
      if (!(x[i] > -bound_[c])) v[i] = std::max(0.0, v[i]);
      if (!(x[i] < bound_[c])) v[i] = std::min(0.0, v[i]);
    }
  }
  void renew(const std::vector<double>& r, const std::vector<double>& /*u*/) override {
    for (int c = 0; c < p_.contact_count; ++c) bound_[c] = p_.mu[c] * std::max(0.0, r[3 * c]);
  }
  std::string name() const override { return "box friction"; }

 private:
  const AssembledProblem& p_;
  std::vector<double> bound_;
};

class CpgBox final : public AssembledSolver {
 public:
  AssembledTraits traits() const override {
    return {"cpg_box", "conjugate projected gradient on box friction, bounds by fixed point",
            true,      false,
            50000,     10,
            "box"};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    monitor.keep_last();
    Boxes boxes(p);
    run_cpg(p, o, boxes, monitor);
  }
};

}  // namespace

std::unique_ptr<AssembledSolver> make_assembled_cpg_box() { return std::make_unique<CpgBox>(); }

}  // namespace scree
