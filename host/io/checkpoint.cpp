#include "host/io/checkpoint.h"

#include <fmt/format.h>

#include <algorithm>
#include <new>
#include <numeric>
#include <stdexcept>
#include <system_error>

#include "host/error.h"
#include "host/io/atomic_file.h"
#include "host/io/bodies_by_id.h"
#include "host/io/h5.h"
#include "host/io/seal.h"
#include "host/io/values.h"
#include "host/particle_table.h"
#include "host/version.h"

namespace scree {
namespace {

constexpr const char* format_name = "scree checkpoint";

/// What is stored per free body beside its state, in the same order.
struct StoredConstants {
  std::vector<double> radius;  ///< 0 unless a sphere [m]
  std::vector<double> mass;    ///< [kg]
  std::vector<std::int32_t> group;
};

/// Constants of the free bodies, picked by id from those of all bodies.
StoredConstants pick(const WorldState& state, const BodyConstants& all) {
  StoredConstants picked;
  for (const int id : state.id) {
    const auto i = static_cast<std::size_t>(id);
    if (id < 0 || i >= all.mass.size())
      throw RunError(fmt::format("cannot write a checkpoint: body id {} is not in the scene", id));
    picked.radius.push_back(all.shape[i] == Shape::Kind::sphere ? all.radius[i] : 0.0);
    picked.mass.push_back(all.mass[i]);
    picked.group.push_back(all.group[i]);
  }
  return picked;
}

BodyConstants constants_of(const Scene& scene) {
  BodyConstants all;
  for (const BodyDescription* body : bodies_by_id(scene)) {
    all.radius.push_back(body->shape.radius);
    all.mass.push_back(body->mass);
    all.group.push_back(body->group);
    all.kind.push_back(body->kind);
    all.shape.push_back(body->shape.kind);
  }
  return all;
}

/// All of a checkpoint, borrowed.
struct Contents {
  const std::string& scene_text;
  BackendKind backend;
  Precision precision;
  const WorldState& state;
  const StoredConstants& constants;
};

/// Reads one file; every complaint names it.
class Reader {
 public:
  explicit Reader(const std::filesystem::path& path) : path_(path) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status)) refuse("there is no such file");
    if (!std::filesystem::is_regular_file(status)) refuse("it is not a file");
  }

  Checkpoint read(StoredConstants* constants) const try {
    const std::string fault = check_seal(path_, format_name, checkpoint_format_version);
    if (!fault.empty()) refuse(fault);
    return read_all(h5::File::open(path_).root(), constants);
  } catch (const h5::Error& error) {
    refuse(error.what());
  } catch (const std::bad_alloc&) {
    refuse("its arrays do not fit in memory");
  } catch (const std::length_error&) {
    refuse("its arrays do not fit in memory");
  }

 private:
  [[noreturn]] void refuse(const std::string& found) const {
    throw InputError(
        fmt::format("cannot read checkpoint {}: {}; expected a {} of format version {}",
                    path_.string(), found, format_name, checkpoint_format_version));
  }

  /// An array of bodies or contacts that must have the given shape.
  template <class T>
  std::vector<T> array(const h5::Group& root, const std::string& name, std::uint64_t rows,
                       std::uint64_t columns = 0) const {
    const h5::Shape shape = root.shape(name);
    if (!(shape == h5::Shape{rows, columns}))
      refuse(fmt::format("dataset {} has {}, expected {}", name, describe(shape),
                         describe({rows, columns})));
    std::vector<T> out(rows);
    root.read(name, values(out));
    return out;
  }

  static std::string describe(h5::Shape shape) {
    return shape.columns == 0 ? fmt::format("{} values", shape.rows)
                              : fmt::format("{} rows of {}", shape.rows, shape.columns);
  }

  Checkpoint read_all(const h5::Group& root, StoredConstants* constants) const {
    Checkpoint c;
    c.format_version = checkpoint_format_version;
    c.backend = word(root, "backend", {BackendKind::cpu, BackendKind::cuda});
    c.precision =
        word(root, "precision", {Precision::single_precision, Precision::double_precision});
    c.scene_text = root.read_text("scene");

    WorldState& s = c.state;
    s.step = root.attribute<std::int64_t>("step");
    s.time = root.attribute<double>("time");
    s.insertions_done = root.attribute<std::uint64_t>("insertions_done");
    const std::uint64_t bodies = root.shape("body/id").rows;
    s.id = array<std::int32_t>(root, "body/id", bodies);
    s.position = array<Vec3d>(root, "body/position", bodies, 3);
    s.orientation = array<Quatd>(root, "body/orientation", bodies, 4);
    s.velocity = array<Vec3d>(root, "body/velocity", bodies, 3);
    s.angular_velocity = array<Vec3d>(root, "body/angular_velocity", bodies, 3);
    constants->radius = array<double>(root, "body/radius", bodies);
    constants->mass = array<double>(root, "body/mass", bodies);
    constants->group = array<std::int32_t>(root, "body/group", bodies);

    const std::uint64_t contacts = root.shape("contact/key").rows;
    const std::uint64_t impulses = root.shape("contact/impulse").rows;
    if (contacts == 0 ? impulses != 0 : impulses % contacts != 0)
      refuse(
          fmt::format("dataset contact/impulse has {} rows, expected a multiple of the {} of "
                      "contact/key",
                      impulses, contacts));
    s.contact_key = array<std::uint64_t>(root, "contact/key", contacts);
    s.contact_impulse = array<Vec3d>(root, "contact/impulse", impulses, 3);
    s.solver_memory = array<double>(root, "solver/memory", root.shape("solver/memory").rows);
    return c;
  }

  template <class Enum>
  Enum word(const h5::Group& root, const std::string& name,
            std::initializer_list<Enum> choices) const {
    const std::string text = root.text_attribute(name);
    for (const Enum choice : choices)
      if (text == to_string(choice)) return choice;
    refuse(fmt::format("attribute {} is \"{}\"", name, text));
  }

  std::filesystem::path path_;
};

void write_all(h5::Group root, const Contents& c) {
  const WorldState& s = c.state;
  const StoredConstants& constants = c.constants;
  root.write_text_attribute("format", format_name);
  root.write_attribute<std::int32_t>("format_version", checkpoint_format_version);
  root.write_text_attribute("program", fmt::format("scree {} ({})", version(), commit()));
  root.write_text_attribute("backend", to_string(c.backend));
  root.write_text_attribute("precision", to_string(c.precision));
  root.write_attribute<std::int64_t>("step", s.step);
  root.write_attribute<double>("time", s.time);
  root.write_attribute<std::uint64_t>("insertions_done", s.insertions_done);
  root.write_text("scene", c.scene_text);

  h5::Group body = root.create_group("body");
  body.write("id", std::span<const std::int32_t>(s.id));
  body.write("position", values(s.position), 3);
  body.write("orientation", values(s.orientation), 4);
  body.write("velocity", values(s.velocity), 3);
  body.write("angular_velocity", values(s.angular_velocity), 3);
  body.write("radius", values(constants.radius));
  body.write("mass", values(constants.mass));
  body.write("group", values(constants.group));
  h5::Group contact = root.create_group("contact");
  contact.write("key", values(s.contact_key));
  contact.write("impulse", values(s.contact_impulse), 3);
  root.create_group("solver").write("memory", values(s.solver_memory));
}

}  // namespace

const char* to_string(BackendKind backend) { return backend == BackendKind::cuda ? "cuda" : "cpu"; }

const char* to_string(Precision precision) {
  return precision == Precision::double_precision ? "double" : "float";
}

void write_checkpoint(const std::filesystem::path& path, const WorldState& state,
                      const Scene& scene, const std::string& scene_text, BackendKind backend,
                      Precision precision) {
  write_checkpoint(path, state, constants_of(scene), scene_text, backend, precision);
}

void write_checkpoint(const std::filesystem::path& path, const WorldState& state,
                      const BodyConstants& bodies, const std::string& scene_text,
                      BackendKind backend, Precision precision) {
  AtomicFile target(path);
  const StoredConstants constants = pick(state, bodies);
  try {
    h5::File file = h5::File::create(target.temporary(), seal_bytes);
    write_all(file.root(), {scene_text, backend, precision, state, constants});
    file.close();
  } catch (const h5::Error& error) {
    std::error_code ignored;
    const bool kept = std::filesystem::exists(path, ignored);
    throw RunError(fmt::format("cannot write checkpoint {}: {}{}", path.string(), error.what(),
                               kept ? "; the previous checkpoint is kept" : ""));
  }
  write_seal(target.temporary(), format_name, checkpoint_format_version);
  target.commit();
}

Checkpoint read_checkpoint(const std::filesystem::path& path) {
  StoredConstants constants;
  return Reader(path).read(&constants);
}

std::vector<ParticleState> read_checkpoint_particles(const std::filesystem::path& file) {
  StoredConstants constants;
  const Checkpoint checkpoint = Reader(file).read(&constants);
  const WorldState& s = checkpoint.state;
  std::vector<std::size_t> order(s.id.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return s.id[a] < s.id[b]; });
  std::vector<ParticleState> particles;
  for (const std::size_t i : order) {
    if (constants.radius[i] <= 0) continue;
    ParticleState particle;
    particle.position = s.position[i];
    particle.orientation = s.orientation[i];
    particle.velocity = s.velocity[i];
    particle.angular_velocity = s.angular_velocity[i];
    particle.radius = constants.radius[i];
    particle.mass = constants.mass[i];
    particle.group = constants.group[i];
    particles.push_back(particle);
  }
  if (particles.empty())
    throw InputError(fmt::format("checkpoint {} holds {} free bodies, none of them a sphere",
                                 file.string(), s.id.size()));
  return particles;
}

}  // namespace scree
