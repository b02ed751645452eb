#pragma once
// Passes over contacts and bodies that every solver makes. Their element programs are large and the same for all: they are
// compiled once, for all rows of kernels/contact/, in contact_passes.inst.h.

#include "kernels/contact/contact_operator.h"

namespace scree {

/// @tparam R  rows of the problem
template <class R, class B, class Real>
struct ContactPasses {
  /// Projects every impulse onto its contact's cone: ProjectImpulses.
  static void project_impulses(B& b, const ContactProblem<Real>& p, Span<Vec3<Real>> gamma);

  /// velocity = v* + M^-1 J^T gamma, for owned bodies: BodyVelocity.
  static void gather_velocities(B& b, const ContactProblem<Real>& p, Span<const Vec3<Real>> gamma,
                                Span<Twist<Real>> velocity);

  /// Residuals of the contacts of all ranks: ContactResidual.
  /// @param velocity  v* + M^-1 J^T gamma
  /// @param sums      one record on the backend, written
  static void sum_residuals(B& b, const ContactProblem<Real>& p, Span<const Vec3<Real>> gamma,
                            Span<const Twist<Real>> velocity, ResidualSums* sums);

  /// 1/2 |V - v*|_M^2 of the bodies of all ranks [J]: ImpulseEnergy.
  /// @param sum  one record on the backend, written
  static void sum_impulse_energy(B& b, const ContactProblem<Real>& p,
                                 Span<const Twist<Real>> velocity, Sums<1>* sum);
};

}  // namespace scree
