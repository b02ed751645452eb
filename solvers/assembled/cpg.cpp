// Conjugate projected gradient: directions of conjugate gradients, bent into the tangent cone of
// the constraints at the present impulses.
//
// In x = S r (ScaledProblem), with g = W x + q and T the tangent cone of K at x:
//   w = P_T(-g),  p+ = w + b P_T(p),  b = -w.W p / p.W p
//   trial = P_K(x + a p+),  a = -g.p+ / p+.W p+
// Corrected line search: where the projection changed the trial, the objective is minimized between
// x and the trial. That alone zigzags between constraints for ever, so a projected gradient step of
// 1 / |W| follows, and directions start anew. An iteration costs one product with W, three where
// the trial was changed. The best iterate that was looked at is kept. Source: Renouf and Alart,
// Comput. Methods Appl. Mech. Engrg. 194, 2005, here for the cones of the convex model; gradient
// steps after changed ones as in Dostal and Schoeberl, Comput. Optim. Appl. 30, 2005.

#include <algorithm>

#include "solvers/assembled/assembled_solver.h"
#include "solvers/assembled/cone_vectors.h"

namespace scree {
namespace {

/// How close to the surface, relative to mu n, is on it.
constexpr double on_surface = 1e-10;
constexpr int power_steps = 20;

/// Projects v on the tangent cone of the friction cone at x.
void project_on_tangent_cone(double mu, const double* x, double* v) {
  const double t = std::hypot(x[1], x[2]);
  if (!(x[0] > 0)) return project_on_cone(mu, v);  // the apex
  if (mu > 0 && t < mu * x[0] * (1 - on_surface)) return;
  if (!(t > 0)) {  // without friction the cone is a ray
    v[1] = v[2] = 0;
    return;
  }
  const double e[2] = {x[1] / t, x[2] / t};
  const double outward = e[0] * v[1] + e[1] * v[2] - mu * v[0];
  if (outward <= 0) return;
  const double back = outward / (1 + mu * mu);
  v[0] += mu * back;
  v[1] -= e[0] * back;
  v[2] -= e[1] * back;
}

/// One solve.
class ConjugateProjectedGradient {
 public:
  ConjugateProjectedGradient(const AssembledProblem& p, const AssembledOptions& o,
                             AssembledMonitor& monitor)
      : scaled_(p), p_(scaled_.problem), monitor_(monitor), x_(scaled_.scaled(o.guess)) {
    project_on_cones(p_, x_);
    stiffness_ = largest_stretch();
  }

  void run() {
    std::vector<double> direction(x_.size()), moved, w;  // moved: W direction
    for (int k = 0;; ++k) {
      if (k == 0 || monitor_.due(k)) {
        if (monitor_.look(k, scaled_.unscaled(x_))) return;
        g_ = scaled_.gradient(monitor_.last_velocity());  // else carried along
      }
      w = g_;
      for (double& v : w) v = -v;
      project_on_tangent(w);
      const double last = k == 0 ? 0 : dot(direction, moved);
      const double bend = last > 0 ? -dot(w, moved) / last : 0;
      project_on_tangent(direction);
      for (std::size_t i = 0; i < w.size(); ++i) direction[i] = w[i] + bend * direction[i];
      apply(direction, moved);
      if (!advance(direction, moved)) {
        gradient_step();
        std::fill(direction.begin(), direction.end(), 0.0);
        std::fill(moved.begin(), moved.end(), 0.0);
      }
    }
  }

 private:
  void apply(const std::vector<double>& x, std::vector<double>& product) {
    multiply(p_, x, product);
    monitor_.count_applications();
  }

  void project_on_tangent(std::vector<double>& v) const {
    for (int c = 0; c < p_.contact_count; ++c)
      project_on_tangent_cone(p_.mu[c], &x_[3 * c], &v[3 * c]);
  }

  /// Steps to the least objective along a direction.
  /// @return whether constraints left the step as it was
  bool advance(const std::vector<double>& direction, const std::vector<double>& moved) {
    const double slope = dot(g_, direction), curvature = dot(direction, moved);
    if (!(slope < 0 && curvature > 0)) return false;
    const double length = -slope / curvature;
    std::vector<double> step(x_.size());
    for (std::size_t i = 0; i < step.size(); ++i) step[i] = length * direction[i];
    if (to_cones(step)) {
      corrected_step(step);
      return false;
    }
    for (std::size_t i = 0; i < step.size(); ++i) {
      x_[i] += step[i];
      g_[i] += length * moved[i];
    }
    return true;
  }

  /// step = P_K(x + step) - x. @return whether that changed it
  bool to_cones(std::vector<double>& step) const {
    bool changed = false;
    for (int c = 0; c < p_.contact_count; ++c) {
      double y[3], before[3];
      for (int k = 0; k < 3; ++k) before[k] = y[k] = x_[3 * c + k] + step[3 * c + k];
      project_on_cone(p_.mu[c], y);
      if (std::equal(y, y + 3, before)) continue;
      changed = true;
      for (int k = 0; k < 3; ++k) step[3 * c + k] = y[k] - x_[3 * c + k];
    }
    return changed;
  }

  /// Goes to the least objective between x and x + step, both in the cones.
  void corrected_step(const std::vector<double>& step) {
    const double slope = dot(g_, step);
    if (!(slope < 0)) return;
    std::vector<double> moved;
    apply(step, moved);
    const double curvature = dot(step, moved);
    const double length = curvature > 0 ? std::min(1.0, -slope / curvature) : 1;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      x_[i] += length * step[i];
      g_[i] += length * moved[i];
    }
  }

  /// x = P_K(x - g / |W|), which descends.
  void gradient_step() {
    std::vector<double> step = g_, moved;
    for (double& v : step) v *= -1 / stiffness_;
    to_cones(step);
    apply(step, moved);
    for (std::size_t i = 0; i < x_.size(); ++i) {
      x_[i] += step[i];
      g_[i] += moved[i];
    }
  }

  /// |W| by the power method, a little too large.
  double largest_stretch() {
    std::vector<double> v(x_.size()), moved;
    for (std::size_t i = 0; i < v.size(); ++i) v[i] = 1 + 0.3 * std::sin(static_cast<double>(i));
    double stretch = 0;
    for (int k = 0; k < power_steps; ++k) {
      const double size = norm(v);
      apply(v, moved);
      stretch = size > 0 ? norm(moved) / size : 0;
      for (std::size_t i = 0; i < v.size(); ++i) v[i] = moved[i] / (stretch > 0 ? stretch : 1);
    }
    return stretch > 0 ? 1.1 * stretch : 1;
  }

  const ScaledProblem scaled_;
  const AssembledProblem& p_;
  AssembledMonitor& monitor_;
  std::vector<double> x_, g_;
  double stiffness_ = 1;
};

class Cpg final : public AssembledSolver {
 public:
  AssembledTraits traits() const override {
    return {"cpg", "conjugate projected gradient (tangent cones, corrected line search)",
            false, true,
            50000, 10};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    ConjugateProjectedGradient(p, o, monitor).run();
  }
};

}  // namespace

std::unique_ptr<AssembledSolver> make_assembled_cpg() { return std::make_unique<Cpg>(); }

}  // namespace scree
