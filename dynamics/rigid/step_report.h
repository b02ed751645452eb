#pragma once
// What a step of rigid bodies tells.

#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "dynamics/rigid/body_store.h"
#include "host/world.h"
#include "kernels/contact/contact_view.h"
#include "kernels/step/step_setup.h"
#include "solvers/solver.h"

namespace scree {

/// Ids of the bodies of a contact or joint, kWorldBody for the world.
template <class B, class Real>
std::pair<int, int> bodies_of(const ContactProblem<Real>& problem, Index c, B& b,
                              BodyStore<B, Real>& store) {
  const auto id_of = [&](Index body) {
    return body < store.count() ? store.id_of(body) : kWorldBody;
  };
  return {id_of(fetch(b, problem.body_a.data + c)), id_of(fetch(b, problem.body_b.data + c))};
}

template <class B, class Real>
void fill_report(StepReport& report, const SolveStats& stats, const SetupSums& sums,
                 const ContactProblem<Real>& problem, B& b, BodyStore<B, Real>& store) {
  const Residual& residual = stats.residual;
  report.body_count = store.owned_count();
  report.iterations = stats.iterations;
  report.applications = stats.applications;
  report.converged = stats.converged;
  report.residual_rms = residual.rms;
  report.residual_max = residual.max;
  report.exact_residual_rms = residual.exact_rms;
  report.objective = residual.objective;
  report.max_cone_violation = residual.cone_violation;
  report.max_penetration = sums.max_penetration;
  if (residual.max_contact >= 0)
    std::tie(report.residual_max_body_a, report.residual_max_body_b) =
        bodies_of(problem, residual.max_contact, b, store);
  const StageTimes& t = report.ms;
  report.ms.total = t.collision + t.setup + t.solve + t.integrate;
}

/// The quantities of a report that sums make.
inline std::array<std::pair<const char*, double>, 9> sums_of(const StepReport& r) {
  return {{{"residual", r.residual_rms},
           {"largest residual", r.residual_max},
           {"relative residual", r.residual_relative},
           {"exact residual", r.exact_residual_rms},
           {"objective", r.objective},
           {"penetration", r.max_penetration},
           {"joint error", r.max_joint_error},
           {"cone violation", r.max_cone_violation},
           {"kinetic energy", r.kinetic_energy}}};
}

/// Sums can overflow where no body and no contact does.
inline bool is_finite(const StepReport& r) {
  for (const auto& [name, value] : sums_of(r))
    if (!std::isfinite(value)) return false;
  return true;
}
inline void require_finite(const StepReport& r) {
  for (const auto& [name, value] : sums_of(r))
    if (!std::isfinite(value)) throw_not_finite(r.step, name, value);
}

}  // namespace scree
