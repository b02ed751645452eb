#pragma once
// Conjugate projected gradient on a backend, for any set of impulses that can be projected on.
//
// A law minimizes 1/2 r.W r + r.(q + lift) over r in a set C, contact by contact. Bounds and lifts
// that belong to it but depend on the solution are held, and updated now and then. Laws are
// structs of spans in backend memory, which element programs carry by value:
//
//   project(c, r)                nearest point of C; r [3] of contact c, in place
//   project_on_tangent(c, r, v)  nearest direction of the tangent cone of C at r; v [3], in place
//   lift(c)                      what is added to the normal velocity
//   renew(c, r, u)               takes bounds and lifts from a point, maybe outside of C, and its
//                                velocity
//   rounding                     largest change by a projection, relative to an impulse, that is
//                                mere rounding: of sets whose faces are planes that are not along
//                                the axes. On curved ones each change is one of direction.

#include <algorithm>
#include <cmath>
#include <string>

#include "solvers/assembled/power_method.h"

namespace scree {

/// Renews the law and projects r. Counts the contacts that the projection changed.
template <class Law>
struct CpgRenew {
  static constexpr const char* name = "cpg_renew";
  Law law;
  Span<const double> u;
  Span<double> r;
  SCREE_HD Sums<1> operator()(Index c) const {
    const Offset at = 3 * static_cast<Offset>(c);
    law.renew(c, &r[at], &u[at]);
    const double before[3] = {r[at], r[at + 1], r[at + 2]};
    law.project(c, &r[at]);
    Sums<1> changed;
    for (int i = 0; i < 3; ++i)
      if (r[at + i] != before[i]) changed.value[0] = 1;
    return changed;
  }
};

/// u += length v, the gradient g of the law there, and -g / D.
template <class Law>
struct CpgGradient {
  static constexpr const char* name = "cpg_gradient";
  Law law;
  double length;
  Span<const double> scale, v;
  Span<double> u, g, fall;
  SCREE_HD void operator()(Index c) const {
    const Offset at = 3 * static_cast<Offset>(c);
    const double inverse = 1 / scale[c];
    for (int i = 0; i < 3; ++i) {
      u[at + i] += length * v[at + i];
      g[at + i] = u[at + i] + (i == 0 ? law.lift(c) : 0);
      fall[at + i] = -inverse * g[at + i];
    }
  }
};

/// w = P_T(-g / D).
template <class Law>
struct CpgDescent {
  static constexpr const char* name = "cpg_descent";
  Law law;
  Span<const double> r, fall;
  Span<double> w;
  SCREE_HD void operator()(Index c) const {
    const Offset at = 3 * static_cast<Offset>(c);
    for (int i = 0; i < 3; ++i) w[at + i] = fall[at + i];
    law.project_on_tangent(c, &r[at], &w[at]);
  }
};

/// p = w + bend P_T(p).
template <class Law>
struct CpgDirection {
  static constexpr const char* name = "cpg_direction";
  Law law;
  double bend;
  Span<const double> r, w;
  Span<double> p;
  SCREE_HD void operator()(Index c) const {
    const Offset at = 3 * static_cast<Offset>(c);
    if (bend != 0) law.project_on_tangent(c, &r[at], &p[at]);
    for (int i = 0; i < 3; ++i) p[at + i] = w[at + i] + bend * p[at + i];
  }
};

/// What a projected point is like.
struct CpgTrialSums {
  Index changed = 0;  ///< contacts that the projection changed by more than rounding
  double slope = 0;   ///< g.step
  double square = 0;  ///< of the step, in the metric of D
  SCREE_HD void combine(const CpgTrialSums& o) {
    changed += o.changed;
    slope += o.slope;
    square += o.square;
  }
};

/// point = P(r + length v), and the step to it.
template <class Law>
struct CpgTrial {
  static constexpr const char* name = "cpg_trial";
  Law law;
  double length;
  Span<const double> scale, r, g, v;
  Span<double> point, step;
  SCREE_HD CpgTrialSums operator()(Index c) const {
    const Offset at = 3 * static_cast<Offset>(c);
    double before[3], change = 0, size = 0;
    for (int i = 0; i < 3; ++i) before[i] = point[at + i] = r[at + i] + length * v[at + i];
    law.project(c, &point[at]);
    CpgTrialSums sums;
    for (int i = 0; i < 3; ++i) {
      const double by = std::abs(point[at + i] - before[i]), own = std::abs(before[i]);
      if (by > change) change = by;
      if (own > size) size = own;
      step[at + i] = point[at + i] - r[at + i];
      sums.slope += g[at + i] * step[at + i];
      sums.square += scale[c] * step[at + i] * step[at + i];
    }
    sums.changed = change > Law::rounding * size ? 1 : 0;
    return sums;
  }
};

/// point = r + length step.
struct CpgPoint {
  static constexpr const char* name = "cpg_point";
  double length;
  Span<const double> r, step;
  Span<double> point;
  SCREE_HD void operator()(Index i) const { point[i] = r[i] + length * step[i]; }
};

/// a.b and a.c.
struct CpgProducts {
  static constexpr const char* name = "cpg_products";
  Span<const double> a, b, c;
  SCREE_HD Sums<2> operator()(Index contact) const {
    const Offset at = 3 * static_cast<Offset>(contact);
    Sums<2> sums;
    for (int i = 0; i < 3; ++i) {
      sums.value[0] += a[at + i] * b[at + i];
      sums.value[1] += a[at + i] * c[at + i];
    }
    return sums;
  }
};

/// |v| in the metric of 1 / D. @param scale  D
inline double inverse_scaled_norm(const std::vector<double>& v, const std::vector<double>& scale) {
  double sum = 0;
  for (std::size_t i = 0; i < v.size(); ++i) sum += v[i] * v[i] / scale[i / 3];
  return std::sqrt(sum);
}

/// One solve. Points are r in C, with velocities u = W r + q carried along. Steps are chosen on the
/// host, which reads sums three times an iteration, once more where the trial was changed and once
/// more for other laws than the cone's: the branches between products with W stay plain code.
template <class B, class Law>
class ConjugateProjectedGradient {
 public:
  ConjugateProjectedGradient(const BackendProblem<B>& p, const AssembledOptions& o, const Law& law,
                             AssembledMonitor& monitor)
      : p_(p),
        b_(p.backend()),
        law_(law),
        monitor_(monitor),
        scale_(p.backend()),
        r_(p.vector(o.guess)) {
    const std::vector<double> scale = contact_scales(p.host());
    upload(b_, scale, scale_);
    settled_ = o.tolerance * inverse_scaled_norm(p.host().q, scale);
    set_velocity();
    renew();
    set_velocity();
    const double stretch = 1.1 * largest_stretch(p, scale_, monitor);
    if (stretch > 0) stiffness_ = stretch;
    fill(b_, moved_.view(), 0.0);
    restart_directions();
  }

  /// @param other_law  name of the law where it is not that of the cone, else empty
  void run(const std::string& other_law) {
    double target = other_law.empty() ? 0 : inner_share * error();
    for (int k = 0;; ++k) {
      if ((k == 0 || monitor_.due(k)) && check(k)) return;
      if (!other_law.empty() && error() <= std::max(target, settled_)) {
        const double renewed = renewed_error();
        if (renewed <= settled_) {
          if (!check(k))
            monitor_.fail(AssembledStatus::stalled, "solved with " + other_law + ", not the cone");
          return;
        }
        target = inner_share * renewed;
      }
      step();
    }
  }

 private:
  /// Error of a minimization, over that with which it began, at which bounds and lifts are renewed.
  static constexpr double inner_share = 0.1;

  using Vector = Buffer<B, double>;

  void apply(const Vector& x, Vector& product) {
    p_.multiply(x, product);
    monitor_.count_applications();
  }

  bool check(int k) {
    apply(r_, u_);  // rounding of what was carried along goes
    if (p_.check(monitor_, k, r_, u_)) return true;
    add_to_velocity(1, p_.q());
    return false;
  }
  void set_velocity() {
    apply(r_, u_);
    add_to_velocity(1, p_.q());
  }
  void add_to_velocity(double length, Span<const double> v) {
    for_each(b_, p_.contact_count(),
             CpgGradient<Law>{law_, length, scale_.view(), v, u_.view(), g_.view(), fall_.view()});
  }

  /// @return whether r is another point now
  bool renew() {
    reduce<Sums<1>>(b_, p_.contact_count(), CpgRenew<Law>{law_, u_.view(), r_.view()},
                    StoreResult<Sums<1>>{count_.data()});
    return fetch(b_, count_.data()).value[0] > 0;
  }

  /// Renews the law. @return the error with it
  double renewed_error() {
    if (renew()) {
      set_velocity();
    } else {
      add_to_velocity(0, p_.q());  // lifts alone are new
    }
    restart_directions();
    return error();
  }

  /// Without a last direction the next one is that of descent.
  void restart_directions() { fill(b_, direction_.view(), 0.0); }

  /// |r - P(r - g / D)|
  double error() {
    project_along(1, fall_);
    return std::sqrt(fetch(b_, trial_.data()).square);
  }

  void step() {
    for_each(b_, p_.contact_count(), CpgDescent<Law>{law_, r_.view(), fall_.view(), w_.view()});
    const Sums<2> last = products(moved_, direction_, w_);
    const double bend = last.value[0] > 0 ? -last.value[1] / last.value[0] : 0;
    for_each(b_, p_.contact_count(),
             CpgDirection<Law>{law_, bend, r_.view(), w_.view(), direction_.view()});
    apply(direction_, moved_);
    if (!advance()) {
      gradient_step();
      restart_directions();
    }
  }

  /// Steps to the least objective along the direction.
  /// @return whether constraints left the step as it was
  bool advance() {
    const Sums<2> along = products(direction_, g_, moved_);
    const double slope = along.value[0], curvature = along.value[1];
    if (!(slope < 0 && curvature > 0)) return false;
    const double length = -slope / curvature;
    project_along(length, direction_);
    const CpgTrialSums trial = fetch(b_, trial_.data());
    if (trial.changed > 0) {
      corrected_step(trial.slope);
      return false;
    }
    go(length);
    return true;
  }

  /// Goes to the least objective between r and the point. @param slope  g.step
  void corrected_step(double slope) {
    if (!(slope < 0)) return;
    apply(step_, moved_);
    const double curvature = products(step_, moved_, g_).value[0];
    if (!(-slope < curvature)) return go(1);
    const double length = -slope / curvature;
    for_each(b_, p_.row_count(), CpgPoint{length, r_.view(), step_.view(), point_.view()});
    go(length);
  }

  /// r = P(r - g / (|W| D)), which descends.
  void gradient_step() {
    project_along(1 / stiffness_, fall_);
    apply(step_, moved_);
    go(1);
  }

  /// Sets the point P(r + length v), the step to it, and trial_.
  void project_along(double length, Vector& v) {
    reduce<CpgTrialSums>(b_, p_.contact_count(),
                         CpgTrial<Law>{law_, length, scale_.view(), r_.view(), g_.view(), v.view(),
                                       point_.view(), step_.view()},
                         StoreResult<CpgTrialSums>{trial_.data()});
  }

  /// Goes to the point to the bit, as tangent cones depend on the bounds that a point is on.
  /// Velocities change by `length` times moved_.
  void go(double length) {
    swap(r_, point_);
    add_to_velocity(length, moved_.view());
  }

  Sums<2> products(Vector& a, Vector& b, Vector& c) {
    reduce<Sums<2>>(b_, p_.contact_count(), CpgProducts{a.view(), b.view(), c.view()},
                    StoreResult<Sums<2>>{pair_.data()});
    return fetch(b_, pair_.data());
  }

  const BackendProblem<B>& p_;
  B& b_;
  const Law law_;
  AssembledMonitor& monitor_;
  Vector scale_;  ///< D [contact_count] [1/kg]
  Vector r_, u_ = p_.vector();
  Vector g_ = p_.vector(), fall_ = p_.vector();       ///< u with lifts; -g / D
  Vector point_ = p_.vector(), step_ = p_.vector();   ///< of a trial: step = point - r
  Vector w_ = p_.vector(), direction_ = p_.vector();  ///< w: of descent
  Vector moved_ = p_.vector();                        ///< W times the direction or step
  Buffer<B, Sums<1>> count_{b_, 1};
  Buffer<B, Sums<2>> pair_{b_, 1};
  Buffer<B, CpgTrialSums> trial_{b_, 1};  ///< of the last projection along a line
  double settled_ = 0;                    ///< error at which a law has been solved
  double stiffness_ = 1;                  ///< |W| in the metric of D
};

/// Runs from the guess until the monitor stops it or, for a law that is not the cone's,
/// until |r - P_C(r - (u + lift) / D)| is below the tolerance times |q / D|, both in the metric
/// of D = contact_scales, with bounds and lifts of the moment: a stall with a note, as the residual
/// is that of another law. 9 vectors in backend memory beside q. See cpg.inst.h for the method.
/// @param law        see above; its spans point into the memory of the backend
/// @param other_law  name of the law where it is not that of the cone, else empty
template <class B, class Law>
void run_cpg(const BackendProblem<B>& p, const AssembledOptions& o, const Law& law,
             const std::string& other_law, AssembledMonitor& monitor) {
  ConjugateProjectedGradient<B, Law>(p, o, law, monitor).run(other_law);
}

}  // namespace scree
