#include "host/particle_table.h"

#include <algorithm>
#include <cmath>

#include "host/csv.h"

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

/// Index of a name in the list, which grows by names not met before.
int index_of(const CsvReader& csv, int column, std::vector<std::string>& names) {
  const std::string_view name = csv.cell(column);
  if (name.empty()) csv.refuse(column, "must be a name");
  const auto at = std::find(names.begin(), names.end(), name);
  if (at == names.end()) {
    names.emplace_back(name);
    return static_cast<int>(names.size()) - 1;
  }
  return static_cast<int>(at - names.begin());
}

}  // namespace

ParticleTable read_particle_csv(const std::filesystem::path& file) {
  CsvReader csv(file, {"x", "y", "z", "vx", "vy", "vz", "radius", "mass", "density", "id", "qw",
                       "qx", "qy", "qz", "wx", "wy", "wz", "group", "material"});
  int position[3];
  int velocity[3];
  int spin[3];
  int orientation[4];
  for (int k = 0; k < 3; ++k) position[k] = csv.require(std::string(1, "xyz"[k]));
  ParticleTable table;
  table.has_velocity = find_group(csv, {"vx", "vy", "vz"}, velocity);
  table.has_angular_velocity = find_group(csv, {"wx", "wy", "wz"}, spin);
  const bool has_orientation = find_group(csv, {"qw", "qx", "qy", "qz"}, orientation);
  const int radius = csv.find("radius");
  const int mass = csv.find("mass");
  const int density = csv.find("density");
  const int group = csv.find("group");
  const int material = csv.find("material");
  while (csv.next()) {
    ParticleState p;
    p.position = vector(csv, position);
    if (table.has_velocity) p.velocity = vector(csv, velocity);
    if (table.has_angular_velocity) p.angular_velocity = vector(csv, spin);
    if (has_orientation) p.orientation = quaternion(csv, orientation);
    if (radius >= 0) p.radius = positive(csv, radius, "m");
    if (mass >= 0) p.mass = positive(csv, mass, "kg");
    if (density >= 0) p.density = positive(csv, density, "kg/m^3");
    if (group >= 0) p.group = index_of(csv, group, table.groups);
    if (material >= 0) p.material = index_of(csv, material, table.materials);
    table.particles.push_back(p);
  }
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
