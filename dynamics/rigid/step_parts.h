#pragma once
// What the problem of a step stores of its contacts, beside what collision detection leaves: for
// those who make it, and for the memory forecast.

#include <algorithm>

#include "host/scene.h"
#include "host/scene/particle_shapes.h"
#include "host/scene/scene_summary.h"
#include "kernels/contact/contact_fields.h"
#include "shapes/shape_card.h"

namespace scree {

/// Whether free bodies have vertices, insertions included.
inline bool has_vertices(const Scene& scene) {
  const auto in = [](const auto& batch) {
    return std::any_of(batch.bodies.begin(), batch.bodies.end(),
                       [](const BodyDescription& body) {
                         return body.kind == BodyKind::free && !shape_card(body.shape.kind).is_ball;
                       }) ||
           std::any_of(batch.particles.begin(), batch.particles.end(),
                       [](const ParticleSet& set) { return !are_spheres(set); });
  };
  return in(scene) || std::any_of(scene.insertions.begin(), scene.insertions.end(), in);
}

/// @tparam Real    in which numbers of the run are compared
/// @param summary  of the run: its layout may differ from that of the scene
template <class Real>
ContactParts parts_of_step(const Scene& scene, const SceneSummary& summary) {
  const std::vector<Material> pairs = all_pair_values(scene);
  const auto is_positive = [&](double Material::*value) {
    return std::any_of(pairs.begin(), pairs.end(),
                       [&](const Material& m) { return static_cast<Real>(m.*value) > 0; });
  };
  const auto friction = [](const Material& m) { return static_cast<Real>(m.friction); };
  ContactParts parts(summary.layout);
  parts.pair = false;
  parts.bias = scene.stepping.restitution_law == RestitutionLaw::newton &&
               is_positive(&Material::restitution);
  parts.friction = std::any_of(pairs.begin(), pairs.end(), [&](const Material& m) {
    return friction(m) != friction(pairs.front());
  });
  parts.adhesion = is_positive(&Material::cohesion);
  // Other layouts have them from detection, in the unit of the problem.
  parts.arms = summary.layout == ContactLayout::mixed;
  parts.drift = summary.layout != ContactLayout::radial && has_vertices(scene);
  return parts;
}

}  // namespace scree
