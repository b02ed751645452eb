#pragma once
// Many spheres read from a file: CSV written by other programs, or a checkpoint of an earlier run.

#include <filesystem>
#include <string>
#include <vector>

#include "host/scene.h"

namespace scree {

/// One sphere of a file. Zero radius, mass or density and index -1 mean "the file does not say".
struct ParticleState {
  Vec3d position;          ///< [m]
  Quatd orientation;       ///< body to world
  Vec3d velocity;          ///< [m/s]
  Vec3d angular_velocity;  ///< world frame [rad/s]
  double radius = 0;       ///< [m]
  double mass = 0;         ///< [kg]
  int group = -1;          ///< CSV: index into ParticleTable::groups
  double density = 0;      ///< [kg/m^3]
  int material = -1;       ///< CSV: index into ParticleTable::materials
};

struct ParticleTable {
  std::vector<ParticleState> particles;
  std::vector<std::string> groups;     ///< names found in the file
  std::vector<std::string> materials;  ///< names found in the file
  bool has_velocity = false;           ///< false: velocities are not in the file
  bool has_angular_velocity = false;
};

/// Reads a CSV file with the columns x, y, z and any of vx vy vz radius mass density qw qx qy qz
/// wx wy wz (world frame) group material id (not used). SI units.
/// @throws InputError naming file, line, column and value
ParticleTable read_particle_csv(const std::filesystem::path& file);

/// Reads the spheres of a checkpoint, in the order of their ids; group is ignored by the reader of
/// scenes. @throws InputError naming the file and what is wrong with it
std::vector<ParticleState> read_checkpoint_particles(const std::filesystem::path& file);

/// Reads a motion: columns time x y z (displacement [m]) and, all four or none, qw qx qy qz.
/// Fills times, positions and orientations. @throws InputError naming file, line, column and value
void read_motion_csv(const std::filesystem::path& file, Motion& motion);

}  // namespace scree
