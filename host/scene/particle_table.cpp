#include "host/scene/particle_table.h"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <unordered_map>
#include <utility>

#include "host/io/csv.h"

namespace scree {
namespace {

/// Columns that belong together: all are there, or none is.
template <std::size_t N>
bool find_group(const CsvReader& csv, const char* const (&names)[N], int (&columns)[N]) {
  bool any = false;
  for (std::size_t i = 0; i < N; ++i) any = any || csv.find(names[i]) >= 0;
  for (std::size_t i = 0; i < N; ++i) columns[i] = any ? csv.require(names[i]) : -1;
  return any;
}

Vec3d vector(const CsvReader& csv, const int (&columns)[3]) {
  return {csv.number(columns[0]), csv.number(columns[1]), csv.number(columns[2])};
}

Quatd quaternion(const CsvReader& csv, const int (&columns)[4]) {
  const Quatd q{csv.number(columns[0]), csv.number(columns[1]), csv.number(columns[2]),
                csv.number(columns[3])};
  const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  if (!(std::abs(length - 1) <= 1e-3))
    csv.refuse(columns[0], "qw, qx, qy, qz must be a unit quaternion");
  return normalized(q);
}

double positive(const CsvReader& csv, int column, const char* unit) {
  const double value = csv.number(column);
  if (!(value > 0)) csv.refuse(column, std::string("must be positive [") + unit + "]");
  return value;
}

/// A whole number from zero on.
int number_below(const CsvReader& csv, int column, int end) {
  const double value = csv.number(column);
  if (!(value >= 0 && value < end && value == std::floor(value)))
    csv.refuse(
        column,
        fmt::format("must be a whole number from 0 to {}, that of a shape in the scene", end - 1));
  return static_cast<int>(value);
}

/// Numbers names in the order in which a column first gives them.
class Names {
 public:
  explicit Names(std::vector<std::string>& names) : names_(&names) {}
  int index_of(const CsvReader& csv, int column) {
    const std::string name(csv.cell(column));
    if (name.empty()) csv.refuse(column, "must be a name");
    const auto [entry, is_new] = index_.emplace(name, static_cast<int>(names_->size()));
    if (is_new) names_->push_back(name);
    return entry->second;
  }

 private:
  std::vector<std::string>* names_;
  std::unordered_map<std::string, int> index_;
};

/// A property of the particles, filled row by row when the file has columns for it.
template <class T>
class Column {
 public:
  Column(bool given, std::size_t rows) : given_(given) {
    if (given_) values_.reserve(rows);
  }
  template <class F>
  void read(F value) {
    if (given_) values_.push_back(value());
  }
  void move_to(PerParticle<T>& property) {
    if (given_) property = PerParticle<T>(std::move(values_));
  }

 private:
  bool given_;
  std::vector<T> values_;
};

}  // namespace

ParticleTable read_particle_csv(const std::filesystem::path& file, int shapes) {
  CsvReader csv(file,
                {"x",  "y",  "z",  "vx", "vy", "vz", "radius", "mass",     "density", "id",   "qw",
                 "qx", "qy", "qz", "wx", "wy", "wz", "group",  "material", "scale",   "shape"});
  if (shapes > 0 && csv.find("radius") >= 0)
    csv.fail("the column \"radius\" is of spheres; bodies with a shape have a \"scale\"");
  for (const char* column : {"scale", "shape"})
    if (shapes == 0 && csv.find(column) >= 0)
      csv.fail(fmt::format("the column \"{}\" goes with a shape in the scene, and none is given",
                           column));
  int at_position[3];
  int at_velocity[3];
  int at_spin[3];
  int at_orientation[4];
  for (int k = 0; k < 3; ++k) at_position[k] = csv.require(std::string(1, "xyz"[k]));
  const int at_radius = csv.find("radius");
  const int at_mass = csv.find("mass");
  const int at_density = csv.find("density");
  if (at_mass >= 0 && at_density >= 0)
    csv.fail("it has the columns \"mass\" and \"density\"; expected one of them");
  const int at_group = csv.find("group");
  const int at_material = csv.find("material");
  const int at_scale = csv.find("scale");
  const int at_shape = csv.find("shape");
  const std::size_t rows = csv.line_count();
  ParticleTable table;
  ParticleSet& particles = table.particles;
  particles.position.reserve(rows);
  Column<Vec3d> velocity(find_group(csv, {"vx", "vy", "vz"}, at_velocity), rows);
  Column<Vec3d> spin(find_group(csv, {"wx", "wy", "wz"}, at_spin), rows);
  Column<Quatd> orientation(find_group(csv, {"qw", "qx", "qy", "qz"}, at_orientation), rows);
  Column<double> radius(at_radius >= 0, rows);
  Column<double> mass(at_mass >= 0, rows);
  Column<double> density(at_density >= 0, rows);
  Column<int> group(at_group >= 0, rows);
  Column<int> material(at_material >= 0, rows);
  Column<double> scale(at_scale >= 0, rows);
  Column<int> shape(at_shape >= 0, rows);
  Names groups(table.groups);
  Names materials(table.materials);
  while (csv.next()) {
    particles.position.push_back(vector(csv, at_position));
    velocity.read([&] { return vector(csv, at_velocity); });
    spin.read([&] { return vector(csv, at_spin); });
    orientation.read([&] { return quaternion(csv, at_orientation); });
    radius.read([&] { return positive(csv, at_radius, "m"); });
    mass.read([&] { return positive(csv, at_mass, "kg"); });
    density.read([&] { return positive(csv, at_density, "kg/m^3"); });
    group.read([&] { return groups.index_of(csv, at_group); });
    material.read([&] { return materials.index_of(csv, at_material); });
    scale.read([&] { return positive(csv, at_scale, "-"); });
    shape.read([&] { return number_below(csv, at_shape, shapes); });
  }
  velocity.move_to(particles.velocity);
  spin.move_to(particles.angular_velocity);
  orientation.move_to(particles.orientation);
  radius.move_to(particles.radius);
  mass.move_to(particles.mass);
  density.move_to(particles.density);
  group.move_to(particles.group);
  material.move_to(particles.material);
  scale.move_to(table.scale);
  shape.move_to(table.shape);
  return table;
}

void read_motion_csv(const std::filesystem::path& file, Motion& motion) {
  CsvReader csv(file, {"time", "x", "y", "z", "qw", "qx", "qy", "qz"});
  const int time = csv.require("time");
  const int position[3] = {csv.require("x"), csv.require("y"), csv.require("z")};
  int orientation[4];
  const bool turns = find_group(csv, {"qw", "qx", "qy", "qz"}, orientation);
  while (csv.next()) {
    const double t = csv.number(time);
    if (!motion.times.empty() && t <= motion.times.back())
      csv.refuse(time, "must be larger than the time before [s]");
    motion.times.push_back(t);
    motion.positions.push_back(vector(csv, position));
    if (turns) motion.orientations.push_back(quaternion(csv, orientation));
  }
  if (motion.times.size() < 2) csv.fail("must hold two rows or more");
}

}  // namespace scree
