#pragma once
// frames.vtkhdf: all bodies at many times, as ParaView reads them (transient VTKHDF, PolyData).
//
// One point per body, in the order of ids, positions in double. Point data per frame are those that
// the model of dynamics says in its card, in the precision of the run; of rigid bodies velocity
// [m/s], angular_velocity (world frame) [rad/s], orientation (w, x, y, z) and speed [m/s].
// Point data that never change are stored once: id, radius (0: not a sphere) and half_extents
// (boxes and containers) [m] in the precision of the run, mass [kg], group, kind (0 free, 1 fixed,
// 2 kinematic), shape (0 sphere, 1 box, 2 half space, 3 container, 4 mesh). They hold all bodies of
// the scene; a frame uses as many as had been inserted by then, so bodies may join from frame to
// frame. The file is a TwinFile: complete at every moment.
//
// Where ranks write pieces (host/io/frame_index.h) a file has the bodies of one rank, others in each frame: by rising ids,
// with all point data in every frame.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

#include "dynamics/dynamics_card.h"
#include "host/io/twin_file.h"
#include "host/own_bodies.h"
#include "host/scene.h"
#include "host/world.h"

namespace scree {

/// The group of a file that brings pieces together, see frame_index.h.
inline constexpr const char* frame_pieces_group = "Pieces";

/// Which bodies the frames of a file have.
enum class FrameBodies {
  all,  ///< those that are inserted, by id; what never changes is stored once
  own   ///< those of a rank; what never changes is stored in each frame
};

/// What a file of frames holds of each body.
struct FrameFormat {
  std::span<const FrameField> fields;                 ///< of the model
  Precision precision = Precision::single_precision;  ///< of the run
  FrameBodies bodies = FrameBodies::all;
};

/// How much of the file is filled. A part is a list of cells; frames with as many bodies as the one before share its part.
struct FrameExtent {
  std::uint64_t body_capacity = 0;  ///< bodies of the whole scene
  std::int64_t frames = 0;
  std::uint64_t points = 0;  ///< of all frames
  std::int64_t parts = 0;
  std::uint64_t cells = 0;        ///< of all parts
  std::uint64_t last_bodies = 0;  ///< bodies of the last frame, cells of the last part
  std::uint64_t most_bodies = 0;  ///< of a frame

  /// Place of the last part in Vertices/Offsets, where each has one row more than cells.
  std::uint64_t last_offset() const {
    return cells - last_bodies + static_cast<std::uint64_t>(parts - 1);
  }
};

/// @param before  a file without a frame of so many bodies, at least one  @return the file with it
FrameExtent extended(const FrameExtent& before, std::uint64_t bodies);

/// @throws InputError "cannot continue PATH: ..." when a file holds less than it should, or in another precision; what is no
///         such file at all throws h5::Error
void require_filled(const h5::Group& root, const std::filesystem::path& path,
                    const FrameExtent& extent, const FrameFormat& format);

class FrameWriter {
 public:
  /// Starts a new file, published with the first frame, or continues the one
  /// a checkpoint belongs to.
  /// @param precision    of the run: what velocities and orientations are stored in
  /// @param resume_time  simulated time of the checkpoint [s]: frames after it are dropped. No file
  ///                     there counts as an empty one. Not set: an existing file is removed
  /// @throws InputError when the file to continue is unreadable, of another scene or
  ///         of another precision
  /// @throws RunError when the file cannot be written
  FrameWriter(std::filesystem::path path, const Scene& scene, Precision precision,
              std::optional<double> resume_time = {});

  /// The same for the bodies of one rank. @param body_capacity  bodies of the whole scene
  FrameWriter(std::filesystem::path path, std::span<const FrameField> fields, Precision precision,
              std::uint64_t body_capacity, std::optional<double> resume_time);

  /// Adds a frame and publishes it, unless it may wait. A frame at the time of the last one is not written again, and
  /// one without bodies is left out.
  /// @param time    simulated time [s], not before the last frame
  /// @param states  bodies inserted so far, by id; never fewer than before
  /// @throws RunError naming the file and the reason; the file keeps the earlier frames
  void append(double time, const BodyStates& states);
  /// The same for the bodies of one rank. @param constants  of all bodies of the run
  void append(double time, const OwnBodies& bodies, const BodyConstants& constants);

  /// From now on frames may wait for each other until they are published, see TwinFile.
  void publish_seldom() { file_.publish_seldom(); }
  /// Publishes the frames that wait. @throws RunError as append()
  void publish() { file_.publish(); }

  std::int64_t frame_count() const { return extent_.frames; }
  std::optional<double> last_time() const { return last_time_; }

 private:
  using Write = TwinFile::Write;
  void start(const Write& write_empty);
  void resume(double time);
  void append(double time, const BodyStates& states, const Write& write_constants);

  TwinFile file_;
  FrameFormat format_;
  FrameExtent extent_;
  std::optional<double> last_time_;
};

}  // namespace scree
