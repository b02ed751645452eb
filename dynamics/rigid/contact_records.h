#pragma once
// Contacts in host memory, for analysis.

#include "dynamics/rigid/impact_phase.h"
#include "host/world.h"
#include "kernels/contact/contact_view.h"

namespace scree {

/// @param id       of all bodies, in storage order
/// @param gamma    impulses of the contacts; empty: left zero
/// @param vectors  a contact in gamma
template <class B, class Real>
std::vector<ContactRecord> contact_records(B& b, const std::vector<Index>& id,
                                           const ContactView<Real>& view,
                                           const std::vector<Vec3<Real>>& gamma, int vectors) {
  const auto body_a = download(b, view.body_a);
  const auto body_b = download(b, view.body_b);
  const auto normal = download(b, view.normal);
  const auto gap = download(b, view.gap);
  std::vector<ContactRecord> out(static_cast<std::size_t>(view.count));
  for (std::size_t c = 0; c < out.size(); ++c) {
    out[c] = {id[static_cast<std::size_t>(body_a[c])], id[static_cast<std::size_t>(body_b[c])],
              Vec3d(normal[c]), static_cast<double>(gap[c]),
              gamma.empty() ? Vec3d{} : Vec3d(gamma[c * static_cast<std::size_t>(vectors)])};
  }
  return out;
}

/// Adds the impulses of the impacts of the step.
template <class B, class Real>
void add_impacts(B& b, const std::vector<ImpactImpulses<B, Real>>& rounds, int vectors,
                 std::vector<ContactRecord>& records) {
  for (const ImpactImpulses<B, Real>& round : rounds) {
    const auto contact = download(b, round.contact.view(round.count));
    const auto impulse = download(b, round.gamma.view(round.gamma.capacity()));
    for (std::size_t k = 0; k < contact.size(); ++k)
      records[static_cast<std::size_t>(contact[k])].impulse +=
          Vec3d(impulse[k * static_cast<std::size_t>(vectors)]);
  }
}

}  // namespace scree
