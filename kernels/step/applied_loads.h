#pragma once
// Loads of single bodies that act in one step only.

#include "kernels/backend/backend.h"
#include "kernels/math/vec3.h"

namespace scree {

template <class Real>
struct BodyLoad {
  Index id = 0;
  Vec3<Real> force;   ///< through the center of mass, world frame [N]
  Vec3<Real> torque;  ///< about it [N m]
};

/// Adds loads to those that act in every step, and keeps what was there. An id comes once.
template <class Real>
struct AddBodyLoads {
  static constexpr const char* name = "add_body_loads";
  Span<const BodyLoad<Real>> load;
  Span<Vec3<Real>> force;   ///< by id [N]
  Span<Vec3<Real>> torque;  ///< by id [N m]
  Span<BodyLoad<Real>> before;

  SCREE_HD void operator()(Index k) const {
    const Index id = load[k].id;
    before[k] = {id, force[id], torque[id]};
    force[id] += load[k].force;
    torque[id] += load[k].torque;
  }
};

/// Puts back what AddBodyLoads kept.
template <class Real>
struct PutBodyLoads {
  static constexpr const char* name = "put_body_loads";
  Span<const BodyLoad<Real>> load;
  Span<Vec3<Real>> force;
  Span<Vec3<Real>> torque;

  SCREE_HD void operator()(Index k) const {
    force[load[k].id] = load[k].force;
    torque[load[k].id] = load[k].torque;
  }
};

}  // namespace scree
