#pragma once
// Contacts in host memory, for analysis.

#include <algorithm>

#include "dynamics/rigid/impact_phase.h"
#include "host/world.h"
#include "kernels/step/contact_loads.h"

namespace scree {

/// Points of the contacts; pieces of them keep memory small.
template <class B, class Real>
std::vector<Vec3d> contact_points(B& b, const BodyView<Real>& bodies,
                                  const ContactView<Real>& view) {
  constexpr Index kPiece = 1 << 20;
  std::vector<Vec3d> points;
  points.reserve(static_cast<std::size_t>(view.count));
  Buffer<B, Vec3<double>> piece(b, std::min(view.count, kPiece));
  for (Index first = 0; first < view.count; first += kPiece) {
    const Index n = std::min(view.count - first, kPiece);
    for_each(b, n, GatherContactPoints<Real>{bodies, view, first, piece.view(n)});
    const std::vector<Vec3<double>> found = download(b, piece.view(n));
    points.insert(points.end(), found.begin(), found.end());
  }
  return points;
}

/// @param id       of all bodies, in storage order
/// @param gamma    impulses of the contacts; empty: left zero
/// @param vectors  a contact in gamma
template <class B, class Real>
std::vector<ContactRecord> contact_records(B& b, const std::vector<Index>& id,
                                           const BodyView<Real>& bodies,
                                           const ContactView<Real>& view,
                                           const std::vector<Vec3<Real>>& gamma, int vectors) {
  const auto body_a = download(b, view.body_a);
  const auto body_b = download(b, view.body_b);
  const auto normal = download(b, view.normal);
  const auto gap = download(b, view.gap);
  const std::vector<Vec3d> point = contact_points(b, bodies, view);
  std::vector<ContactRecord> out(static_cast<std::size_t>(view.count));
  for (std::size_t c = 0; c < out.size(); ++c) {
    out[c] = {id[static_cast<std::size_t>(body_a[c])],
              id[static_cast<std::size_t>(body_b[c])],
              point[c],
              Vec3d(normal[c]),
              static_cast<double>(gap[c]),
              gamma.empty() ? Vec3d{} : Vec3d(gamma[c * static_cast<std::size_t>(vectors)])};
  }
  return out;
}

/// Leaves out contacts that another rank tells of. @param view  the contacts of the records
template <class B, class Real>
void keep_counted(B& b, const BodyRanges& bodies, const ContactView<Real>& view,
                  std::vector<ContactRecord>& records) {
  const auto body_b = download(b, view.body_b);
  std::size_t kept = 0;
  for (std::size_t c = 0; c < records.size(); ++c)
    if (bodies.counts(body_b[c])) records[kept++] = records[c];
  records.resize(kept);
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
