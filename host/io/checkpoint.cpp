#include "host/io/checkpoint.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <span>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "host/error.h"
#include "host/io/atomic_file.h"
#include "host/io/h5.h"
#include "host/io/seal.h"
#include "host/io/values.h"
#include "host/scene/particle_table.h"
#include "host/version.h"
#include "shapes/shape_card.h"

namespace scree {
namespace {

constexpr const char* format_name = "scree checkpoint";

/// Positions [m] and speeds [m/s, rad/s] of runs are far below this, and those far above it are no
/// place where contacts could be found in float.
constexpr double most_size = 1e15;

/// What a float holds.
constexpr double most_float = std::numeric_limits<float>::max();

/// Beyond this, step numbers are no longer exact where they are doubles.
constexpr std::int64_t most_steps = std::int64_t{1} << 53;

/// All of a checkpoint, borrowed.
struct Contents {
  const std::string& scene_text;
  BackendKind backend;
  Precision precision;
  const WorldState& state;
  const BodyConstants& bodies;
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

  Checkpoint read() const { return opened(&Reader::read_all); }
  ParticleSet read_particles() const { return opened(&Reader::read_spheres); }

 private:
  /// What a function below reads from the root group.
  template <class T>
  T opened(T (Reader::*read)(const h5::Group&) const) const try {
    const std::string fault = check_seal(path_, format_name, checkpoint_format_version);
    if (!fault.empty()) refuse(fault);
    return (this->*read)(h5::File::open_foreign(path_).root());
  } catch (const h5::Error& error) {
    refuse(error.what());
  } catch (const std::bad_alloc&) {
    refuse("its arrays do not fit in memory");
  } catch (const std::length_error&) {
    refuse("its arrays do not fit in memory");
  }

  [[noreturn]] void refuse(const std::string& found) const {
    throw InputError(
        fmt::format("cannot read checkpoint {}: {}; expected a {} of format version {}",
                    path_.string(), found, format_name, checkpoint_format_version));
  }

  void require_shape(const h5::Group& root, const std::string& name, std::uint64_t rows,
                     std::uint64_t columns = 0) const {
    const h5::Shape shape = root.shape(name);
    if (!(shape == h5::Shape{rows, columns}))
      refuse(fmt::format("dataset {} has {}, expected {}", name, describe(shape),
                         describe({rows, columns})));
  }

  /// An array of bodies or contacts that must have the given shape.
  template <class T>
  std::vector<T> array(const h5::Group& root, const std::string& name, std::uint64_t rows,
                       std::uint64_t columns = 0) const {
    require_shape(root, name, rows, columns);
    std::vector<T> out(rows);
    root.read(name, values(out));
    return out;
  }

  static std::string describe(h5::Shape shape) {
    return shape.columns == 0 ? fmt::format("{} values", shape.rows)
                              : fmt::format("{} rows of {}", shape.rows, shape.columns);
  }

  /// Values of some rows of an array with one row per body.
  template <class T>
  std::vector<T> rows(const h5::Group& root, const std::string& name, std::uint64_t columns,
                      std::uint64_t bodies, const std::vector<std::uint32_t>& wanted) const {
    const std::vector<T> all = array<T>(root, name, bodies, columns);
    std::vector<T> out;
    out.reserve(wanted.size());
    for (const std::uint32_t row : wanted) out.push_back(all[row]);
    return out;
  }

  /// One array after the other, so that little is held twice.
  ParticleSet read_spheres(const h5::Group& root) const {
    const std::uint64_t bodies = root.shape("body/id").rows;
    std::vector<std::uint32_t> wanted;  // rows of spheres, in the order of ids
    {
      const auto radius = array<double>(root, "body/radius", bodies);
      const auto id = array<std::int32_t>(root, "body/id", bodies);
      wanted.reserve(bodies);
      for (std::uint32_t row = 0; row < bodies; ++row)
        if (radius[row] > 0) wanted.push_back(row);
      std::sort(wanted.begin(), wanted.end(),
                [&](std::uint32_t a, std::uint32_t b) { return id[a] < id[b]; });
    }
    if (wanted.empty())
      throw InputError(fmt::format("checkpoint {} holds {} free bodies, none of them a sphere",
                                   path_.string(), bodies));
    ParticleSet set;
    set.position = rows<Vec3d>(root, "body/position", 3, bodies, wanted);
    set.orientation = PerParticle(rows<Quatd>(root, "body/orientation", 4, bodies, wanted));
    set.velocity = PerParticle(rows<Vec3d>(root, "body/velocity", 3, bodies, wanted));
    set.angular_velocity =
        PerParticle(rows<Vec3d>(root, "body/angular_velocity", 3, bodies, wanted));
    set.radius = PerParticle(rows<double>(root, "body/radius", 0, bodies, wanted));
    set.mass = PerParticle(rows<double>(root, "body/mass", 0, bodies, wanted));
    return set;
  }

  Checkpoint read_all(const h5::Group& root) const {
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
    if (s.step < 0 || s.step > most_steps)
      refuse(fmt::format("attribute step is {}, expected 0 to {}", s.step, most_steps));
    if (!(std::isfinite(s.time) && s.time >= 0))
      refuse(fmt::format("attribute time is {}, expected a time from 0 on", s.time));
    const std::uint64_t bodies = root.shape("body/id").rows;
    s.id = array<std::int32_t>(root, "body/id", bodies);
    s.position = array<Vec3d>(root, "body/position", bodies, 3);
    s.orientation = array<Quatd>(root, "body/orientation", bodies, 4);
    s.velocity = array<Vec3d>(root, "body/velocity", bodies, 3);
    s.angular_velocity = array<Vec3d>(root, "body/angular_velocity", bodies, 3);
    for (const char* name : {"body/radius", "body/mass", "body/group"})
      require_shape(root, name, bodies);  // other scenes read them

    const std::uint64_t contacts = root.shape("contact/key").rows;
    const std::uint64_t impulses = root.shape("contact/impulse").rows;
    if (impulses != contacts && impulses != 2 * contacts)
      refuse(fmt::format("dataset contact/impulse has {} rows, expected {}, or {} with moments",
                         impulses, contacts, 2 * contacts));
    s.contact_key = array<std::uint64_t>(root, "contact/key", contacts);
    s.contact_impulse = array<Vec3d>(root, "contact/impulse", impulses, 3);
    s.solver_memory = array<double>(root, "solver/memory", root.shape("solver/memory").rows);
    require_up_to(most_size, "body/position", values(s.position));
    require_up_to(2, "body/orientation", values(s.orientation));
    require_up_to(most_size, "body/velocity", values(s.velocity));
    require_up_to(most_size, "body/angular_velocity", values(s.angular_velocity));
    require_up_to(most_float, "contact/impulse", values(s.contact_impulse));
    require_up_to(most_float, "solver/memory", s.solver_memory);
    return c;
  }

  void require_up_to(double most, const char* name, std::span<const double> numbers) const {
    for (const double x : numbers)
      if (!(std::abs(x) <= most))
        refuse(
            fmt::format("dataset {} holds {}, expected finite numbers up to {:g}", name, x, most));
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

/// Writes f(constants) of the bodies of a state, in its order.
template <class T, class F>
void write_constant(h5::Group& group, const std::string& name, const Contents& c, F f) {
  std::vector<T> values;
  values.reserve(c.state.id.size());
  for (const int id : c.state.id) values.push_back(f(c.bodies[static_cast<std::size_t>(id)]));
  group.write(name, std::span<const T>(values));
}

void write_all(h5::Group root, const Contents& c) {
  const WorldState& s = c.state;
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
  write_constant<double>(body, "radius", c, [](const BodyConstant& b) {
    return shape_card(b.shape).is_ball ? b.radius : 0.0;
  });
  write_constant<double>(body, "mass", c, [](const BodyConstant& b) { return b.mass; });
  write_constant<std::int32_t>(body, "group", c, [](const BodyConstant& b) { return b.group; });
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
                      const BodyConstants& bodies, const std::string& scene_text,
                      BackendKind backend, Precision precision) {
  for (const int id : state.id)
    if (id < 0 || static_cast<std::size_t>(id) >= bodies.size())
      throw RunError(fmt::format("cannot write a checkpoint: body id {} is not in the scene", id));
  AtomicFile target(path);
  try {
    h5::File file = h5::File::create(target.temporary(), seal_bytes);
    write_all(file.root(), {scene_text, backend, precision, state, bodies});
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

Checkpoint read_checkpoint(const std::filesystem::path& path) { return Reader(path).read(); }

ParticleSet read_checkpoint_particles(const std::filesystem::path& file) {
  return Reader(file).read_particles();
}

}  // namespace scree
