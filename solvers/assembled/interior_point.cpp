// Primal-dual interior point for the convex model: Nesterov-Todd scaling, Mehrotra's
// predictor and corrector.
//
// With x = (mu r_n, r_t) and s = (u_n / mu, u_t) both laws of the model are cones of second order
// that are their own duals. Iterates are inside the cones and need not satisfy u = W r + q until
// the end, so a singular W is nothing special: what is factorized is W + P^-2 with P the scaling.
// Complementarity of 1e-16 leaves the direction of slip open to 1e-8, so rounding ends the interior
// point at residuals about 1e-8. From there a few iterations of the proximal method around Newton,
// which then has all states right, lead to 1e-12 and below.
//
// An iteration costs one Cholesky factorization of 3n x 3n, four pairs of triangular solves, each a
// pass over the factor, and five products with W; one of the proximal method some Newton steps.
// Some 15 to 30 iterations whatever the problem; the guess is not used. Contacts without friction
// have no tangential rows. Impulses that grow without bound along a ray on which nothing moves show
// that there is no solution. Source: Andersen, Roos and Terlaky, Math. Program. 95, 2003; Mehrotra,
// SIAM J. Optim. 2, 1992; for contacts Kleinert, Simeon and Obermayr, Comput. Methods Appl. Mech.
// Engrg. 278, 2014.

#include "solvers/assembled/interior_point.h"

#include "solvers/assembled/assembled_solver.h"
#include "solvers/assembled/cone_vectors.h"
#include "solvers/assembled/infeasibility.h"
#include "solvers/assembled/proximal_method.h"
#include "solvers/assembled/second_order_cone.h"
#include "solvers/assembled/shifted_factors.h"

namespace scree {
namespace {

/// Share of the way to the surface that a step goes at most.
constexpr double most_of_the_way = 0.995;
/// Checks without a better residual, once the mean x.s is as small as that, after which rounding is
/// all that is left.
constexpr int looks_without_gain = 3;
constexpr double small_gap = 1e-6;
/// Outer iterations of the proximal method behind it without half the residual.
constexpr int polish_patience = 15;

Cone3 at(const std::vector<double>& v, int c) { return {v[3 * c], v[3 * c + 1], v[3 * c + 2]}; }

/// The problem in x: r = factor x, row by row.
struct ConicProblem {
  AssembledProblem problem;
  std::vector<double> factor;  ///< [3 contact_count]

  explicit ConicProblem(const AssembledProblem& p) : problem(p), factor(p.q.size()) {
    const std::vector<double> scale = contact_scales(p);
    for (int c = 0; c < p.contact_count; ++c) {
      const double root = 1 / std::sqrt(scale[c]);
      factor[3 * c] = p.mu[c] > 0 ? root / p.mu[c] : root;
      factor[3 * c + 1] = factor[3 * c + 2] = p.mu[c] > 0 ? root : 0;
    }
    const auto square_sum = [](const std::vector<double>& v) { return dot(v, v); };
    for (std::size_t i = 0; i < factor.size(); ++i) problem.q[i] *= factor[i];
    const double size = std::sqrt(square_sum(problem.q) / p.contact_count);
    unit = size > 0 ? size : 1;
    for (double& q : problem.q) q /= unit;
    for (int c = 0; c < p.contact_count; ++c) {
      for (int k = p.row_start[c]; k < p.row_start[c + 1]; ++k)
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j)
            problem.block[k][3 * i + j] *= factor[3 * c + i] * factor[3 * p.column[k] + j];
      // Tangential parts without friction: nothing acts on them, and their minimum is zero.
      if (!(p.mu[c] > 0)) problem.diagonal(c)[4] = problem.diagonal(c)[8] = 1;
    }
    if (p.held) problem.held = p.held->scaled(factor);
    for (double& f : factor) f *= unit;
  }

  double unit = 1;  ///< size of the loads, which x and s are in units of
};

/// One solve.
class InteriorPoint {
 public:
  /// All must outlive this.
  InteriorPoint(const AssembledProblem& p, const AssembledOptions& o, double least_growth,
                AssembledMonitor& monitor)
      : original_(p),
        options_(o),
        least_growth_(least_growth),
        monitor_(monitor),
        conic_(p),
        p_(conic_.problem),
        factors_(p_),
        x_(p.q.size(), 0.0),
        s_(p.q.size(), 0.0),
        r_(p.q.size(), 0.0),
        shift_(p.contact_count) {
    for (int c = 0; c < p.contact_count; ++c) x_[3 * c] = s_[3 * c] = 1;
  }

  void run() {
    int k = 0, without_gain = 0;
    for (;; ++k) {
      for (std::size_t i = 0; i < r_.size(); ++i) r_[i] = conic_.factor[i] * x_[i];
      const double best = monitor_.best_residual().relative;
      if (monitor_.check(k, r_) || no_solution()) return;
      const bool gained = k == 0 || monitor_.last().relative < best;
      without_gain = gained || !(gap() < small_gap) ? 0 : without_gain + 1;
      if (without_gain >= looks_without_gain || !step()) break;
    }
    polish();
  }

 private:
  /// x moves along a ray d of the cone with W d = 0 and q.d < 0.
  bool no_solution() {
    if (norm(x_) < least_growth_ * std::sqrt(static_cast<double>(p_.contact_count))) return false;
    if (!grows_without_bound(original_, r_)) return false;
    monitor_.fail(AssembledStatus::no_solution, "impulses grow along a ray on which nothing moves");
    return true;
  }

  /// Mean x.s of a contact, in units of the loads.
  double gap() const { return dot(x_, s_) / p_.contact_count; }

  /// Goes on from the best impulses.
  void polish() {
    if (!monitor_.next_phase(0, 1)) return;
    AssembledOptions from = options_;
    from.guess = monitor_.best();
    ProximalSettings settings;
    settings.patience = polish_patience;
    run_proximal(original_, from, settings, monitor_);
    if (monitor_.status() == AssembledStatus::stalled)
      monitor_.fail(AssembledStatus::stalled, "rounding ends the interior point");
  }

  /// (W + P^-2)^-1 b with one refinement.
  void solve(const std::vector<double>& b, std::vector<double>& x) {
    factors_.solve(b, x);
    std::vector<double> left;
    multiply(p_, x, left);
    monitor_.count_applications();
    for (int c = 0; c < p_.contact_count; ++c)
      for (int i = 0; i < 3; ++i) {
        double sum = b[3 * c + i] - left[3 * c + i];
        for (int j = 0; j < 3; ++j) sum -= shift_[c][3 * i + j] * x[3 * c + j];
        left[3 * c + i] = sum;
      }
    factors_.solve(left, left);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += left[i];
  }

  /// ds = W dx + W x + q - s.
  void slack_step(const std::vector<double>& dx, const std::vector<double>& u,
                  std::vector<double>& ds) {
    multiply(p_, dx, ds);
    monitor_.count_applications();
    for (std::size_t i = 0; i < ds.size(); ++i) ds[i] += u[i] - s_[i];
  }

  double longest(const std::vector<double>& dx, const std::vector<double>& ds) const {
    double a = std::numeric_limits<double>::infinity();
    for (int c = 0; c < p_.contact_count; ++c)
      a = std::min(
          {a, step_to_surface(at(x_, c), at(dx, c)), step_to_surface(at(s_, c), at(ds, c))});
    return a;
  }

  /// @return whether there was one
  bool step() {
    const int n = p_.contact_count;
    std::vector<NesterovTodd> scaling;
    scaling.reserve(n);
    for (int c = 0; c < n; ++c) {
      if (!(cone_determinant(at(x_, c)) > 0 && cone_determinant(at(s_, c)) > 0)) return false;
      scaling.emplace_back(at(x_, c), at(s_, c));
      shift_[c] = scaling[c].inverse_square();
    }
    monitor_.count_factorizations();
    if (!factors_.factorize(shift_)) return false;

    std::vector<double> u, b(x_.size()), dx, ds;
    multiply(p_, x_, u);
    monitor_.count_applications();
    for (std::size_t i = 0; i < u.size(); ++i) b[i] = -(u[i] += p_.q[i]);
    solve(b, dx);
    slack_step(dx, u, ds);
    const double affine = std::min(1.0, longest(dx, ds));
    const double before = dot(x_, s_);
    double affine_gap = 0;
    for (std::size_t i = 0; i < x_.size(); ++i)
      affine_gap += (x_[i] + affine * dx[i]) * (s_[i] + affine * ds[i]);
    const double ratio = std::max(0.0, affine_gap / before);
    const double target = ratio * ratio * ratio * before / n;

    for (int c = 0; c < n; ++c) {
      const Cone3 l = scaling[c].apply(at(s_, c));
      const Cone3 second = jordan(scaling[c].apply_inverse(at(dx, c)), scaling[c].apply(at(ds, c)));
      const Cone3 aim =
          scaling[c].apply_inverse(jordan_divide(l, {target - second[0], -second[1], -second[2]}));
      for (int k = 0; k < 3; ++k) b[3 * c + k] = aim[k] - u[3 * c + k];
    }
    solve(b, dx);
    slack_step(dx, u, ds);
    const double length = std::min(1.0, most_of_the_way * longest(dx, ds));
    if (!(length > 1e-12)) return false;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      x_[i] += length * dx[i];
      s_[i] += length * ds[i];
    }
    return true;
  }

  const AssembledProblem& original_;
  const AssembledOptions& options_;
  double least_growth_;
  AssembledMonitor& monitor_;
  ConicProblem conic_;
  const AssembledProblem& p_;
  ShiftedFactors factors_;
  std::vector<double> x_, s_, r_;
  std::vector<Block3> shift_;
};

class InteriorPointSolver final : public AssembledSolver {
 public:
  AssembledTraits traits() const override {
    return {"interior_point",
            "primal-dual interior point (Nesterov-Todd, Mehrotra), Cholesky",
            false,
            true,
            200,
            1};
  }

  void run(const AssembledProblem& p, const AssembledOptions& o,
           AssembledMonitor& monitor) const override {
    run_interior_point(p, o, kLeastGrowth, monitor);
  }
};

}  // namespace

void run_interior_point(const AssembledProblem& problem, const AssembledOptions& options,
                        double least_growth, AssembledMonitor& monitor) {
  InteriorPoint(problem, options, least_growth, monitor).run();
}

std::unique_ptr<AssembledSolver> make_assembled_interior_point() {
  return std::make_unique<InteriorPointSolver>();
}

}  // namespace scree
