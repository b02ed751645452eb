#include "dynamics/variational/variational_card.h"

#include <fmt/format.h>

#include <array>

#include "dynamics/rigid/shared_constants.h"
#include "host/error.h"
#include "host/scene/bodies_by_id.h"
#include "host/scene/compound.h"
#include "host/scene/particle_shapes.h"
#include "host/scene/scene_checks.h"
#include "host/scene/scene_summary.h"
#include "kernels/variational/rigid_islands.h"
#include "shapes/shape_card.h"
#include "shapes/sphere.h"

namespace scree {
namespace {

std::string body_path(const BodyDescription& body, std::size_t id) {
  return body.entry >= 0 ? fmt::format("bodies[{}]", body.entry) : fmt::format("body {}", id);
}

void check_body(const BodyDescription& body, std::size_t id) {
  const ShapeCard& shape = shape_card(body.shape.kind);
  const std::string path = body_path(body, id);
  if (body.kind == BodyKind::kinematic)
    refuse_value(path + ".kind", "\"kinematic\"",
                 "must be free or fixed: walls of the dynamics \"variational\" rest");
  if (body.kind != BodyKind::free && shape.is_compound)
    refuse_value(
        path + ".shape", fmt::format("\"{}\"", shape.name),
        "must be one of its parts: walls of the dynamics \"variational\" are no compounds");
  if (body.kind == BodyKind::free && body.locks != 0)
    refuse_value(path + ".lock", fmt::format("{} locked axes", std::popcount(body.locks)),
                 "must be none: bodies of the dynamics \"variational\" move along all axes");
}

void check_set(const ParticleSet& set) {
  const std::string path = set.entry >= 0 ? fmt::format("particles[{}]", set.entry) : "particles";
  if (set.locks != 0)
    refuse_value(path + ".lock", fmt::format("{} locked axes", std::popcount(set.locks)),
                 "must be none: bodies of the dynamics \"variational\" move along all axes");
}

constexpr std::array<std::pair<const char*, double Material::*>, 4> kNoValues{
    {{"friction", &Material::friction},
     {"cohesion", &Material::cohesion},
     {"rolling_friction", &Material::rolling_friction},
     {"spinning_friction", &Material::spinning_friction}}};

/// Bytes of the parts of compounds, see PartStore, for each body.
double part_bytes_per_body(const Scene& scene) {
  double bodies = 0, parts = 0;
  bool has_compounds = false;
  const auto count = [&](const Shape& shape) {
    ++bodies;
    parts += static_cast<double>(part_count_of(scene, shape));
    has_compounds = has_compounds || shape_card(shape.kind).is_compound;
  };
  for_each_by_id(
      scene, [&](std::size_t, const BodyDescription& body) { count(body.shape); },
      [&](std::size_t, const ParticleSet& set) {
        Shape sphere;
        sphere.kind = shapes::Sphere::kind;
        const bool spheres = are_spheres(set);
        for (std::size_t i = 0; i < set.position.size(); ++i)
          count(spheres ? sphere : particle_shape(set, i));
      });
  constexpr double kPart = 5 * 4 + 2 * 8 + 2 + 24 + 32 + 3 * 24;
  return has_compounds ? kPart * parts / bodies : 0;
}

}  // namespace

void require_gravity_of_periods(const Periodicity& periodicity, const Vec3d& gravity) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double g = gravity[static_cast<int>(axis)];
    if (periodicity.periodic[axis] && g != 0)
      refuse_value(
          "gravity", vector_text(gravity),
          fmt::format("must be 0 along {}, which is periodic: the dynamics \"variational\" "
                      "keeps the energy of "
                      "bodies, and it would not be the same in all periods",
                      "xyz"[axis]));
  }
}

bool has_convex_bodies(const Scene& scene) {
  bool has = false;
  for_each_by_id(
      scene,
      [&](std::size_t, const BodyDescription& body) {
        has = has || (body.kind == BodyKind::free && !shape_card(body.shape.kind).is_ball);
      },
      [&](std::size_t, const ParticleSet& set) { has = has || !are_spheres(set); });
  return has;
}

void check_variational(const Scene& scene) {
  require_no_insertions(scene,
                        "all bodies of the dynamics \"variational\" are there from the start");
  require_no_values(scene, kNoValues,
                    "impacts of the dynamics \"variational\" are along the normal");
  for_each_by_id(
      scene, [](std::size_t id, const BodyDescription& body) { check_body(body, id); },
      [](std::size_t, const ParticleSet& set) { check_set(set); });
  require_gravity_of_periods(scene.periodicity, scene.gravity);
}

double variational_bytes_per_body(const Scene& scene, const WorldOptions&) {
  const SharedConstants shared = shared_constants(scene);
  const double constants = (shared.mass ? 0 : 8) + (shared.radius ? 0 : 8) +
                           (shared.spheres ? 0 : 4) + (shared.locks ? 0 : 1) +
                           (shared.material ? 0 : 1) + (shared.group ? 0 : 4) +
                           (summarize(scene).solid_spheres ? 0 : 24);
  constexpr double kState = 24 + 32 + 24 + 24 + 4, kAfter = 48;
  // Near pairs of a body, when it is listed farther than a diameter away, and what listing them takes at its fullest.
  constexpr double kPairs = 4, kLists = 24 + 8 + 16 + 8 * kPairs, kListing = 16 + 24 * kPairs;
  // One body in five is in an island, and there is room for half as many more.
  constexpr double kBeside = 24;  // what is sorted and linked beside a member
  constexpr double kIslands = 0.3 * (kBeside + sizeof(Member));
  // Ways and states after a step of bodies that turn; their members of islands are larger.
  constexpr double kTurning = sizeof(RigidPath) + 32 + 24 + 0.3 * (kBeside + sizeof(RigidMember));
  return kState + constants + kAfter + kLists + kListing + 16 +
         (has_convex_bodies(scene) ? kTurning + part_bytes_per_body(scene) : kIslands);
}

}  // namespace scree
