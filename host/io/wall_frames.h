#pragma once
// walls.vtkhdf: the surfaces of all fixed and kinematic bodies at the times of the frames, as
// ParaView reads them (transient VTKHDF, PolyData).
//
// Cell data, stored once: id, group, kind (1 fixed, 2 kinematic). Corners are stored in double, for
// a frame in which a wall has moved since the last one; other frames refer to the corners of the
// last one. The file is a TwinFile: complete at every moment.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "host/io/twin_file.h"
#include "host/io/wall_surfaces.h"
#include "host/world.h"

namespace scree {

/// How much of the file is filled.
struct WallExtent {
  std::int64_t frames = 0;
  std::uint64_t poses = 0;  ///< of all walls, each as many points as they have corners
};

class WallFrameWriter {
 public:
  /// Starts a new file, published with the first frame, or continues the one a checkpoint belongs
  /// to. A scene without fixed and kinematic bodies gets no file.
  /// @param resume_time  simulated time of the checkpoint [s]: frames after it are dropped. No file
  ///                     there counts as an empty one. Not set: an existing file is removed
  /// @throws InputError when the file to continue is unreadable or of other walls
  /// @throws RunError when the file cannot be written
  WallFrameWriter(std::filesystem::path path, const Scene& scene,
                  std::optional<double> resume_time = {});

  /// Adds a frame and publishes it, unless it may wait. One at the time of the last frame is not written again.
  /// @param time    simulated time [s], not before the last frame
  /// @param states  by id, of the bodies of the scene at least
  /// @throws RunError naming the file and the reason; the file keeps the earlier frames
  void append(double time, const BodyStates& states);

  /// From now on frames may wait for each other until they are published, see TwinFile.
  void publish_seldom() {
    if (file_) file_->publish_seldom();
  }
  /// Publishes the frames that wait. @throws RunError as append()
  void publish() {
    if (file_) file_->publish();
  }

  std::int64_t frame_count() const { return extent_.frames; }
  /// Ids of the bodies that it shows are below.
  std::size_t body_end() const;

 private:
  void start(const Scene& scene);
  void resume(double time);
  Filled filled() const;
  std::vector<Vec3d> corners(const BodyStates& states) const;

  std::vector<WallSurface> walls_;
  std::uint64_t corner_count_ = 0;
  std::uint64_t face_count_ = 0;
  std::uint64_t face_corner_count_ = 0;
  std::unique_ptr<TwinFile> file_;  ///< none without walls
  WallExtent extent_;
  std::vector<Vec3d> last_corners_;
  std::optional<double> last_time_;
};

}  // namespace scree
