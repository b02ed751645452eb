#pragma once
// What contacts and joints did to walls, groups and joints, summed over steps: World::track_forces().

#include <utility>

#include "dynamics/rigid/force_totals.h"
#include "dynamics/rigid/impact_phase.h"
#include "kernels/step/contact_loads.h"

namespace scree {

/// The contacts of a step with the impulses that the solver found.
template <class Real>
struct SolvedContacts {
  BodyView<Real> bodies;  ///< as the contacts were found
  ContactView<Real> contacts;
  Span<const Vec3<Real>> gamma;
  int vectors = 1;                       ///< a contact in gamma
  Span<const RollingRow<Real>> rolling;  ///< where these are two
  SphereArms arms;
};

/// Contacts that carry forces from outside to a wall or a group, impacts of the step included. Two host reads; backend
/// memory while it works: 12 bytes a contact, and with impacts a copy of the impulses.
template <class B, class Real>
std::vector<ContactLoad<Real>> contact_loads(B& b, const SolvedContacts<Real>& solved,
                                             const std::vector<ImpactImpulses<B, Real>>& impacts) {
  const Index n = solved.contacts.count;
  Buffer<B, Vec3<Real>> with_impacts(b);
  Span<const Vec3<Real>> gamma = solved.gamma;
  if (!impacts.empty()) {
    copy(b, gamma, with_impacts.resize_discard(gamma.size));
    for (const ImpactImpulses<B, Real>& round : impacts)
      for_each(b, round.count,
               AddImpactImpulses<Real>{round.contact.view(round.count),
                                       round.gamma.view(round.gamma.capacity()), solved.vectors,
                                       with_impacts.view()});
    gamma = std::as_const(with_impacts).view(gamma.size);
  }
  Buffer<B, Index> flag(b, n);
  Buffer<B, Offset> before(b, static_cast<Offset>(n) + 1);
  for_each(b, n, FlagContactLoads<Real>{solved.bodies, solved.contacts, flag.view()});
  exclusive_scan(b, Span<const Index>(flag.view()), before.view());
  Buffer<B, ContactLoad<Real>> load(b, fetch(b, before.data() + n));
  for_each(b, n,
           GatherContactLoads<Real>{solved.bodies, solved.contacts, gamma, solved.vectors,
                                    solved.rolling, solved.arms, flag.view(), before.view(),
                                    load.view()});
  return download(b, load.view());
}

/// Adds a step to the totals. Contacts come in their order, so the sums have the same bits in every run.
template <class Real>
void add_loads(const std::vector<ContactLoad<Real>>& loads, ForceTotals& totals) {
  for (const ContactLoad<Real>& load : loads) {
    const Vec3d impulse(load.impulse), moment(load.moment);
    if (load.b_is_fixed)
      totals.add_to_body(load.body_b, impulse, cross(Vec3d(load.arm_b), impulse) + moment);
    if (load.group_a == load.group_b) continue;
    const Vec3d torque = cross(load.point, impulse) + moment;
    totals.add_to_group(load.group_b, impulse, torque);
    totals.add_to_group(load.group_a, -impulse, -torque);
  }
}

}  // namespace scree
