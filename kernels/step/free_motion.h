#pragma once
// What all bodies of a problem have without contacts and joints: whatever joined bodies have more than that in the end, neither
// contacts nor loads gave them.

#include "kernels/bodies/body_view.h"
#include "kernels/contact/contact_problem.h"
#include "kernels/contact/contact_rows.h"

namespace scree {

struct FreeMotion {
  double energy = 0;      ///< of the free bodies [J]
  double prescribed = 0;  ///< speed of the fastest point of the others, as of a ball [m/s]
  SCREE_HD void combine(const FreeMotion& o) {
    energy += o.energy;
    if (o.prescribed > prescribed) prescribed = o.prescribed;
  }
};

/// That of body i. Bytes: its velocity and inertia.
template <class Real>
struct NoteFreeMotion {
  static constexpr const char* name = "note_free_motion";
  BodyView<Real> bodies;
  FreeVelocity<Real> free;
  Span<const GeneralInertia<Real>> inertia;

  SCREE_HD FreeMotion operator()(Index i) const {
    FreeMotion m;
    if (bodies.is_owned(i)) m.energy = 0.5 * LeverArms<Real>::mass_norm2(inertia[i], free[i]);
    if (bodies.is_fixed(i))
      m.prescribed = static_cast<double>(norm(bodies.velocity[i])) +
                     static_cast<double>(bodies.radius[i] * norm(bodies.angular_velocity[i]));
    return m;
  }
};

}  // namespace scree
