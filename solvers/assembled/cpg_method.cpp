#include "solvers/assembled/cpg_method.h"

#include <algorithm>
#include <cmath>

#include "solvers/assembled/cone_vectors.h"

namespace scree {
namespace {

constexpr int power_steps = 20;
/// Error of a minimization, over that with which it began, at which bounds and lifts are renewed.
constexpr double inner_share = 0.1;

void add(std::vector<double>& to, double factor, const std::vector<double>& v) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += factor * v[i];
}

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> d = a;
  add(d, -1, b);
  return d;
}

/// One solve. Points are x in C, with velocities u = W x + q carried along.
class ConjugateProjectedGradient {
 public:
  ConjugateProjectedGradient(const AssembledProblem& p, const AssembledOptions& o, CpgLaw& law,
                             AssembledMonitor& monitor)
      : scaled_(p),
        p_(scaled_.problem),
        law_(law),
        monitor_(monitor),
        x_(scaled_.scaled(o.guess)),
        settled_(o.tolerance * norm(p_.q)) {
    set_velocity();
    law_.renew(x_, u_);
    project(x_);
    set_velocity();
    stiffness_ = largest_stretch();
  }

  void run() {
    const bool other_law = !law_.name().empty();
    double target = inner_share * error();
    for (int k = 0;; ++k) {
      if ((k == 0 || monitor_.due(k)) && look(k)) return;
      if (other_law && error() <= std::max(target, settled_)) {
        const double renewed = renewed_error();
        if (renewed <= settled_) {
          if (!look(k))
            monitor_.fail(AssembledStatus::stalled,
                          "solved with " + law_.name() + ", not the cone");
          return;
        }
        target = inner_share * renewed;
      }
      step();
    }
  }

 private:
  void apply(const std::vector<double>& x, std::vector<double>& product) {
    multiply(p_, x, product);
    monitor_.count_applications();
  }

  void project(std::vector<double>& x) const {
    for (int c = 0; c < p_.contact_count; ++c) law_.project(c, &x[3 * c]);
  }
  void project_on_tangent(std::vector<double>& v) const {
    for (int c = 0; c < p_.contact_count; ++c) law_.project_on_tangent(c, &x_[3 * c], &v[3 * c]);
  }

  bool look(int k) {
    if (monitor_.look(k, scaled_.unscaled(x_))) return true;
    u_ = scaled_.gradient(monitor_.last_velocity());  // rounding of what was carried along goes
    set_slopes();
    return false;
  }

  void set_velocity() {
    apply(x_, u_);
    add(u_, 1, p_.q);
    set_slopes();
  }
  void set_slopes() {
    g_ = u_;
    for (int c = 0; c < p_.contact_count; ++c) g_[3 * c] += law_.lift(c);
  }

  /// |x - P(x - g)|
  double error() const {
    std::vector<double> y = difference(x_, g_);
    project(y);
    return norm(difference(x_, y));
  }

  /// Renews the law. @return the error with it
  double renewed_error() {
    law_.renew(x_, u_);
    const std::vector<double> before = x_;
    project(x_);
    if (x_ != before) {
      set_velocity();
    } else {
      set_slopes();
    }
    moved_.clear();
    return error();
  }

  void step() {
    std::vector<double> w = g_;
    for (double& v : w) v = -v;
    project_on_tangent(w);
    if (moved_.empty()) {
      direction_ = w;
    } else {
      const double last = dot(direction_, moved_);
      const double bend = last > 0 ? -dot(w, moved_) / last : 0;
      project_on_tangent(direction_);
      for (std::size_t i = 0; i < w.size(); ++i) direction_[i] = w[i] + bend * direction_[i];
    }
    apply(direction_, moved_);
    if (!advance()) {
      gradient_step();
      moved_.clear();
    }
  }

  /// Goes by `length` along a direction whose product is known, to `end` to the bit: tangent cones
  /// look at which bounds a point is on.
  void go(const std::vector<double>& end, double length, const std::vector<double>& moved) {
    x_ = end;
    add(u_, length, moved);
    set_slopes();
  }

  /// Steps to the least objective along the direction.
  /// @return whether constraints left the step as it was
  bool advance() {
    const double slope = dot(g_, direction_), curvature = dot(direction_, moved_);
    if (!(slope < 0 && curvature > 0)) return false;
    const double length = -slope / curvature;
    std::vector<double> trial = x_;
    add(trial, length, direction_);
    std::vector<double> inside = trial;
    project(inside);
    if (is_changed(trial, inside)) {
      corrected_step(inside);
      return false;
    }
    go(inside, length, moved_);
    return true;
  }

  /// Whether a projection changed a contact by more than rounding.
  bool is_changed(const std::vector<double>& before, const std::vector<double>& after) const {
    for (int c = 0; c < p_.contact_count; ++c) {
      double change = 0, size = 0;
      for (int k = 3 * c; k < 3 * c + 3; ++k) {
        change = std::max(change, std::abs(after[k] - before[k]));
        size = std::max(size, std::abs(before[k]));
      }
      if (change > law_.rounding() * size) return true;
    }
    return false;
  }

  /// Goes to the least objective between x and another point of the set.
  void corrected_step(const std::vector<double>& point) {
    const std::vector<double> step = difference(point, x_);
    const double slope = dot(g_, step);
    if (!(slope < 0)) return;
    apply(step, moved_);
    const double curvature = dot(step, moved_);
    if (!(-slope < curvature)) return go(point, 1, moved_);
    std::vector<double> end = x_;
    add(end, -slope / curvature, step);
    go(end, -slope / curvature, moved_);
  }

  /// x = P(x - g / |W|), which descends.
  void gradient_step() {
    std::vector<double> point = x_;
    add(point, -1 / stiffness_, g_);
    project(point);
    apply(difference(point, x_), moved_);
    go(point, 1, moved_);
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
  CpgLaw& law_;
  AssembledMonitor& monitor_;
  std::vector<double> x_, u_, g_;          ///< g: u with lifts
  std::vector<double> direction_, moved_;  ///< moved: W direction; empty: directions start anew
  double settled_;
  double stiffness_ = 1;
};

}  // namespace

void run_cpg(const AssembledProblem& p, const AssembledOptions& o, CpgLaw& law,
             AssembledMonitor& monitor) {
  ConjugateProjectedGradient(p, o, law, monitor).run();
}

}  // namespace scree
