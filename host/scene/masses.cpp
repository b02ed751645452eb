// Masses and moments of bodies from the densities of their materials.

#include <fmt/format.h>

#include <cmath>

#include "host/error.h"
#include "host/scene/particle_shapes.h"
#include "host/scene/scene_checks.h"
#include "shapes/shape_card.h"
#include "shapes/sphere.h"

namespace scree {
namespace {

void set_mass(BodyDescription& body, double density) {
  const ShapeCard& card = shape_card(body.shape.kind);
  const MassProperties solid =
      (card.mass != nullptr ? card.mass : card.mass_inside)(body.shape, density);
  body.mass = solid.mass;
  body.inertia = solid.inertia;
}

}  // namespace

void set_mass_from_density(BodyDescription& body, double density) {
  const auto refuse = [&](const std::string& expected) {
    throw InputError(fault_text("density", fmt::format("{}", density), expected));
  };
  if (!(std::isfinite(density) && density > 0)) refuse("must be positive [kg/m^3]");
  if (!is_shape(body.shape.kind)) refuse("a body without a shape has no mass");
  if (!shape_card(body.shape.kind).may_be_free_where(body.shape.volume > 0))
    refuse(fmt::format("only {} bodies have a mass", shape_names(&ShapeCard::may_be_free, " or ")));
  set_mass(body, density);
}

BodyDescription particle_body(const ParticleSet& set, std::size_t i) {
  BodyDescription body;
  body.shape = particle_shape(set, i);
  body.position = set.position[i];
  body.orientation = set.orientation[i];
  body.velocity = set.velocity[i];
  body.angular_velocity = set.angular_velocity[i];
  body.material = set.material[i];
  body.group = set.group[i];
  body.locks = set.locks;
  const double mass = set.mass[i];
  if (mass == 0) {
    set_mass(body, set.density[i]);
  } else {
    // Moments of a solid body of that mass: they are proportional to the density.
    set_mass(body, 1.0);
    body.inertia *= mass / body.mass;
    body.mass = mass;
  }
  return body;
}

double particle_mass(const ParticleSet& set, std::size_t i) {
  if (set.mass[i] != 0) return set.mass[i];
  if (particle_kind(set, i) == shapes::Sphere::kind)
    return shapes::Sphere::mass_of(set.radius[i], set.density[i]);
  const Shape shape = particle_shape(set, i);
  return shape_card(shape.kind).mass(shape, set.density[i]).mass;
}

}  // namespace scree
