#pragma once
// Element programs that gather what contacts carried in a step, for the forces on walls and groups.

#include "kernels/bodies/body_view.h"
#include "kernels/contact/contact_view.h"
#include "kernels/narrow_phase/wall_images.h"

namespace scree {

/// Where a contact acts on body A, which stands in for both, world frame [m].
template <class Real>
SCREE_HD Vec3<double> contact_point(const BodyView<Real>& bodies, const ContactView<Real>& contacts,
                                    Index c) {
  const Index a = contacts.body_a[c];
  const Vec3<Real> arm =
      contacts.is_radial(c) ? bodies.radius[a] * contacts.normal[c] : contacts.lever_a(c);
  return bodies.position[a] + Vec3<double>(arm);
}

/// Those of the contacts from `first` on.
template <class Real>
struct GatherContactPoints {
  static constexpr const char* name = "gather_contact_points";
  BodyView<Real> bodies;
  ContactView<Real> contacts;
  Index first = 0;
  Span<Vec3<double>> out;

  SCREE_HD void operator()(Index k) const { out[k] = contact_point(bodies, contacts, first + k); }
};

/// What one contact carried in a step.
template <class Real>
struct ContactLoad {
  Index body_a = 0;  ///< ids
  Index body_b = 0;
  Index group_a = 0;
  Index group_b = 0;
  bool b_is_fixed = false;
  Vec3<double> point;  ///< where it acts, world frame [m]
  Vec3<Real> arm_b;    ///< from the center of a fixed or kinematic B to that point, world frame [m]
  Vec3<Real> impulse;  ///< acting on B, world frame [N s]
  Vec3<Real> moment;   ///< acting on B, of rolling and spinning friction [N m s]
};

/// Flags contacts on fixed and kinematic bodies and those between two groups. Bytes per contact: 8 read, 4 written; the
/// groups of the bodies where they differ.
template <class Real>
struct FlagContactLoads {
  static constexpr const char* name = "flag_contact_loads";
  BodyView<Real> bodies;
  ContactView<Real> contacts;
  Span<Index> flag;  ///< [contact_count] out

  SCREE_HD void operator()(Index c) const {
    const Index a = contacts.body_a[c], b = contacts.body_b[c];
    const bool is_told = bodies.is_fixed(b) || bodies.group[a] != bodies.group[b];
    flag[c] = is_told && bodies.counts(b) ? 1 : 0;
  }
};

/// Arms of spheres' contacts about the bodies B, which those contacts do not hold.
struct SphereArms {
  Vec3d period;                  ///< zero where space does not repeat [m]
  Span<const WallSolid> solids;  ///< as contacts were found with them
  Span<const Index> owner;       ///< of parts, which solids then name; empty: they name bodies

  /// From the image of the body that is at the point. Along axes on which a wall goes on for ever none is: zero.
  SCREE_HD Vec3d arm(const Vec3d& center, Index body, const Vec3d& point) const {
    if (!(period.x > 0 || period.y > 0 || period.z > 0)) return point - center;
    Index wall = -1, walls = 0;
    for (Index s = 0; s < solids.size; ++s) {
      const Index place = solids[s].body;
      if ((owner.empty() ? place : owner[place]) != body) continue;
      wall = s, ++walls;
    }
    // Parts of a compound have centers of their own.
    if (walls == 1) return -1.0 * nearest_wall(solids[wall], period, point);
    return minimum_image(point - center, period);
  }
};

/// Gathers the flagged contacts, in their order.
template <class Real>
struct GatherContactLoads {
  static constexpr const char* name = "gather_contact_loads";
  BodyView<Real> bodies;  ///< as the contacts were found
  ContactView<Real> contacts;
  Span<const Vec3<Real>> gamma;  ///< impulses of the contacts [N s]
  int vectors = 1;               ///< a contact in gamma
  /// Of the rows of rolling friction, where a contact has two vectors.
  Span<const RollingRow<Real>> rolling;
  SphereArms arms;
  Span<const Index> flag;
  Span<const Offset> before;  ///< running sum of the flags
  Span<ContactLoad<Real>> out;

  SCREE_HD void operator()(Index c) const {
    if (flag[c] == 0) return;
    const Index a = contacts.body_a[c], b = contacts.body_b[c];
    ContactLoad<Real> load;
    load.body_a = bodies.id[a];
    load.body_b = bodies.id[b];
    load.group_a = bodies.group[a];
    load.group_b = bodies.group[b];
    load.b_is_fixed = bodies.is_fixed(b);
    load.point = contact_point(bodies, contacts, c);
    load.arm_b =
        contacts.is_radial(c)
            ? Vec3<Real>(load.b_is_fixed ? arms.arm(bodies.position[b], b, load.point) : Vec3d{})
            : contacts.lever_b(c);
    load.impulse = gamma[static_cast<Offset>(c) * vectors];
    if (vectors == 2) load.moment = rolling[c].length * gamma[static_cast<Offset>(c) * vectors + 1];
    out[before[c]] = load;
  }
};

/// Adds the impulses of one round of impacts to those of the step. A contact is in a round once.
template <class Real>
struct AddImpactImpulses {
  static constexpr const char* name = "add_impact_impulses";
  Span<const Index> contact;
  Span<const Vec3<Real>> gamma;
  int vectors = 1;
  Span<Vec3<Real>> sum;

  SCREE_HD void operator()(Index k) const {
    for (int v = 0; v < vectors; ++v)
      sum[static_cast<Offset>(contact[k]) * vectors + v] +=
          gamma[static_cast<Offset>(k) * vectors + v];
  }
};

}  // namespace scree
