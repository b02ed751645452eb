#pragma once
// The two fused passes of one APGD iteration and the scalar updates that end them. All scalars live
// in backend memory; impulses and velocities rotate through buffers by the count of accepted
// iterations, so nothing is copied and a rejected trial costs nothing but its pass. Source: Mazhar,
// Heyn, Negrut, Tasora, ACM TOG 34(3), 2015; docs/theory.md section "APGD".

#include "kernels/contact/contact_operator.h"
#include "kernels/contact/packed_contact.h"
#include "kernels/solve/momentum.h"

namespace scree {

/// Scalars of a running solve, in backend memory.
struct ApgdState {
  /// L, inverse step: [-] in the diagonal metric, [1/kg] in the Euclidean one.
  double lipschitz = 1;
  double lipschitz_max = 1;  ///< upper bound of the largest eigenvalue of H^-1 N
  double step = 1;           ///< 1 / L
  double theta = 1;          ///< momentum parameter of the extrapolated point in use
  double beta = 0;           ///< its extrapolation factor
  double next_theta = 1;     ///< those of the next point, unless the step ends in a restart
  double next_beta = 0;
  double next_lipschitz = 1;  ///< those of the next trial, unless this one is too long
  double next_step = 1;
  double descent = 0;       ///< g.(gamma+ - gamma) of the trial; positive: against the gradient
  double step_squares = 0;  ///< |gamma+ - y|_H^2 of the trial
  double measure = 0;       ///< L |gamma+ - y|_H of the trial: goes with the residual
  double lowest = 0;        ///< measure since momentum last grew; 0: none. For exact friction
  Index trials = 0;         ///< so far, rejected ones included
  Index accepted = 0;       ///< accepted iterations: selects the roles of the buffers
  Index restarts = 0;

  /// Takes the momentum of the point in use, and works out that of the next one.
  SCREE_HD void set_momentum(double new_theta, double new_beta) {
    theta = new_theta;
    beta = new_beta;
    foresee_momentum();
  }
  SCREE_HD void foresee_momentum() {
    next_theta = scree::next_theta(theta);
    next_beta = scree::next_beta(theta);
  }
  SCREE_HD void set_lipschitz(double value) {
    lipschitz = value < lipschitz_max ? value : lipschitz_max;
    step = 1 / lipschitz;
  }
  /// Works out what comes next as far as it can be known before a trial ends: a device does that while it waits for the end.
  /// @param decay  of L after a step that is not too long
  SCREE_HD void foresee(double decay) {
    foresee_momentum();
    next_lipschitz = decay * lipschitz;
    next_step = 1 / next_lipschitz;
  }
};

/// Two impulse buffers, by turns of the current iterate and of its neighbors: a contact's next
/// impulse takes the place of its previous one, which no one else needs. Comparisons pick the
/// buffer: an array that a device program indexes would move from registers to memory.
template <class Real>
struct ApgdImpulses {
  Span<Vec3<Real>> buffer[2];
  SCREE_HD Span<Vec3<Real>> current(Index k) const { return k % 2 == 0 ? buffer[0] : buffer[1]; }
  SCREE_HD Span<Vec3<Real>> previous(Index k) const { return current(k + 1); }
  SCREE_HD Span<Vec3<Real>> next(Index k) const { return current(k + 1); }
};

/// V of the current iterate, V of the one before or room for the trial's, and V_y of the
/// extrapolated point, which tuned twins may leave out. The next V_y of a body takes the place of
/// the one in use, which no contact needs by then: after a rejected trial the next one starts from
/// the iterate itself.
template <class Real>
struct ApgdVelocities {
  Span<Twist<Real>> of_iterate[2];
  Span<Twist<Real>> of_extrapolated;

  SCREE_HD Span<Twist<Real>> iterate(Index k) const {
    return k % 2 == 0 ? of_iterate[0] : of_iterate[1];
  }
  /// V of the accepted iterate.
  SCREE_HD Span<const Twist<Real>> current(const ApgdState& s) const { return iterate(s.accepted); }
  /// V_y of the point in use. Without momentum it is the iterate itself: so a restart, known only
  /// after the body pass has extrapolated, needs no second pass.
  SCREE_HD Span<const Twist<Real>> extrapolated(const ApgdState& s) const {
    return s.beta == 0 ? iterate(s.accepted) : of_extrapolated;
  }
};

/// Metric weights of every contact, or none: then the metric is Euclidean and no memory is read.
template <class R, class Real>
struct StoredMetric {
  Span<Real> values;          ///< [per_contact(p) * contact_count], or empty
  bool one_each = false;      ///< the tangential weight is a multiple of the normal one
  Real tangential_ratio = 1;  ///< which multiple

  /// Values stored per contact.
  static Index per_contact(const ContactProblem<Real>& p) {
    return p.radial_inertia.spin_ratio < 0 ? R::kMetricValues : 1;
  }
  static StoredMetric on(const ContactProblem<Real>& p, Span<Real> memory) {
    return {memory, !(p.radial_inertia.spin_ratio < 0), 1 + p.radial_inertia.spin_ratio};
  }
  SCREE_HD ContactMetric<Real> load(Index c) const {
    if (values.empty()) return euclidean_metric<Real>();
    if (one_each) return {values[c], tangential_ratio * values[c], 1};
    const Offset first = static_cast<Offset>(c) * R::kMetricValues;
    ContactMetric<Real> m{values[first], values[first + 1], 1};
    if constexpr (R::kMetricValues == 3) m.moment = values[first + 2];
    return m;
  }
  SCREE_HD void store(Index c, const ContactMetric<Real>& m) const {
    if (one_each) {
      values[c] = m.normal;
      return;
    }
    const Offset first = static_cast<Offset>(c) * R::kMetricValues;
    values[first] = m.normal;
    values[first + 1] = m.tangential;
    if constexpr (R::kMetricValues == 3) values[first + 2] = m.moment;
  }
};

/// y = gamma + beta (gamma - gamma_prev), g = J V_y + bias, gamma+ = P_K^H(y - H^-1 g / L) or,
/// for exact friction, P_K replaced by the projection onto the disk that the normal part leaves,
/// on given buffers; gamma+ may take the place of gamma_prev. Bytes per contact (radial, float):
/// read normal and bias 16, ids 8, two impulses 24, metric 4 for uniform bodies and 8 else,
/// two twists 48 gathered (from cache when bodies are in Morton order); written 12.
template <class R, class Real>
struct ApgdContactStep {
  Span<const Vec3<Real>> current;
  Span<const Vec3<Real>> previous;
  Span<Vec3<Real>> next;
  Span<const Twist<Real>> extrapolated;  ///< V_y
  Real beta;
  Real step;           ///< 1 / L
  bool exact = false;  ///< Coulomb's law in place of the convex one

  /// @param v_a, v_b  V_y of the bodies of contact c
  SCREE_HD Sums<2> operator()(const ContactProblem<Real>& p, const StoredMetric<R, Real>& metric,
                              Index c, const Twist<Real>& v_a, const Twist<Real>& v_b) const {
    const auto gamma = R::load(current, c);
    const auto y = gamma + beta * (gamma - R::load(previous, c));
    const auto g = R::velocity(p, c, v_a, v_b);
    const ContactMetric<Real> h = metric.load(c);
    const Vec3<Real> n = p.normal[c];
    // Of the law itself there is no objective that could rise: the way of the step against the way gone tells.
    const auto sums_of_law = [&](const auto& moved) {
      return Sums<2>{{-static_cast<double>(metric_dot(h, n, moved - y, moved - gamma)),
                      static_cast<double>(metric_norm2(h, n, moved - y))}};
    };
    if constexpr (R::kHasJoints) {
      if (R::is_joint(p, c)) {
        const Real own_step = step / h.normal;
        const auto moved = R::Joints::project(p, c, y - step * solve_metric(h, n, g), own_step);
        R::store(next, c, moved);
        if (exact) return sums_of_law(moved);
        // Springs, friction and limits have a part in the objective: g is not zero where they rest.
        const auto slope =
            R::Joints::joint(p, c).has_own_terms() ? (Real(1) / own_step) * (y - moved) : g;
        return {{static_cast<double>(dot(slope, moved - gamma)),
                 static_cast<double>(metric_norm2(h, n, moved - y))}};
      }
    }
    if (exact) {
      const auto moved = R::project_coulomb(p, c, y - step * solve_metric(h, n, g), h);
      R::store(next, c, moved);
      return sums_of_law(moved);
    }
    const auto moved = R::project(p, c, y - step * solve_metric(h, n, g), h);
    R::store(next, c, moved);
    return {{static_cast<double>(dot(g, moved - gamma)),
             static_cast<double>(metric_norm2(h, n, moved - y))}};
  }
  SCREE_HD Sums<2> operator()(const ContactProblem<Real>& p, const StoredMetric<R, Real>& metric,
                              Index c) const {
    return (*this)(p, metric, c, extrapolated[p.body_a[c]], extrapolated[p.body_b[c]]);
  }
};

/// The contact step of a running solve.
template <class R, class Real>
struct ApgdContactPass {
  static constexpr const char* name = "apgd_contact_pass";
  ContactProblem<Real> p;
  ApgdImpulses<Real> gamma;
  ApgdVelocities<Real> velocity;
  StoredMetric<R, Real> metric;
  const ApgdState* state;
  bool exact;

  SCREE_HD ApgdContactStep<R, Real> step() const {
    const Index k = state->accepted;
    return {gamma.current(k),
            gamma.previous(k),
            gamma.next(k),
            velocity.extrapolated(*state),
            static_cast<Real>(state->beta),
            static_cast<Real>(state->step),
            exact};
  }
  SCREE_HD Sums<2> operator()(Index c) const { return step()(p, metric, c); }
};

struct ApgdContactFinish {
  ApgdState* state;
  bool adds = false;  ///< to what other contacts of the trial have found
  SCREE_HD void operator()(const Sums<2>& sums) const {
    state->descent = sums.value[0] + (adds ? state->descent : 0);
    state->step_squares = sums.value[1] + (adds ? state->step_squares : 0);
  }
};

/// V+ = v* + M^-1 J^T gamma+, V_y+ = V+ + beta+ (V+ - V), and |V+ - V_y|_M^2 = (gamma+ - y)^T N
/// (gamma+ - y). The momentum is linear, so N y+ needs no application of its own. Bytes per body
/// (radial, float): read v*, V, V_y 72, inertia 8, starts 8; written 48; per contact gathered twice
/// impulse and normal 24, list 4.
template <class R, class Real>
struct ApgdBodyPass {
  static constexpr const char* name = "apgd_body_pass";
  ContactProblem<Real> p;
  ApgdImpulses<Real> gamma;
  ApgdVelocities<Real> velocity;
  const ApgdState* state;

  SCREE_HD Sums<1> operator()(Index i) const {
    const Index k = state->accepted;
    const Twist<Real> next =
        p.free_velocity[i] +
        R::apply_inverse_mass(p, i, gather_wrench<R>(p, Span<const Vec3<Real>>(gamma.next(k)), i));
    const Twist<Real> extrapolated = velocity.extrapolated(*state)[i];
    const Twist<Real> momentum =
        static_cast<Real>(state->next_beta) * (next - velocity.current(*state)[i]);
    velocity.iterate(k + 1)[i] = next;
    velocity.of_extrapolated[i] = next + momentum;
    return {{R::mass_norm2(p, i, next - extrapolated)}};
  }
};

/// V_y+ of ghosts, whose V+ has come from their owners: what ApgdBodyPass does there. Bytes per ghost (float): 48 read, 24
/// written.
template <class Real>
struct ApgdGhostPass {
  static constexpr const char* name = "apgd_ghost_pass";
  Index first;  ///< ghost
  ApgdVelocities<Real> velocity;
  const ApgdState* state;

  SCREE_HD void operator()(Index k) const {
    const Index i = first + k;
    const Twist<Real> next = velocity.iterate(state->accepted + 1)[i];
    const Twist<Real> momentum =
        static_cast<Real>(state->next_beta) * (next - velocity.current(*state)[i]);
    velocity.of_extrapolated[i] = next + momentum;
  }
};

/// Adapts L to the curvature rho = (gamma+ - y)^T N (gamma+ - y) / |gamma+ - y|_H^2 that
/// the trial met. Up to 2 L the trial lowers the objective and is accepted; a shorter step
/// follows when rho passed L. Above, it is rejected, and one from the iterate itself follows:
/// the previous iterate, on which y rests, is gone. That is rare, as L follows rho closely.
/// At the upper bound of the spectrum rho <= L in exact arithmetic, so the trial is accepted
/// whatever rounding says. An accepted step against the gradient restarts the momentum.
/// Exact friction has no objective, and momentum can grow without end where contacts slide:
/// a measure of twice the lowest one restarts it too.
struct ApgdBodyFinish {
  static constexpr double kAbove = 1.1;       ///< L over rho after a step that was too long
  static constexpr double kDecay = 0.95;      ///< of L after any other: finds the local curvature
  static constexpr double kSlowDecay = 0.99;  ///< with exact friction, which steps too long disturb
  static constexpr double kGrown = 2;         ///< measure over the lowest one

  ApgdState* state;
  bool exact = false;
  bool is_foreseen = false;  ///< foresee() came before the trial ended, and comes before the next
  static SCREE_HD double decay(bool exact) { return exact ? kSlowDecay : kDecay; }

  SCREE_HD void operator()(const Sums<1>& energy) const {
    ApgdState& s = *state;
    ++s.trials;
    s.measure = s.lipschitz * std::sqrt(s.step_squares);
    const double allowed = s.lipschitz * s.step_squares;
    const bool at_bound = s.lipschitz >= s.lipschitz_max;
    if (!(energy.value[0] <= 2 * allowed || at_bound)) {
      set_lipschitz_above(energy);
      set_momentum(s.theta, 0);
      return;
    }
    ++s.accepted;
    const bool has_grown = exact && s.lowest > 0 && s.measure > kGrown * s.lowest;
    if (has_grown || !(s.lowest > 0 && s.lowest < s.measure)) s.lowest = s.measure;
    if (s.descent > 0 || has_grown) {
      ++s.restarts;
      set_momentum(1, 0);
    } else {
      set_momentum(s.next_theta, s.next_beta);
    }
    if (energy.value[0] > allowed) {
      set_lipschitz_above(energy);
    } else if (is_foreseen) {
      s.lipschitz = s.next_lipschitz;
      s.step = s.next_step;
    } else {
      s.set_lipschitz(decay(exact) * s.lipschitz);
    }
  }

 private:
  SCREE_HD void set_lipschitz_above(const Sums<1>& energy) const {
    state->set_lipschitz(kAbove * energy.value[0] / state->step_squares);
  }
  SCREE_HD void set_momentum(double theta, double beta) const {
    state->theta = theta;
    state->beta = beta;
    if (!is_foreseen) state->foresee_momentum();
  }
};

/// What a trial adds up: see ApgdContactFinish and ApgdBodyFinish.
struct ApgdSums {
  Sums<2> contacts;
  Sums<1> bodies;
  SCREE_HD void combine(const ApgdSums& o) {
    contacts.combine(o.contacts);
    bodies.combine(o.bodies);
  }
};

/// All that the passes of a solve work on.
template <class R, class Real>
struct ApgdPasses {
  ContactProblem<Real> p;
  ApgdImpulses<Real> gamma;
  ApgdVelocities<Real> velocity;
  StoredMetric<R, Real> metric;
  ApgdState* state;
  bool exact = false;            ///< Coulomb's law in place of the convex one
  bool has_moving_bias = false;  ///< the bias changes from one run of trials to the next

  SCREE_HD ApgdContactPass<R, Real> contact_pass() const {
    return {p, gamma, velocity, metric, state, exact};
  }
  SCREE_HD ApgdBodyPass<R, Real> body_pass() const { return {p, gamma, velocity, state}; }
};

/// The same data for passes on other rows.
template <class To, class R, class Real>
ApgdPasses<To, Real> passes_on(const ApgdPasses<R, Real>& a) {
  return {a.p,
          a.gamma,
          a.velocity,
          {a.metric.values, a.metric.one_each, a.metric.tangential_ratio},
          a.state,
          a.exact,
          a.has_moving_bias};
}

/// Residual of the current iterate, wherever the rotation left it.
template <class R, class Real>
struct ApgdResidual {
  static constexpr const char* name = "apgd_residual";
  ContactProblem<Real> p;
  ApgdImpulses<Real> gamma;
  ApgdVelocities<Real> velocity;
  const ApgdState* state;
  SCREE_HD ResidualSums operator()(Index c) const {
    const Index k = state->accepted;
    return ContactResidual<R, Real>{p, gamma.current(k), velocity.current(*state)}(c);
  }
};

/// Energy of the current iterate's impulses, wherever the rotation left its velocities.
template <class R, class Real>
struct ApgdImpulseEnergy {
  static constexpr const char* name = "apgd_impulse_energy";
  ContactProblem<Real> p;
  ApgdVelocities<Real> velocity;
  const ApgdState* state;
  SCREE_HD Sums<1> operator()(Index i) const {
    return ImpulseEnergy<R, Real>{p, velocity.current(*state)}(i);
  }
};

/// What the host reads at a check, in one transfer.
struct ApgdCheck {
  ApgdState state;
  ResidualSums residual;
  ResidualSums own_residual;  ///< of this rank, where there are several
  Sums<1> energy;             ///< 1/2 |V - v*|_M^2 [J]
  Largest<double> contrast;   ///< of the bodies in contact, worked out once
};

/// Stores the residual with the state it belongs to.
struct ApgdCheckFinish {
  const ApgdState* state;
  ApgdCheck* check;
  SCREE_HD void operator()(const ResidualSums& sums) const {
    check->state = *state;
    check->residual = sums;
  }
  SCREE_HD void keep_own(const ResidualSums& sums) const { check->own_residual = sums; }
};

/// Chooses the metric of every contact and bounds the spectrum: N <= P (mass splitting) gives
/// H^-1 N <= max(P / H). The diagonal metric is H = (P D^2)^(1/3) with D the bound of the contact's
/// own block: between Jacobi's scaling, too long for contacts of crowded bodies, and the safe one,
/// too short elsewhere.
template <class R, class Real>
struct ApgdMetric {
  static constexpr const char* name = "apgd_metric";
  ContactProblem<Real> p;
  StoredMetric<R, Real> metric;  ///< out; empty: Euclidean

  SCREE_HD Largest<double> operator()(Index c) const {
    const ContactMetric<Real> split = mass_split_metric<R>(p, c);
    ContactMetric<Real> h = euclidean_metric<Real>();
    if (!metric.values.empty()) {
      const Real trace = R::block_trace(p, c);
      const ContactMetric<Real> block = floor_metric(R::block_metric(p, c), trace);
      const ContactMetric<Real> above = floor_metric(split, trace);
      h = scaled({weight(above.normal, block.normal), weight(above.tangential, block.tangential),
                  R::kVectors == 2 ? weight(above.moment, block.moment) : Real(1)});
      metric.store(c, h);
      h = metric.load(c);
    }
    Real largest = split.normal / h.normal;
    if (split.tangential / h.tangential > largest) largest = split.tangential / h.tangential;
    if (R::kVectors == 2 && split.moment / h.moment > largest) largest = split.moment / h.moment;
    return {static_cast<double>(largest)};
  }

 private:
  static SCREE_HD Real weight(Real split, Real block) { return block * std::cbrt(split / block); }

  /// All weights enlarged by the same few percent, so that the normal one can be packed. Any metric
  /// will do, and a larger one is still a bound.
  static SCREE_HD ContactMetric<Real> scaled(const ContactMetric<Real>& h) {
    if constexpr (std::is_same_v<Real, float>) {
      const float normal = PackedContact::round_weight(h.normal);
      const float scale = normal / h.normal;
      return {normal, scale * h.tangential, scale * h.moment};
    } else {
      return h;
    }
  }
};

/// gamma *= scale, vector by vector.
template <class Real>
struct ScaleImpulses {
  static constexpr const char* name = "scale_impulses";
  Span<Vec3<Real>> gamma;
  Real scale;
  SCREE_HD void operator()(Index k) const { gamma[k] = scale * gamma[k]; }
};

/// State after impulses were changed from outside: the step is that of before.
struct ApgdResume {
  static constexpr const char* name = "apgd_resume";
  ApgdState* state;
  SCREE_HD void operator()(Index) const { state->set_momentum(kFirstTheta, 0); }
};

/// First state of a solve.
struct ApgdStart {
  ApgdState* state;
  double carried_lipschitz;  ///< L at the end of the last solve, or 0
  SCREE_HD void operator()(const Largest<double>& bound) const {
    ApgdState s;
    s.lipschitz_max = bound.value > 0 ? bound.value * (1 + 1e-5) : 1;
    // A quarter of the bound: the rule of the steps finds the local curvature within a few trials.
    s.set_lipschitz(carried_lipschitz > 0 ? carried_lipschitz : s.lipschitz_max / 4);
    s.set_momentum(kFirstTheta, 0);
    *state = s;
  }
};

}  // namespace scree
