#pragma once
// The contact problem of one step as solvers see it: operator, right-hand side, cones, body data;
// no shapes and no scenes. Element programs carry it by value.
//
//   minimize 1/2 gamma^T N gamma + r^T gamma over the product of cones,
//   N = J M^-1 J^T,  r = J v* + bias
//
// Body rates are twists (v, s) with s = l w. In the radial and the mixed layout the length l of a
// free sphere is its radius, so that s is its surface speed, and no radius and no lever arm is read
// where spheres touch; of all other bodies it is 1. Lever arms and inertias are in the same unit:
// arms divided by the length of their body, inertias by its square.
//
// Contacts are one group, all with the same data, or several one after the other: each sorted by
// body A, with lists of its own for each body. Fields that not all groups have, as lever arms, are
// stored from the first contact on that has them.

#include "kernels/bodies/body_ranges.h"
#include "kernels/bodies/per_body.h"
#include "kernels/contact/contact_fields.h"
#include "kernels/contact/joint_row.h"
#include "kernels/math/scalar.h"
#include "kernels/math/sym3.h"

namespace scree {

/// Linear and angular part of a body's rate or of a generalized impulse. Aligned so that a gather
/// takes half the loads.
template <class Real>
struct alignas(2 * sizeof(Real)) Twist {
  Vec3<Real> linear;
  Vec3<Real> angular;

  friend SCREE_HD Twist operator+(const Twist& a, const Twist& b) {
    return {a.linear + b.linear, a.angular + b.angular};
  }
  friend SCREE_HD Twist operator-(const Twist& a, const Twist& b) {
    return {a.linear - b.linear, a.angular - b.angular};
  }
  friend SCREE_HD Twist operator*(Real s, const Twist& a) { return {s * a.linear, s * a.angular}; }
};

/// Inverse mass of a body in the radial layout.
template <class Real>
struct RadialInertia {
  Real inv_mass = 0;  ///< [1/kg]
  Real inv_spin = 0;  ///< r^2 / I [1/kg]: 2.5 / m for a solid sphere, 0 when rotation is locked
};

/// Mass matrix of a body and its inverse, world frame; locked axes have zero inverse.
template <class Real>
struct GeneralInertia {
  Real mass = 0;           ///< [kg]
  Vec3<Real> inv_mass;     ///< per world axis [1/kg]
  Sym3<Real> inertia;      ///< [kg m^2]
  Sym3<Real> inv_inertia;  ///< [1/(kg m^2)]
};

/// A value per contact, or one for all (then no memory is read).
template <class Real>
struct PerContact {
  Span<const Real> values;
  Real uniform = 0;
  SCREE_HD Real operator[](Index c) const { return values.empty() ? uniform : values[c]; }
};

/// Bias of each contact [m/s]: stored, or gap / h with the push out of overlaps limited.
template <class Real>
struct ContactBias {
  Span<const Real> values;  ///< [contact_count], or empty:
  Span<const Real> gap;     ///< [contact_count] [m]
  Real inv_time_step = 0;   ///< 1 / h [1/s]
  Real least = 0;           ///< -max_recovery_speed [m/s]

  ContactBias() = default;
  template <class U>
  requires(std::is_same_v<std::remove_const_t<U>, Real>) SCREE_HD
      constexpr ContactBias(const Span<U>& all)
      : values(all) {}
  SCREE_HD Real operator[](Index c) const { return value(read(c)); }
  /// What is stored of a contact, and its bias: in two steps where other loads should
  /// not wait for this one.
  SCREE_HD Real read(Index c) const { return values.empty() ? gap[c] : values[c]; }
  SCREE_HD Real value(const Real& stored) const {
    if (!values.empty()) return stored;
    const Real speed = inv_time_step * stored;
    return select(speed <= least, least, speed);  // NaN stays
  }
};

/// v* = v + h g of each body: stored, or worked out from the rates of free spheres and of bodies
/// that do not turn.
template <class Real>
struct FreeVelocity {
  Span<const Twist<Real>> values;           ///< [bodies.count], or empty:
  Span<const Vec3<Real>> velocity;          ///< [bodies.count] [m/s]
  Span<const Vec3<Real>> angular_velocity;  ///< [bodies.count] [rad/s]
  PerBody<Real> radius;                     ///< [m]
  Vec3<Real> gravity_step;                  ///< h g [m/s]
  Index moving_count = 0;                   ///< bodies that get gravity_step

  FreeVelocity() = default;
  template <class U>
  requires(std::is_same_v<std::remove_const_t<U>, Twist<Real>>) SCREE_HD
      constexpr FreeVelocity(const Span<U>& all)
      : values(all) {}
  SCREE_HD Twist<Real> operator[](Index i) const {
    if (!values.empty()) return values[i];
    if (i >= moving_count) return {velocity[i], {}};
    return {velocity[i] + gravity_step, radius[i] * angular_velocity[i]};
  }
};

/// Inverse mass of each body in the radial layout: stored, or worked out where all bodies have
/// the same inv_spin / inv_mass.
template <class Real>
struct RadialInertias {
  Span<const RadialInertia<Real>> values;  ///< [bodies.count], or empty:
  PerBody<Real> inv_mass;                  ///< [1/kg]
  /// inv_spin / inv_mass where it is the same for all free bodies, else negative.
  Real spin_ratio = -1;

  RadialInertias() = default;
  template <class U>
  requires(std::is_same_v<std::remove_const_t<U>, RadialInertia<Real>>) SCREE_HD
      constexpr RadialInertias(const Span<U>& all)
      : values(all) {}
  SCREE_HD RadialInertia<Real> operator[](Index i) const {
    if (!values.empty()) return values[i];
    const Real m = inv_mass[i];
    return {m, spin_ratio * m};
  }
};

/// The contacts of each owned body in one group, numbered from the first one of the group: as A they
/// are the range [a_start[i], a_start[i + 1]), as B the listed ones.
struct ContactLists {
  Index first = 0;              ///< contact of the group
  Span<const Index> a_start;    ///< [owned_count + 1]; empty: there is no such group
  Span<const Index> b_start;    ///< [owned_count + 1]
  Span<const Index> b_contact;  ///< sorted by (body_b, contact)

  SCREE_HD Index count(Index i) const {
    return a_start[i + 1] - a_start[i] + b_start[i + 1] - b_start[i];
  }
};

/// Groups behind the first one: the general contacts of the mixed layout, or joints.
inline constexpr int kLaterGroups = 1;

/// Store: fields as solvers read them.
template <class Real_>
struct InProblem {
  using Real = Real_;
  template <class T>
  using Array = Span<const T>;
  using Bias = ContactBias<Real>;
  using Varying = PerContact<Real>;
};

/// Contacts, each group sorted by body_a, and bodies.
template <class Real>
struct ContactProblem : ProblemFields<InProblem<Real>> {
  ContactLayout layout = ContactLayout::radial;
  Index contact_count = 0;
  /// Contacts of all ranks, each once; negative: there is one rank.
  Offset all_contacts = -1;
  /// Storage of the arrays of bodies; the world, where joints hold to it, counts as one more fixed
  /// body. Solvers find velocities of owned bodies. Ghosts have v* and inertia too, but only their
  /// owners know all of their contacts: here they keep the velocity that they have, as fixed ones
  /// do, until their owners' comes (kernels/bodies/ghosts.h).
  BodyRanges bodies;
  /// Mixed layout: contacts [0, radial_count) are radial, the others general. 0 in other layouts.
  Index radial_count = 0;
  /// Jointed layout: contacts [joint_begin, contact_count) are joints, with these rows. They have
  /// bodies and an axis in place of the normal, but no other field of a contact.
  Index joint_begin = 0;
  Span<const JointRow<Real>> joints;
  /// What the solver leaves at each contact and finds again in the next step, -1 at new contacts.
  /// Empty unless Solver::keeps_marks().
  Span<Index> mark;

  // bodies
  FreeVelocity<Real> free_velocity;  ///< v* = v + h M^-1 f_ext [bodies.count]
  /// [bodies.count], radial and mixed layout; zero for bodies of the latter that are no radial ones
  RadialInertias<Real> radial_inertia;
  /// [bodies.count], other layouts; of the mixed one empty when all free bodies are radial
  Span<const GeneralInertia<Real>> general_inertia;

  // contacts of a body in the first group: as A they are the range [a_start[i], a_start[i+1]), as B
  // the listed ones
  Span<const Index> a_start;    ///< [owned_count + 1]
  Span<const Index> b_start;    ///< [owned_count + 1]
  Span<const Index> b_contact;  ///< contact indices sorted by (body_b, contact)
  /// Contacts that each ghost has in all, [moving_count - owned_count]; empty: ghosts stand still.
  Span<const Index> ghost_contacts;
  ContactLists later[kLaterGroups];  ///< of the groups behind it

  /// The lists of a group, 0 to kLaterGroups.
  SCREE_HD ContactLists lists(int group) const {
    return group == 0 ? ContactLists{0, a_start, b_start, b_contact} : later[group - 1];
  }
  /// Contacts without joints: those that have a bias of their own.
  SCREE_HD Index own_contacts() const {
    return layout == ContactLayout::jointed ? joint_begin : contact_count;
  }
  /// Contacts of owned body i, of all groups.
  SCREE_HD Index count_contacts(Index i) const {
    Index n = lists(0).count(i);
    for (const ContactLists& group : later) n += group.a_start.empty() ? 0 : group.count(i);
    return n;
  }
  /// The same of ghosts too, where ranks have told of these; 0 of fixed bodies.
  SCREE_HD Index count_contacts_of_moving(Index i) const {
    if (bodies.is_owned(i)) return count_contacts(i);
    return bodies.moves(i) && !ghost_contacts.empty() ? ghost_contacts[i - bodies.owned_count] : 0;
  }
  /// Contacts of all ranks, each once.
  double contacts_in_all() const {
    return static_cast<double>(all_contacts < 0 ? contact_count : all_contacts);
  }
};

/// What a problem stores of a field; empty where it is worked out or the same for all.
template <class T>
Span<const T> stored_values(const Span<const T>& field) {
  return field;
}
template <class Real>
Span<const Real> stored_values(const PerContact<Real>& field) {
  return field.values;
}
template <class Real>
Span<const Real> stored_values(const ContactBias<Real>& field) {
  return field.values;
}

/// Lets a field be what an array holds.
template <class T>
void point_to(Span<const T>& field, Span<const T> values) {
  field = values;
}
template <class Real>
void point_to(PerContact<Real>& field, Span<const Real> values) {
  field.values = values;
}
template <class Real>
void point_to(ContactBias<Real>& field, Span<const Real> values) {
  field = ContactBias<Real>(values);
}

/// The parts that a copy of the contacts stores: those of the problem, and the bias.
template <class Real>
ContactParts parts_of(const ContactProblem<Real>& p) {
  ContactParts parts;
  ContactProblem<Real>::visit(
      [&](const ContactField& field, const auto& values) {
        if (!stored_values(values).empty()) parts.*field.part = true;
      },
      p);
  parts.bias = true;
  return parts;
}

/// Metric weights of one contact's rows; a bound of its diagonal Delassus block from above.
template <class Real>
struct ContactMetric {
  Real normal = 1;      ///< [1/kg]
  Real tangential = 1;  ///< [1/kg]
  Real moment = 1;      ///< [1/kg], layouts with moment rows
};

}  // namespace scree
