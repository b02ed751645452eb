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

#include "dynamics/dynamics_card.h"
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

/// The first version of the format that is still read.
constexpr int first_version = 1;

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
    const std::string fault =
        check_seal(path_, format_name, checkpoint_format_version, first_version);
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
        fmt::format("cannot read checkpoint {}: {}; expected a {} of format version {} to {}",
                    path_.string(), found, format_name, first_version, checkpoint_format_version));
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
    // Models may have none of these.
    if (root.has("body/orientation"))
      set.orientation = PerParticle(rows<Quatd>(root, "body/orientation", 4, bodies, wanted));
    if (root.has("body/velocity"))
      set.velocity = PerParticle(rows<Vec3d>(root, "body/velocity", 3, bodies, wanted));
    if (root.has("body/angular_velocity"))
      set.angular_velocity =
          PerParticle(rows<Vec3d>(root, "body/angular_velocity", 3, bodies, wanted));
    set.radius = PerParticle(rows<double>(root, "body/radius", 0, bodies, wanted));
    set.mass = PerParticle(rows<double>(root, "body/mass", 0, bodies, wanted));
    return set;
  }

  Checkpoint read_all(const h5::Group& root) const {
    Checkpoint c;
    c.format_version = root.attribute<std::int32_t>("format_version");
    if (c.format_version < first_version || c.format_version > checkpoint_format_version)
      refuse(fmt::format("attribute format_version is {}", c.format_version));
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
    const DynamicsCard& card = model_of(root, c.format_version);
    s.dynamics = card.name;
    for (const StateField& field : card.state)
      if (field.first_version <= c.format_version && c.format_version <= field.last_version &&
          (!field.may_be_absent || root.has(field.name)))
        read_field(root, field, s);
    const std::uint64_t bodies = root.shape("body/id").rows;
    for (const char* name : {"body/radius", "body/mass", "body/group"})
      require_shape(root, name, bodies);  // other scenes read them
    return c;
  }

  const DynamicsCard& model_of(const h5::Group& root, int format_version) const {
    const std::string name = format_version == 1 ? "rigid" : root.text_attribute("dynamics");
    for (const DynamicsCard& card : dynamics_cards())
      if (name == card.name) return card;
    refuse(fmt::format("attribute dynamics is \"{}\", which this program does not have", name));
  }

  void read_field(const h5::Group& root, const StateField& field, WorldState& s) const {
    require_rows(root, field);
    switch (field.type) {
      case StateField::Type::int32:
        return read_rows<std::int32_t>(root, field, 0, s);
      case StateField::Type::uint64:
        return read_rows<std::uint64_t>(root, field, 0, s);
      case StateField::Type::number:
        return read_rows<double>(root, field, 0, s);
      case StateField::Type::vector:
        return read_rows<Vec3d>(root, field, 3, s);
      case StateField::Type::quaternion:
        return read_rows<Quatd>(root, field, 4, s);
    }
  }

  template <class T>
  void read_rows(const h5::Group& root, const StateField& field, std::uint64_t columns,
                 WorldState& s) const {
    std::vector<T> rows = array<T>(root, field.name, root.shape(field.name).rows, columns);
    if constexpr (!std::is_integral_v<T>) {
      if (field.largest > 0) require_up_to(field.largest, field.name, values(std::as_const(rows)));
    }
    s.add(field.name, std::move(rows));
  }

  /// An array has as many rows as the one it goes with, or a multiple of them.
  void require_rows(const h5::Group& root, const StateField& field) const {
    if (field.rows_of == nullptr) return;
    const std::uint64_t found = root.shape(field.name).rows, rows = root.shape(field.rows_of).rows;
    if (found == 0 && field.may_be_empty) return;
    std::string expected;
    for (std::uint64_t k = 1; k <= static_cast<std::uint64_t>(field.most_rows); ++k) {
      if (found == k * rows) return;
      expected += fmt::format("{}{}", k == 1 ? "" : " or ", k * rows);
    }
    refuse(fmt::format("dataset {} has {} rows, expected {}", field.name, found, expected));
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

template <class T>
std::uint64_t columns_of(const std::vector<T>&) {
  if constexpr (std::is_same_v<T, Vec3d>) return 3;
  if constexpr (std::is_same_v<T, Quatd>) return 4;
  return 0;
}

/// Writes f(constants) of the bodies of a state, in its order.
template <class T, class F>
void write_constant(h5::Group& group, const std::string& name, const Contents& c, F f) {
  std::vector<T> values;
  const std::vector<std::int32_t>& ids = c.state.at<std::int32_t>("body/id");
  values.reserve(ids.size());
  for (const int id : ids) values.push_back(f(c.bodies[static_cast<std::size_t>(id)]));
  group.write(name, std::span<const T>(values));
}

void write_all(h5::Group root, const Contents& c) {
  const WorldState& s = c.state;
  root.write_text_attribute("format", format_name);
  root.write_attribute<std::int32_t>("format_version", checkpoint_format_version);
  root.write_text_attribute("program", fmt::format("scree {} ({})", version(), commit()));
  root.write_text_attribute("backend", to_string(c.backend));
  root.write_text_attribute("precision", to_string(c.precision));
  root.write_text_attribute("dynamics", s.dynamics);
  root.write_attribute<std::int64_t>("step", s.step);
  root.write_attribute<double>("time", s.time);
  root.write_attribute<std::uint64_t>("insertions_done", s.insertions_done);
  root.write_text("scene", c.scene_text);

  for (const StateArray& array : s.arrays) {
    const std::string group = array.name.substr(0, array.name.find('/'));
    if (!root.has(group)) root.create_group(group);
    std::visit([&](const auto& rows) { root.write(array.name, values(rows), columns_of(rows)); },
               array.values);
  }
  h5::Group body = root.open_group("body");
  write_constant<double>(body, "radius", c, [](const BodyConstant& b) {
    return shape_card(b.shape).is_ball ? b.radius : 0.0;
  });
  write_constant<double>(body, "mass", c, [](const BodyConstant& b) { return b.mass; });
  write_constant<std::int32_t>(body, "group", c, [](const BodyConstant& b) { return b.group; });
}

}  // namespace

void restore_from(const std::filesystem::path& path, const Checkpoint& checkpoint, World& world) {
  try {
    world.restore(checkpoint.state);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", path.string(), error.what()));
  }
}

const char* to_string(BackendKind backend) { return backend == BackendKind::cuda ? "cuda" : "cpu"; }

const char* to_string(Precision precision) {
  return precision == Precision::double_precision ? "double" : "float";
}

void write_checkpoint(const std::filesystem::path& path, const WorldState& state,
                      const BodyConstants& bodies, const std::string& scene_text,
                      BackendKind backend, Precision precision) {
  for (const int id : state.at<std::int32_t>("body/id"))
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
