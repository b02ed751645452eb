#pragma once
// What a step of rigid bodies tells.

#include <cmath>

#include "dynamics/rigid/body_store.h"
#include "host/world.h"
#include "kernels/contact/contact_view.h"
#include "kernels/step/step_setup.h"
#include "solvers/solver.h"

namespace scree {

template <class B, class Real>
void fill_report(StepReport& report, const SolveStats& stats, const SetupSums& sums,
                 const ContactView<Real>& contacts, B& b, BodyStore<B, Real>& store) {
  const Residual& residual = stats.residual;
  report.body_count = store.free_count();
  report.contact_count = contacts.count;
  report.iterations = stats.iterations;
  report.applications = stats.applications;
  report.converged = stats.converged;
  report.residual_rms = residual.rms;
  report.residual_max = residual.max;
  report.exact_residual_rms = residual.exact_rms;
  report.objective = residual.objective;
  report.max_cone_violation = residual.cone_violation;
  report.max_penetration = sums.max_penetration;
  if (residual.max_contact >= 0) {
    report.residual_max_body_a = store.id_of(fetch(b, contacts.body_a.data + residual.max_contact));
    report.residual_max_body_b = store.id_of(fetch(b, contacts.body_b.data + residual.max_contact));
  }
  const StageTimes& t = report.ms;
  report.ms.total = t.collision + t.setup + t.solve + t.integrate;
}

/// Sums can overflow where no body and no contact does.
inline void require_finite(const StepReport& r) {
  const std::pair<const char*, double> values[] = {{"residual", r.residual_rms},
                                                   {"largest residual", r.residual_max},
                                                   {"relative residual", r.residual_relative},
                                                   {"exact residual", r.exact_residual_rms},
                                                   {"objective", r.objective},
                                                   {"penetration", r.max_penetration},
                                                   {"cone violation", r.max_cone_violation},
                                                   {"kinetic energy", r.kinetic_energy}};
  for (const auto& [name, value] : values) {
    if (!std::isfinite(value)) throw_not_finite(r.step, name, value);
  }
}

}  // namespace scree
