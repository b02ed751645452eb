// Compiled once per backend, which the build names BuildBackend.
#include "kernels/contact/impact_rows.h"
#include "solvers/contact_passes.h"

namespace scree {

template <class R, class B, class Real>
void ContactPasses<R, B, Real>::project_impulses(B& b, const ContactProblem<Real>& p,
                                                 Span<Vec3<Real>> gamma) {
  for_each(b, p.contact_count, ProjectImpulses<R, Real>{p, gamma});
}

template <class R, class B, class Real>
void ContactPasses<R, B, Real>::gather_velocities(B& b, const ContactProblem<Real>& p,
                                                  Span<const Vec3<Real>> gamma,
                                                  Span<Twist<Real>> velocity) {
  for_each(b, p.bodies.owned_count, BodyVelocity<R, Real>{p, gamma, velocity});
}

template <class R, class B, class Real>
void ContactPasses<R, B, Real>::sum_residuals(B& b, const ContactProblem<Real>& p,
                                              Span<const Vec3<Real>> gamma,
                                              Span<const Twist<Real>> velocity,
                                              ResidualSums* sums) {
  reduce_contacts<ResidualSums>(b, p, ContactResidual<R, Real>{p, gamma, velocity},
                                StoreResult<ResidualSums>{sums});
}

template <class R, class B, class Real>
void ContactPasses<R, B, Real>::sum_impulse_energy(B& b, const ContactProblem<Real>& p,
                                                   Span<const Twist<Real>> velocity, Sums<1>* sum) {
  reduce_over_ranks<Sums<1>>(b, p.bodies.owned_count, ImpulseEnergy<R, Real>{p, velocity},
                             StoreResult<Sums<1>>{sum});
}

template struct ContactPasses<RadialRows<float>, BuildBackend, float>;
template struct ContactPasses<RadialRows<double>, BuildBackend, double>;
template struct ContactPasses<GeneralRows<float>, BuildBackend, float>;
template struct ContactPasses<GeneralRows<double>, BuildBackend, double>;
template struct ContactPasses<RollingRows<float>, BuildBackend, float>;
template struct ContactPasses<RollingRows<double>, BuildBackend, double>;
template struct ContactPasses<MixedRows<float>, BuildBackend, float>;
template struct ContactPasses<MixedRows<double>, BuildBackend, double>;
template struct ContactPasses<JointedRows<float>, BuildBackend, float>;
template struct ContactPasses<JointedRows<double>, BuildBackend, double>;

template struct ContactPasses<ImpactRows<RadialRows<float>>, BuildBackend, float>;
template struct ContactPasses<ImpactRows<RadialRows<double>>, BuildBackend, double>;
template struct ContactPasses<ImpactRows<GeneralRows<float>>, BuildBackend, float>;
template struct ContactPasses<ImpactRows<GeneralRows<double>>, BuildBackend, double>;
template struct ContactPasses<ImpactRows<RollingRows<float>>, BuildBackend, float>;
template struct ContactPasses<ImpactRows<RollingRows<double>>, BuildBackend, double>;
template struct ContactPasses<ImpactRows<MixedRows<float>>, BuildBackend, float>;
template struct ContactPasses<ImpactRows<MixedRows<double>>, BuildBackend, double>;
template struct ContactPasses<ImpactRows<JointedRows<float>>, BuildBackend, float>;
template struct ContactPasses<ImpactRows<JointedRows<double>>, BuildBackend, double>;

}  // namespace scree
