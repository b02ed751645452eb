#pragma once
// What every solver is: something that takes a contact problem and a guess, and returns impulses,
// body velocities and an account of how good they are.

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kernels/bodies/ghosts.h"
#include "kernels/contact/contact_operator.h"
#include "solvers/solver_parameter.h"

namespace scree {

/// A parameter outside its range. what() names the parameter, the value and what was expected.
class InvalidParameter : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Metric in which APGD takes its steps and projections.
enum class ApgdMetricKind {
  diagonal,  ///< two or three weights per contact, see ApgdMetric: fewer iterations
  euclidean  ///< as in the paper
};

/// The contact law that APGD's steps aim at, and with it the residual that tolerances are on.
enum class ApgdLaw {
  convex,   ///< the cone program of a step
  coulomb,  ///< Coulomb's law itself, by projections onto the disk that the normal impulse leaves
  lifted    ///< Coulomb's law, by steps of the convex one while De Saxce's shift follows
};

struct SolverParams {
  int max_iterations = 400;  ///< [-], > 0
  int check_every = 10;      ///< iterations between residual checks (host reads), see each solver
  ParameterValues own = {};  ///< of those on the solver's card
  ApgdLaw law = ApgdLaw::convex;  ///< of solvers that step to Coulomb's law
};

/// @throws InvalidParameter
inline void validate(const SolverParams& p) {
  const auto require = [](bool ok, const std::string& what) {
    if (!ok) throw InvalidParameter(what);
  };
  require(p.max_iterations > 0,
          "solver.max_iterations must be positive, got " + std::to_string(p.max_iterations));
  require(p.check_every > 0,
          "solver.check_every must be positive, got " + std::to_string(p.check_every));
}

/// The one measure every solver is judged by: e_c = (gamma_c - P_K(gamma_c - rho_c u_c)) / rho_c
/// with rho_c = 3 / trace(N_cc), over all contacts. Does not depend on problem size.
/// docs/theory.md eq. (12).
struct Residual {
  double rms = 0;             ///< [m/s]
  double max = 0;             ///< [m/s]
  Index max_contact = -1;     ///< contact of the largest residual
  double exact_rms = 0;       ///< with the De Saxce velocity u + mu |u_t| n [m/s]
  double objective = 0;       ///< 1/2 gamma^T N gamma + r^T gamma [J]
  double cone_violation = 0;  ///< max(|gamma_t| - mu gamma_n) [N s]
  Index bad_contact = -1;     ///< a contact whose residual is not finite, or -1
  /// With several ranks, of contacts here, at least of those that this one counts; then max_contact and bad_contact say nothing.
  double own_max = 0;  ///< [m/s]
  Index own_max_contact = -1;
  Index own_bad_contact = -1;
};

struct SolveStats {
  int iterations = 0;
  int applications = 0;    ///< operator applications: passes over all contacts and bodies
  bool converged = false;  ///< residual reached the tolerance
  Residual residual;       ///< of the returned impulses
  int colors = 0;          ///< of a colored solver
};

/// A point of a convergence curve.
struct CurvePoint {
  int iterations = 0;
  int applications = 0;
  double residual_rms = 0;  ///< [m/s]
};

template <class B, class Real>
class Solver {
 public:
  virtual ~Solver() = default;

  /// Solves to `tolerance` (RMS residual [m/s]; 0 runs all iterations).
  /// @param gamma  in: guess (any values; projected first); out: impulses, world frame [N s]
  /// Working memory is taken before the first iteration and given back at the end.
  virtual SolveStats solve(B& backend, const ContactProblem<Real>& problem, Span<Vec3<Real>> gamma,
                           double tolerance) = 0;

  /// V = v* + M^-1 J^T gamma of the returned impulses [body_count]; valid until the next solve
  /// or forget_velocity().
  Span<const Twist<Real>> velocity() const {
    return velocity_ ? std::as_const(*velocity_).view(velocity_->capacity()) : Span<Twist<Real>>{};
  }

  /// Gives the memory of velocity() back, which is void after it.
  void forget_velocity() { velocity_.reset(); }

  /// What is carried from step to step beside the impulses, for checkpoints.
  virtual std::vector<double> memory() const { return {}; }
  virtual void restore_memory(const std::vector<double>&) {}

  /// Whether ContactProblem::mark is to travel with the contacts from step to step.
  virtual bool keeps_marks() const { return false; }

  /// With several ranks: solve() is then a call that all make together. Those that can say so on their card.
  virtual void set_ghosts(const Ghosts<B>* ghosts) { ghosts_ = ghosts; }

  /// When set, every residual check of a solve is appended here.
  void record_curve(std::vector<CurvePoint>* curve) { curve_ = curve; }

 protected:
  const Ghosts<B>* ghosts() const { return ghosts_; }
  bool is_over_ranks() const { return ghosts_ != nullptr; }
  /// Ghosts get the rows that their owners have.
  void update_ghosts(B& b, Span<Twist<Real>> velocity) const {
    if (ghosts_ != nullptr) ghosts_->update(b, velocity);
  }

  bool is_recorded() const { return curve_ != nullptr; }
  void add_to_curve(int iterations, int applications, double rms) {
    if (curve_ != nullptr) curve_->push_back({iterations, applications, rms});
  }

  /// Makes the velocities that another solver found this one's.
  void take_velocity(Solver& other) { velocity_ = std::exchange(other.velocity_, std::nullopt); }

  /// Takes the memory of velocity(), set to v*.
  Span<Twist<Real>> start_velocity(B& b, const ContactProblem<Real>& p) {
    velocity_.reset();  // first gives back what it had
    velocity_.emplace(b, p.bodies.count);
    for_each(b, p.bodies.count, StartVelocity<Real>{p, velocity_->view()});
    return velocity_->view();
  }

 private:
  std::optional<Buffer<B, Twist<Real>>> velocity_;
  std::vector<CurvePoint>* curve_ = nullptr;
  const Ghosts<B>* ghosts_ = nullptr;
};

/// Makes a solver by its registered name.
/// @throws InvalidParameter  see make_one_of()
template <class B, class Real>
std::unique_ptr<Solver<B, Real>> make_solver(const std::string& name, const SolverParams& params);

}  // namespace scree
