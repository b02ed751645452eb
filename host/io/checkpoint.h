#pragma once
// checkpoint.h5: all that a run needs to go on bit for bit, and the spheres for
// other scenes to read.
//
// Layout (HDF5, sealed, see seal.h): attributes of the root group: format, format_version, program,
// backend, precision, step, time [s], insertions_done. Datasets: scene (text); body/id, position,
// orientation (w, x, y, z), velocity, angular_velocity in storage order, with radius (0: not a
// sphere), mass and group (index) of the same bodies; contact/key, impulse; solver/memory. Numbers
// are stored as the program holds them: IEEE doubles and integers.

#include <filesystem>
#include <string>

#include "host/scene.h"
#include "host/world.h"

namespace scree {

/// Number of the layout above; files of another version are refused.
inline constexpr int checkpoint_format_version = 1;

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
///         not HDF5, truncated, another program or format version, missing datasets, sizes that
///         disagree, or contents that do not match their checksum
Checkpoint read_checkpoint(const std::filesystem::path& path);

/// "cpu" or "cuda", "float" or "double": the words of files and the command line.
const char* to_string(BackendKind backend);
const char* to_string(Precision precision);

}  // namespace scree
