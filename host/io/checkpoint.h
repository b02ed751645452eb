#pragma once
// checkpoint.h5: all that a run needs to go on bit for bit, and the spheres for
// other scenes to read.
//
// Layout (HDF5, sealed, see seal.h): attributes of the root group: format, format_version, program,
// backend, precision, dynamics (the model), step, time [s], insertions_done. Datasets: scene (text)
// and the arrays that the card of the model names (DynamicsCard::state); beside them in body/ radius
// (0: not a sphere), mass and group (index) of the bodies of body/id. Numbers are stored as the
// program holds them: IEEE doubles and integers.
//
// Arrays of rigid bodies: body/id, position, orientation (w, x, y, z), velocity, angular_velocity in
// storage order; contact/body_a and body_b (ids; -1: a wall), feature, impulse, mark; joint/impulse
// (force and moment by turns) where there are joints; solver/memory.
// Of bodies that a program added, by turns: added/integer (shape, open faces, mesh, material, group, locks), number (radius, volume,
// mass), vector (position, velocity, angular velocity, inertia, half extents, normal, moments), orientation, name (number of the
// body, length, letters); added/removed: ids of those that are no more.
// Version 1, which is still read, had no attribute dynamics, and contact/key, names of contacts in
// places of storage, where body_a, body_b, feature and mark are now.

#include <filesystem>
#include <string>

#include "host/scene.h"
#include "host/world.h"

namespace scree {

/// Number of the layout above; files of versions that are not known are refused.
inline constexpr int checkpoint_format_version = 2;

struct Checkpoint {
  int format_version = 0;
  std::string scene_text;  ///< as given to write_checkpoint
  BackendKind backend = BackendKind::cpu;
  Precision precision = Precision::single_precision;
  WorldState state;
};

/// Replaces the file in one rename: a kill or a full disk leaves the previous checkpoint.
/// @param bodies      constants of all bodies, by id
/// @param scene_text  the resolved scene, which --resume compares
/// @throws RunError naming the file and the reason
void write_checkpoint(const std::filesystem::path& path, const WorldState& state,
                      const BodyConstants& bodies, const std::string& scene_text,
                      BackendKind backend, Precision precision);

/// @throws InputError naming the file, what was found and what was expected: no such file,
///         not HDF5, truncated, another program, format version or model of dynamics, missing datasets, sizes that
///         disagree, or contents that do not match their checksum
Checkpoint read_checkpoint(const std::filesystem::path& path);

/// Takes a world to the state of a checkpoint.
/// @param path  of the file, for messages
/// @throws InputError naming the file when the state does not fit the world
void restore_from(const std::filesystem::path& path, const Checkpoint& checkpoint, World& world);

/// "cpu" or "cuda", "float" or "double": the words of files and the command line.
const char* to_string(BackendKind backend);
const char* to_string(Precision precision);

}  // namespace scree
