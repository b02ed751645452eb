// Meshes of a scene, and whether they are what their bodies need.

#include <fmt/format.h>

#include <cmath>
#include <set>
#include <tuple>

#include "host/error.h"
#include "host/scene/bodies_by_id.h"
#include "host/scene/compound.h"
#include "host/scene/convex_hull.h"
#include "host/scene/free_mesh.h"
#include "host/scene/particle_shapes.h"
#include "host/scene/scene_checks.h"
#include "shapes/polyhedron.h"

namespace scree {

void check_meshes(const Scene& scene) {
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const TriangleMesh& mesh = scene.meshes[m];
    const std::string path = fmt::format("meshes[{}] ({})", m, mesh.name);
    const int count = static_cast<int>(mesh.vertices.size());
    if (mesh.triangles.empty())
      refuse_value(path, "an empty mesh", "must hold one triangle or more");
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
      if (!is_finite(mesh.vertices[v]))
        refuse_value(fmt::format("{}.vertices[{}]", path, v), vector_text(mesh.vertices[v]),
                     "must be three finite numbers [m]");
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (const int v : mesh.triangles[t])
        if (v < 0 || v >= count)
          refuse_value(fmt::format("{}.triangles[{}]", path, t), fmt::format("{}", v),
                       fmt::format("must be a vertex index below {}", count));
  }
}

void check_hulls(const Scene& scene) {
  std::set<std::tuple<int, bool, long long>> seen;
  const auto check_one = [&](const Shape& shape, bool is_free, const auto& check_again) {
    if (!is_shape(shape.kind)) return;
    const bool is_hull = has_hull(shape);
    const bool is_compound = shape_card(shape.kind).is_compound;
    const bool is_solid = is_free && shape_card(shape.kind).mass_inside != nullptr;
    const TriangleMesh* mesh = is_hull || is_compound || is_solid ? mesh_of(scene, shape) : nullptr;
    if (mesh == nullptr) return;
    // Bodies of all sizes have one mesh, with one rounding relative to it.
    const double core = core_half_extents(shape).x;
    const double part = core > 0 ? shape.rounded.radius / core : 0;
    if (!seen.emplace(shape.mesh, is_free, std::llround(1e6 * part)).second) return;
    const auto fault = is_hull    ? hull_fault(*mesh, is_free, part * box_about(*mesh).x)
                       : is_solid ? free_mesh_fault(*mesh)
                                  : compound_fault(scene, *mesh);
    if (fault)
      refuse_value(fmt::format("meshes[{}] ({})", shape.mesh, mesh->name), "a mesh that " + *fault,
                   is_hull    ? "must be that of a hull: set_hull() makes one"
                   : is_solid ? "must be that of a free body: set_free_mesh() makes one"
                              : "must be that of a compound: set_compound() makes one");
    for (const ShapePart& part : mesh->parts) check_again(part.shape, true, check_again);
  };
  const auto check = [&](const Shape& shape, bool is_free) {
    check_one(shape, is_free, check_one);
  };
  for_each_by_id(
      scene,
      [&](std::size_t, const BodyDescription& body) {
        check(body.shape, body.kind == BodyKind::free);
      },
      [&](std::size_t, const ParticleSet& set) {
        if (set.shape.uniform() && set.shape[0].kind == kNoShape) return;
        for (std::size_t i = 0; i < set.position.size(); ++i) check(set.shape[i], true);
      });
}

}  // namespace scree
