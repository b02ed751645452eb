#pragma once
// Many bodies read from a file: CSV written by other programs, or spheres of a checkpoint of an earlier run.

#include <filesystem>
#include <string>
#include <vector>

#include "host/scene.h"

namespace scree {

struct ParticleTable {
  /// What the file says of its particles; properties it is silent about are uniform and have their
  /// defaults. Groups and materials are indices into the lists below. Shapes are not set.
  ParticleSet particles;
  PerParticle<double> scale;           ///< of the shape [-]; uniform: the file has no such column
  PerParticle<int> shape;              ///< number in the list `shapes` of the scene; the same
  std::vector<std::string> groups;     ///< names found in the file
  std::vector<std::string> materials;  ///< names found in the file
};

/// Reads a CSV file with the columns x, y, z and any of vx vy vz mass density qw qx qy qz wx wy wz (world frame) group
/// material id (not used), and radius, or of bodies with shapes scale and shape. SI units.
/// @param shapes  in the list `shapes` of the scene; 0: the particles are spheres
/// @throws InputError naming file, line, column and value
ParticleTable read_particle_csv(const std::filesystem::path& file, int shapes);

/// Reads the spheres of a checkpoint with their masses and states, in the order of their ids.
/// @throws InputError naming the file and what is wrong with it
ParticleSet read_checkpoint_particles(const std::filesystem::path& file);

/// Reads a motion: columns time x y z (displacement [m]) and, all four or none, qw qx qy qz.
/// Fills times, positions and orientations. @throws InputError naming file, line, column and value
void read_motion_csv(const std::filesystem::path& file, Motion& motion);

}  // namespace scree
