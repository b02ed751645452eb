#include "solvers/assembled/cpg_pyramid.h"

#include "solvers/assembled/cpg_method.h"
#include "solvers/assembled/friction_pyramid.h"
#include "solvers/assembled/pyramid_projection.h"

namespace scree {
namespace {

class Pyramids final : public CpgLaw {
 public:
  Pyramids(const AssembledProblem& p, AssembledModel model, int sides)
      : p_(p),
        exact_(model == AssembledModel::exact),
        pyramid_(sides),
        lift_(p.contact_count, 0.0) {}
  void project(int c, double* x) const override { project_on_pyramid(pyramid_.sides, p_.mu[c], x); }
  void project_on_tangent(int c, const double* x, double* v) const override {
    project_on_pyramid_tangent(pyramid_.sides, p_.mu[c], x, v);
  }
  double rounding() const override { return 1e-13; }
  double lift(int c) const override { return lift_[c]; }
  void renew(const std::vector<double>& /*r*/, const std::vector<double>& u) override {
    if (!exact_) return;
    for (int c = 0; c < p_.contact_count; ++c) lift_[c] = pyramid_.lift(p_.mu[c], &u[3 * c]);
  }
  std::string name() const override { return std::to_string(pyramid_.sides) + "-sided pyramids"; }

 private:
  const AssembledProblem& p_;
  bool exact_;
  Pyramid pyramid_;
  std::vector<double> lift_;
};

}  // namespace

void run_cpg_pyramid(const AssembledProblem& p, const AssembledOptions& o, int sides,
                     AssembledMonitor& monitor) {
  monitor.keep_last();
  Pyramids pyramids(p, o.model, sides);
  run_cpg(p, o, pyramids, monitor);
}

}  // namespace scree
