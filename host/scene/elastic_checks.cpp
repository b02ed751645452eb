// What elastic bodies and their attachments may be.

#include <fmt/format.h>

#include <map>
#include <set>

#include "dynamics/dynamics_card.h"
#include "host/scene/body_name.h"
#include "host/scene/scene_checks.h"
#include "kernels/bodies/range.h"

namespace scree {
namespace {

/// Moduli of what there is are below 1e13 Pa.
constexpr double kLargestModulus = 1e15;

/// Calls visit(corner) for those that an attachment holds. @return how many corners the body has
template <class Visit>
int for_each_held(const Scene& scene, const Attachment& attachment, Visit visit) {
  const BodyDescription& body = scene.bodies[static_cast<std::size_t>(attachment.body)];
  const TriangleMesh& mesh = *mesh_of(scene, body.shape);
  int corner = 0;
  for (const std::vector<Vec3d>* points : {&mesh.vertices, &mesh.inner}) {
    for (const Vec3d& v : *points) {
      if (attachment.holds(body.position + rotate(body.orientation, v))) visit(corner);
      ++corner;
    }
  }
  return corner;
}

}  // namespace

std::optional<Fault> elasticity_fault(const Scene& scene, const BodyDescription& body) {
  if (!body.elastic->is_on()) return std::nullopt;
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
  // Below zero the energy (31a) has no least value: tetrahedra fall together.
  if (!(poisson >= 0 && poisson < 0.5))
    return Fault{"elastic.poisson_ratio", fmt::format("{:g}", poisson),
                 "must be 0 or more and below 0.5 [-]"};
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
  if (attachment.body < 0 || attachment.body >= count || !body(attachment.body).elastic->is_on())
    return Fault{"body", fmt::format("{}", attachment.body), "must be an elastic body"};
  if (attachment.to != kWorldBody &&
      (attachment.to < 0 || attachment.to >= count || body(attachment.to).elastic->is_on()))
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
  std::map<int, std::set<int>> held;  // corners, by body
  const auto name = [&](int body) {
    return body_name(BodyConstants(scene), body, scene.body_names);
  };
  for (std::size_t k = 0; k < scene.attachments.size(); ++k) {
    const Attachment& each = scene.attachments[k];
    const std::string path = fmt::format("attachments[{}].", k);
    if (auto fault = attachment_fault(scene, each))
      return Fault{path + fault->field, fault->value, fault->expected};
    const std::size_t before = held[each.body].size();
    const int corners = for_each_held(scene, each, [&](int v) { held[each.body].insert(v); });
    if (held[each.body].size() == before)
      return Fault{path + "box",
                   fmt::format("{} to {}", vector_text(each.low), vector_text(each.high)),
                   fmt::format("must hold a corner of {} at the start that no attachment "
                               "before it holds",
                               name(each.body))};
    if (std::ssize(held[each.body]) == corners)
      return Fault{path + "box",
                   fmt::format("{} to {}", vector_text(each.low), vector_text(each.high)),
                   fmt::format("must leave a corner of {} loose", name(each.body))};
  }
  std::set<int> meshes;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    if (scene.bodies[b].elastic->is_on() && !meshes.insert(scene.bodies[b].shape.mesh).second)
      return Fault{fmt::format("bodies[{}].mesh", b), fmt::format("{}", scene.bodies[b].shape.mesh),
                   "must be its own: another elastic body has it"};
  return std::nullopt;
}

}  // namespace scree
