#pragma once
// How far impacts may push bodies off their course within the step. A body that is hit takes over
// speed that it did not have when contacts were listed, and so do the bodies behind it.

#include "kernels/backend/atomic.h"
#include "kernels/backend/backend.h"
#include "kernels/broad_phase/contact_range.h"
#include "kernels/contact/contact_velocity.h"
#include "kernels/contact/contact_view.h"

namespace scree {

/// Bodies and their contacts, as margins are computed from them.
template <class Real>
struct ImpactGraph {
  BodyView<Real> bodies;
  ContactView<Real> contacts;
  ContactRange range;
  double lift = 0;    ///< separation speed the contact law asks for, per sliding speed [-]
  double bounce = 0;  ///< largest restitution of bodies that bounce more than once in a step [-]
  double bounce_threshold = 0;  ///< approach speed up to which they do not [m/s]

  /// How far contact c may push its two bodies off their course [m]: the way of a closing speed
  /// that would make the surfaces pass each other, since they may bounce, and more than once; or
  /// what a sliding contact lacks of its lift.
  SCREE_HD double push(Index c) const {
    const Vec3<Real> n = contacts.normal[c];
    const Vec3<Real> u = contact_velocity(bodies, contacts, c);
    const double u_n = dot(u, n);
    const double gap = contacts.gap[c] > 0 ? contacts.gap[c] : Real(0);
    const double h = range.h;
    const double lifted = h * (lift * norm(across(u, n)) - u_n) - gap;
    const bool is_closing = u_n < 0 && gap + h * (u_n + loaded(c)) < 0;
    const double closing = is_closing ? -h * u_n * bounced(u_n) : 0.0;
    return lifted > closing ? lifted : closing;
  }

  /// How many times the way of its approach a contact may push its bodies.
  SCREE_HD double bounced(double u_n) const { return u_n < -bounce_threshold ? 1 + bounce : 1.0; }

  /// What loads add to the separation speed of contact c [m/s]. They decide whether surfaces meet,
  /// not how far bodies are pushed: the envelope, or ContactRange::fall, is enough for their way.
  SCREE_HD double loaded(Index c) const {
    const Index a = contacts.body_a[c], b = contacts.body_b[c];
    if (a < range.first_held && b < range.first_held) return 0;
    return dot(off_course(b) - off_course(a), Vec3<double>(contacts.normal[c]));
  }

  /// What course_velocity() adds to the velocity of a body [m/s].
  SCREE_HD Vec3<double> off_course(Index i) const {
    if (i < range.first_held) return {};
    if (bodies.is_fixed(i)) return -range.gravity_step;
    return course_velocity(bodies, range, i) - Vec3<double>(bodies.velocity[i]);
  }

  /// How far one body of contact c can be pushed toward the other before that is pushed too [m]:
  /// the gap at the end of the step on their present course.
  SCREE_HD double room(Index c) const {
    const double way = range.h * dot(contact_velocity(bodies, contacts, c), contacts.normal[c]);
    const double gap = contacts.gap[c];
    const double end = way < 0 ? gap + way : gap;
    return end > 0 ? end : 0.0;
  }

  SCREE_HD float limited(Index i, double margin) const {
    const double most = 2 * range.margin_limit * static_cast<double>(bodies.radius[i]);
    return static_cast<float>(margin < most ? margin : most);
  }
};

/// Margins of free bodies from their own contacts, and the largest push of all [m]; notes
/// the room of each contact. Bytes per contact (float, radial), besides bodies from the caches:
/// 24 read, 8 written.
template <class Real>
struct StartMargins {
  static constexpr const char* name = "start_margins";
  ImpactGraph<Real> graph;
  Span<float> margin;  ///< [moving_count] in: zero; out [m]
  Span<double> room;   ///< [contacts.count] out [m]

  SCREE_HD Largest<double> operator()(Index c) const {
    room[c] = graph.room(c);
    const double push = graph.push(c);
    if (push > 0) {
      raise(graph.contacts.body_a[c], push);
      raise(graph.contacts.body_b[c], push);
    }
    return {push};
  }
  SCREE_HD void raise(Index i, double push) const {
    if (graph.bodies.moves(i)) atomic_max(&margin[i], graph.limited(i, push));
  }
};

/// One round over the contacts: a body is pushed as far as its neighbor, less the room between
/// them. Bytes per contact, besides margins from the caches: 8, and 8 where the margins differ.
template <class Real>
struct SpreadMargins {
  static constexpr const char* name = "spread_margins";
  ImpactGraph<Real> graph;
  Span<const double> room;   ///< [contacts.count] by StartMargins [m]
  Span<const float> margin;  ///< [moving_count]
  Span<float> spread;        ///< [moving_count] in: the same; out [m]

  SCREE_HD void operator()(Index c) const {
    const Index a = graph.contacts.body_a[c], b = graph.contacts.body_b[c];
    if (!graph.bodies.moves(b)) return;
    const float of_a = margin[a], of_b = margin[b];
    if (of_a == of_b) return;
    const Index pushed = of_a < of_b ? a : b;
    const double push = static_cast<double>(of_a < of_b ? of_b : of_a) - room[c];
    if (push > 0) atomic_max(&spread[pushed], graph.limited(pushed, push));
  }
};

/// How much larger margins are than before. Bytes per body: 8.
struct MarginGrowth {
  static constexpr const char* name = "margin_growth";
  Span<const float> before;  ///< [moving_count]
  Span<const float> margin;  ///< [moving_count]
  SCREE_HD Largest<double> operator()(Index i) const {
    return {static_cast<double>(margin[i]) - static_cast<double>(before[i])};
  }
};

}  // namespace scree
