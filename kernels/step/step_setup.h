#pragma once
// Element programs that turn bodies and contacts into the contact problem of a step.
// docs/theory.md, sections "Time step" and "Contact law".

#include "kernels/backend/backend.h"
#include "kernels/bodies/body_view.h"
#include "kernels/bodies/locks.h"
#include "kernels/contact/contact_rows.h"
#include "kernels/contact/contact_view.h"
#include "kernels/contact/radial_bodies.h"
#include "shapes/ellipsoid.h"
#include "shapes/rounded.h"

namespace scree {

/// Contact law of one pair of materials.
template <class Real>
struct PairLaw {
  Real friction = 0;           ///< [-]
  Real restitution = 0;        ///< [-]
  Real cohesion = 0;           ///< [N]
  Real rolling_friction = 0;   ///< [m]
  Real spinning_friction = 0;  ///< [m]
};

/// Symmetric table of contact laws, row-major.
template <class Real>
struct LawTable {
  Span<const PairLaw<Real>> laws;
  Index material_count = 0;
  SCREE_HD const PairLaw<Real>& operator()(Index a, Index b) const {
    return laws[a * material_count + b];
  }
};

/// Inverse mass of free body i in the radial layout.
template <class Real>
SCREE_HD RadialInertia<Real> radial_inertia(const BodyView<Real>& bodies, Index i) {
  const Real r = bodies.radius[i];
  return {bodies.inv_mass[i], bodies.locks[i] == 0 ? r * r / bodies.moments(i).x : Real(0)};
}

/// v* = v + h g, and the inverse mass, of one body in the radial layout (angular part: r w).
/// Solid spheres need no such pass: see FreeVelocity and RadialInertias.
template <class Real>
struct PredictRadial {
  static constexpr const char* name = "predict_radial";
  BodyView<Real> bodies;
  Vec3<Real> gravity_step;  ///< h g [m/s]
  Span<Twist<Real>> free_velocity;
  Span<RadialInertia<Real>> inertia;

  SCREE_HD void operator()(Index i) const {
    const Real r = bodies.radius[i];
    if (!bodies.moves(i)) {  // the layout is chosen only when such bodies do not rotate
      free_velocity[i] = {bodies.is_fixed(i) ? bodies.velocity[i] : Vec3<Real>{}, {}};
      inertia[i] = {};
      return;
    }
    const bool turns = bodies.locks[i] == 0;
    free_velocity[i] = {bodies.velocity[i] + gravity_step,
                        turns ? r * bodies.angular_velocity[i] : Vec3<Real>{}};
    inertia[i] = radial_inertia(bodies, i);
  }
};

/// v* = v + h g of one body of any shape, with locked axes.
template <class Real>
SCREE_HD Twist<Real> general_velocity(const BodyView<Real>& bodies, const Vec3<Real>& gravity_step,
                                      Index i) {
  if (!bodies.moves(i)) {
    const bool exists = bodies.exists(i);  // else room, or the world
    return {exists ? bodies.velocity[i] : Vec3<Real>{},
            exists ? bodies.angular_velocity[i] : Vec3<Real>{}};
  }
  return {on_axes(bodies.velocity[i] + gravity_step, free_linear_axes(bodies.locks[i])),
          on_axes(bodies.angular_velocity[i], free_angular_axes(bodies.locks[i]))};
}

/// Mass matrix of free body i.
template <class Real>
SCREE_HD GeneralInertia<Real> general_inertia(const BodyView<Real>& bodies, Index i) {
  const Real inv_mass = bodies.inv_mass[i];
  GeneralInertia<Real> g;
  g.mass = Real(1) / inv_mass;
  g.inv_mass = on_axes(Vec3<Real>{inv_mass, inv_mass, inv_mass}, free_linear_axes(bodies.locks[i]));
  g.inertia = rotated_diagonal(bodies.orientation[i], bodies.moments(i));
  g.inv_inertia = inverse_on_axes(g.inertia, free_angular_axes(bodies.locks[i]));
  return g;
}

/// The same as PredictRadial for any shape, with locked axes.
template <class Real>
struct PredictGeneral {
  static constexpr const char* name = "predict_general";
  BodyView<Real> bodies;
  Vec3<Real> gravity_step;  ///< h g [m/s]
  Span<Twist<Real>> free_velocity;
  Span<GeneralInertia<Real>> inertia;

  SCREE_HD void operator()(Index i) const {
    free_velocity[i] = general_velocity(bodies, gravity_step, i);
    inertia[i] = bodies.moves(i) ? general_inertia(bodies, i) : GeneralInertia<Real>{};
  }
};

/// The same in the mixed layout.
template <class Real>
struct PredictMixed {
  static constexpr const char* name = "predict_mixed";
  BodyView<Real> bodies;
  Vec3<Real> gravity_step;  ///< h g [m/s]
  Span<Twist<Real>> free_velocity;
  Span<RadialInertia<Real>> radial;    ///< empty when they can be worked out
  Span<GeneralInertia<Real>> general;  ///< empty when all free bodies are radial ones

  SCREE_HD void operator()(Index i) const {
    RadialInertia<Real> r;
    GeneralInertia<Real> g;
    if (bodies.moves(i) && is_radial_body(bodies, i)) {
      r = radial_inertia(bodies, i);
      g = isotropic(r);
      free_velocity[i] = {
          bodies.velocity[i] + gravity_step,
          bodies.locks[i] == 0 ? bodies.radius[i] * bodies.angular_velocity[i] : Vec3<Real>{}};
    } else {
      free_velocity[i] = general_velocity(bodies, gravity_step, i);
      if (bodies.moves(i)) g = general_inertia(bodies, i);
    }
    if (!radial.empty()) radial[i] = r;
    if (!general.empty()) general[i] = g;
  }
};

/// Lever arms of general contacts over the lengths of their bodies, in the mixed layout.
template <class Real>
struct ScaleArms {
  static constexpr const char* name = "scale_arms";
  BodyView<Real> bodies;
  ContactView<Real> contacts;
  Span<Vec3<Real>> arm_a;  ///< [count - radial_count] out
  Span<Vec3<Real>> arm_b;  ///< [count - radial_count] out

  SCREE_HD void operator()(Index k) const {
    const Index c = contacts.radial_count + k;
    arm_a[k] = inverse_length(contacts.body_a[c]) * contacts.arm_a[k];
    arm_b[k] = inverse_length(contacts.body_b[c]) * contacts.arm_b[k];
  }

 private:
  SCREE_HD Real inverse_length(Index i) const {
    return Real(1) / rate_length(ContactLayout::mixed, bodies, i);
  }
};

/// Normal velocity of body B against body A at contact c [m/s]; negative: they approach.
template <class Real>
SCREE_HD Real normal_velocity(const BodyView<Real>& bodies, const ContactView<Real>& contacts,
                              Index c) {
  const Index a = contacts.body_a[c], b = contacts.body_b[c];
  Vec3<Real> relative = bodies.velocity[b] - bodies.velocity[a];
  if (!contacts.is_radial(c)) {  // radial arms turn no normal velocity
    relative += cross(bodies.angular_velocity[b], contacts.lever_b(c)) -
                cross(bodies.angular_velocity[a], contacts.lever_a(c));
  }
  return dot(relative, contacts.normal[c]);
}

/// Scale of the moment rows of contact c [m]: the smaller lever arm of its free bodies, so they
/// weigh like the tangential ones.
template <class Real>
SCREE_HD RollingRow<Real> rolling_row(const BodyView<Real>& bodies,
                                      const ContactView<Real>& contacts, Index c,
                                      const PairLaw<Real>& pair) {
  const Real arm_a = norm(contacts.arm_a[c]);
  const Real arm_b = norm(contacts.arm_b[c]);
  const Real length = bodies.moves(contacts.body_b[c]) && arm_b < arm_a ? arm_b : arm_a;
  return {length, pair.rolling_friction / length, pair.spinning_friction / length};
}

/// Velocity that the vertex of a free body at arm r gains by turning for half a step [m/s]: h/2 of
/// the acceleration w' x r + w x (w x r) of a free rotation, I w' = I w x w. With it a contact that
/// sticks keeps its place to second order. That is the beginning of a series in the angle of a step: above half a radian it
/// fades, and from one on there is none, since a vertex that turns so far within a step is not where the series says, and
/// walls would push it with energy from nowhere. docs/theory.md, section "Rotation".
template <class Real>
struct ContactDrift {
  static constexpr const char* name = "contact_drift";
  BodyView<Real> bodies;
  BodyView<Real> parts;  ///< the bodies as collision detection saw them
  ContactView<Real> contacts;
  Span<const GeneralInertia<Real>> inertia;
  Span<const ShapeRecord<Real>> shapes;
  Real half_step;          ///< h / 2 [s]
  Span<Vec3<Real>> drift;  ///< [count - radial_count] out [m/s]

  SCREE_HD void operator()(Index k) const {
    drift[k] = {};
    const Index c = contacts.radial_count + k;
    // Vertices on walls. Where a sphere, or a rounded vertex, touches, the point of contact moves
    // over it.
    const Index a = contacts.body_a[c], b = contacts.body_b[c];
    if (bodies.shape[a] < 0 || !bodies.is_fixed(b) || bodies.shape[b] < 0) return;
    const Vec3<Real> w = on_axes(bodies.angular_velocity[a], free_angular_axes(bodies.locks[a]));
    const Index part = contact_body(contacts.key[c]);
    const Vec3<Real> r =
        contacts.arm_a[k] - rounding(part, contacts.normal[c], w) * contacts.normal[c];
    const GeneralInertia<Real>& body = inertia[a];
    const Vec3<Real> turn = body.inv_inertia * cross(body.inertia * w, w);
    const Real fading = 2 - 4 * half_step * norm(w);
    if (!(fading > Real(0))) return;
    const Real share = fading < Real(1) ? fading : Real(1);
    drift[k] = -(share * half_step) * (cross(turn, r) + cross(w, cross(w, r)));
  }

 private:
  /// By how much a part is rounded where it touches, along the way that the point of contact takes over it [m].
  SCREE_HD Real rounding(Index part, const Vec3<Real>& normal, const Vec3<Real>& w) const {
    const Index shape = parts.shape[part];
    if (shape < 0) return parts.radius[part];
    const ShapeRecord<Real>& record = shapes[shape];
    const bool is_rounded = record.kind == shapes::Rounded::kind;
    if ((is_rounded ? record.rounded.core : record.kind) != shapes::Ellipsoid::kind)
      return record.rounding;
    const Quat<double> q(parts.orientation[part]);
    const Vec3<double> n(normal);
    const double radius =
        shapes::Ellipsoid::curvature_radius(Vec3<double>(record.half_extents), rotate_back(q, n),
                                            rotate_back(q, cross(Vec3<double>(w), n)));
    return static_cast<Real>(radius) + record.rounded.radius;
  }
};

/// What the set-up pass adds up over contacts.
struct SetupSums {
  double max_penetration = 0;   ///< [m]
  double approach_squares = 0;  ///< sum over touching contacts of min(u_n, 0)^2 [m^2/s^2]
  double touching = 0;          ///< their number
  double contacts = 0;          ///< all of them
  SCREE_HD void combine(const SetupSums& o) {
    if (o.max_penetration > max_penetration) max_penetration = o.max_penetration;
    approach_squares += o.approach_squares;
    touching += o.touching;
    contacts += o.contacts;
  }
};

/// Bias and cone parameters of one contact. docs/theory.md eq. (3) and (4):
///   a gap may be closed but not passed:  bias = gap / h
///   an overlap is pushed out:            bias = max(gap / h, -max_recovery_speed)
///   an impact bounces:                   bias = min(bias, e u_n) when approach is faster than the
///                                        threshold and the gap closes within the step
template <class Real>
struct ContactSetup {
  static constexpr const char* name = "contact_setup";
  BodyView<Real> bodies;
  ContactView<Real> contacts;
  LawTable<Real> law;
  ContactBias<Real> without_impact;  ///< of contacts that do not bounce
  Real time_step;                    ///< h [s]
  Real restitution_threshold;        ///< [m/s]
  Real cohesion_range;               ///< largest gap at which cohesion acts [m]
  Span<Real> bias;                   ///< out [m/s], empty when no pair bounces
  Span<Real> friction;               ///< out, empty when uniform
  Span<Real> adhesion;               ///< out [N s], empty when no pair has cohesion
  Span<RollingRow<Real>> rolling;    ///< out, empty unless contacts have moment rows

  SCREE_HD SetupSums operator()(Index c) const {
    const Index a = contacts.body_a[c], b = contacts.body_b[c];
    const PairLaw<Real>& pair = law(bodies.material[a], bodies.material[b]);
    const Real gap = contacts.gap[c];
    const Real u_n = normal_velocity(bodies, contacts, c);
    if (!bias.empty()) {
      Real value = without_impact[c];
      if (pair.restitution > 0 && u_n < -restitution_threshold && gap + time_step * u_n <= 0 &&
          pair.restitution * u_n < value) {
        value = pair.restitution * u_n;
      }
      bias[c] = value;
    }
    if (!friction.empty()) friction[c] = pair.friction;
    if (!adhesion.empty())
      adhesion[c] = gap <= cohesion_range ? pair.cohesion * time_step : Real(0);
    if (!rolling.empty()) rolling[c] = rolling_row(bodies, contacts, c, pair);

    SetupSums s;
    s.contacts = 1;
    if (gap < 0) s.max_penetration = -gap;
    if (gap <= 0) {
      s.touching = 1;
      if (u_n < 0) s.approach_squares = static_cast<double>(u_n) * u_n;
    }
    return s;
  }
};

}  // namespace scree
