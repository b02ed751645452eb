// What elastic bodies and their attachments may be.

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "dynamics/dynamics_card.h"
#include "host/scene/scene_checks.h"
#include "kernels/bodies/range.h"

namespace scree {
namespace {

/// Moduli of what there is are below 1e13 Pa.
constexpr double kLargestModulus = 1e15;

bool is_elastic(const BodyDescription& body) { return body.elastic->young_modulus != 0; }

}  // namespace

std::optional<Fault> elasticity_fault(const Scene& scene, const BodyDescription& body) {
  if (!is_elastic(body)) return std::nullopt;
  const double young = body.elastic->young_modulus, poisson = body.elastic->poisson_ratio;
  const DynamicsCard* card = find_dynamics(scene.dynamics.type);
  const std::string modulus = fmt::format("{:g}", young);
  if (card == nullptr || !card->bodies_may_be_elastic)
    return Fault{"elastic.young_modulus", modulus,
                 fmt::format("must be absent: bodies of the dynamics \"{}\" are not elastic",
                             scene.dynamics.type)};
  if (!(young > 0 && young <= kLargestModulus))
    return Fault{"elastic.young_modulus", modulus,
                 fmt::format("must be positive, {:g} at most [Pa]", kLargestModulus)};
  if (!(poisson > -1 && poisson < 0.5))
    return Fault{"elastic.poisson_ratio", fmt::format("{:g}", poisson),
                 "must be above -1 and below 0.5 [-]"};
  if (body.kind != BodyKind::free)
    return Fault{"elastic.young_modulus", modulus, "must be absent: only free bodies are elastic"};
  const TriangleMesh* mesh = mesh_of(scene, body.shape);
  if (mesh == nullptr || mesh->tetrahedra.empty())
    return Fault{"elastic.young_modulus", modulus,
                 "must be absent: only bodies whose mesh has tetrahedra (.msh, .vtk) are elastic"};
  if (body.locks != 0)
    return Fault{"lock", "a lock", "must be absent: attach an elastic body to hold it"};
  if (norm2(body.load->torque) > 0)
    return Fault{"torque", vector_text(body.load->torque),
                 "must be absent: an elastic body has no torque of its own"};
  return std::nullopt;
}

std::optional<Fault> attachment_fault(const Scene& scene, const Attachment& attachment) {
  const auto count = static_cast<int>(scene.bodies.size());
  const auto body = [&](int k) -> const BodyDescription& {
    return scene.bodies[static_cast<std::size_t>(k)];
  };
  if (attachment.body < 0 || attachment.body >= count || !is_elastic(body(attachment.body)))
    return Fault{"body", fmt::format("{}", attachment.body), "must be an elastic body"};
  if (attachment.to != kWorldBody &&
      (attachment.to < 0 || attachment.to >= count || is_elastic(body(attachment.to))))
    return Fault{"to", fmt::format("{}", attachment.to),
                 "must be a body that is not elastic, or \"world\""};
  for (const Vec3d& corner : {attachment.low, attachment.high})
    if (!is_finite(corner) || !is_in_range(corner))
      return Fault{
          "box", vector_text(corner),
          fmt::format("must be three numbers from {:g} to {:g} [m]", -kFarthest, kFarthest)};
  for (int k = 0; k < 3; ++k)
    if (!(attachment.low[k] <= attachment.high[k]))
      return Fault{
          "box",
          fmt::format("{} before {}", vector_text(attachment.low), vector_text(attachment.high)),
          "must be the lower corner and then the upper one"};
  return std::nullopt;
}

std::optional<Fault> attachments_fault(const Scene& scene) {
  for (std::size_t k = 0; k < scene.attachments.size(); ++k)
    if (auto fault = attachment_fault(scene, scene.attachments[k]))
      return Fault{fmt::format("attachments[{}].{}", k, fault->field), fault->value,
                   fault->expected};
  std::set<int> meshes;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    if (is_elastic(scene.bodies[b]) && !meshes.insert(scene.bodies[b].shape.mesh).second)
      return Fault{fmt::format("bodies[{}].mesh", b), fmt::format("{}", scene.bodies[b].shape.mesh),
                   "must be its own: another elastic body has it"};
  return std::nullopt;
}

}  // namespace scree
