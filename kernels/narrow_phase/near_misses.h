#pragma once
// Contacts of spheres that pass each other within the step, see spheres_on_way(). A pass of its own
// after FillContacts: few contacts are such, and their registers would slow down all others.

#include "kernels/broad_phase/contact_range.h"
#include "kernels/contact/contact_view.h"
#include "kernels/math/periodic.h"
#include "kernels/narrow_phase/pairs/sphere_sphere.h"

namespace scree {

/// Gives contacts of spheres that pass each other the plane of their nearest pass.
/// Bytes per contact (float, radial), besides what is read of bodies from the caches: 4, and 8 more
/// where there is a gap.
template <class Real>
struct TurnPasses {
  static constexpr const char* name = "turn_passes";
  BodyView<Real> bodies;
  ContactRange range;
  Span<const std::uint8_t> may_pass;  ///< [free_count] by CheckReach; or empty: not known
  ContactView<Real> contacts;
  Span<Vec3<Real>> normal;  ///< in, out
  Span<Real> gap;           ///< in, out [m]
  Span<Vec3<Real>> arm_a;   ///< out, empty when radial [m]
  Span<Vec3<Real>> arm_b;   ///< out, empty when radial [m]

  SCREE_HD void operator()(Index c) const {
    if (!(gap[c] > Real(0))) return;
    const Index a = contacts.body_a[c], b = contacts.body_b[c];
    if (is_slow(a) && is_slow(b)) return;
    if (bodies.shape[a] >= 0 || bodies.shape[b] >= 0) return;
    const Vec3d d = minimum_image(bodies.position[b] - bodies.position[a], range.period);
    const double radius_a = bodies.radius[a], radius_b = bodies.radius[b];
    const Vec3d way =
        range.h * (course_velocity(bodies, range, b) - course_velocity(bodies, range, a));
    const ContactGeometry g =
        spheres_on_way(sphere_sphere(d, radius_a, radius_b), d, way, radius_a, radius_b);
    normal[c] = Vec3<Real>(g.normal);
    gap[c] = static_cast<Real>(g.gap);
    if (!arm_a.empty()) {
      arm_a[c] = Vec3<Real>(g.arm_a);
      arm_b[c] = Vec3<Real>(g.arm_b);
    }
  }

 private:
  SCREE_HD bool is_slow(Index i) const { return i < may_pass.size && may_pass[i] == 0; }
};

}  // namespace scree
