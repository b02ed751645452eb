#include "host/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "dynamics/dynamics_card.h"
#include "host/error.h"
#include "host/io/printable.h"
#include "host/scene/bodies_by_id.h"
#include "host/scene/compound.h"
#include "host/scene/convex_hull.h"
#include "host/scene/free_mesh.h"
#include "host/scene/particle_shapes.h"
#include "host/scene/scene_checks.h"
#include "host/scene/scene_summary.h"
#include "kernels/bodies/range.h"
#include "kernels/narrow_phase/pair_table.h"
#include "shapes/half_space.h"
#include "shapes/sphere.h"
#include "solvers/solver_card.h"

namespace scree {

std::string fault_text(const std::string& path, const std::string& value,
                       const std::string& expected) {
  return fmt::format("{}: {} is not allowed: {}", path, value, expected);
}

void refuse_value(const std::string& path, const std::string& value, const std::string& expected) {
  throw InputError(fault_text(path, value, expected));
}

std::string value_text(double value) { return fmt::format("{}", value); }
std::string value_text(const Vec3d& value) { return vector_text(value); }

namespace {

constexpr double kMostOfSum = 1.005;  // the largest moment over half of all three, with rounding

std::string quoted(const std::string& s) { return '"' + s + '"'; }

// Written so that NaN fails.
bool is_positive(double x) { return std::isfinite(x) && x > 0; }
bool is_non_negative(double x) { return std::isfinite(x) && x >= 0; }
bool is_positive(const Vec3d& v) {
  return is_positive(v.x) && is_positive(v.y) && is_positive(v.z);
}

void check_positive(const std::string& path, double value, const char* unit) {
  if (!is_positive(value))
    refuse_value(path, value_text(value), fmt::format("must be positive [{}]", unit));
}
void check_non_negative(const std::string& path, double value, const char* unit) {
  if (!is_non_negative(value))
    refuse_value(path, value_text(value), fmt::format("must be zero or positive [{}]", unit));
}
void check_finite(const std::string& path, const Vec3d& value, const char* unit) {
  if (!is_finite(value))
    refuse_value(path, value_text(value), fmt::format("must be three finite numbers [{}]", unit));
}
void check_one_of(const std::string& path, const std::string& value,
                  const std::vector<std::string>& known) {
  std::string list;
  for (const std::string& name : known) {
    if (value == name) return;
    list += (list.empty() ? "" : ", ") + quoted(name);
  }
  refuse_value(path, quoted(value), "must be one of " + list);
}

bool is_wall_shape(const ShapeCard& card) { return !card.may_be_free(); }

std::optional<Fault> shape_fault(const Scene& scene, const BodyDescription& body) {
  const Shape& shape = body.shape;
  if (!is_shape(shape.kind))
    return Fault{"shape", fmt::format("number {}", static_cast<int>(shape.kind)),
                 "must be one of " + shape_names([](const ShapeCard&) { return true; }, " or ")};
  const ShapeCard& card = shape_card(shape.kind);
  if ((card.has_mesh || has_hull(shape)) && mesh_of(scene, shape) == nullptr)
    return Fault{"mesh", fmt::format("{}", shape.mesh),
                 fmt::format("must be an index below {}", scene.meshes.size())};
  if (auto fault = card.fault(shape)) return fault;
  if (card.is_hull && !(shape.volume > 0))
    return Fault{"volume", value_text(shape.volume), "must be positive: set_hull() gives it [m^3]"};
  if (card.is_compound && !(shape.volume > 0))
    return Fault{"volume", value_text(shape.volume),
                 "must be positive: set_compound() gives it [m^3]"};
  if (body.kind != BodyKind::free || card.may_be_free()) return std::nullopt;
  if (!card.may_be_free_where(meshes_may_be_free(scene)))
    return Fault{
        "kind", "\"free\"",
        fmt::format("only {} bodies can be free; {} bodies must be \"fixed\" or \"kinematic\"",
                    shape_names(&ShapeCard::may_be_free, " or "), shape_names(is_wall_shape))};
  if (!(shape.volume > 0))
    return Fault{"volume", value_text(shape.volume),
                 "must be positive: set_free_mesh() gives it [m^3]"};
  return std::nullopt;
}

/// What a model of dynamics must know, or bodies cannot have it.
std::optional<Fault> own_fault(const Scene& scene, const BodyDescription& body) {
  const DynamicsCard* card = find_dynamics(scene.dynamics.type);
  const std::string model = fmt::format("the dynamics \"{}\"", scene.dynamics.type);
  if (body.collision_group < kNoCollisionGroup || body.collision_group >= kRestingGroup)
    return Fault{"collision_group", fmt::format("{}", body.collision_group),
                 fmt::format("must be from 0 to {}, or -1 for none", kRestingGroup - 1)};
  if (body.collision_group != kNoCollisionGroup && !(card != nullptr && card->has_collision_groups))
    return Fault{"collision_group", fmt::format("{}", body.collision_group),
                 "must be absent: " + model + " has no such groups"};
  struct Part {
    const char* key;
    Vec3d value;
    const char* unit;
  };
  for (const auto& [key, value, unit] :
       {Part{"force", body.load->force, "N"}, Part{"torque", body.load->torque, "N m"}}) {
    if (!is_finite(value))
      return Fault{key, value_text(value), fmt::format("must be three finite numbers [{}]", unit)};
    if (!(norm2(value) > 0)) continue;
    if (!(card != nullptr && card->has_loads))
      return Fault{key, value_text(value),
                   "must be absent: bodies of " + model + " have no such load"};
    if (body.kind != BodyKind::free)
      return Fault{key, value_text(value), "must be absent: only free bodies have it"};
  }
  return std::nullopt;
}

}  // namespace

std::optional<Fault> body_fault(const Scene& scene, const BodyDescription& body) {
  if (auto fault = shape_fault(scene, body)) return fault;
  if (!is_finite(body.position))
    return Fault{"position", value_text(body.position), "must be three finite numbers [m]"};
  if (auto fault = turn_fault("orientation", body.orientation)) return fault;
  if (!is_finite(body.velocity))
    return Fault{"velocity", value_text(body.velocity), "must be three finite numbers [m/s]"};
  if (!is_finite(body.angular_velocity))
    return Fault{"angular_velocity", value_text(body.angular_velocity),
                 "must be three finite numbers [rad/s]"};
  if (body.kind == BodyKind::free) {
    if (!is_positive(body.mass))
      return Fault{"mass", value_text(body.mass), "a free body needs a positive mass [kg]"};
    if (!is_positive(body.inertia))
      return Fault{"inertia", value_text(body.inertia),
                   "a free body needs three positive principal moments [kg m^2]"};
    const Vec3d& i = body.inertia;
    if (2 * std::max({i.x, i.y, i.z}) > kMostOfSum * (i.x + i.y + i.z))
      return Fault{"inertia", value_text(i),
                   "must have no moment larger than the sum of the other two, as no body has [kg "
                   "m^2]"};
  }
  const bool moving = norm2(body.velocity) > 0 || norm2(body.angular_velocity) > 0;
  if (body.kind == BodyKind::fixed && moving)
    return Fault{"velocity", value_text(body.velocity),
                 "a fixed body does not move; make it \"kinematic\" and give it a motion"};
  if (body.material < 0 || body.material >= static_cast<int>(scene.materials.size()))
    return Fault{"material", fmt::format("{}", body.material),
                 fmt::format("must be an index below {}", scene.materials.size())};
  if (body.group < 0 || body.group >= static_cast<int>(scene.groups.size()))
    return Fault{"group", fmt::format("{}", body.group),
                 fmt::format("must be an index below {}", scene.groups.size())};
  if (body.locks > lock_all)
    return Fault{"lock", fmt::format("{}", body.locks), "must be bits 0 to 5"};
  if (auto fault = motion_fault(body, scene.stepping.time_step)) return fault;
  if (auto fault = own_fault(scene, body)) return fault;
  if (auto fault = elasticity_fault(scene, body)) return fault;
  return range_fault(scene, body);
}

namespace {

void check_material(const std::string& path, const Material& m) {
  check_non_negative(path + ".friction", m.friction, "-");
  if (!(m.restitution >= 0 && m.restitution <= 1))
    refuse_value(path + ".restitution", value_text(m.restitution), "must be from 0 to 1 [-]");
  check_non_negative(path + ".cohesion", m.cohesion, "N");
  check_non_negative(path + ".rolling_friction", m.rolling_friction, "m");
  check_non_negative(path + ".spinning_friction", m.spinning_friction, "m");
}

void check_materials(const Scene& scene) {
  const int count = static_cast<int>(scene.materials.size());
  if (count == 0) refuse_value("materials", "an empty list", "must hold one material or more");
  if (scene.materials.size() > kMostMaterials)
    refuse_value("materials", fmt::format("a list of {} materials", count),
                 fmt::format("must hold {} or fewer", kMostMaterials));
  for (const Material& m : scene.materials) check_material("materials." + m.name, m);
  std::map<std::pair<int, int>, std::size_t> listed;
  for (std::size_t i = 0; i < scene.material_pairs.size(); ++i) {
    const MaterialPair& pair = scene.material_pairs[i];
    const std::string path = fmt::format("material_pairs[{}]", i);
    for (const int m : {pair.material_a, pair.material_b})
      if (m < 0 || m >= count)
        refuse_value(path + ".between", fmt::format("{}", m),
                     fmt::format("must be an index below {}", count));
    check_material(path, pair.values);
    const std::pair<int, int> ends = std::minmax(pair.material_a, pair.material_b);
    const auto [first, is_new] = listed.emplace(ends, i);
    if (!is_new)
      refuse_value(path + ".between",
                   fmt::format("[\"{}\", \"{}\"]", scene.materials[pair.material_a].name,
                               scene.materials[pair.material_b].name),
                   fmt::format("material_pairs[{}] is the same pair", first->second));
  }
}

/// The name is that of a folder inside out/, and is printed.
void check_name(const std::string& name) {
  constexpr std::size_t kMaxNameBytes = 200;  // bytes, below what file systems allow
  const auto is_bad = [](char c) {
    return static_cast<unsigned char>(c) < 0x20 || c == 0x7f || c == '/' || c == '\\';
  };
  if (name.empty() || name.size() > kMaxNameBytes || name == "." || name == ".." ||
      std::any_of(name.begin(), name.end(), is_bad))
    refuse_value("name", quoted(printable(name, 80)),
                 fmt::format("must be fit for a folder: 1 to {} bytes without slashes and control "
                             "characters, not . or ..",
                             kMaxNameBytes));
}

void check_solver_parameters(const ParameterValues& values) {
  std::vector<std::string> known;
  for (const auto& [parameter, solvers] : solver_parameters()) {
    known.emplace_back(parameter.key);
    const double value = parameter.of(values);
    if (!parameter.allows(value))
      refuse_value(fmt::format("solver.{}", parameter.key), parameter.text(value),
                   parameter.expected());
  }
  for (const auto& [key, value] : values) check_one_of("solver.parameters", key, known);
}

void check_dynamics(const Scene& scene) {
  const DynamicsSettings& dynamics = scene.dynamics;
  check_one_of("dynamics.type", dynamics.type, dynamics_names());
  const DynamicsCard& card = dynamics_card(dynamics.type);
  std::vector<std::string> known;
  for (const SolverParameter& parameter : card.parameters) {
    known.emplace_back(parameter.key);
    const double value = parameter.of(dynamics.parameters);
    if (!parameter.allows(value))
      refuse_value(fmt::format("dynamics.{}", parameter.key), parameter.text(value),
                   parameter.expected());
  }
  for (const auto& [key, value] : dynamics.parameters)
    check_one_of("dynamics.parameters", key, known);
  if (card.check != nullptr) card.check(scene);
}

void check_settings(const Scene& scene) {
  check_name(scene.name);
  check_one_of("backend", scene.backend, {"auto", "cpu", "cuda"});
  check_one_of("precision", scene.precision, {"float", "double"});
  check_finite("gravity", scene.gravity, "m/s^2");

  const SteppingSettings& stepping = scene.stepping;
  check_positive("time_step", stepping.time_step, "s");
  check_non_negative("duration", stepping.duration, "s");
  check_non_negative("stepping.max_recovery_speed", stepping.max_recovery_speed, "m/s");
  check_non_negative("stepping.restitution_threshold", stepping.restitution_threshold, "m/s");
  if (!std::isfinite(stepping.envelope))
    refuse_value("collision.envelope", value_text(stepping.envelope),
                 "must be a finite number [m]");
  if (!std::isfinite(stepping.skin))
    refuse_value("collision.skin", value_text(stepping.skin), "must be a finite number [m]");

  const SolverSettings& solver = scene.solver;
  check_one_of("solver.name", solver.name, solver_names());
  if (solver.stop.level == StopRule::Level::absolute)
    check_positive("solver.stop", solver.stop.residual, "m/s");
  check_positive("solver.max_iterations", solver.max_iterations, "-");
  check_positive("solver.check_every", solver.check_every, "-");
  check_positive("solver.max_outer_iterations", solver.max_outer_iterations, "-");
  check_solver_parameters(solver.parameters);

  const OutputSettings& output = scene.output;
  check_non_negative("output.frame_interval", output.frame_interval, "s");
  check_non_negative("output.checkpoint_interval", output.checkpoint_interval, "s");
  check_non_negative("output.force_interval", output.force_interval, "s");
  const DynamicsCard& card = dynamics_card(scene.dynamics.type);
  const std::string no_contacts =
      fmt::format("the dynamics \"{}\" tells of no contacts", card.name);
  if (output.force_interval > 0 && !card.has_contacts)
    refuse_value("output.force_interval", value_text(output.force_interval),
                 "must be 0: " + no_contacts);
  if (output.contact_frames && !card.has_contacts)
    refuse_value("output.contact_frames", "true", "must be false: " + no_contacts);
  if (output.surface_frames && output.frame_pieces)
    refuse_value(
        "output.surface_frames", "true",
        "must be false with output.frame_pieces: surfaces are written by one rank, from the "
        "states of all bodies");
  check_picture(output.picture);
}

/// Calls f(body, path maker) for the bodies that are described one by one, those of
/// insertions included.
template <class F>
void for_each_body(const Scene& scene, F f) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    f(scene.bodies[i], [i] { return fmt::format("bodies[{}]", i); });
  for (std::size_t k = 0; k < scene.insertions.size(); ++k) {
    const auto& bodies = scene.insertions[k].bodies;
    for (std::size_t i = 0; i < bodies.size(); ++i)
      f(bodies[i], [k, i] { return fmt::format("insertions[{}].bodies[{}]", k, i); });
  }
}

/// What a body meets of a shape.
ShapeKind met_shape(ShapeKind kind) {
  return shape_card(kind).faces != nullptr ? shapes::HalfSpace::kind : kind;
}

/// Bodies of two shapes without a pair function would pass through each other without a word. Where
/// surfaces meet, there are no such functions.
void check_pairs(const Scene& scene) {
  if (meshes_may_be_free(scene)) return;
  struct Place {
    std::string path;
    std::size_t count = 0;
  };
  std::map<ShapeKind, Place> free, walls;
  const auto add = [](std::map<ShapeKind, Place>& places, ShapeKind kind, std::size_t count,
                      auto path) {
    Place& place = places[kind];
    if (place.count == 0) place.path = path();
    place.count += count;
  };
  for_each_body(scene, [&](const BodyDescription& body, auto path) {
    for_each_part(scene, body.shape, [&](const Shape& part) {
      add(body.kind == BodyKind::free ? free : walls, part.kind, 1, path);
    });
  });
  for_each_by_id(
      scene, [](std::size_t, const BodyDescription&) {},
      [&](std::size_t, const ParticleSet& set) {
        for (const auto& [kind, count] : part_shape_counts(scene, set))
          add(free, kind, count, [&set] {
            return set.entry < 0 ? "particles" : fmt::format("particles[{}]", set.entry);
          });
      });
  const auto require = [](ShapeKind a, const Place& at_a, ShapeKind b, const Place& at_b) {
    if (find_pair(a, met_shape(b)) != nullptr) return;
    const char *name_a = shape_card(a).name, *name_b = shape_card(b).name;
    refuse_value(at_a.path, fmt::format("a free {}", name_a),
                 fmt::format("it could meet the {} {}, and contact between a {} and a {} is not "
                             "available yet; a free {} may meet {}",
                             name_b, at_b.path, name_a, name_b, name_a,
                             shape_names([a](const ShapeCard& card) {
                               return find_pair(a, met_shape(card.kind)) != nullptr;
                             })));
  };
  for (const auto& [a, at_a] : free) {
    for (const auto& [b, at_b] : walls) require(a, at_a, b, at_b);
    for (const auto& [b, at_b] : free)
      if (a < b || (a == b && at_a.count > 1)) require(b, at_b, a, at_a);
  }
}

void check_insertions(const Scene& scene) {
  for (std::size_t k = 0; k < scene.insertions.size(); ++k) {
    const Insertion& insertion = scene.insertions[k];
    const std::string path = fmt::format("insertions[{}]", k);
    check_non_negative(path + ".time", insertion.time, "s");
    if (k > 0 && insertion.time <= scene.insertions[k - 1].time)
      refuse_value(path + ".time", value_text(insertion.time),
                   "must be later than the insertion before [s]");
    for (std::size_t i = 0; i < insertion.bodies.size(); ++i)
      if (insertion.bodies[i].kind != BodyKind::free)
        refuse_value(fmt::format("{}.bodies[{}].kind", path, i), "a fixed or kinematic body",
                     "only free bodies can be inserted during a run");
  }
}

void check_count(const std::string& path, bool fits, std::size_t count) {
  if (!fits)
    refuse_value(path, "a list of another length",
                 fmt::format("must be one value for all, or one for each of {} particles", count));
}

/// What the list of bodies cannot say of a particle: that it is free, and how large.
std::optional<Fault> particle_fault(const Scene& scene, const ParticleSet& set, std::size_t i) {
  BodyDescription body;
  body.shape = particle_shape(set, i);
  if (auto fault = shape_fault(scene, body)) return fault;
  const double radius = bounding_radius(scene, body);
  if (set.radius[i] == radius) return std::nullopt;
  return Fault{"radius", value_text(set.radius[i]),
               fmt::format("must be that of the bounding sphere, {} [m]", radius)};
}

void check_particles(const Scene& scene, const ParticleSet& set, const std::string& path) {
  const std::size_t count = set.position.size();
  check_count(path + ".radius", set.radius.fits(count), count);
  check_count(path + ".shape", set.shape.fits(count), count);
  check_count(path + ".density", set.density.fits(count), count);
  check_count(path + ".mass", set.mass.fits(count), count);
  check_count(path + ".orientation", set.orientation.fits(count), count);
  check_count(path + ".velocity", set.velocity.fits(count), count);
  check_count(path + ".angular_velocity", set.angular_velocity.fits(count), count);
  check_count(path + ".material", set.material.fits(count), count);
  check_count(path + ".group", set.group.fits(count), count);
  const bool uniform = set.radius.uniform() && set.shape.uniform() && set.density.uniform() &&
                       set.mass.uniform() && set.orientation.uniform() && set.velocity.uniform() &&
                       set.angular_velocity.uniform() && set.material.uniform() &&
                       set.group.uniform();
  const bool spheres = are_spheres(set);
  for (std::size_t i = 0; i < count; ++i) {
    if (i > 0 && uniform && is_in_range(set.position[i])) continue;  // as good as the first
    auto fault = spheres ? std::nullopt : particle_fault(scene, set, i);
    if (!fault) fault = body_fault(scene, particle_body(set, i));
    if (fault)
      refuse_value(fmt::format("{}[{}].{}", path, i, fault->field), fault->value, fault->expected);
  }
}

void check_all_particles(const Scene& scene) {
  for (std::size_t i = 0; i < scene.particles.size(); ++i)
    check_particles(scene, scene.particles[i], fmt::format("particles[{}]", i));
  for (std::size_t k = 0; k < scene.insertions.size(); ++k) {
    const auto& sets = scene.insertions[k].particles;
    for (std::size_t i = 0; i < sets.size(); ++i)
      check_particles(scene, sets[i], fmt::format("insertions[{}].particles[{}]", k, i));
  }
}

void check_bodies(const Scene& scene) {
  for_each_body(scene, [&](const BodyDescription& body, auto path) {
    if (const auto fault = body_fault(scene, body))
      refuse_value(fault->field.empty() ? path() : path() + "." + fault->field, fault->value,
                   fault->expected);
  });
  check_all_particles(scene);
  const BodyCounts count = count_bodies(scene);
  if (count.free == 0)
    refuse_value("bodies", fmt::format("a scene of {} bodies, none free", count.all()),
                 "must hold one free body or more, in bodies, particles or insertions");
  if (count.all() > static_cast<std::size_t>(std::numeric_limits<Index>::max()))
    refuse_value("bodies", fmt::format("{} bodies", count.all()), "must be below 2^31");
}

void check_periodicity(const Scene& scene) {
  const Periodicity& box = scene.periodicity;
  if (!box.periodic[0] && !box.periodic[1] && !box.periodic[2]) return;
  const SceneSummary summary = summarize(scene);
  const double needed = 2 * (summary.largest_diameter + summary.envelope);
  for (int k = 0; k < 3; ++k) {
    if (!box.periodic[k]) continue;
    const std::string path = fmt::format("periodic.{}", "xyz"[k]);
    const std::string value = fmt::format("[{}, {}]", box.lower[k], box.upper[k]);
    const double extent = box.upper[k] - box.lower[k];
    if (!is_positive(extent))
      refuse_value(path, value, "must be two finite numbers, the smaller first");
    if (extent < needed)
      refuse_value(
          path, value,
          fmt::format("must span at least {:.6g} m: twice the largest free body and the contact "
                      "envelope, so that two bodies meet through one image only; what spans the "
                      "domain must be fixed or kinematic",
                      needed));
  }
  for_each_body(scene, [&](const BodyDescription& body, auto path) {
    if (const auto fault = periodic_wall_fault(scene, body))
      refuse_value(fault->field.empty() ? path() : path() + "." + fault->field, fault->value,
                   fault->expected);
  });
}

void check_body_names(const Scene& scene) {
  const BodyCounts count = count_bodies(scene);
  for (const auto& [name, id] : scene.body_names) {
    if (name.empty()) refuse_value("body_names", "an empty name", "must have a letter or more");
    if (name == kWorldName)
      refuse_value("body_names", quoted(name), "stands for what bodies are fixed to");
    if (id < 0 || static_cast<std::size_t>(id) >= count.free + count.fixed)
      refuse_value(fmt::format("body_names[{}]", quoted(printable(name, 80))),
                   fmt::format("{}", id),
                   fmt::format("must be the id of one of {} bodies", count.free + count.fixed));
  }
}

}  // namespace

void require_no_insertions(const Scene& scene, const std::string& why) {
  if (scene.insertions.empty()) return;
  const Insertion& first = scene.insertions[0];
  const std::string time = value_text(first.time);
  if (!first.bodies.empty() && first.bodies[0].entry >= 0)
    refuse_value(fmt::format("bodies[{}].insert_at", first.bodies[0].entry), time,
                 "must be missing: " + why);
  if (!first.particles.empty() && first.particles[0].entry >= 0)
    refuse_value(fmt::format("particles[{}]", first.particles[0].entry),
                 fmt::format("a batch that joins at {} s", time),
                 "must be of another layout: " + why);
  refuse_value("insertions", fmt::format("a list of {}", scene.insertions.size()),
               "must be empty: " + why);
}

void check_picture(const PictureSettings& picture) {
  if (!std::isfinite(picture.interval))
    refuse_value("output.picture.interval", value_text(picture.interval),
                 "must be a finite number [s]");
  for (const auto& [key, pixels] : {std::pair{"width", picture.width}, {"height", picture.height}})
    if (pixels < 16 || pixels > 16384)
      refuse_value(std::string("output.picture.") + key, fmt::format("{}", pixels),
                   "must be from 16 to 16384 [pixels]");
  if (!std::isfinite(picture.color_min) || !(picture.color_max >= picture.color_min) ||
      !std::isfinite(picture.color_max))
    refuse_value("output.picture.color_range",
                 fmt::format("[{}, {}]", picture.color_min, picture.color_max),
                 "must be two finite numbers, the smaller first");
  const CameraSettings& camera = picture.camera;
  if (camera.automatic) return;
  check_finite("output.picture.camera.position", camera.position, "m");
  check_finite("output.picture.camera.target", camera.target, "m");
  check_finite("output.picture.camera.up", camera.up, "-");
  if (!(camera.vertical_angle > 0 && camera.vertical_angle < 170))
    refuse_value("output.picture.camera.vertical_angle_deg", value_text(camera.vertical_angle),
                 "must be between 0 and 170, both excluded [deg]");
  const Vec3d view = camera.target - camera.position;
  if (!(norm(view) > 0))
    refuse_value("output.picture.camera.target", value_text(camera.target),
                 "must differ from the position");
  if (!(norm(cross(normalized(view), normalized(camera.up, {0, 0, 0}))) > 1e-6))
    refuse_value("output.picture.camera.up", value_text(camera.up),
                 "must not be zero or parallel to the view direction");
}

void validate(const Scene& scene) {
  check_settings(scene);
  check_materials(scene);
  if (const auto fault = range_fault(scene))
    refuse_value(fault->field, fault->value, fault->expected);
  if (scene.groups.empty()) refuse_value("groups", "an empty list", "must hold one name or more");
  check_meshes(scene);
  check_hulls(scene);
  check_bodies(scene);
  check_insertions(scene);
  check_body_names(scene);
  if (const auto fault = room_fault(scene))
    refuse_value(fault->field, fault->value, fault->expected);
  check_pairs(scene);
  check_periodicity(scene);
  if (const auto fault = contact_elements_fault(scene))
    refuse_value(fault->field, fault->value, fault->expected);
  check_dynamics(scene);
  if (const auto fault = joints_fault(scene))
    refuse_value(fault->field, fault->value, fault->expected);
  if (const auto fault = attachments_fault(scene))
    refuse_value(fault->field, fault->value, fault->expected);
}

bool meshes_may_be_free(const Scene& scene) {
  const DynamicsCard* card = find_dynamics(scene.dynamics.type);
  return card != nullptr && card->meshes_may_be_free;
}

const TriangleMesh* mesh_of(const Scene& scene, const Shape& shape) {
  const bool has_one = shape.mesh >= 0 && shape.mesh < static_cast<int>(scene.meshes.size());
  return has_one ? &scene.meshes[static_cast<std::size_t>(shape.mesh)] : nullptr;
}

}  // namespace scree
