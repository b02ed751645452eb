#pragma once
// frames.vtkhdf: all bodies at many times, as ParaView reads them (transient VTKHDF, PolyData).
//
// One point per body, in the order of ids. Point data per frame: velocity [m/s], angular_velocity
// (world frame) [rad/s], orientation (w, x, y, z) and speed [m/s] in float, positions in double.
// Point data that never change are stored once: id, radius (0: not a sphere) [m], half_extents
// (boxes and containers) [m], mass [kg], group, kind (0 free, 1 fixed, 2 kinematic), shape (0
// sphere, 1 box, 2 half space, 3 container, 4 mesh). They hold all bodies of the scene; a frame
// uses as many as had been inserted by then, so bodies may join from frame to frame.
//
// Kill safety without copying the whole file each frame. HDF5 rewrites its own metadata in place,
// so a file being appended to is unreadable if the writer dies. Two copies are kept instead: the
// published file and a spare beside it (".next") that is one frame behind. append() brings the
// spare up to date (the frame it lacks comes from the published file), adds the new frame, syncs
// it, and renames it over the published name, whose old contents become the next spare. What
// carries the published name is always complete, and no reader ever sees it change under its name.
// The price is twice the writing and, while the run lasts, twice the disk space: a constant factor,
// where a copy per frame would be quadratic. Other ways that were weighed: one file per frame
// behind virtual datasets reads back zeros when moved without its parts; SWMR files of a killed
// writer need a repair tool before ParaView opens them.

#include <cstdint>
#include <filesystem>
#include <optional>

#include "host/scene.h"
#include "host/world.h"

namespace scree {

/// How much of the file is filled. A part is a list of cells; frames with as many bodies share one.
struct FrameExtent {
  std::uint64_t body_capacity = 0;  ///< bodies of the whole scene
  std::int64_t frames = 0;
  std::uint64_t points = 0;  ///< of all frames
  std::int64_t parts = 0;
  std::uint64_t cells = 0;        ///< of all parts
  std::uint64_t last_bodies = 0;  ///< bodies of the last frame, cells of the last part
};

class FrameWriter {
 public:
  /// Starts a new file, published with the first frame, or continues the one a checkpoint belongs
  /// to.
  /// @param resume_time  simulated time of the checkpoint [s]: frames after it are dropped. No file
  ///                     there counts as an empty one. Not set: an existing file is removed
  /// @throws InputError when the file to continue is unreadable or of another scene
  /// @throws RunError when the file cannot be written
  FrameWriter(std::filesystem::path path, const Scene& scene,
              std::optional<double> resume_time = {});
  ~FrameWriter();  ///< as finish()
  FrameWriter(const FrameWriter&) = delete;
  FrameWriter& operator=(const FrameWriter&) = delete;

  /// Adds a frame and publishes it. A frame at the time of the last one is not written again, and
  /// one without bodies is left out.
  /// @param time    simulated time [s], not before the last frame
  /// @param states  bodies inserted so far, by id; never fewer than before
  /// @throws RunError naming the file and the reason; the file keeps the earlier frames
  void append(double time, const BodyStates& states);

  std::int64_t frame_count() const { return extent_.frames; }
  std::optional<double> last_time() const { return last_time_; }

  /// Removes the spare copy. Every frame is on disk already.
  void finish() noexcept;

 private:
  void start(const Scene& scene);
  void resume(const Scene& scene, double time);
  void drop_frames_beyond(const FrameExtent& kept);
  void prepare_spare();
  void publish(bool keep_previous);

  std::filesystem::path path_;
  std::filesystem::path spare_;     ///< gets the next frame, then the published name
  std::filesystem::path previous_;  ///< the published file while names are exchanged
  FrameExtent extent_;
  std::optional<double> last_time_;
};

}  // namespace scree
