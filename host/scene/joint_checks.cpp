// What joints may hold, and what scenes with joints may not have.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dynamics/dynamics_card.h"
#include "host/scene/scene_checks.h"
#include "kernels/bodies/range.h"
#include "shapes/shape_card.h"

namespace scree {
namespace {

/// What the laws of contact must be, for those that meet in contacts.
std::optional<Fault> law_fault(const Scene& scene) {
  if (scene.solver.exact_coulomb)
    return Fault{"solver.model", "\"exact\" in a scene with joints",
                 "joints are solved with \"convex\" friction only so far"};
  const std::vector<Material> pairs = all_pair_values(scene);
  const bool bounces = std::any_of(pairs.begin(), pairs.end(),
                                   [](const Material& pair) { return pair.restitution > 0; });
  if (bounces && scene.stepping.restitution_law == RestitutionLaw::poisson)
    return Fault{
        "stepping.restitution_law", "\"poisson\" in a scene with joints and restitution",
        "impacts before the loads do not know joints yet; take \"newton\", or restitution 0"};
  return std::nullopt;
}

}  // namespace

std::optional<Fault> joint_fault(const Scene& scene, const Joint& joint) {
  const int count = static_cast<int>(scene.bodies.size());
  bool has_free = false;
  for (std::size_t k = 0; k < 2; ++k) {
    const int id = joint.bodies[k];
    if (id != kWorldBody && (id < 0 || id >= count))
      return Fault{fmt::format("bodies[{}]", k), fmt::format("{}", id),
                   fmt::format("must be an index of `bodies` below {}, or the world", count)};
    has_free = has_free || (id != kWorldBody &&
                            scene.bodies[static_cast<std::size_t>(id)].kind == BodyKind::free);
  }
  if (joint.bodies[0] == joint.bodies[1])
    return Fault{"bodies", "the same body twice", "must be two bodies"};
  if (!has_free)
    return Fault{"bodies", "a joint of two bodies that are not free",
                 "one of them must be free to follow the other"};
  if (!is_finite(joint.anchor) || !is_in_range(joint.anchor))
    return Fault{"anchor", vector_text(joint.anchor),
                 fmt::format("must be three numbers from {:g} to {:g} [m]", -kFarthest, kFarthest)};
  if (joint.kind == JointKind::hinge && !(std::abs(norm(joint.axis) - 1) <= 1e-6))
    return Fault{"axis", vector_text(joint.axis), "must have length 1"};
  return std::nullopt;
}

std::optional<Fault> joints_fault(const Scene& scene) {
  if (scene.joints.empty()) return std::nullopt;
  const DynamicsCard& card = dynamics_card(scene.dynamics.type);
  if (!card.has_joints)
    return Fault{"joints", fmt::format("a list of {}", scene.joints.size()),
                 fmt::format("bodies of the dynamics \"{}\" cannot be joined", card.name)};
  for (std::size_t k = 0; k < scene.joints.size(); ++k)
    if (auto fault = joint_fault(scene, scene.joints[k]))
      return Fault{fmt::format("joints[{}].{}", k, fault->field), fault->value, fault->expected};
  return card.has_contacts ? law_fault(scene) : std::nullopt;
}

}  // namespace scree
