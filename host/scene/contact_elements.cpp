#include "kernels/contact/contact_elements.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "host/scene/bodies_by_id.h"
#include "host/scene/compound.h"
#include "host/scene/particle_shapes.h"
#include "host/scene/scene_checks.h"
#include "host/scene/scene_summary.h"
#include "kernels/narrow_phase/pair_table.h"
#include "kernels/narrow_phase/wall_images.h"

namespace scree {

namespace {

int bits_of(ShapeKind a, ShapeKind b) {
  const PairEntry* pair = find_pair(a, b);
  return pair == nullptr ? 0 : pair->feature_bits;
}

/// Bodies, compounds as often as they have parts.
std::uint64_t count_parts(const Scene& scene) {
  std::uint64_t count = 0;
  for_each_by_id(
      scene,
      [&](std::size_t, const BodyDescription& body) { count += part_count_of(scene, body.shape); },
      [&](std::size_t, const ParticleSet& set) {
        for (const auto& [kind, parts] : part_shape_counts(scene, set)) count += parts;
      });
  return count;
}

/// Shapes of parts of free bodies but for spheres, each with how many there are.
std::map<ShapeKind, std::size_t> free_shapes(const Scene& scene) {
  std::map<ShapeKind, std::size_t> count;
  for_each_by_id(
      scene,
      [&](std::size_t, const BodyDescription& body) {
        if (body.kind != BodyKind::free) return;
        for_each_part(scene, body.shape, [&](const Shape& part) {
          if (!shape_card(part.kind).is_ball) ++count[part.kind];
        });
      },
      [&](std::size_t, const ParticleSet& set) {
        for (const auto& [kind, particles] : part_shape_counts(scene, set))
          if (!shape_card(kind).is_ball) count[kind] += particles;
      });
  return count;
}

ContactElements count_elements(const Scene& scene) {
  ContactElements elements;
  elements.bodies = count_parts(scene);
  const std::map<ShapeKind, std::size_t> free = free_shapes(scene);
  for (const auto& [a, count] : free)
    for (const auto& [b, other] : free)
      if (a != b || count > 1)
        elements.feature_bits = std::max(elements.feature_bits, bits_of(a, b));
  Vec3d period;
  for (int k = 0; k < 3; ++k) period[k] = scene.periodicity.periodic[k] ? 1 : 0;
  const auto images = static_cast<std::uint64_t>(image_count(period));
  const auto add_wall = [&](const Shape& wall) {
    const ShapeCard& card = shape_card(wall.kind);
    if (card.is_ball) return;
    if (card.faces != nullptr) {
      elements.planes += card.faces(wall).size();
      return;
    }
    int bits = 0;
    for (const auto& [a, count] : free) bits = std::max(bits, bits_of(a, wall.kind));
    const TriangleMesh* mesh = has_hull(wall) ? nullptr : mesh_of(scene, wall);
    elements.solids +=
        images * (mesh ? mesh_slots(mesh->triangles.size(), bits) : std::uint64_t{1} << bits);
  };
  for (const BodyDescription& body : scene.bodies)
    if (body.kind != BodyKind::free) for_each_part(scene, body.shape, add_wall);
  return elements;
}

}  // namespace

std::optional<Fault> contact_elements_fault(const Scene& scene) {
  const ContactElements elements = count_elements(scene);
  if (elements.fit()) return {};
  const std::string why =
      elements.feature_bits == 0
          ? ""
          : " (because free bodies that are no spheres touch at several points)";
  return Fault{
      "bodies",
      fmt::format("{} bodies with {} faces and {} elements of solid walls", elements.bodies,
                  elements.planes, elements.solids),
      fmt::format("one run has 2^32 names of contacts; a body takes {}{}, a face {}, a solid "
                  "wall one for each triangle and each periodic image",
                  1 << elements.feature_bits, why, kPlaneSlots)};
}

}  // namespace scree
